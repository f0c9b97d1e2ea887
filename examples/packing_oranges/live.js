// Both arms, the oranges and the plan, drawn on a plane canvas: capsules from the farthest to the nearest.
import {Stream} from './stream.js';

const $ = id => document.getElementById(id);
const steps = ['look', 'reach above', 'reach', 'take', 'squeeze', 'lift', 'to box', 'lift a bad one', 'to bin', 'release', 'go back'];
const colours = ['#3b76c4', '#8a5bb5'];
const view = {turn: -0.6, tilt: 0.62, far: 2.75};
const packing = window.packing = {frames: 0, messages: 0, state: null, trays: [], errors: 0};

const css = name => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
/// A point in the world to the canvas: x, y in pixels, the scale there [pixels/m], its depth.
function camera(w, h) {
  const ct = Math.cos(view.turn), st = Math.sin(view.turn), cu = Math.cos(view.tilt), su = Math.sin(view.tilt), f = 1.25 * Math.min(w, 1.5 * h);
  const middle = packing.state?.stands?.[1] ?? 0;  // it goes along with a robot that drives
  return (x, y, z) => {
    y -= middle;
    const a = ct * x + st * y, b = -st * x + ct * y, up = z - 0.25;
    const depth = view.far + cu * b - su * up, s = f / Math.max(0.2, depth);
    return [w / 2 + s * a, h / 2 - s * (su * b + cu * up), s, depth];
  };
}
function draw() {
  const k = $('world'), dpr = devicePixelRatio || 1, w = k.clientWidth, h = k.clientHeight, s = packing.state;
  if (k.width !== Math.round(w * dpr)) k.width = Math.round(w * dpr), k.height = Math.round(h * dpr);
  const g = k.getContext('2d'), at = camera(w, h);
  g.setTransform(dpr, 0, 0, dpr, 0, 0);
  g.clearRect(0, 0, w, h);
  const line = css('--line'), ink = css('--ink'), soft = css('--soft');
  const path = points => { g.beginPath(); points.forEach((p, i) => i ? g.lineTo(p[0], p[1]) : g.moveTo(p[0], p[1])); g.closePath(); };
  g.lineWidth = 1, g.strokeStyle = line;
  const [wide, deep, ...tables] = s?.stands ? [0.5, 0.62, 0, 1.6] : [0.9, 0.7, 0];
  for (const y of tables) path([[-wide, y - deep], [wide, y - deep], [wide, y + deep], [-wide, y + deep]].map(([x, y]) => at(x, y, 0))), g.stroke();
  if (s?.stands) {
    const [x, y, yaw] = s.stands, c = Math.cos(yaw), n = Math.sin(yaw), on = ([a, b, z]) => at(x + c * a - n * b, y + n * a + c * b, z);
    for (const a of [-0.6, 0.6]) path([[a - 0.1, -0.35, -0.75], [a + 0.1, -0.35, -0.75], [a + 0.1, 0.35, -0.75], [a - 0.1, 0.35, -0.75]].map(on)), g.fillStyle = 'rgba(90,100,115,.25)', g.fill(), g.stroke();
    for (const a of [-0.6, 0.6]) { const p = on([a, 0, -0.75]), q = on([a, 0, 0]); g.beginPath(), g.moveTo(p[0], p[1]), g.lineTo(q[0], q[1]), g.lineWidth = 0.1 * p[2], g.strokeStyle = 'rgba(90,100,115,.35)', g.stroke(), g.lineWidth = 1; }
  }
  const names = ['box', 'bin', 'oranges', 'bin', 'oranges'];
  packing.trays.forEach(([x, y, hx, hy, wall], i) => {
    const corners = [[-1, -1], [1, -1], [1, 1], [-1, 1]].map(([a, b]) => [x + a * hx, y + b * hy]);
    path(corners.map(([a, b]) => at(a, b, 0))), g.fillStyle = i === 0 ? 'rgba(190,140,70,.25)' : 'rgba(130,130,130,.14)', g.fill();
    g.strokeStyle = soft;
    path(corners.map(([a, b]) => at(a, b, wall))), g.stroke();
    for (const [a, b] of corners) { const p = at(a, b, 0), q = at(a, b, wall); g.beginPath(), g.moveTo(p[0], p[1]), g.lineTo(q[0], q[1]), g.stroke(); }
    const p = at(x, y - hy, 0);
    g.fillStyle = soft, g.font = '12px system-ui', g.textAlign = 'center', g.fillText(names[i], p[0], p[1] + 14);
  });
  if (!s) return;
  const things = [];
  const ball = (x, y, z, r, colour) => { const p = at(x, y, z); things.push([p[3], () => { g.beginPath(), g.arc(p[0], p[1], r * p[2], 0, 7), g.fillStyle = colour, g.fill(), g.lineWidth = 1, g.strokeStyle = 'rgba(0,0,0,.35)', g.stroke(); }]); };
  for (const [x, y, z, r] of s.oranges) ball(x, y, z, r, '#f28c1e');
  for (const [x, y, z, r] of s.things) ball(x, y, z, r, '#a02c6e');
  const capsule = (c, colour, arm) => {
    const p = at(c[0], c[1], c[2]), q = at(c[3], c[4], c[5]), r = c[6] * (p[2] + q[2]) / 2;
    things.push([(p[3] + q[3]) / 2, () => {
      g.lineCap = 'round';
      const stroke = (wide, style) => { g.beginPath(), g.moveTo(p[0], p[1]), g.lineTo(q[0] + 0.01, q[1]), g.lineWidth = wide, g.strokeStyle = style, g.stroke(); };
      stroke(2 * r + 2, arm.kept ? '#d98200' : 'rgba(0,0,0,.45)'), stroke(2 * r, colour), g.globalAlpha = 0.25, stroke(0.8 * r, '#fff'), g.globalAlpha = 1;
    }]);
  };
  s.arms.forEach((arm, a) => {
    arm.parts.forEach((c, i) => capsule(c, i === 6 ? '#555c66' : colours[a], arm));
    arm.fingers.forEach(c => capsule(c, '#2b3038', arm));
    if (arm.touched) { const c = arm.parts[2], p = at((c[0] + c[3]) / 2, (c[1] + c[4]) / 2, (c[2] + c[5]) / 2); things.push([p[3] - 1, () => { g.beginPath(), g.arc(p[0], p[1], 0.11 * p[2], 0, 7), g.lineWidth = 4, g.strokeStyle = '#d1242f', g.stroke(); }]); }
  });
  things.sort((a, b) => b[0] - a[0]).forEach(t => t[1]());
  s.arms.forEach((arm, a) => { const c = arm.parts[1], p = at(c[0], c[1], c[2] + 0.16); g.fillStyle = ink, g.font = '600 13px system-ui', g.textAlign = 'center', g.fillText(`arm ${a + 1}: ${arm.step}`, p[0], p[1]); });
  ++packing.frames;
}
function words() {
  const s = packing.state;
  if (!s) return;
  $('clock').textContent = s.time.toFixed(1) + ' s';
  $('count').textContent = `${s.box} in the box, ${s.bins} in the bins${s.lost ? `, ${s.lost} lost` : ''}, of ${s.all}`;
  s.arms.forEach((arm, a) => {
    let card = $('arm' + a);
    if (!card) {
      card = document.createElement('section'), card.id = 'arm' + a;
      const head = document.createElement('h2'), key = document.createElement('span'), list = document.createElement('ol');
      key.className = 'key', key.style.background = colours[a];
      head.append(key, `Arm ${a + 1}, ${s.robot}`);
      for (const step of s.stands ? [...steps, 'drive to the box', 'drive to the oranges'] : steps) list.append(Object.assign(document.createElement('li'), {textContent: step}));
      card.append(head, list, document.createElement('p'));
      $('arms').append(card);
    }
    for (const li of card.querySelectorAll('li')) li.textContent === arm.step ? li.setAttribute('aria-current', 'step') : li.removeAttribute('aria-current');
    card.querySelector('ol').className = arm.state === 'goes back' ? 'back' : '';
    const said = [arm.state, arm.box ? 'has the box' : '', arm.touched ? 'a person pushes its forearm' : '', arm.kept ? 'kept clear of the other arm' : ''].filter(x => x).join('; ');
    const p = card.querySelector('p');
    p.className = arm.state || arm.kept ? 'warn' : '';
    p.textContent = `finger ${arm.force.toFixed(1)} N` + (arm.stiffness ? `, last judged ${arm.good ? 'good' : 'bad'} (${arm.stiffness} N/m)` : '') + (said ? '; ' + said : '');
  });
}
function message(topic, type, time, bytes) {
  try {
    const value = JSON.parse(new TextDecoder().decode(bytes));
    if (topic === '/packing/trays') packing.trays = value;
    else packing.state = value, ++packing.messages;
  } catch (e) { ++packing.errors; }
}
const stream = packing.stream = new Stream(`ws://${location.host}/`, ['/packing/trays', '/packing/state'], {
  state: (text, good) => { $('link').textContent = text, $('link').className = 'chip ' + (good ? 'good' : 'bad'); },
  channels: () => {}, message, status: text => { $('said').textContent = text; }, services: () => {}, parameters: () => {},
  control: allowed => { $('resume').disabled = !allowed, $('resume').title = allowed ? 'Asks first (key R)' : 'Not allowed: start with --allow-control'; }});
const call = async (name, what) => { const a = await stream.call(name); $('said').textContent = a.done ? a.words : `not ${what}: ${a.words}`; };
$('stop').addEventListener('click', () => call('/packing/stop', 'stopped'));
$('resume').addEventListener('click', () => { if (confirm('Both arms will move again. Is everybody clear of them?')) call('/packing/resume', 'resumed'); });
addEventListener('keydown', e => {
  if (e.ctrlKey || e.metaKey || e.altKey) return;
  if (e.key === 's' || e.key === 'S') $('stop').click();
  if ((e.key === 'r' || e.key === 'R') && !$('resume').disabled) $('resume').click();
});
const canvas = $('world');
canvas.addEventListener('pointerdown', e => canvas.setPointerCapture(e.pointerId));
canvas.addEventListener('pointermove', e => { if (e.buttons) view.turn += 0.008 * e.movementX, view.tilt = Math.min(1.5, Math.max(0.1, view.tilt + 0.006 * e.movementY)); });
canvas.addEventListener('wheel', e => { e.preventDefault(), view.far = Math.min(6, Math.max(1.2, view.far * Math.exp(0.001 * e.deltaY))); }, {passive: false});
function frame() { draw(), words(), requestAnimationFrame(frame); }
requestAnimationFrame(frame);

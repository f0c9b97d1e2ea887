// The page: what comes from a running job or a file, at the present instant or an earlier one.
import {decode} from './cdr.js';
import {bars, colour, hovers, lines, strip} from './charts.js';
import {readMcap} from './replay.js';
import {RobotView} from './robot.js';
import {reasons} from './reasons.js';
import {feltWords} from './skin.js';
import {Stream} from './stream.js';
import {Timeline} from './timeline.js';

const $ = id => document.getElementById(id);
const topics = ['/joint_states', '/skinctl/torque_shares', '/skinctl/status', '/skin/cells', '/skin/contacts', '/tf', '/robot_description', '/skin/layout', '/skin/felt'];
const window_s = 90, shown_s = 10;
const state = {timeline: new Timeline(window_s), live: true, file: null, at: 0, view: null, control: false, names: [], laws: [], errors: 0, work: []};  // work: times of the last frames [ms]
window.skinctl = state;  // for tests and the curious

function chip(text, good) { $('link').textContent = text; $('link').className = 'chip ' + (good ? 'good' : 'bad'); }

/// Takes a message; clouds are kept as they came, small ones decoded.
function feed(topic, type, time, bytes) {
  if (!topics.includes(topic)) return;
  let value;
  try { value = decode(type, bytes); } catch (e) { ++state.errors; return; }
  if (value === undefined) return;
  if (topic === '/robot_description') { if (state.view) state.view.robot(value); else state.urdf = value; return; }
  if (topic === '/skin/layout') {
    try { state.layout = JSON.parse(value); } catch (e) { ++state.errors; return; }
    if (state.view) state.view.layout(state.layout);
    showFelt();
    return;
  }
  if (topic === '/skin/felt') {
    try { state.felt = JSON.parse(value); } catch (e) { ++state.errors; return; }
    showFelt();
    return;
  }
  if (topic === '/skinctl/status') { try { value = JSON.parse(value); } catch (e) { ++state.errors; return; } }
  if (topic === '/skin/cells') {  // a third of its bytes are drawn
    const {view, step, fields, count} = value, small = new DataView(new ArrayBuffer(16 * count));
    for (let i = 0; i < count; ++i)
      ['force', 'proximity', 'cell', 'status'].forEach((f, k) => small.setUint32(16 * i + 4 * k, view.getUint32(i * step + fields[f], true), true));
    value = {view: small, step: 16, fields: {force: 0, proximity: 4, cell: 8, status: 12}, count};
  }
  state.heard = performance.now(), state.ended = undefined;
  state.timeline.add(topic, time, value);
}

/// How well each place feels: on the robot while the box is ticked, and in words.
function showFelt() {
  if (!state.felt) return;
  $('map').hidden = false, $('map-words').textContent = feltWords(state.felt);
  if (state.view) state.view.felt($('map-on').checked ? state.felt : null);
  $('map-legend').hidden = !$('map-on').checked;
}

function legend(element, names, from = 0) {
  element.replaceChildren(...names.map((name, k) => {
    const item = document.createElement('span'), key = document.createElement('span');
    key.className = 'key', key.style.background = colour(k + from);
    item.append(key, ' ' + name);
    return item;
  }));
}

const stale_s = 1;  // age from which on what is shown looks old [s]
const effects = ['none', 'report', 'refuse', 'wait', 'hold', 'limit', 'fade', 'brake', 'stop'];  // the last is the gravest
const reason = r => reasons[r]?.words || r.replaceAll('_', ' ');
const effect = list => list.reduce((most, r) => { const e = reasons[r]?.effect || 'report'; return effects.indexOf(e) > effects.indexOf(most) ? e : most; }, 'none');
/// What the robot does, in a word.
function doing(status, joints, newtons) {
  const e = effect(status.reasons);
  if (e === 'stop') return 'stopped';
  if (e === 'brake') return 'braking';
  if (newtons > 1) return 'giving way';
  if (e === 'hold' || e === 'wait') return 'waiting';
  return joints && joints.velocity && joints.velocity.some(v => Math.abs(v) > 0.005) ? 'moving' : 'at rest';
}
/// The age of what is shown; from `stale_s` on, or when the job has ended, all of it looks old.
function age() {
  const s = state.file || state.heard === undefined ? 0 : (performance.now() - state.heard) / 1e3, old = s > stale_s || (state.ended && !state.file);
  document.body.classList.toggle('old', Boolean(old));
  $('age').textContent = state.file || state.heard === undefined ? '' : old ? `${s.toFixed(0)} s old` : `${(1e3 * s).toFixed(0)} ms old`;
  if (old && state.live) $('state').textContent = state.ended ? `ended: ${state.ended}` : 'no data', $('state').className = 'state bad';
}

function show() {
  const t = state.timeline, now = state.live ? t.last : state.at;
  if (Number.isFinite(now)) {
    $('clock').textContent = now.toFixed(2) + ' s';
    const joints = t.at('/joint_states', now), shares = t.at('/skinctl/torque_shares', now), status = t.at('/skinctl/status', now);
    if (joints && joints.names.join() !== state.names.join()) { state.names = joints.names; legend($('joint-names'), state.names); }
    if (shares) {
      const laws = shares.dims[0].label.split(','), n = shares.dims[1].size;
      if (laws.join() !== state.laws.join()) { state.laws = laws; legend($('laws'), laws); $('laws').append('line: their sum'); }
      bars($('torque'), Array.from({length: n}, (_, j) => laws.map((_, k) => shares.data[k * n + j])), Array.from({length: n}, (_, j) => String(j)));
    }
    const begin = Math.max(t.first, t.last - (state.live || now > t.last - shown_s ? shown_s : Infinity)), from = state.live ? begin : Math.min(begin, now - shown_s / 2);
    const to = state.live ? t.last : Math.min(t.last, Math.max(now + shown_s / 2, from + shown_s));
    const part = (topic, f) => {
      const list = t.list(topic), a = Math.max(0, t.index(topic, from)), b = t.index(topic, to) + 1, every = Math.max(1, Math.floor((b - a) / 600)), out = [];
      for (let i = a; i < b; i += every) out.push([list[i].time, f(list[i].value)]);
      return out;
    };
    lines($('joints'), state.names.map((_, j) => ({k: j, name: String(j), points: part('/joint_states', v => v.position[j])})), from, to, now, 'rad');
    const total = c => { let sum = 0; for (let i = 0; i < c.count; ++i) sum += Math.hypot(...['fx', 'fy', 'fz'].map(f => c.view.getFloat32(i * c.step + c.fields[f], true))); return sum; };
    lines($('force'), [{k: 5, points: part('/skin/contacts', total)}], from, to, now, 'N', 0);
    const stages = status ? Object.keys(status.times_us) : [];
    if (stages.length) {
      if (stages.join() !== (state.stages || []).join()) { state.stages = stages; legend($('stages'), stages); }
      lines($('time'), stages.map((s, k) => ({k, name: s, points: part('/skinctl/status', v => v.times_us[s])})), from, to, now, 'µs', 0);
    }
    if (status) {
      const contacts = t.at('/skin/contacts', now), newtons = contacts ? total(contacts) : 0, word = doing(status, joints, newtons);
      showFinger(contacts ? newtons : null);
      $('state').textContent = word, $('state').className = 'state' + (/stopped|braking/.test(word) ? ' bad' : '');
      $('reasons').textContent = status.reasons.length ? status.reasons.map(reason).join('; ') : 'nothing limited, nothing held';
      strip($('events'), part('/skinctl/status', v => v.reasons).filter(([, r]) => r.length).map(([s, r]) => [s, effect(r)]), from, to);
      const facts = [['cycle', status.cycle], ['cycles dropped on the way', status.dropped]];
      const period = periodOf(t.list('/skinctl/status')), spent = Object.values(status.times_us).reduce((a, b) => a + b, 0);
      if (period > 0 && spent > 0) facts.push(['time of a cycle', `${spent.toFixed(0)} µs`], [`of its ${(1e3 * period).toFixed(0)} ms`, `${(1e-4 * spent / period).toFixed(1)} %`]);
      if (state.errors) facts.push(['messages that could not be read', state.errors]);
      $('facts').replaceChildren(...facts.flatMap(([k, v]) => { const a = document.createElement('dt'), b = document.createElement('dd'); a.textContent = k, b.textContent = v; return [a, b]; }));
    }
    if (state.view) {
      const tf = t.at('/tf', now), cells = t.at('/skin/cells', now), contacts = t.at('/skin/contacts', now);
      if (tf) state.view.tf(tf);
      if (cells && cells !== state.drawn_cells) state.view.readings(cells), state.drawn_cells = cells;
      if (contacts) state.view.contacts(contacts);
    }
    const range = Math.max(0.01, t.last - t.first);
    $('scrub').min = (-range).toFixed(2);
    if (state.live) $('scrub').value = 0;
    $('when').textContent = state.live ? 'now' : (now - t.last).toFixed(2) + ' s';
  }
  if (state.view) state.view.draw(getComputedStyle(document.documentElement).getPropertyValue('--card').trim() || '#fff');
}

/// The time of a cycle by the numbers and stamps of the last ones [s].
function periodOf(list) {
  const n = Math.min(list.length - 1, 15);
  if (n < 3) return 0;
  const a = list[list.length - 1 - n], b = list[list.length - 1], cycles = b.value.cycle - a.value.cycle;
  return cycles > 0 ? (b.time - a.time) / cycles : 0;
}

let next = 0;
function frame(time) {
  if (time >= next) {
    next = time + 33;
    const from = performance.now();
    play(time);
    show();
    age();
    state.work.push(performance.now() - from);
    if (state.work.length > 300) state.work.shift();
  }
  requestAnimationFrame(frame);
}

let played = 0;  // time of the last frame [ms]
/// Moves on in a recording.
function play(time) {
  const passed = 1e-3 * (time - played);
  played = time;
  if (!state.playing || state.live) return;
  state.at = Math.min(state.timeline.last, state.at + Math.min(passed, 0.2) * Number($('speed').value));
  $('scrub').value = (state.at - state.timeline.last).toFixed(2);
  if (state.at >= state.timeline.last) setPlaying(false);
}
function setPlaying(on) {
  if (on && state.at >= state.timeline.last) state.at = state.timeline.first;
  state.playing = on;
  $('play').textContent = on ? 'pause' : 'play', $('play').setAttribute('aria-pressed', String(on));
}
function setLive(on) {
  state.live = on;
  $('live').setAttribute('aria-pressed', String(on));
  if (!on) state.at = state.timeline.last + Number($('scrub').value);
}
function ask(question) {
  $('question').textContent = question;
  $('ask').returnValue = 'no';
  $('ask').showModal();
  return new Promise(done => $('ask').addEventListener('close', () => done($('ask').returnValue === 'yes'), {once: true}));
}
/// What the job says to the person at the page, with the time of day; it stays until the next.
function answer(words, good) { $('answer').textContent = `${new Date().toTimeString().slice(0, 8)} ${words}`, $('answer').className = good ? '' : 'bad'; }
async function request(name) {
  answer(name + ': no answer yet', false);
  const a = state.stream ? await state.stream.call('/skinctl/' + name.toLowerCase()) : {done: false, words: 'not connected'};
  answer(`${name}: ${a.done ? '' : 'refused, '}${a.words}`, a.done);
}
function stop() {
  if ($('ask').open) $('ask').close('no');
  request('Stop');
}
async function resume() { if (await ask('The robot will move again. Is everybody clear of it?')) request('Resume'); }

/// Sliders. A new value counts when it has been agreed to: asked once a slider is let go.
function parameters(list) {
  for (const p of list) {
    const [low, high] = JSON.parse(state.stream.facts['range of ' + p.name] || '[0,1]');
    let input = document.getElementById('p-' + p.name);
    if (!input) {
      const label = document.createElement('label'), name = document.createElement('span'), value = document.createElement('output');
      input = Object.assign(document.createElement('input'), {type: 'range', min: low, max: high, step: 'any', id: 'p-' + p.name, disabled: !state.control});
      name.textContent = p.name.replace('weight of ', '');
      // Whole hundredths, both ends among them: counted from a lower end of 0.1, the last step would miss 1.
      input.addEventListener('input', () => { value.textContent = Number(input.value).toFixed(2); });
      input.addEventListener('change', async () => {
        const asked = Math.min(high, Math.max(low, Number(Number(input.value).toFixed(2))));
        if (await ask(`Set ${p.name} to ${asked}? The robot's behaviour changes.`)) state.stream.set(p.name, asked);
        else input.value = input.dataset.known, value.textContent = Number(input.value).toFixed(2);
      });
      label.append(name, input, value);
      input.setAttribute('aria-label', p.name);
      $('weights').append(label);
      $('sliders').hidden = false;
    }
    input.value = p.value, input.dataset.known = p.value, input.parentElement.querySelector('output').textContent = Number(p.value).toFixed(2);
  }
}

const finger_topic = '/simulation/finger';
/// The pointer as a finger on a robot that is simulated. What it does is sent while it presses, however long a picture takes; a silent page's finger leaves.
const finger = {offered: false, spot: null, aside: [0, 0, 0], aim: null, by: null};
function press(x, y, by) {
  if (!finger.offered || finger.spot || !state.view || !state.live || state.file) return false;
  const spot = state.view.pick(x, y);
  if (!spot) return false;
  Object.assign(finger, {spot, by, force: 0, peak: 0, aside: [0, 0, 0], number: 1 + Math.floor(1e9 * Math.random())});
  state.view.controls.enabled = false;
  point();
  finger.sends = setInterval(point, 50);
  return true;
}
function release() {
  if (!finger.spot) return;
  clearInterval(finger.sends);
  finger.spot = finger.by = null;
  state.view.controls.enabled = true;
  state.stream.publish(finger_topic, {press: 0});
}
function point() {
  if (!finger.spot) return;
  const {link, p, n} = finger.spot;
  state.stream.publish(finger_topic, {press: finger.number, link, point: p, normal: n, stiffness: 3000, travel: 1e-3 * Number($('travel').value), aside: finger.aside});
}
function pointers() {
  const canvas = $('robot'), clip = e => { const b = canvas.getBoundingClientRect(); return [2 * (e.clientX - b.left) / b.width - 1, 1 - 2 * (e.clientY - b.top) / b.height]; };
  canvas.addEventListener('pointerdown', e => {
    finger.aim = null;
    if (e.button === 0 && press(...clip(e), e.pointerId)) canvas.setPointerCapture(e.pointerId);
  }, true);
  canvas.addEventListener('pointermove', e => {
    if (finger.by === e.pointerId) finger.aside = state.view.beside(...clip(e), finger.spot.at);
    else if (finger.offered && !finger.spot && state.view) canvas.classList.toggle('over', Boolean(state.view.pick(...clip(e))));
  });
  for (const end of ['pointerup', 'pointercancel', 'lostpointercapture']) canvas.addEventListener(end, e => { if (finger.by === e.pointerId) release(); });
  const arrows = {ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1]};
  canvas.addEventListener('keydown', e => {
    if (!finger.offered || !(arrows[e.key] || e.key === ' ')) return;
    e.preventDefault();
    finger.aim = finger.aim || [0, 0];
    if (arrows[e.key] && !finger.spot) finger.aim = finger.aim.map((v, i) => Math.min(0.98, Math.max(-0.98, v + 0.02 * arrows[e.key][i])));
    if (e.key === ' ' && !e.repeat) press(...finger.aim, 'key');
  });
  canvas.addEventListener('keyup', e => { if (e.key === ' ' && finger.by === 'key') release(); });
  canvas.addEventListener('blur', () => { finger.aim = null; if (finger.by === 'key') release(); });
  $('travel').addEventListener('input', () => { $('travel-mm').textContent = `${$('travel').value} mm`; });
}
/// Draws the finger, and says what it feels; `newtons`: what the robot's skin does, null without one.
function showFinger(newtons) {
  if (!finger.offered || !state.view) return;
  if (finger.spot) $('pressed').textContent = `On the finger: ${finger.force.toFixed(1)} N, at most ${finger.peak.toFixed(1)} N.` + (newtons === null ? '' : ` The robot feels ${newtons.toFixed(1)} N.`);
  const aimed = finger.aim && !finger.spot ? state.view.pick(...finger.aim) : null;
  state.view.point(finger.spot || aimed, finger.spot ? 0 : 0.03);
}

async function open(file) {
  const buffer = await file.arrayBuffer();
  if (state.stream) state.stream.on.message = () => {};
  release(), finger.offered = false, $('finger').hidden = true;
  document.body.classList.remove('old');
  state.timeline = new Timeline(Infinity), state.live = false, state.errors = 0, state.file = file.name;
  const result = readMcap(buffer, feed);
  chip(`${file.name}: ${result.words}`, result.messages > 0 && !result.cut);
  for (const id of ['stop', 'resume']) $(id).disabled = true;
  for (const id of ['play', 'pace']) $(id).hidden = false;
  state.at = state.timeline.last;
  $('scrub').value = 0, $('live').setAttribute('aria-pressed', 'false');
}

function control(allowed) {
  state.control = allowed;
  $('resume').disabled = !allowed;
  $('resume').title = allowed ? 'Asks first (key R)' : 'Not allowed: start with --allow-control';
  for (const input of document.querySelectorAll('#weights input')) input.disabled = !allowed;
}

RobotView.create($('robot')).then(view => {
  state.view = view;
  if (state.urdf) view.robot(state.urdf);
  if (state.layout) view.layout(state.layout), showFelt();
}, error => {
  $('robot').hidden = true, $('no3d').hidden = false;
  $('no3d').textContent = /WebGL/.test(error.message) ? `No picture of the robot: ${error.message}.` : 'No picture of the robot: three.js is missing. On Debian: sudo apt-get install libjs-three';
  state.no3d = error.message;
});
if (location.protocol.startsWith('http') && !new URLSearchParams(location.search).has('file')) {
  state.stream = new Stream(`ws://${location.host}/`, topics, {
    state: chip, channels: () => {}, message: feed, status: text => answer(text, false), ended: text => { state.ended = text; },
    services: () => {}, parameters, control, told: (topic, text) => { if (topic === finger_topic && finger.spot) finger.force = Number(text), finger.peak = Math.max(finger.peak, finger.force); },
    facts: facts => { finger.offered = 'takes ' + finger_topic in facts, $('finger').hidden = !finger.offered; }});
  pointers();
} else {
  chip('open an .mcap file', false);
}
$('map-on').addEventListener('change', showFelt);
$('stop').addEventListener('click', stop);
$('play').addEventListener('click', () => setPlaying(!state.playing));
for (const id of ['joints', 'force', 'time']) hovers($(id));
$('resume').addEventListener('click', resume);
$('scrub').addEventListener('input', () => setLive(Number($('scrub').value) >= -0.005 && !state.file));
$('live').addEventListener('click', () => { if (state.file) location.reload(); else setLive(true); });
$('file').addEventListener('change', e => { if (e.target.files[0]) open(e.target.files[0]); });
addEventListener('dragover', e => { e.preventDefault(); document.body.classList.add('drop'); });
addEventListener('dragleave', () => document.body.classList.remove('drop'));
addEventListener('drop', e => { e.preventDefault(); document.body.classList.remove('drop'); if (e.dataTransfer.files[0]) open(e.dataTransfer.files[0]); });
addEventListener('keydown', e => {
  if (e.repeat || e.ctrlKey || e.metaKey || e.altKey) return;
  const stops = e.key === 's' || e.key === 'S' || (e.code === 'KeyS' && !/^[a-z]$/i.test(e.key));  // other alphabets
  if (stops) return stop();  // whatever has the focus, a question among them
  if (e.target.tagName === 'INPUT' || $('ask').open) return;
  if ((e.key === 'r' || e.key === 'R') && !$('resume').disabled) resume();
  if (e.key === 'l' || e.key === 'L') $('live').click();
}, true);
state.open = open;
const given = new URLSearchParams(location.search).get('file');  // `skinctl_record view`
if (given && /^[\w.-]+$/.test(given))
  fetch('/' + given).then(r => r.ok ? r.blob() : Promise.reject(new Error(r.statusText))).then(b => open(new File([b], given)), e => chip(`${given}: ${e.message}`, false));
requestAnimationFrame(frame);

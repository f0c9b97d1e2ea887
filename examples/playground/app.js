// Press the arm: what the visitor does, and what the arm answers.
import {ArmView} from './arm3d.js';
import {choices, Core} from './core.js';
import {readRobot} from './urdf.js';

const $ = id => document.getElementById(id);
const feelings = ['nothing', 'skin', 'wrist sensor', 'motors'], interfaces = ['position', 'velocity', 'torque'];
/// What a slider chooses: [name, words, unit, least, most, step]; of the finger they count at once, others start the controller anew.
const sliders = [['stiffness', 'Finger and cover: stiffness', 'N/m', 500, 6000, 100], ['travel', 'Finger: travel beyond the surface', 'mm', 10, 120, 5],
  ['felt_mass', 'Felt mass of the lightest place', 'kg', 0, 40, 0.5], ['damping', 'Damping of the virtual arm', '1/s', 2, 20, 0.5],
  ['delay', 'Delay of the arm', 'ms', 0, 40, 1], ['declared_lag', 'Lag of its drives, as declared', 'ms', 0, 60, 1], ['real_lag', 'Lag of its drives, in truth', 'ms', 0, 80, 1]];
const state = {feeling: 1, interface: 0, felt_mass: 0, damping: 6, delay: 8, declared_lag: 8, real_lag: 8, stiffness: 3000, travel: 60};
const app = {state, chosen: -1, pressing: null, due: 0, cycles: 0, spent: 0, errors: []};
window.playground = app;  // for tests and the curious
addEventListener('error', e => app.errors.push(e.message));
addEventListener('unhandledrejection', e => app.errors.push(String(e.reason)));

const round = (x, digits = 0) => x.toFixed(digits);
function radios(id, names) {
  $(id).replaceChildren(...names.map((name, i) => {
    const label = document.createElement('label'), input = document.createElement('input'), text = document.createElement('span');
    Object.assign(input, {type: 'radio', name: id, value: i, checked: state[id] === i});
    input.addEventListener('change', () => choose(id, i));
    text.textContent = name;
    label.append(input, text);
    return label;
  }));
}
function slider([name, words, unit, min, max, step]) {
  const label = document.createElement('label'), text = document.createElement('span'), value = document.createElement('output'), input = document.createElement('input');
  Object.assign(input, {type: 'range', min, max, step, value: state[name], id: 's-' + name});
  text.textContent = words;
  input.show = () => {
    const known = name === 'felt_mass' ? Math.max(state.felt_mass, app.view ? app.view.lightest : 0) : state[name];
    value.textContent = input.disabled ? 'its own' : `${round(known, step < 1 ? 1 : 0)} ${unit}`;
  };
  input.addEventListener('input', () => { state[name] = Number(input.value), input.show(); });
  input.addEventListener('change', () => { if (choices.includes(name)) choose(name, Number(input.value)); });
  label.append(text, value, input);
  $('sliders').append(label);
}
/// A choice that the library refuses is taken back, in its words.
function choose(name, value) {
  const before = {...app.good};
  state[name] = value;
  if (name === 'feeling' && value > 1 && state.interface === 2) state.interface = 0;
  start(before);
}
app.choose = choose;
function start(before) {
  try {
    app.pressing = null;
    app.core.start(state);
    app.good = {...state};
    app.refused = '';
  } catch (e) {
    app.refused = e.message.replace('skinctl: ', '');
    app.core.load();
    Object.assign(state, before);
    app.core.start(state);
  }
  app.hurt = false, app.view = app.core.view();
  controls();
}
function controls() {
  const v = app.view, torque = state.interface === 2, rigid = state.feeling === 0;
  document.querySelectorAll('#feeling input').forEach((e, i) => {
    e.checked = state.feeling === i, e.disabled = i > 1 && !!app.own;
    e.title = e.disabled ? 'your robot feels by its skin' : '';
  });
  document.querySelectorAll('#interface input').forEach((e, i) => {
    e.checked = state.interface === i, e.disabled = i === 2 && (state.feeling > 1 || !!app.own);
    e.title = !e.disabled ? '' : app.own ? 'of your robot: by position and velocity' : 'by torque it feels by its skin';
  });
  for (const [name] of sliders) {
    const input = $('s-' + name);
    input.disabled = (torque && choices.includes(name)) || (rigid && name === 'felt_mass');
    if (name === 'felt_mass' && !input.disabled) input.min = Math.floor(2 * v.lightest) / 2, input.max = Math.max(40, 3 * v.lightest);
    input.value = state[name], input.parentElement.classList.toggle('off', input.disabled), input.show();
  }
  $('rate').textContent = `${round(1 / v.period)} commands a second; ` + (torque ? 'the arm itself gives way.' : 'a virtual arm gives way, and its motion is commanded.');
  $('hurt').setAttribute('aria-pressed', String(app.hurt)), $('hurt').textContent = app.hurt ? 'Make the skin whole' : 'Kill ten cells, stick two';
}

function press(spot, pointer) {
  app.pressing = {...spot, pointer, aside: [0, 0, 0]};
  app.core.press(spot.link, spot.p, spot.n);
  app.pressed = true;
}
function release() {
  if (app.pressing) app.core.release();
  app.pressing = null, app.arm.controls.enabled = true;
}
function pointers() {
  const canvas = $('arm');
  canvas.addEventListener('pointerdown', e => {
    if (app.pressing || e.button !== 0) return;
    const spot = app.arm.pick(e);
    if (!spot) return;
    app.arm.controls.enabled = false, app.chosen = -1;
    canvas.setPointerCapture(e.pointerId);
    press(spot, e.pointerId);
  });
  canvas.addEventListener('pointermove', e => {
    if (!app.pressing) { canvas.classList.toggle('over', !!app.arm.pick(e)); return; }
    if (app.pressing.pointer !== e.pointerId) return;
    app.pressing.aside = app.arm.plane(e, app.pressing.at).sub(app.pressing.at).clampLength(0, 0.3).toArray();
  });
  for (const end of ['pointerup', 'pointercancel', 'lostpointercapture'])
    canvas.addEventListener(end, e => { if (app.pressing && app.pressing.pointer === e.pointerId) release(); });
  const arrows = {ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1]};
  canvas.addEventListener('keydown', e => {
    if (arrows[e.key] || e.key === ' ') e.preventDefault();
    if (e.repeat && e.key === ' ') return;
    if (arrows[e.key] && !app.pressing) app.chosen = app.arm.next(app.chosen < 0 ? middle() : app.chosen, ...arrows[e.key]);
    if (e.key === ' ' && !app.pressing) {
      if (app.chosen < 0) app.chosen = middle();
      press(app.core.cells[app.chosen], 'key');
    }
    if (e.key === 'Escape') release();
  });
  canvas.addEventListener('keyup', e => { if (e.key === ' ' && app.pressing && app.pressing.pointer === 'key') release(); });
  canvas.addEventListener('blur', release);
}

/// A cell of a long link: where the keys begin; of a UR5 one of its forearm.
const middle = () => app.own ? Math.floor(app.core.cells.length / 2) : 169;

/// The state in a few words.
function inWords(v) {
  if (v.ended) return 'Stopped';
  if (v.touching && v.force > 0.5) {
    const gives = v.gave_way > 1 + v.rigid_gave_way;
    return state.feeling === 0 || !gives ? `Pressed with ${round(v.force)} N, does not give way` : `Gives way by ${round(v.gave_way)} mm`;
  }
  if (v.away > 0.02 && app.core.words().includes('feels badly')) return 'Held back: it would lead with skin that feels nothing';
  if (v.away > 0.02 && app.pressed) return 'Goes back to its task';
  return v.resting ? `At place ${v.place} of its task` : `Goes to place ${v.place} of its task`;
}
function show(v) {
  const text = (id, words) => { if ($(id).textContent !== words) $(id).textContent = words; };
  text('state', inWords(v));
  $('state').className = v.ended ? 'bad' : '';
  $('again').hidden = !v.ended;
  text('words', app.refused ? `refused: ${app.refused}` : app.core.words() || 'nothing limited, nothing held');
  const most = Math.max(50, v.peak, v.rigid_peak), width = f => `${round(62 * f / most, 1)}%`;
  $('bar').style.width = width(v.force), $('rigid-bar').style.width = width(v.rigid_force);
  text('force', `${round(v.force)} N`), text('rigid-force', `${round(v.rigid_force)} N`);
  text('peaks', v.rigid_peak > 0 ? `Peak of this press: ${round(v.peak)} N; of the rigid arm ${round(v.rigid_peak)} N` +
    (v.peak > 0 && v.rigid_peak > 1.15 * v.peak ? `, ${round(v.rigid_peak / v.peak, 1)} times as much.` : '.') : 'Not pressed yet.');
  text('cells', `${v.usable} of ${v.cells} cells count.`);
  $('felt').hidden = !(v.touching && v.force > 0.5);
  if (!$('felt').hidden) {
    const at = app.arm.project(app.arm.finger.position), box = $('stage');
    $('felt').style.transform = `translate(${round(Math.min(box.clientWidth - 90, (0.5 + 0.5 * at.x) * box.clientWidth + 22))}px,${round((0.5 - 0.5 * at.y) * box.clientHeight - 46)}px)`;
    text('felt', `${round(v.force)} N`);
  }
}

let last = 0;
function frame(now) {
  app.due += Math.min(0.1, (now - last) / 1e3 || 0), last = now;
  const v = app.view;
  const count = Math.floor(app.due / v.period);
  if (count > 0) {
    app.due -= count * v.period;
    app.core.finger(state.stiffness, state.travel, app.pressing ? app.pressing.aside : [0, 0, 0]);
    const from = performance.now();
    app.core.cycle(count);
    app.spent += performance.now() - from, app.cycles += count;
    app.view = app.core.view();
  }
  app.arm.show(app.view, state.feeling === 1, app.chosen);
  show(app.view);
  requestAnimationFrame(frame);
}

/// Another robot: what `readRobot` gives, or none, the UR5. One that the library refuses changes nothing.
function bring(own) {
  const before = app.own;
  release();
  try {
    app.core.robot(own && own.numbers);
    if (own) state.feeling = Math.min(state.feeling, 1), state.interface = Math.min(state.interface, 1);
    app.core.start(state);
    app.own = own;
    $('own').textContent = own ? own.words : '';
    $('own').className = 'note';
  } catch (e) {
    refuse(e);
    app.core.robot(before && before.numbers);
    app.core.start(state);
  }
  app.good = {...state}, app.refused = '', app.hurt = false, app.chosen = -1, app.pressed = false, app.view = app.core.view();
  app.arm.robot(app.core.tubes(), app.core.cells, !!app.own);
  app.arm.look(app.view.links);
  $('robot').textContent = `A simulated ${app.own ? `"${app.own.name}"` : 'UR5'} with ${app.view.cells} cells of skin, run by the library that would run a real one.`;
  $('ur5').hidden = !app.own;
  controls();
}
function refuse(e) {
  $('own').textContent = `refused: ${e.message.replace('skinctl: ', '')}`;
  $('own').className = 'note bad';
}
async function read(file) {
  try {
    if (!file) return;
    if (file.size > 4e6) throw new Error(`${file.size} bytes, at most 4 MB`);
    bring(readRobot(await file.text()));
  } catch (e) { refuse(e); }
}
function files() {
  addEventListener('dragover', e => e.preventDefault());
  addEventListener('drop', e => { e.preventDefault(), read(e.dataTransfer.files[0]); });
  $('file').addEventListener('change', () => { read($('file').files[0]), $('file').value = ''; });
  $('ur5').addEventListener('click', () => bring(null));
}

async function begin() {
  radios('feeling', feelings), radios('interface', interfaces);
  app.core = await Core.create();
  app.core.start(state);
  app.good = {...state}, app.view = app.core.view();
  sliders.forEach(slider);
  controls();
  app.arm = new ArmView($('arm'));
  app.arm.robot(app.core.tubes(), app.core.cells, false);
  pointers(), files();
  $('again').addEventListener('click', () => start({...app.good}));
  $('hurt').addEventListener('click', () => { app.core.hurt(app.hurt = !app.hurt), controls(); });
  requestAnimationFrame(now => {
    last = now, frame(now);
    app.ready = performance.now();
    setInterval(() => {
      $('cost').textContent = `Ready after ${round(app.ready / 1e3, 1)} s. A cycle of both arms takes ${round(app.spent / Math.max(1, app.cycles), 2)} of its ${round(1e3 * app.view.period)} ms.`;
      app.last_cost = app.spent / Math.max(1, app.cycles);
      if (app.cycles > 2000) app.spent = app.cycles = 0;
    }, 500);
  });
}
begin().catch(e => {
  app.errors.push(e.message);
  $('state').textContent = 'No arm here', $('words').textContent = e.message;
});

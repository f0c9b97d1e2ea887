// The placing page: a patch of cells is dragged onto a link by hand, snapped to its tube, and saved as a skin file.
import {decode} from './cdr.js';
import {onKnown, RobotView, shapesOf} from './robot.js';
import {cellsOf, compose, inverse, minus, multiply, plus, rotate, size} from './skin.js';
import {Stream} from './stream.js';
import {asPatch, capsules, hexagons, lay, nearest} from './surface.js';

const $ = id => document.getElementById(id);
const place = {kept: [], before: [], tubes: new Map(), frames: new Map(), pose: {p: [0.25, -0.1, 0.5], q: [0, 0, 0, 1]}};
window.skinctl = place;  // for tests and the curious

/// The number of a field; one outside of its range counts as the nearest that is in it.
function number(id) {
  const e = $(id), low = +e.min, high = +(e.max || Infinity), given = Number.isFinite(+e.value) && e.value !== '' ? +e.value : +e.defaultValue;
  const x = Math.min(high, Math.max(low, given));
  return e.step === '' ? Math.round(x) : x;
}
const outside = () => ['rows', 'columns', 'pitch', 'first'].filter(id => $(id).value === '' || +$(id).value !== number(id)).map(id => `${id}: ${$(id).min} to ${$(id).max}, counts as ${number(id)}`);
const flat = () => hexagons(number('rows'), number('columns'), 1e-3 * number('pitch'), number('first'));

/// What is wrong with the patch beside those that are kept: cells on top of others, ids that are taken.
function clashes() {
  const out = [], near = 0.6e-3 * number('pitch');  // centres of cells that overlap by a third
  for (const p of place.kept) {
    const others = cellsOf({patches: [p]}), ids = new Set(others.map(c => c.id));
    const on = p.link === place.laid.link ? place.laid.cells.filter(c => others.some(o => size(minus(o.p, c.X.p)) < near)).length : 0;
    const taken = place.laid.cells.filter(c => ids.has(c.id)).length;
    if (on > 0) out.push(`${on} of its cells lie on those of ${p.name}`);
    if (taken > 0) out.push(`${taken} of its ids are those of ${p.name}`);
  }
  return out;
}
/// Remembers how all stands, for Undo.
function remember() {
  place.before.push({pose: place.pose, kept: place.kept, first: $('first').value, name: $('name').value});
  if (place.before.length > 200) place.before.shift();
  $('undo').disabled = false;
}
function undo() {
  const was = place.before.pop();
  if (!was) return;
  $('undo').disabled = place.before.length === 0;
  place.kept = was.kept, $('first').value = was.first, $('name').value = was.name;
  place.moveTo(was.pose);
}
/// Whether the patch is wanted in spite of what is wrong with it. A file with an id twice is refused by whoever reads it.
function wanted() {
  const wrong = clashes();
  if (wrong.length === 0) return Promise.resolve(true);
  $('question').textContent = `${wrong.join('; ')}. Keep it all the same?`;
  $('ask').returnValue = 'no';
  $('ask').showModal();
  return new Promise(done => $('ask').addEventListener('close', () => done($('ask').returnValue === 'yes'), {once: true}));
}

/// Lays the patch where it was dragged: onto the link whose tube is nearest.
function snap() {
  let best = null;
  for (const [link, tube] of place.tubes) {
    const X = place.frames.get(link);
    if (!X) continue;
    const local = compose(inverse(X), place.pose), far = size(minus(nearest(tube, local.p).p, local.p));
    if (!best || far < best.far) best = {link, tube, X, local, far};
  }
  if (!best) return;
  const laid = lay(best.tube, best.local, flat());
  place.laid = {link: best.link, ...laid};
  show();
}
function skin() {
  const patches = [...place.kept];
  if (place.laid) patches.push(asPatch($('name').value || 'patch', place.laid.link, place.laid, {force: +$('gain').value || 0, proximity: 0}));
  const links = [...new Set(patches.map(p => p.link))].map(name => {
    const t = place.tubes.get(name), old = (place.layout ? place.layout.links : []).find(l => l.name === name);
    return {...(old || {}), name, radius: t.radius, length: size(minus(t.to, t.from))};
  });
  return {format: 'skinctl-skin-1', links, patches};
}
function show() {
  const {laid, view} = place;
  // How far neighbours lie apart after all: a tube's ends crowd them.
  const pitch = 1e-3 * number('pitch'), cells = laid.cells, f = flat();
  let low = Infinity, high = 0;
  f.forEach((a, i) => f.forEach((b, k) => {
    if (k <= i || Math.hypot(a.x - b.x, a.y - b.y) > 1.1 * pitch) return;
    const d = size(minus(cells[i].X.p, cells[k].X.p));
    low = Math.min(low, d), high = Math.max(high, d);
  }));
  $('where').textContent = [`on ${laid.link}` + (laid.cap ? ': cells lie on a round end and crowd there' : ''), ...outside(), ...clashes()].join('; ');
  const facts = [['root in the link [mm]', laid.root.p.map(v => (1e3 * v).toFixed(1)).join(', ')], ['cells', cells.length],
    ['neighbours apart [mm]', high > 0 ? `${(1e3 * low).toFixed(1)} to ${(1e3 * high).toFixed(1)}` : 'one cell'], ['patches kept', place.kept.length]];
  $('facts').replaceChildren(...facts.flatMap(([k, v]) => { const a = document.createElement('dt'), b = document.createElement('dd'); a.textContent = k, b.textContent = v; return [a, b]; }));
  if (view) { view.layout(skin()); view.tf([...place.frames].map(([child, X]) => ({child, p: X.p, q: X.q}))); }
}

function feed(topic, type, time, bytes) {
  const value = decode(type, bytes);
  if (topic === '/robot_description') {
    place.shapes = shapesOf(value);
    if (place.view) place.view.robot(value); else place.urdf = value;
  } else if (topic === '/skin/layout') {
    place.layout = JSON.parse(value);
    const last = Math.max(0, ...place.layout.patches.flatMap(p => p.cells.map(c => c.id)));
    if (!place.known) $('first').value = last + 1, place.known = true;
  } else if (topic === '/tf' && place.frames.size === 0 && place.shapes) {  // the robot of the page stands still
    for (const f of value) place.frames.set(f.child, {p: f.p, q: f.q});
    place.tubes = capsules(onKnown(place.shapes, place.frames));
    $('link').textContent = `${place.tubes.size} links`, $('link').className = 'chip good';
    snap();
  }
}

RobotView.create($('robot')).then(async view => {
  place.view = view;
  const T = view.THREE, {TransformControls} = await import('three/addons/controls/TransformControls.js');
  const handle = place.handle = new T.Object3D(), tool = new TransformControls(view.camera, view.canvas);
  handle.position.set(...place.pose.p);
  view.scene.add(handle), tool.attach(handle), tool.setSpace('local'), tool.setSize(0.7);
  view.scene.add(tool.getHelper ? tool.getHelper() : tool);
  tool.addEventListener('dragging-changed', e => { view.controls.enabled = !e.value; if (e.value) remember(); });
  tool.addEventListener('objectChange', () => { place.moveTo({p: handle.position.toArray(), q: handle.quaternion.toArray()}); });
  $('turn').addEventListener('click', () => tool.setMode(tool.getMode && tool.getMode() === 'rotate' ? 'translate' : 'rotate'));
  if (place.urdf) view.robot(place.urdf);
  if (place.laid) show();
}, error => { $('robot').hidden = true, $('no3d').hidden = false, $('no3d').textContent = `No picture: ${error.message}. Keys and numbers still work.`; });

place.moveTo = pose => {
  place.pose = pose;
  if (place.handle) place.handle.position.set(...pose.p), place.handle.quaternion.set(...pose.q);
  snap();
};
place.skin = skin;
place.save = async () => {
  if (place.laid && !await wanted()) return '';
  const text = JSON.stringify(skin(), null, 2), a = document.createElement('a');
  a.href = URL.createObjectURL(new Blob([text], {type: 'application/json'})), a.download = 'skin.json';
  a.click();
  return text;
};
addEventListener('keydown', e => {
  if (e.target.tagName === 'INPUT' || !place.laid || $('ask').open) return;
  if ((e.ctrlKey || e.metaKey) && e.key.toLowerCase() === 'z') return e.preventDefault(), undo();
  const X = place.frames.get(place.laid.link), root = compose(X, place.laid.root), by = 0.005;
  const moves = {ArrowLeft: [-by, 0, 0], ArrowRight: [by, 0, 0], ArrowUp: [0, by, 0], ArrowDown: [0, -by, 0]};
  if (moves[e.key]) e.preventDefault(), remember(), place.moveTo({p: plus(root.p, rotate(root.q, moves[e.key])), q: root.q});
  const a = {q: 0.05, e: -0.05}[e.key.toLowerCase()];
  if (a) remember(), place.moveTo({p: root.p, q: multiply(root.q, [0, 0, Math.sin(a), Math.cos(a)])});
});
for (const id of ['rows', 'columns', 'pitch', 'first', 'name', 'gain']) $(id).addEventListener('input', () => { if (place.laid) snap(); });
$('undo').addEventListener('click', undo);
$('add').addEventListener('click', async () => {
  if (!place.laid || !await wanted()) return;
  remember();
  const now = skin();
  place.kept = now.patches;
  $('first').value = number('first') + place.laid.cells.length;
  $('name').value = `patch ${place.kept.length + 1}`;
  place.moveTo({...place.pose, p: plus(place.pose.p, [0, 0, 0.15])});
});
$('save').addEventListener('click', place.save);
place.stream = new Stream(`ws://${location.host}/`, ['/robot_description', '/skin/layout', '/tf'], {
  state: (text, good) => { if (!good) $('link').textContent = text; }, channels: () => {}, message: feed, status: () => {}, services: () => {},
  parameters: () => {}, control: () => {}});
const draw = () => { if (place.view) place.view.moved = true, place.view.draw(getComputedStyle(document.documentElement).getPropertyValue('--card').trim() || '#fff'); requestAnimationFrame(draw); };
requestAnimationFrame(draw);

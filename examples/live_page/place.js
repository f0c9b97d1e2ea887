// The placing page: a patch of cells is dragged onto a link by hand, snapped to its tube, and saved as a skin file.
import {decode} from './cdr.js';
import {onKnown, RobotView, shapesOf} from './robot.js';
import {compose, inverse, minus, multiply, plus, rotate, size} from './skin.js';
import {Stream} from './stream.js';
import {asPatch, capsules, hexagons, lay, nearest} from './surface.js';

const $ = id => document.getElementById(id);
const place = {kept: [], tubes: new Map(), frames: new Map(), pose: {p: [0.25, -0.1, 0.5], q: [0, 0, 0, 1]}};
window.skinctl = place;  // for tests and the curious

const flat = () => hexagons(+$('rows').value || 1, +$('columns').value || 1, 1e-3 * (+$('pitch').value || 27.8), Math.round(+$('first').value) || 1);

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
  const pitch = 1e-3 * $('pitch').value, cells = laid.cells, f = flat();
  let low = Infinity, high = 0;
  f.forEach((a, i) => f.forEach((b, k) => {
    if (k <= i || Math.hypot(a.x - b.x, a.y - b.y) > 1.1 * pitch) return;
    const d = size(minus(cells[i].X.p, cells[k].X.p));
    low = Math.min(low, d), high = Math.max(high, d);
  }));
  $('where').textContent = `on ${laid.link}` + (laid.cap ? ': cells lie on a round end and crowd there' : '');
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
  tool.addEventListener('dragging-changed', e => { view.controls.enabled = !e.value; });
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
place.save = () => {
  const text = JSON.stringify(skin(), null, 2), a = document.createElement('a');
  a.href = URL.createObjectURL(new Blob([text], {type: 'application/json'})), a.download = 'skin.json';
  a.click();
  return text;
};
addEventListener('keydown', e => {
  if (e.target.tagName === 'INPUT' || !place.laid) return;
  const X = place.frames.get(place.laid.link), root = compose(X, place.laid.root), by = 0.005;
  const moves = {ArrowLeft: [-by, 0, 0], ArrowRight: [by, 0, 0], ArrowUp: [0, by, 0], ArrowDown: [0, -by, 0]};
  if (moves[e.key]) e.preventDefault(), place.moveTo({p: plus(root.p, rotate(root.q, moves[e.key])), q: root.q});
  const a = {q: 0.05, e: -0.05}[e.key.toLowerCase()];
  if (a) place.moveTo({p: root.p, q: multiply(root.q, [0, 0, Math.sin(a), Math.cos(a)])});
});
for (const id of ['rows', 'columns', 'pitch', 'first', 'name', 'gain']) $(id).addEventListener('input', () => { if (place.laid) snap(); });
$('add').addEventListener('click', () => {
  if (!place.laid) return;
  const now = skin();
  place.kept = now.patches;
  $('first').value = +$('first').value + place.laid.cells.length;
  $('name').value = `patch ${place.kept.length + 1}`;
  place.moveTo({...place.pose, p: plus(place.pose.p, [0, 0, 0.15])});
});
$('save').addEventListener('click', place.save);
place.stream = new Stream(`ws://${location.host}/`, ['/robot_description', '/skin/layout', '/tf'], {
  state: (text, good) => { if (!good) $('link').textContent = text; }, channels: () => {}, message: feed, status: () => {}, services: () => {},
  parameters: () => {}, control: () => {}});
const draw = () => { if (place.view) place.view.moved = true, place.view.draw(getComputedStyle(document.documentElement).getPropertyValue('--card').trim() || '#fff'); requestAnimationFrame(draw); };
requestAnimationFrame(draw);

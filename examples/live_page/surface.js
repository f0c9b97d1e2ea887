// Surfaces of links as tubes with round ends: the nearest point, and a patch laid onto it.
import {compose, cross, dot, inverse, minus, multiply, plus, rotate, size, times, turn, unit} from './skin.js';

/// The nearest point of a capsule {from, to, radius} to `p`: {p, z}, with the outward normal.
export function nearest(capsule, p) {
  const along = minus(capsule.to, capsule.from), l = dot(along, along);
  const s = l > 0 ? Math.min(1, Math.max(0, dot(minus(p, capsule.from), along) / l)) : 0;
  const axis = plus(capsule.from, times(s, along)), way = minus(p, axis);
  const z = size(way) > 1e-9 ? unit(way) : unit(cross(Math.abs(along[2]) < 0.9 * Math.sqrt(l) ? [0, 0, 1] : [1, 0, 0], along));
  return {p: plus(axis, times(capsule.radius, z)), z, cap: s === 0 || s === 1};
}
/// From a point of the surface `far` along the direction `way`, in steps of 1 mm that stay on it.
export function walk(capsule, from, way, far) {
  let at = nearest(capsule, from), d = unit(minus(way, times(dot(way, at.z), at.z))), cap = at.cap;
  for (let left = far; left > 1e-12;) {
    const h = Math.min(left, 1e-3), next = nearest(capsule, plus(at.p, times(h, d)));
    d = rotate(turn(at.z, next.z), d);
    left -= h, at = next, cap = cap || next.cap;
  }
  return {p: at.p, z: at.z, way: unit(minus(d, times(dot(d, at.z), at.z))), cap};
}
/// The pose with normal z whose x is nearest to `x`, as {p, q}.
export function upright(p, z, x) {
  const tilt = turn([0, 0, 1], z), back = rotate([-tilt[0], -tilt[1], -tilt[2], tilt[3]], x), a = Math.atan2(back[1], back[0]);
  return {p, q: multiply(tilt, [0, 0, Math.sin(a / 2), Math.cos(a / 2)])};
}
/// Lays a flat patch, [{id, x, y}] in metres, with its root at the surface point nearest to `pose`, whose x it keeps.
/// Returns {root, cells: [{id, X}], cap}: poses in the link; cap: cells lie on a round end, where they crowd.
export function lay(capsule, pose, flat) {
  const foot = nearest(capsule, pose.p), root = upright(foot.p, foot.z, rotate(pose.q, [1, 0, 0]));
  let cap = false;
  const cells = flat.map(({id, x, y}) => {
    const far = Math.hypot(x, y);
    if (far < 1e-9) return {id, X: root};
    const end = walk(capsule, root.p, rotate(root.q, [x / far, y / far, 0]), far);
    cap = cap || end.cap;
    // The cell keeps its own x: turned against the way as in the flat patch.
    const a = Math.atan2(y, x), side = cross(end.z, end.way);
    return {id, X: upright(end.p, end.z, plus(times(Math.cos(a), end.way), times(-Math.sin(a), side)))};
  });
  return {root, cells, cap};
}
/// The patch as a skin file has it.
export const asPatch = (name, link, laid, gains) => ({name, link, X_LinkRoot: rounded(laid.root), gains,
  cells: laid.cells.map(c => ({id: c.id, X_RootCell: rounded(compose(inverse(laid.root), c.X))}))});
const rounded = X => ({p: X.p.map(v => Math.round(1e9 * v) / 1e9), q: X.q.map(v => Math.round(1e9 * v) / 1e9)});
/// A flat patch of rows x columns hexagonal cells, `pitch` apart, around its middle; ids from `first`.
export function hexagons(rows, columns, pitch, first) {
  const out = [];
  for (let r = 0; r < rows; ++r)
    for (let c = 0; c < columns; ++c)
      out.push({id: first + out.length, x: pitch * (c - (columns - 1) / 2 + (r % 2 ? 0.5 : 0)), y: pitch * 0.8660254037844386 * (r - (rows - 1) / 2)});
  return out;
}
/// The links' tubes of shapes (see robot.js): the longest of each, as {from, to, radius} in the link.
export function capsules(shapes) {
  const out = new Map();
  for (const s of shapes) {
    if (s.kind !== 'cylinder' && s.kind !== 'capsule') continue;
    const [radius, length] = s.size, half = rotate(s.X.q, [0, 0, length / 2]), known = out.get(s.link);
    const tube = {from: minus(s.X.p, half), to: plus(s.X.p, half), radius};
    if (!known || size(minus(known.to, known.from)) < length) out.set(s.link, tube);
  }
  return out;
}

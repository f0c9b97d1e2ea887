// Poses, and the cells of a skin file (`skinctl-skin-1`) on their links.
export const rotate = (q, v) => {
  const [x, y, z, w] = q, [a, b, c] = v;
  const tx = 2 * (y * c - z * b), ty = 2 * (z * a - x * c), tz = 2 * (x * b - y * a);
  return [a + w * tx + y * tz - z * ty, b + w * ty + z * tx - x * tz, c + w * tz + x * ty - y * tx];
};
export const multiply = (a, b) => [
  a[3] * b[0] + a[0] * b[3] + a[1] * b[2] - a[2] * b[1], a[3] * b[1] - a[0] * b[2] + a[1] * b[3] + a[2] * b[0],
  a[3] * b[2] + a[0] * b[1] - a[1] * b[0] + a[2] * b[3], a[3] * b[3] - a[0] * b[0] - a[1] * b[1] - a[2] * b[2]];
export const plus = (a, b) => a.map((x, i) => x + b[i]);
export const minus = (a, b) => a.map((x, i) => x - b[i]);
export const times = (s, a) => a.map(x => s * x);
export const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
export const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
export const size = a => Math.sqrt(dot(a, a));
export const unit = a => times(1 / (size(a) || 1), a);
/// A pose {p, q} after another.
export const compose = (A, B) => ({p: plus(A.p, rotate(A.q, B.p)), q: multiply(A.q, B.q)});
export const inverse = X => { const q = [-X.q[0], -X.q[1], -X.q[2], X.q[3]]; return {p: rotate(q, times(-1, X.p)), q}; };
/// The shortest turn from one unit vector to another.
export const turn = (from, to) => {
  const c = dot(from, to);
  if (c < -0.999999) { const a = unit(cross(from, Math.abs(from[0]) < 0.9 ? [1, 0, 0] : [0, 1, 0])); return [...a, 0]; }
  const a = cross(from, to), w = 1 + c, n = Math.sqrt(dot(a, a) + w * w);
  return [...times(1 / n, a), w / n];
};

/// Cells of a skin: [{id, link, p, z}], in the frames of the links named in `links`.
export function cellsOf(skin) {
  const out = [];
  for (const patch of skin.patches)
    for (const cell of patch.cells) {
      const X = compose(patch.X_LinkRoot, cell.X_RootCell);
      out.push({id: cell.id, link: patch.link, patch: patch.name, p: X.p, q: X.q});
    }
  return out;
}

/// The class of the least force on a place that somebody notices [N]; null: none does. As in the report.
export const feltClass = noticed => noticed === null ? 3 : noticed <= 5 ? 0 : noticed <= 25 ? 1 : 2;
/// A map {cells, noticed, speed} in words.
export function feltWords({cells, noticed, speed}) {
  const blind = cells.filter((_, i) => noticed[i] === null), slow = noticed.filter(n => n !== null && feltClass(n) > 0).length;
  const list = blind.length ? ` (cells ${blind.slice(0, 5).join(', ')}${blind.length > 5 ? ', ...' : ''})` : '';
  return `${cells.length} places: ${blind.length} feel nothing${list}, ${slow} feel little; the slowest may lead at ${Math.min(...speed).toFixed(2)} m/s.`;
}

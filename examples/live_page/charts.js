// Charts on a 2-D canvas: lines over time, bars from zero.
export const colour = k => getComputedStyle(document.documentElement).getPropertyValue(`--c${k % 7}`).trim();
const css = name => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

function begin(canvas) {
  const scale = window.devicePixelRatio || 1, w = canvas.clientWidth, h = canvas.clientHeight;
  if (canvas.width !== Math.round(w * scale) || canvas.height !== Math.round(h * scale))
    canvas.width = Math.round(w * scale), canvas.height = Math.round(h * scale);
  const c = canvas.getContext('2d');
  c.setTransform(scale, 0, 0, scale, 0, 0);
  c.clearRect(0, 0, w, h);
  c.font = '12px system-ui, sans-serif';
  return {c, w, h};
}
/// Shows the values under the pointer.
export function hovers(canvas) {
  canvas.addEventListener('pointermove', e => { canvas.hover = e.offsetX; });
  canvas.addEventListener('pointerleave', () => { canvas.hover = NaN; });
}
/// Steps of 1, 2 or 5 times a power of ten, about `n` of them over `range`.
export function step(range, n) {
  const raw = range / n || 1, power = 10 ** Math.floor(Math.log10(raw));
  return power * ([1, 2, 5].find(m => m * power >= raw) || 10);
}
function scaleY(c, w, h, low, high, left) {
  const by = step(high - low, 4), y = v => h - 18 - (v - low) / (high - low) * (h - 26);
  c.fillStyle = css('--soft'), c.strokeStyle = css('--line'), c.lineWidth = 1, c.textAlign = 'right', c.textBaseline = 'middle';
  for (let v = Math.ceil(low / by) * by; v <= high + 1e-9 * by; v += by) {
    c.beginPath(), c.moveTo(left, y(v)), c.lineTo(w, y(v)), c.stroke();
    c.fillText(String(+v.toPrecision(6)), left - 6, y(v));
  }
  return y;
}
/// series: [{points: [[t, v], ...], k, name}], from `t0` to `t1` [s]; `mark` is the present instant. A name stands at the
/// line's end, for those who cannot tell the colours apart.
export function lines(canvas, series, t0, t1, mark, unit, from = null) {
  const {c, w, h} = begin(canvas), left = 44;
  let low = Infinity, high = -Infinity;
  for (const s of series) for (const [, v] of s.points) if (Number.isFinite(v)) low = Math.min(low, v), high = Math.max(high, v);
  if (from !== null) low = Math.min(low, from), high = Math.max(high, from);
  if (!(high > low)) { const m = Number.isFinite(low) ? low : 0; low = m - 1, high = m + 1; }
  const margin = 0.06 * (high - low);
  low -= from === low ? 0 : margin, high += margin;
  const right = 4 + Math.max(0, ...series.map(s => s.name ? c.measureText(s.name).width + 6 : 0)), y = scaleY(c, w, h, low, high, left), x = t => left + (t - t0) / (t1 - t0) * (w - left - right);
  c.textAlign = 'center', c.textBaseline = 'alphabetic', c.fillStyle = css('--soft');
  const by = step(t1 - t0, 5);
  for (let t = Math.ceil((t0 - t1) / by) * by; t <= 1e-9; t += by) c.fillText(t === 0 ? '0 s' : String(+t.toPrecision(4)), Math.min(x(t1 + t), w - 12), h - 3);
  for (const s of series) {
    c.strokeStyle = colour(s.k), c.lineWidth = 1.8, c.beginPath();
    let on = false;
    for (const [t, v] of s.points) { if (!Number.isFinite(v)) { on = false; continue; } on ? c.lineTo(x(t), y(v)) : c.moveTo(x(t), y(v)); on = true; }
    c.stroke();
  }
  const ends = series.filter(s => s.name && s.points.length).map(s => ({s, at: y(s.points[s.points.length - 1][1])})).sort((a, b) => a.at - b.at);
  c.textAlign = 'right', c.textBaseline = 'middle';
  ends.forEach((e, i) => {  // not over one another
    if (i > 0) e.at = Math.max(e.at, ends[i - 1].at + 12);
    c.fillStyle = colour(e.s.k), c.fillText(e.s.name, w - 2, Math.min(e.at, h - 24));
  });
  if (mark < t1 - 1e-6) { c.strokeStyle = css('--ink'), c.lineWidth = 1, c.beginPath(), c.moveTo(x(mark), 4), c.lineTo(x(mark), h - 18), c.stroke(); }
  const at = canvas.hover - left > 0 ? t0 + (canvas.hover - left) / (w - left - right) * (t1 - t0) : NaN;
  if (at <= t1) {
    c.strokeStyle = css('--soft'), c.lineWidth = 1, c.beginPath(), c.moveTo(canvas.hover, 4), c.lineTo(canvas.hover, h - 18), c.stroke();
    c.textBaseline = 'middle', c.textAlign = canvas.hover > w / 2 ? 'right' : 'left';
    series.forEach((s, i) => {
      const p = s.points.findLast(([t]) => t <= at);
      if (p) c.fillStyle = colour(s.k), c.fillText(` ${s.name || ''} ${p[1].toFixed(3)} ${unit} `, canvas.hover, 12 + 13 * i);
    });
  }
  const last = series.map(s => s.points.length ? s.points[s.points.length - 1][1] : NaN);
  canvas.setAttribute('aria-label', last.map(v => Number.isFinite(v) ? v.toFixed(2) : 'none').join(', ') + ' ' + unit);
}
/// events: [[t, effect], ...], a mark each, in the colour of its effect.
export function strip(canvas, events, t0, t1) {
  const {c, w, h} = begin(canvas), left = 44;
  c.fillStyle = css('--line'), c.fillRect(left, h / 2, w - left - 4, 1);
  for (const [t, effect] of events) {
    const wide = Math.max(2, 0.1 / (t1 - t0) * (w - left - 4));
    c.fillStyle = css(/stop|brake/.test(effect) ? '--bad' : /report|refuse/.test(effect) ? '--soft' : '--c1');
    c.fillRect(left + (t - t0) / (t1 - t0) * (w - left - 4) - wide, 2, wide, h - 4);
  }
  canvas.setAttribute('aria-label', `${events.length} reports in the time shown`);
}
/// groups: rows of numbers, one group a joint; each number a bar from zero, their sum a line.
export function bars(canvas, groups, names) {
  const {c, w, h} = begin(canvas), left = 44;
  let low = -1, high = 1;
  for (const g of groups) { const sum = g.reduce((a, b) => a + b, 0); for (const v of [...g, sum]) low = Math.min(low, v), high = Math.max(high, v); }
  const margin = 0.08 * (high - low), y = scaleY(c, w, h, low - margin, high + margin, left), wide = (w - left - 4) / groups.length;
  groups.forEach((g, i) => {
    const each = 0.8 * wide / Math.max(1, g.length), x0 = left + i * wide + 0.1 * wide;
    g.forEach((v, k) => { c.fillStyle = colour(k); c.fillRect(x0 + k * each, Math.min(y(0), y(v)), each - 1, Math.max(1, Math.abs(y(v) - y(0)))); });
    const sum = y(g.reduce((a, b) => a + b, 0));
    c.strokeStyle = css('--ink'), c.lineWidth = 2.5, c.beginPath(), c.moveTo(x0 - 2, sum), c.lineTo(x0 + 0.8 * wide + 2, sum), c.stroke();
    c.fillStyle = css('--soft'), c.textAlign = 'center', c.textBaseline = 'alphabetic', c.fillText(names[i] || String(i), x0 + 0.4 * wide, h - 3);
  });
  canvas.setAttribute('aria-label', groups.map((g, i) => `joint ${i}: ${g.map(v => v.toFixed(1)).join(', ')} N m`).join('; '));
}

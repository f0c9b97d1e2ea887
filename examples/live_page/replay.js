// An .mcap file, whole or cut, as the messages in it. Chunks are read uncompressed, as this library writes them.
const magic = [0x89, 0x4d, 0x43, 0x41, 0x50, 0x30, 0x0d, 0x0a];

class Records {
  constructor(view, at, end) { Object.assign(this, {view, at, end}); }
  /// The next whole record as [opcode, start, end], or null.
  next() {
    if (this.at + 9 > this.end) return null;
    const length = Number(this.view.getBigUint64(this.at + 1, true));
    const start = this.at + 9;
    if (length > this.end - start) return null;
    const op = this.view.getUint8(this.at);
    this.at = start + length;
    return [op, start, start + length];
  }
}

/// Calls message(topic, type, seconds, bytes) in the order of the file. Returns {messages, cut, words}.
export function readMcap(buffer, message) {
  const view = new DataView(buffer), bytes = new Uint8Array(buffer);
  if (bytes.length < 8 || magic.some((b, i) => bytes[i] !== b)) return {messages: 0, cut: false, words: 'this is no MCAP file'};
  const text = at => [new TextDecoder().decode(bytes.subarray(at + 4, at + 4 + view.getUint32(at, true))), at + 4 + view.getUint32(at, true)];
  const schemas = new Map(), channels = new Map();
  let messages = 0, compressed = 0, ended = false;
  const read = (records, inside) => {
    for (let r; (r = records.next()) !== null;) {
      const [op, start, end] = r;
      if (op === 3) {
        schemas.set(view.getUint16(start, true), text(start + 2)[0]);
      } else if (op === 4) {
        const [topic] = text(start + 4);
        channels.set(view.getUint16(start, true), {topic, type: schemas.get(view.getUint16(start + 2, true)) || ''});
      } else if (op === 5) {
        const c = channels.get(view.getUint16(start, true));
        if (c) message(c.topic, c.type, Number(view.getBigUint64(start + 6, true)) * 1e-9, bytes.subarray(start + 22, end)), ++messages;
      } else if (op === 6 && !inside) {
        const [compression, at] = text(start + 28);
        if (compression === '') read(new Records(view, at + 8, Math.min(end, at + 8 + Number(view.getBigUint64(at, true)))), true);
        else ++compressed;
      } else if (op === 15) {
        ended = true;
        if (!inside) return;
      }
    }
  };
  try { read(new Records(view, 8, bytes.length), false); } catch (e) { if (!(e instanceof RangeError)) throw e; }
  const words = `${messages} messages` + (ended ? '' : '; the file is cut') + (compressed ? `; ${compressed} compressed chunks left out` : '');
  return {messages, cut: !ended, words};
}

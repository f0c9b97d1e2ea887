// CDR, as ROS 2 and this library write it: little-endian, members aligned to their size from byte 4 on.
export class Reader {
  constructor(bytes) {
    this.view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
    if (bytes.byteLength < 4 || bytes[0] !== 0 || bytes[1] !== 1) throw new Error('not plain little-endian CDR');
    this.at = 4;
  }
  align(n) { this.at = 4 + Math.ceil((this.at - 4) / n) * n; }
  number(n, get) { this.align(n); const v = this.view[get](this.at, true); this.at += n; return v; }
  u8() { return this.number(1, 'getUint8'); }
  i32() { return this.number(4, 'getInt32'); }
  u32() { return this.number(4, 'getUint32'); }
  f64() { return this.number(8, 'getFloat64'); }
  count(least) {
    const n = this.u32();
    if (n * least > this.view.byteLength - this.at) throw new Error('a sequence longer than its message');
    return n;
  }
  text() {
    const n = this.count(1);
    const bytes = new Uint8Array(this.view.buffer, this.view.byteOffset + this.at, n);
    this.at += n;
    return new TextDecoder().decode(n > 0 ? bytes.subarray(0, n - 1) : bytes);
  }
  numbers() {
    const n = this.count(8), out = new Float64Array(n);
    for (let i = 0; i < n; ++i) out[i] = this.f64();
    return out;
  }
  header() { const s = this.i32(), ns = this.u32(); return {time: s + 1e-9 * ns, frame: this.text()}; }
}

const readers = {
  'std_msgs/msg/String': r => r.text(),
  'sensor_msgs/msg/JointState': r => {
    const {time} = r.header(), names = [];
    for (let n = r.count(4); n > 0; --n) names.push(r.text());
    return {time, names, position: r.numbers(), velocity: r.numbers(), effort: r.numbers()};
  },
  'tf2_msgs/msg/TFMessage': r => {
    const out = [];
    for (let n = r.count(8); n > 0; --n) {
      const {time, frame} = r.header(), child = r.text(), v = [];
      for (let i = 0; i < 7; ++i) v.push(r.f64());
      out.push({time, frame, child, p: v.slice(0, 3), q: v.slice(3)});
    }
    return out;
  },
  'std_msgs/msg/Float64MultiArray': r => {
    const dims = [];
    for (let n = r.count(8); n > 0; --n) dims.push({label: r.text(), size: r.u32(), stride: r.u32()});
    r.u32();
    return {dims, data: r.numbers()};
  },
  'sensor_msgs/msg/PointCloud2': r => {
    const {time, frame} = r.header(), height = r.u32(), width = r.u32(), fields = {};
    for (let n = r.count(8); n > 0; --n) { const name = r.text(), offset = r.u32(); r.u8(); r.u32(); fields[name] = offset; }
    r.u8();
    const step = r.u32();
    r.u32();
    const n = r.count(1), start = r.view.byteOffset + r.at;
    if (step * width * height !== n) throw new Error('a cloud of another size than it says');
    return {time, frame, count: width * height, step, fields, view: new DataView(r.view.buffer, start, n)};
  },
};
/// The value of a message of a type by name, or undefined for a type that is not known here.
export function decode(type, bytes) { return readers[type] ? readers[type](new Reader(bytes)) : undefined; }

// The WebAssembly module: the flat structs of playground.hpp as arrays of numbers in its memory.
import bytes from 'playground.wasm';
import numbers from 'numbers.txt';

const sizes = {time: 1, period: 1, force: 1, rigid_force: 1, peak: 1, rigid_peak: 1, gave_way: 1, rigid_gave_way: 1, away: 1, place: 1, places: 1,
  resting: 1, touching: 1, ended: 1, felt_mass: 1, lightest: 1, cells: 1, usable: 1, tip: 3, direction: 3, q: 6, target: 6, rigid_q: 6, links: 72,
  rigid_links: 72, reading: 512, mask: 512};
export const choices = ['feeling', 'interface', 'felt_mass', 'damping', 'delay', 'declared_lag', 'real_lag'];

export class Core {
  static async create() {
    const core = new Core();
    core.module = await WebAssembly.compile(bytes);
    core.load();
    return core;
  }
  /// A fresh module: the only way on after a refusal.
  load() {
    const zero = () => 0;
    this.exports = new WebAssembly.Instance(this.module, {
      page: {refused: at => { throw new Error(this.text(at)); }},
      wasi_snapshot_preview1: {fd_close: zero, fd_seek: zero, fd_write: zero},
    }).exports;
    this.exports._initialize();
    this.exports.playground_begin();
    this.array('scenario', numbers.trim().split('\n').length).set(numbers.trim().split('\n').map(Number));
    if (this.brought) this.array('robot', this.brought.length).set(this.brought);
  }
  /// Numbers of `readRobot` from the next start on; none: the UR5.
  robot(numbers) {
    this.brought = numbers;
    this.load();
  }
  array(name, count, ...more) { return new Float64Array(this.exports.memory.buffer, this.exports['playground_' + name](...more), count); }
  text(at) {
    const all = new Uint8Array(this.exports.memory.buffer);
    return new TextDecoder().decode(all.slice(at, all.indexOf(0, at)));
  }
  /// Throws, in the words of the library, what it refuses.
  start(choice) {
    this.array('choice', choices.length).set(choices.map(k => choice[k]));
    this.exports.playground_start();
    this.cells = Array.from({length: this.view().cells}, (_, i) => {
      const c = this.array('cell', 7, i);
      return {link: c[0], p: [...c.slice(1, 4)], n: [...c.slice(4, 7)]};
    });
  }
  view() {
    const out = {};
    let at = 0;
    const all = this.array('view', Object.values(sizes).reduce((a, b) => a + b));
    for (const [name, n] of Object.entries(sizes)) out[name] = n === 1 ? all[at] : all.subarray(at, at + n), at += n;
    return out;
  }
  press(link, p, n) {
    this.array('place', 6).set([...p, ...n]);
    this.exports.playground_press(link);
  }
  release() { this.exports.playground_release(); }
  finger(stiffness, travel, aside) { this.array('finger', 5).set([stiffness, travel, ...aside]); }
  hurt(on) { this.exports.playground_hurt(on ? 1 : 0); }
  cycle(count) { this.exports.playground_cycle(count); }
  words() { return this.text(this.exports.playground_words()); }
  tubes() { return Array.from({length: 6}, (_, i) => [...this.array('tube', 7, i)]); }
}

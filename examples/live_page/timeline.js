// What was received in the last seconds, to be looked at again.
export class Timeline {
  constructor(seconds) { this.keep = seconds; this.topics = new Map(); this.first = Infinity, this.last = -Infinity; }
  add(topic, time, value) {
    if (time < this.last - 1 && this.keep < Infinity) this.clear();  // the job was started anew
    const list = this.topics.get(topic) || this.topics.set(topic, []).get(topic);
    list.push({time, value});
    this.first = Math.min(this.first, time), this.last = Math.max(this.last, time);
    if (list.length % 64 === 0) {
      const old = this.last - this.keep;
      let n = 0;
      while (n < list.length && list[n].time < old) ++n;
      if (n > 0) list.splice(0, n);
      this.first = Math.max(this.first, old);
    }
  }
  clear() { this.topics.clear(); this.first = Infinity, this.last = -Infinity; }
  list(topic) { return this.topics.get(topic) || []; }
  /// The index of the newest entry at or before `time`, or -1.
  index(topic, time) {
    const list = this.list(topic);
    let low = 0, high = list.length;
    while (low < high) { const m = (low + high) >> 1; list[m].time <= time ? low = m + 1 : high = m; }
    return low - 1;
  }
  at(topic, time) { const i = this.index(topic, time); return i < 0 ? undefined : this.list(topic)[i].value; }
}

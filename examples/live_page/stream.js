// The Foxglove WebSocket protocol from a page's side: topics, services and parameters of a running job.
export class Stream {
  /// on: {state(text, good), channels(list), message(topic, type, seconds, bytes), status(text), ended(text), services(set), parameters(list), control(bool), facts({name: text}), told(topic, text)}
  constructor(url, wanted, on) {
    Object.assign(this, {url, wanted, on, byId: new Map(), services: new Map(), calls: new Map(), sinks: new Map(), next: 1, wait: 500});
    this.open();
  }
  open() {
    const socket = this.socket = new WebSocket(this.url, ['foxglove.sdk.v1', 'foxglove.websocket.v1']);
    socket.binaryType = 'arraybuffer';
    socket.onopen = () => { this.wait = 500; this.on.state('live', true); };
    socket.onmessage = e => { typeof e.data === 'string' ? this.text(JSON.parse(e.data)) : this.binary(e.data); };
    socket.onclose = () => {
      this.on.state('no connection; trying again', false);
      for (const done of this.calls.values()) done({done: false, words: 'the connection is gone'});
      this.calls.clear(), this.byId.clear(), this.services.clear(), this.sinks.clear();
      setTimeout(() => this.open(), this.wait = Math.min(2 * this.wait, 8000));
    };
  }
  send(op) { if (this.socket.readyState === 1) this.socket.send(JSON.stringify(op)); }
  text(m) {
    if (m.op === 'serverInfo') {
      const facts = this.facts = m.metadata || {};
      this.on.control(facts.control === 'allowed');
      if (this.on.facts) this.on.facts(facts);
      if ((m.capabilities || []).includes('parameters')) {
        this.send({op: 'getParameters', parameterNames: [], id: 'all'});
        this.send({op: 'subscribeParameterUpdates', parameterNames: []});
      }
    } else if (m.op === 'advertise') {
      const subscriptions = [];
      for (const c of m.channels) {
        if (!this.wanted.includes(c.topic)) continue;
        const id = this.next++;
        this.byId.set(id, c);
        subscriptions.push({id, channelId: c.id});
      }
      this.on.channels(m.channels);
      this.send({op: 'subscribe', subscriptions});
    } else if (m.op === 'advertiseServices') {
      for (const s of m.services) this.services.set(s.name, s.id);
      this.on.services(new Set(this.services.keys()));
    } else if (m.op === 'parameterValues') {
      this.on.parameters(m.parameters);
    } else if (m.op === 'status') {
      if (m.id === 'ended') this.on.ended(m.message);
      else if (this.sinks.has(m.id)) this.on.told(m.id, m.message);
      else this.on.status(m.message);
    } else if (m.op === 'serviceCallFailure') {
      this.answer(m.callId, {done: false, words: m.message});
    }
  }
  binary(buffer) {
    const view = new DataView(buffer);
    if (view.getUint8(0) === 1 && buffer.byteLength >= 13) {
      const channel = this.byId.get(view.getUint32(1, true));
      if (channel) this.on.message(channel.topic, channel.schemaName, Number(view.getBigUint64(5, true)) * 1e-9, new Uint8Array(buffer, 13));
    } else if (view.getUint8(0) === 3 && buffer.byteLength >= 13) {
      const bytes = new Uint8Array(buffer, 13 + view.getUint32(9, true));
      const length = bytes.length >= 12 ? new DataView(buffer, bytes.byteOffset).getUint32(8, true) : 1;
      this.answer(view.getUint32(5, true), {done: bytes[4] === 1, words: new TextDecoder().decode(bytes.subarray(12, 11 + length))});
    }
  }
  answer(call, value) { const done = this.calls.get(call); this.calls.delete(call); if (done) done(value); }
  /// Calls a service without arguments; resolves to {done, words}.
  call(name) {
    const service = this.services.get(name);
    if (service === undefined || this.socket.readyState !== 1) return Promise.resolve({done: false, words: 'not connected'});
    const call = this.next++, bytes = new Uint8Array(13 + 3 + 5), view = new DataView(bytes.buffer);
    view.setUint8(0, 2), view.setUint32(1, service, true), view.setUint32(5, call, true), view.setUint32(9, 3, true);
    bytes.set([99, 100, 114, 0, 1, 0, 0, 0], 13);
    this.socket.send(bytes);
    return new Promise(done => this.calls.set(call, done));
  }
  /// A message in JSON to a topic that the job takes; without a connection it is lost.
  publish(topic, message) {
    if (this.socket.readyState !== 1) return;
    let id = this.sinks.get(topic);
    if (id === undefined) {
      this.sinks.set(topic, id = this.next++);
      this.send({op: 'advertise', channels: [{id, topic, encoding: 'json', schemaName: ''}]});
    }
    const text = new TextEncoder().encode(JSON.stringify(message)), bytes = new Uint8Array(5 + text.length);
    bytes[0] = 1, new DataView(bytes.buffer).setUint32(1, id, true), bytes.set(text, 5);
    this.socket.send(bytes);
  }
  set(name, value) { this.send({op: 'setParameters', parameters: [{name, value}], id: 'set'}); }
}

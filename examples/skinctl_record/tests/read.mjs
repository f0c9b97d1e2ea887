// Reads an MCAP file with the libraries of others: @mcap/core by its index, @foxglove/rosmsg and rosmsg2-serialization.
// Prints what read.py prints, but for the hashes. Arguments: folder with node_modules, file.
import { readFileSync } from "node:fs";
import { createRequire } from "node:module";

const require = createRequire(process.argv[2] + "/");
const { McapIndexedReader } = require("@mcap/core");
const { parse } = require("@foxglove/rosmsg");
const { MessageReader } = require("@foxglove/rosmsg2-serialization");

const file = readFileSync(process.argv[3]);
const readable = {
  size: async () => BigInt(file.length),
  read: async (offset, size) => new Uint8Array(file.buffer, file.byteOffset + Number(offset), Number(size)),
};
const reader = await McapIndexedReader.Initialize({ readable });
const decoders = new Map();
for (const [id, channel] of reader.channelsById) {
  const schema = reader.schemasById.get(channel.schemaId);
  if (channel.messageEncoding === "cdr")
    decoders.set(id, new MessageReader(parse(new TextDecoder().decode(schema.data), { ros2: true })));
}
// rosmsg2-serialization names the nanoseconds of a Time as JavaScript does.
const plain = (key, value) => {
  if (typeof value === "bigint") return "bigint " + value;  // beyond 2^53 no Number holds it
  if (ArrayBuffer.isView(value)) return Array.from(value);
  if (value && typeof value === "object" && "sec" in value && "nsec" in value) return { sec: value.sec, nanosec: value.nsec };
  return value;
};
const lines = [];
for await (const m of reader.readMessages()) {
  const topic = reader.channelsById.get(m.channelId).topic;
  const out = { topic, time: m.logTime, sequence: m.sequence };
  const decoder = decoders.get(m.channelId);
  if (decoder) out.message = decoder.readMessage(m.data);
  else out.hex = Buffer.from(m.data).toString("hex");
  lines.push(out);
}
lines.sort((a, b) => Number(a.time - b.time) || (a.topic < b.topic ? -1 : a.topic > b.topic ? 1 : 0) || a.sequence - b.sequence);
for (const line of lines) console.log(JSON.stringify(line, plain).replace(/"bigint (\d+)"/g, "$1"));

// Writes 100 words with @mcap/core, 10 ms apart: outside of chunks ("plain"), or in compressed ones ("deflate").
// Arguments: folder with node_modules, file, form.
import { writeFileSync } from "node:fs";
import { createRequire } from "node:module";
import { deflateRawSync } from "node:zlib";

const require = createRequire(process.argv[2] + "/");
const { McapWriter } = require("@mcap/core");

const parts = [];
let size = 0n;
const writable = {
  position: () => size,
  write: async (bytes) => { parts.push(Buffer.from(bytes)); size += BigInt(bytes.length); },
};
const writer = new McapWriter({
  writable,
  useChunks: process.argv[4] !== "plain",
  chunkSize: 500,
  compressChunk: (bytes) => ({ compression: "deflate", compressedData: deflateRawSync(bytes) }),
});
await writer.start({ profile: "", library: "" });
const schemaId = await writer.registerSchema({ name: "std_msgs/msg/String", encoding: "ros2msg", data: Buffer.from("string data\n") });
const channelId = await writer.registerChannel({ topic: "/words", schemaId, messageEncoding: "cdr", metadata: new Map() });
for (let k = 0; k < 100; ++k) {
  const word = Buffer.from(`word ${k}\0`), head = Buffer.from([0, 1, 0, 0, word.length, 0, 0, 0]);
  const time = BigInt(k) * 10_000_000n;
  await writer.addMessage({ channelId, sequence: k, logTime: time, publishTime: time, data: Buffer.concat([head, word]) });
}
await writer.end();
writeFileSync(process.argv[3], Buffer.concat(parts));

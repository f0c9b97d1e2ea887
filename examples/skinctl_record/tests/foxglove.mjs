// Hears a running job by the client library of Foxglove (@foxglove/ws-protocol) until the job ends, then prints a line of
// JSON for each message, decoded by the schema that the server advertised. Arguments: folder with node_modules, URL.
import { createRequire } from "node:module";

const require = createRequire(process.argv[2] + "/");
const { FoxgloveClient } = require("@foxglove/ws-protocol");
const { parse } = require("@foxglove/rosmsg");
const { MessageReader } = require("@foxglove/rosmsg2-serialization");
const WebSocket = require("ws");

const client = new FoxgloveClient({ ws: new WebSocket(process.argv[3], [FoxgloveClient.SUPPORTED_SUBPROTOCOL]) });
const lines = [], heard = new Map();
const reader = (schema) => new MessageReader(parse(schema, { ros2: true }));
client.on("error", (error) => { console.error(error.message); process.exit(1); });
client.on("advertise", (channels) => {
  for (const c of channels) heard.set(client.subscribe(c.id), { topic: c.topic, decoder: reader(c.schema) });
  client.getParameters([], "all");
});
client.on("advertiseServices", (services) => {
  const resume = services.find((s) => s.name === "/skinctl/resume");
  client.on("serviceCallResponse", (answer) => {
    lines.push({ service: resume.name, callId: answer.callId, answer: reader(resume.response.schema).readMessage(answer.data) });
  });
  client.sendServiceCallRequest({ serviceId: resume.id, callId: 7, encoding: "cdr", data: new DataView(new Uint8Array([0, 1, 0, 0, 0]).buffer) });
});
client.on("parameterValues", ({ parameters }) => lines.push({ parameters }));
client.on("message", ({ subscriptionId, timestamp, data }) => {
  const { topic, decoder } = heard.get(subscriptionId);
  lines.push({ topic, time: timestamp, message: decoder.readMessage(data) });
});
client.on("close", () => {
  const plain = (key, value) => typeof value === "bigint" ? "bigint " + value : ArrayBuffer.isView(value) ? Array.from(value) : value;
  for (const line of lines) console.log(JSON.stringify(line, plain).replace(/"bigint (\d+)"/g, "$1"));
});

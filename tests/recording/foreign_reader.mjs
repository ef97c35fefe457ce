// Reads a recording with the reader of the format's authors: through the index at its end, every checksum checked; and
// compares what it finds with what `collide` said. Exit status 77 where their package is not there.
// usage: node foreign_reader.mjs FILE.mcap LEAST_MESSAGES
import { readFile } from "node:fs/promises";
import { createRequire } from "node:module";

let core;
try {
  core = createRequire(process.cwd() + "/")("@mcap/core");
} catch {
  console.log("skipped: no package @mcap/core beside " + process.cwd() + " (npm install @mcap/core)");
  process.exit(77);
}

const [file, least] = process.argv.slice(2);
const bytes = await readFile(file);
const readable = {
  size: async () => BigInt(bytes.length),
  read: async (offset, length) => new Uint8Array(bytes.buffer, bytes.byteOffset + Number(offset), Number(length)),
};
const reader = await core.McapIndexedReader.Initialize({ readable });
const counts = new Map();
let messages = 0;
for await (const message of reader.readMessages({ validateCrcs: true })) {
  messages += 1;
  const topic = reader.channelsById.get(message.channelId).topic;
  counts.set(topic, (counts.get(topic) ?? 0) + 1);
}
for (const [id, schema] of reader.schemasById) {
  const text = new TextDecoder().decode(schema.data);
  if (schema.encoding !== "omgidl" && schema.encoding !== "jsonschema") throw new Error(`schema ${id}, ${schema.name}: in ${schema.encoding}`);
  if (schema.encoding === "jsonschema") JSON.parse(text);
  else if (!text.includes("struct " + schema.name.split("::").pop())) {
    throw new Error(`schema ${id}, ${schema.name}: its text does not describe it`);
  }
}
if (BigInt(messages) !== reader.statistics.messageCount) throw new Error(`${messages} messages, ${reader.statistics.messageCount} in the statistics`);
if (messages < Number(least)) throw new Error(`${messages} messages, at least ${least} expected`);

// The same without the index, from the front.
const stream = new core.McapStreamReader({ validateCrcs: true });
stream.append(new Uint8Array(bytes));
let streamed = 0;
for (let record = stream.nextRecord(); record; record = stream.nextRecord()) streamed += record.type === "Message" ? 1 : 0;
if (streamed !== messages || !stream.done()) throw new Error(`${streamed} messages from the front, ${messages} through the index`);
console.log(`${messages} messages: ${[...counts].map(([topic, count]) => `${topic} ${count}`).join(", ")}`);

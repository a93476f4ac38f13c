// read_trace.mjs FILE: prints every message of a trace, each value with all its bits, for interop_test to compare.
import { indexedMessages, makeFlattener, streamRecords } from "./mcap_files.mjs";

const path = process.argv[2];
const records = await streamRecords(path);
const schemas = new Map();
const channels = new Map();
const flatteners = new Map();
const messages = [];
for (const record of records) {
  if (record.type === "Schema") schemas.set(record.id, record);
  if (record.type === "Channel") channels.set(record.id, record);
  if (record.type === "Message") messages.push(record);
}
for (const channel of channels.values()) {
  const schema = schemas.get(channel.schemaId);
  flatteners.set(channel.id, makeFlattener(new TextDecoder().decode(schema.data)));
}
const print = (message) =>
  [channels.get(message.channelId).topic, message.sequence, message.logTime, ...flatteners.get(message.channelId)(message.data)].join(" ");
for (const message of messages) console.log(print(message));

// The index must lead to the same messages.
const indexed = await indexedMessages(path);
const byText = (list) => list.map(print).sort().join("\n");
if (byText(indexed.messages) !== byText(messages)) throw new Error("the index leads to other messages");
for (const attachment of indexed.attachments) {
  console.log(`attachment ${attachment.name} ${attachment.mediaType} ${new TextDecoder().decode(attachment.data)}`);
}
for (const record of records) {
  if (record.type === "Metadata") console.log(`metadata ${record.name} ${JSON.stringify(Object.fromEntries(record.metadata))}`);
  if (record.type === "Statistics") console.log(`statistics ${record.messageCount} messages, ${record.chunkCount} chunks`);
}

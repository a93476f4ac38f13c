// compare_cat.mjs FILE REHEARSE: every message that @mcap/core reads, with checked CRCs, must be in the output of
// `rehearse cat --json`, in order of log time, with the same values, or, if it isn't decoded, the same bytes. Prints the
// number of messages.
import { spawn } from "node:child_process";
import { createInterface } from "node:readline";
import { makeComparison, parseExactly } from "./decode.mjs";
import { streamRecords } from "./mcap_files.mjs";

const [path, rehearse] = process.argv.slice(2);
const schemas = new Map();
const channels = new Map();
const messages = [];
for (const record of await streamRecords(path)) {
  if (record.type === "Schema") schemas.set(record.id, record);
  if (record.type === "Channel") channels.set(record.id, record);
  if (record.type === "Message") messages.push(record);
}
messages.sort((a, b) => (a.logTime < b.logTime ? -1 : a.logTime > b.logTime ? 1 : 0)); // stable: then file order

const comparisons = new Map();
function comparisonOf(channel) {
  const schema = schemas.get(channel.schemaId);
  if (channel.messageEncoding !== "cdr" || schema?.encoding !== "ros2msg") return undefined;
  if (!comparisons.has(channel.id)) comparisons.set(channel.id, makeComparison(new TextDecoder().decode(schema.data)));
  return comparisons.get(channel.id);
}

function compare(message, line) {
  const ours = parseExactly(line);
  const channel = channels.get(message.channelId);
  const head = [channel.topic, message.sequence, message.logTime, message.publishTime].join(" ");
  const time = (value) => value.int ?? value;
  const ourHead = [ours.topic, ours.sequence, time(ours.log_time), time(ours.publish_time)].join(" ");
  if (head !== ourHead) throw new Error(`${ourHead} instead of ${head}`);
  const decodes = comparisonOf(channel);
  if (decodes != undefined) decodes(message.data, ours.message);
  else if (channel.messageEncoding === "json") {
    if (JSON.stringify(JSON.parse(new TextDecoder().decode(message.data))) !== JSON.stringify(ours.message)) throw new Error("other JSON");
  } else if (Buffer.from(message.data).toString("base64") !== ours.data) throw new Error("other bytes");
}

const cat = spawn(rehearse, ["cat", path, "--json"], { stdio: ["ignore", "pipe", "inherit"] });
const ended = new Promise((resolve) => cat.on("close", resolve));
let count = 0;
for await (const line of createInterface({ input: cat.stdout, crlfDelay: Infinity })) {
  if (count === messages.length) throw new Error("cat prints more messages than there are");
  try {
    compare(messages[count], line);
  } catch (problem) {
    throw new Error(`message ${count}, topic ${channels.get(messages[count].channelId).topic}: ${problem.message}`);
  }
  ++count;
}
if ((await ended) !== 0) throw new Error("rehearse cat failed");
if (count !== messages.length) throw new Error(`cat prints ${count} of ${messages.length} messages`);
console.log(`${count} messages, ${comparisons.size} channels decoded`);

// write_forms.mjs FILE COMPRESSION [--no-SWITCH...]: a file in one of the forms that the format's own library can write:
// none, lz4, zstd or unchunked; with features of McapWriter switched off, as --no-useChunkIndex. Two channels of joint
// states, one of JSON without a schema, one of bytes; chunks that overlap in time; an attachment; metadata.
import { parse } from "@foxglove/rosmsg";
import { MessageWriter } from "@foxglove/rosmsg2-serialization";
import zstd from "@foxglove/wasm-zstd";
import { McapWriter } from "@mcap/core";
import lz4 from "lz4js";
import { open } from "node:fs/promises";

const [path, compression, ...switches] = process.argv.slice(2);
await zstd.isLoaded;
const compressors = {
  lz4: (data) => ({ compression: "lz4", compressedData: Uint8Array.from(lz4.compress(data)) }),
  zstd: (data) => ({ compression: "zstd", compressedData: Uint8Array.from(zstd.compress(data, 3)) }),
};
const schemaText = `# a comment
std_msgs/Header header
string[] name
float64[] position
float64[] velocity
float64[] effort
================================================================================
MSG: std_msgs/Header
builtin_interfaces/Time stamp
string frame_id
`;

const file = await open(path, "w");
let position = 0n;
const writable = {
  position: () => position,
  write: async (bytes) => {
    await file.write(bytes);
    position += BigInt(bytes.length);
  },
};
const options = { writable, useChunks: compression !== "unchunked", chunkSize: 2000, compressChunk: compressors[compression] };
for (const feature of switches) options[feature.replace("--no-", "")] = false;
const writer = new McapWriter(options);
await writer.start({ profile: "ros2", library: "interop" });
const text = (value) => new TextEncoder().encode(value);
const schemaId = await writer.registerSchema({ name: "sensor_msgs/msg/JointState", encoding: "ros2msg", data: text(schemaText) });
const channel = (topic, messageEncoding, schema = 0) =>
  writer.registerChannel({ schemaId: schema, topic, messageEncoding, metadata: new Map([["note", topic]]) });
const joints = [await channel("/robot/joints", "cdr", schemaId), await channel("/other/joints", "cdr", schemaId)];
const json = await channel("/json", "json");
const bytes = await channel("/bytes", "");
const messages = new MessageWriter(parse(schemaText, { ros2: true }));
const add = (channelId, sequence, logTime, data) =>
  writer.addMessage({ channelId, sequence, logTime: BigInt(logTime), publishTime: BigInt(logTime + 7), data });
for (let i = 0; i < 100; ++i) {
  const data = messages.writeMessage({
    header: { stamp: { sec: -1, nanosec: i }, frame_id: "world" },
    name: ["KNEE", "ANKLE"],
    position: [0.1 * i, -0],
    velocity: [],
    effort: [Infinity, NaN],
  });
  // Every tenth comes late, so that chunks overlap; and pairs have the same time.
  await add(joints[i % 2], i, i % 10 === 9 ? 1000 * (i - 9) : 1000 * Math.floor(i / 2), data);
  if (i % 25 === 0) await add(json, i, 1000 * i, text(`{ "i" : ${i}, "x": [1.5, null, "a\\"b"] }`));
  if (i % 25 === 1) await add(bytes, i, 1000 * i, Uint8Array.from([i, 0, 255]));
}
await writer.addAttachment({ name: "note", mediaType: "text/plain", logTime: 5n, createTime: 6n, data: text("hello") });
await writer.addMetadata({ name: "about", metadata: new Map([["key", "value"]]) });
await writer.end();
await file.close();

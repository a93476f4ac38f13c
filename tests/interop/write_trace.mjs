// write_trace.mjs FILE chunked|unchunked: writes joint states with the format's own library, for interop_test to read.
import { parse } from "@foxglove/rosmsg";
import { MessageWriter } from "@foxglove/rosmsg2-serialization";
import { McapWriter } from "@mcap/core";
import { open } from "node:fs/promises";

const [path, form] = process.argv.slice(2);
const schemaText = `std_msgs/Header header
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
const writer = new McapWriter({ writable, useChunks: form === "chunked", chunkSize: 2000 });
await writer.start({ profile: "ros2", library: "interop" });
const schemaId = await writer.registerSchema({
  name: "sensor_msgs/msg/JointState",
  encoding: "ros2msg",
  data: new TextEncoder().encode(schemaText),
});
const channelId = await writer.registerChannel({ schemaId, topic: "/robot/joints", messageEncoding: "cdr", metadata: new Map() });
const messages = new MessageWriter(parse(schemaText, { ros2: true }));
for (let i = 0; i < 100; ++i) {
  const data = messages.writeMessage({
    header: { stamp: { sec: 0, nanosec: i }, frame_id: "" },
    name: ["KNEE", "ANKLE"],
    position: [0.1 * i, -0],
    velocity: [],
    effort: [Infinity, NaN],
  });
  await writer.addMessage({ channelId, sequence: i, logTime: BigInt(i), publishTime: BigInt(i), data });
}
await writer.addAttachment({ name: "note", mediaType: "text/plain", logTime: 0n, createTime: 0n, data: new TextEncoder().encode("hello") });
await writer.end();
await file.close();

// check_frames.mjs FILE: connects the frames of a viewer's file as viewers do: every frame that a message or a link of a
// /robot_description names must lead to "world" by the transforms on /tf and /tf_static. Fails if one doesn't, if a
// description is not at the beginning, or if a link of a description isn't in the file's transforms.
import { parse } from "@foxglove/rosmsg";
import { MessageReader } from "@foxglove/rosmsg2-serialization";
import { indexedMessages } from "./mcap_files.mjs";

const { reader, messages } = await indexedMessages(process.argv[2]);
const decoders = new Map();
function decode(message) {
  const channel = reader.channelsById.get(message.channelId);
  const schema = reader.schemasById.get(channel.schemaId);
  if (schema?.encoding !== "ros2msg") return { channel, value: {} };
  if (!decoders.has(schema.id))
    decoders.set(schema.id, new MessageReader(parse(new TextDecoder().decode(schema.data), { ros2: true })));
  return { channel, value: decoders.get(schema.id).readMessage(message.data) };
}

const parents = new Map();
const named = new Map(); // frame: topic that names it
const described = [];
const start = messages[0].logTime;
for (const message of messages) {
  const { channel, value } = decode(message);
  for (const transform of value.transforms ?? []) parents.set(transform.child_frame_id, transform.header.frame_id);
  if (value.header?.frame_id) named.set(value.header.frame_id, channel.topic);
  if (!channel.topic.endsWith("/robot_description")) continue;
  if (message.logTime !== start) throw new Error(`${channel.topic} isn't at the beginning`);
  described.push(channel.topic);
  for (const [, link] of value.data.matchAll(/<link\s[^>]*name="([^"]*)"/g)) {
    if (!link.includes("/")) throw new Error(`${channel.topic} names the link ${link}, which is no frame`);
    named.set(link, channel.topic);
  }
}
if (!described.includes("/robot_description")) throw new Error("there is no /robot_description");
const unconnected = [];
for (const [frame, topic] of named) {
  let at = frame;
  for (let depth = 0; at !== "world" && depth < 100; ++depth) at = parents.get(at);
  if (at !== "world") unconnected.push(`${frame} of ${topic}`);
}
console.log(`${described.join(" ")}\n${[...named.keys()].sort().join(" ")}\n${unconnected.length} unconnected`);
if (unconnected.length > 0) throw new Error(`unconnected: ${unconnected.join(", ")}`);

// Opens MCAP files with the format's own TypeScript library, and decodes ROS 2 messages with external libraries.
import { parse } from "@foxglove/rosmsg";
import { MessageReader } from "@foxglove/rosmsg2-serialization";
import { McapIndexedReader, McapStreamReader } from "@mcap/core";
import { decompress } from "fzstd";
import lz4 from "lz4js";
import { open, readFile } from "node:fs/promises";

const decompressHandlers = {
  lz4: (buffer) => Uint8Array.from(lz4.decompress(buffer)),
  zstd: (buffer, size) => decompress(buffer, new Uint8Array(Number(size))),
};

/** All records of the file from front to back, every CRC checked. Throws if the file doesn't end as it should. */
export async function streamRecords(path) {
  const reader = new McapStreamReader({ validateCrcs: true, includeChunks: false, decompressHandlers });
  reader.append(await readFile(path));
  const records = [];
  for (let record; (record = reader.nextRecord()); ) records.push(record);
  if (!reader.done()) throw new Error("the file is not complete");
  return records;
}

/** All messages by way of the summary's index, in order of log time. */
export async function indexedMessages(path) {
  const file = await open(path);
  const { size } = await file.stat();
  const readable = {
    size: async () => BigInt(size),
    read: async (offset, length) => {
      const bytes = new Uint8Array(Number(length));
      await file.read(bytes, 0, bytes.length, Number(offset));
      return bytes;
    },
  };
  const reader = await McapIndexedReader.Initialize({ readable, decompressHandlers });
  const messages = [];
  for await (const message of reader.readMessages()) messages.push(message);
  const attachments = [];
  for await (const attachment of reader.readAttachments()) attachments.push(attachment);
  await file.close();
  return { reader, messages, attachments };
}

/** The 16 hexadecimal digits of a double. */
function doubleBits(value) {
  const view = new DataView(new ArrayBuffer(8));
  view.setFloat64(0, value);
  return view.getBigUint64(0).toString(16).padStart(16, "0");
}

function printPrimitive(type, value) {
  if (type === "float64" || type === "float32") return doubleBits(value);
  if (type === "bool") return value ? "1" : "0";
  return String(value);
}

/** Makes "path=value" texts of a decoded message, in the order of the schema. */
export function makeFlattener(schemaText) {
  const definitions = parse(schemaText, { ros2: true });
  const root = definitions.find((definition) => definition.name == undefined) ?? definitions[0];
  const find = (type) => definitions.find((definition) => definition.name === type);
  const walk = (definition, message, path, out) => {
    for (const field of definition.definitions) {
      if (field.isConstant) continue;
      const here = path === "" ? field.name : `${path}/${field.name}`;
      const value = message[field.name];
      const print = (element, place) => {
        // The library has a special type for builtin_interfaces/Time.
        if (field.type === "time") out.push(`${place}/sec=${element.sec}`, `${place}/nanosec=${element.nanosec ?? element.nsec}`);
        else if (!field.isComplex) out.push(`${place}=${printPrimitive(field.type, element)}`);
        else walk(find(field.type), element, place, out);
      };
      if (field.isArray && field.type === "uint8") out.push(`${here}=${Buffer.from(value).toString("hex")}`);
      else if (field.isArray) Array.from(value).forEach((element, i) => print(element, `${here}/${i}`));
      else print(value, here);
    }
    return out;
  };
  const reader = new MessageReader(definitions);
  return (data) => walk(root, reader.readMessage(data), "", []);
}

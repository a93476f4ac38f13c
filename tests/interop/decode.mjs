// Decodes messages with external libraries, and compares them with the output of `rehearse cat --json`.
import { parse } from "@foxglove/rosmsg";
import { MessageReader } from "@foxglove/rosmsg2-serialization";

/** JSON with integers that a double can't hold as {int: "digits"}; strings are left alone. */
export function parseExactly(text) {
  const token = /"(?:[^"\\]|\\.)*"|-?\d+(?:\.\d+)?(?:[eE][-+]?\d+)?/g;
  return JSON.parse(text.replace(token, (part) => (/^-?\d{16,}$/.test(part) ? `{"int":"${part}"}` : part)));
}

function sameNumber(theirs, ours) {
  if (typeof ours === "string") return Object.is(theirs, { NaN: NaN, Infinity, "-Infinity": -Infinity }[ours]);
  return typeof ours === "number" && Object.is(theirs, ours);
}

function sameInteger(theirs, ours) {
  return BigInt(theirs) === BigInt(ours?.int ?? ours);
}

/** Throws, naming the path, unless both have the same fields, with the same bits. */
class Comparison {
  constructor(definitions) {
    this.definitions = definitions;
    this.root = definitions.find((definition) => definition.name == undefined) ?? definitions[0];
  }

  message(definition, theirs, ours, path) {
    const fields = definition.definitions.filter((field) => field.isConstant !== true);
    const names = fields.map((field) => field.name);
    if (JSON.stringify(Object.keys(ours)) !== JSON.stringify(names)) throw new Error(`${path}: fields ${Object.keys(ours)}`);
    for (const field of fields) this.field(field, theirs[field.name], ours[field.name], `${path}/${field.name}`);
  }

  field(field, theirs, ours, path) {
    if (!field.isArray) return this.element(field, theirs, ours, path);
    if (field.type === "uint8") {
      if (Buffer.from(theirs).toString("base64") !== ours) throw new Error(`${path}: other bytes`);
      return;
    }
    if (!Array.isArray(ours) || ours.length !== theirs.length) throw new Error(`${path}: another length`);
    for (let i = 0; i < ours.length; ++i) this.element(field, theirs[i], ours[i], `${path}/${i}`);
  }

  element(field, theirs, ours, path) {
    const type = field.type;
    if (type === "time" || type === "duration") {
      if (theirs.sec !== ours.sec || theirs.nanosec !== ours.nanosec) throw new Error(`${path}: another time`);
    } else if (field.isComplex) {
      this.message(this.definitions.find((definition) => definition.name === type), theirs, ours, path);
    } else {
      const same =
        type.startsWith("float") ? sameNumber(theirs, ours) :
        type === "bool" || type === "string" ? theirs === ours : sameInteger(theirs, ours);
      if (!same) throw new Error(`${path}: ${JSON.stringify(ours)} instead of ${theirs}`);
    }
  }
}

/** A function that throws unless its second argument, from our JSON, is what the payload, its first, decodes to. */
export function makeComparison(schemaText) {
  const definitions = parse(schemaText, { ros2: true });
  const reader = new MessageReader(definitions);
  const comparison = new Comparison(definitions);
  return (data, ours) => comparison.message(comparison.root, reader.readMessage(data), ours, "");
}

// check_standard_types.mjs SOURCE: compares the list of standard types in our source with the definitions of ROS 2
// Humble in an external package: the same fields, of the same types, in the same order. Prints the number of compared
// types, and the names of those that the package doesn't have.
import { ros2humble } from "@foxglove/rosmsg-msgs-common";
import { readFile } from "node:fs/promises";

const list = (await readFile(process.argv[2], "utf8")).split('R"(')[1].split(')"')[0];
const ours = new Map(
  list
    .split("\n")
    .filter((line) => line !== "")
    .map((line) => {
      const [name, fields] = line.split(/: (.*)/);
      return [name, fields.split(", ")];
    }),
);
const bytes = { byte: "uint8", char: "uint8", time: "builtin_interfaces/Time", duration: "builtin_interfaces/Duration" };

/** The type of a field with its package. */
function typeOf(text, name) {
  const [, type, array] = text.match(/^([^[]+)(\[.*\])?$/);
  const local = `${name.split("/")[0]}/${type}`;
  const whole = type === "Header" ? "std_msgs/Header" : ours.has(local) ? local : (bytes[type] ?? type);
  return whole + (array ?? "");
}

let compared = 0;
const unknown = [];
for (const [name, fields] of ours) {
  const theirs = ros2humble[name]?.definitions.filter((field) => field.isConstant !== true);
  if (theirs == undefined) {
    unknown.push(name);
    continue;
  }
  // A message without fields has one byte, which only the encoded message shows.
  if (theirs.length === 0) theirs.push({ type: "uint8", name: "structure_needs_at_least_one_member" });
  const here = fields.map((field) => `${typeOf(field.split(" ")[0], name)} ${field.split(" ")[1]}`).join("; ");
  const there = theirs
    .map((field) => `${(bytes[field.type] ?? field.type).replace("/msg/", "/")}${field.isArray ? `[${field.arrayLength ?? ""}]` : ""} ${field.name}`)
    .join("; ");
  if (here !== there) throw new Error(`${name} has ${here} instead of ${there}`);
  ++compared;
}
console.log(`${compared} types; not in the package: ${unknown.join(" ")}`);

// compare_schemas.mjs FILE: compares the schemas of a file, with all types that they use, with the ROS 2 definitions
// of an external package: the same fields, of the same types, in the same order. Prints the names of the compared
// schemas.
import { parse } from "@foxglove/rosmsg";
import { ros2humble, ros2jazzy } from "@foxglove/rosmsg-msgs-common";
import { streamRecords } from "./mcap_files.mjs";

const short = (name) => name.replace("/msg/", "/");
/** A definition as text, without constants: they are in no message. */
function fieldsOf(definition) {
  return definition.definitions
    .filter((field) => field.isConstant !== true)
    .map((field) => {
      // One library has a special type for builtin_interfaces/Time, the other has not.
      const type = { time: "builtin_interfaces/Time", duration: "builtin_interfaces/Duration" }[field.type] ?? short(field.type);
      return `${type}${field.isArray ? `[${field.arrayLength ?? ""}]` : ""} ${field.name}`;
    })
    .join("; ");
}

const compared = new Set();
for (const record of await streamRecords(process.argv[2])) {
  if (record.type !== "Schema") continue;
  for (const definition of parse(new TextDecoder().decode(record.data), { ros2: true })) {
    const name = short(definition.name ?? record.name);
    if (name.startsWith("rehearse_msgs/")) continue;
    for (const [distribution, known] of Object.entries({ humble: ros2humble, jazzy: ros2jazzy })) {
      if (known[name] == undefined) throw new Error(`${name} is no type of ROS 2 ${distribution}`);
      const theirs = fieldsOf(known[name]);
      if (theirs !== fieldsOf(definition)) throw new Error(`${name} has ${fieldsOf(definition)} instead of ${theirs}`);
    }
    compared.add(name);
  }
}
console.log([...compared].sort().join(" "));

// recipes_test.mjs SOURCE BUILD: follows the recipe "A sensor" in a scratch copy of the sources. With the files that the
// recipe lists, and no others, the affected units compile. With each of them left out in turn, one doesn't, and the
// errors name the file. Likewise each member of a device's row.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { cpSync, mkdirSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { dirname, join } from 'node:path';
import { sectionOf } from '../../tools/site/markdown.mjs';

const [source, build] = process.argv.slice(2);
const copied = ['engine/include', 'engine/src', 'harness/include', 'harness/src'];
const kinds = 'harness/src/core/kinds';

/** A photometer measures the light of a sun above it [lx], a unit that has no row so far. */
const message = `#include "number_message.h"

namespace rehearse {
namespace msg {
struct Illuminance {
  static constexpr std::string_view type_name = "sensor_msgs/msg/Illuminance";
  Header header;
  double illuminance = 0.0;  // [lx]
  double variance = 0.0;
  REHEARSE_FIELDS(header, illuminance, variance)
};
}  // namespace msg
namespace {
constexpr ElementGroup illuminance_groups[] = {{"illuminance", "lx"}};
std::array<double*, 1> places_of_illuminance(msg::Illuminance& message) { return {&message.illuminance}; }
constexpr LogInput illuminance_input{.content = LogInput::Content::numbers,
                                     .key = "photometers",
                                     .form = "photometer_source",
                                     .owner = "a photometer",
                                     .devices = "photometers",
                                     .messages = "an Illuminance"};
constexpr DeviceMeasurement illuminance_measurement{.log = illuminance_input};
}  // namespace
const ChannelForm illuminance_kind{.level = ChannelForm::Level::owner,
                                   .segment = "illuminance",
                                   .type = msg::Illuminance::type_name,
                                   .schema = msg::schema_text<msg::Illuminance>,
                                   .stage = Stage::sensors,
                                   .groups = illuminance_groups,
                                   .has_fixed_elements = true,
                                   .is_state = true,
                                   .make_rows = number_rows<msg::Illuminance, places_of_illuminance, ChannelKind::illuminance>,
                                   .numbers = &number_message<msg::Illuminance, places_of_illuminance>,
                                   .measurement = &illuminance_measurement};
}  // namespace rehearse
`;
const members = {
  type: '"Photometer"',
  readings: 'DeviceReadings::each_step(1)',
  quantities: '{{"illuminance", "lx", 1}}',
  scenario_types: '{"photometer"}',
  urdf_types: '{"photometer"}',
  body_types: 'DeviceNames::None()',
};
const struct = (name, given) =>
  `struct ${name} {\n  static constexpr DeviceForm form() {\n    return {${Object.entries(given)
    .map(([member, value]) => `.${member} = ${value}`)
    .join(', ')}};\n  }\n};\n`;

/** What the recipe's files become: each a function of the text so far. */
const steps = {
  'engine/include/rehearse/units.h': (text) => insertBefore(text, '    {"B", exact},', '    {"lx", {1e-3, 0.0}, {{{"lx"}}}},\n'),
  'engine/include/rehearse/devices.h': (text) =>
    insertBefore(text, 'using DeviceKind = std::variant<', struct('Photometer', members)).replace('Magnetometer>;', 'Magnetometer, Photometer>;'),
  'engine/src/world/link_sensor.h': (text) =>
    insertBefore(text, '  void operator()(const Magnetometer&)', '  void operator()(const Photometer&) const { values_.assign({1e5 * to_sensor_(2, 2)}); }\n'),
  [`${kinds}/NAME.cpp`]: () => message,
  [`${kinds}/kinds.inl`]: (text) => insertBefore(text, 'REHEARSE_KIND(scan', 'REHEARSE_KIND(illuminance, Photometer)\n'),
};
function insertBefore(text, place, added) {
  assert(text.includes(place), `the sources have no '${place}' any more`);
  return text.replace(place, added + place);
}

const section = sectionOf(readFileSync(join(source, 'tools/site/pages/contribute/recipes.md'), 'utf8'), 'a-sensor').lines.join('\n');
const listed = [...section.matchAll(/^\d+\. `([^`]+)`/gm)].map(([, file]) => file);
assert.deepEqual([...listed].sort(), Object.keys(steps).sort(), 'the recipe "A sensor" lists other files than this test changes');

/** Makes the copy as it is with the recipe's files, without those of `left`. */
const scratch = mkdtempSync(join(tmpdir(), 'recipe-'));
process.on('exit', () => rmSync(scratch, { recursive: true, force: true }));
copied.forEach((folder) => cpSync(join(source, folder), join(scratch, folder), { recursive: true }));
function follow(left) {
  for (const [file, change] of Object.entries(steps)) {
    const name = file.replace('NAME', 'illuminance');
    const original = file.includes('NAME') ? null : readFileSync(join(source, name), 'utf8');
    rmSync(join(scratch, name), { force: true });
    if (file === left) {
      if (original !== null) writeFileSync(join(scratch, name), original);
    } else {
      writeFileSync(join(scratch, name), change(original));
    }
  }
}

const commands = JSON.parse(readFileSync(join(build, 'compile_commands.json'), 'utf8'));
/** The errors of a file of the copy, compiled with the flags of its room; empty: none. */
function errorsOf(file, room) {
  const of = commands.find(({ command }) => command.includes(`rehearse_room_${room}_`));
  assert(of, `the build has no room ${room}`);
  const words = of.command.split(/\s+/).map((word) => word.replaceAll('\\"', '"'));
  const flags = words.filter((word, i) => /^-(I|D|isystem|std|f)/.test(word) || words[i - 1] === '-isystem');
  const inCopy = flags.map((flag) => copied.reduce((text, folder) => text.replace(join(source, folder), join(scratch, folder)), flag));
  const compiler = words.find((word) => /(\+\+|clang|gcc)[-\d.]*$/.test(word));
  const kept = inCopy.filter((flag) => flag !== '-fpch-preprocess');
  const outcome = spawnSync(compiler, [...kept, '-fsyntax-only', join(scratch, file)], { encoding: 'utf8' });
  return outcome.status === 0 ? '' : outcome.stderr;
}

const units = [
  ['engine/src/model/model.cpp', 'model'],
  ['engine/src/world/simulated_body.cpp', 'world'],
  [`${kinds}/kinds.cpp`, 'kinds'],
  [`${kinds}/illuminance.cpp`, 'kinds'],
];
follow(null);
for (const [file, room] of units) assert.equal(errorsOf(file, room), '', `with all files of the recipe ${file} doesn't compile`);
console.log('with the files of the recipe the affected units compile');

/** CMake's errors on the folder of kinds. */
function configured() {
  const folder = join(scratch, 'configure');
  mkdirSync(folder, { recursive: true });
  writeFileSync(
    join(folder, 'CMakeLists.txt'),
    `cmake_minimum_required(VERSION 3.25)\nproject(kinds NONE)\nfunction(rehearse_room)\nendfunction()\nadd_subdirectory(${join(scratch, kinds)} kinds)\n`,
  );
  const outcome = spawnSync('cmake', ['-S', folder, '-B', join(folder, 'build')], { encoding: 'utf8' });
  return outcome.status === 0 ? '' : outcome.stderr;
}
assert.equal(configured(), '');

const forgotten = {
  'engine/include/rehearse/units.h': [() => errorsOf(...units[0]), /rehearse\/units\.h has no row/],
  'engine/include/rehearse/devices.h': [() => errorsOf(...units[2]), /Photometer/],
  'engine/src/world/link_sensor.h': [() => errorsOf(...units[1]), /link_sensor\.h/],
  [`${kinds}/NAME.cpp`]: [configured, /illuminance\.cpp/],
  [`${kinds}/kinds.inl`]: [() => errorsOf(...units[2]), /kinds\/kinds\.inl/],
};
for (const [file, [errors, named]] of Object.entries(forgotten)) {
  follow(file);
  const told = errors();
  assert(named.test(told), `without ${file} there is no error that names it:\n${told.slice(0, 2000)}`);
  console.log(`without ${file}: an error names it`);
}

// A row without one of its members. `type` is a text, which may be empty.
follow(null);
const probe = 'engine/src/model/incomplete_rows.cpp';
mkdirSync(dirname(join(scratch, probe)), { recursive: true });
const required = Object.keys(members).filter((member) => member !== 'type');
const without = (member) => struct(`Without_${member}`, Object.fromEntries(Object.entries(members).filter(([name]) => name !== member)));
writeFileSync(join(scratch, probe), `#include <rehearse/devices.h>\nnamespace rehearse {\n${struct('Whole', members)}${required.map(without).join('')}}\n`);
const incomplete = errorsOf(probe, 'model');
assert.doesNotMatch(incomplete, /Whole/);
for (const member of required) assert.match(incomplete, new RegExp(`Without_${member}`), `a row without ${member} compiles`);

// A unit without a row, and a row without a tolerance.
const measurement = `${kinds}/illuminance.cpp`;
writeFileSync(join(scratch, measurement), message.replace('"lx"', '"furlong"'));
assert.match(errorsOf(measurement, 'kinds'), /rehearse\/units\.h has no row/, 'a channel with a unit of no row compiles');
const registry = 'engine/include/rehearse/units.h';
const rows = readFileSync(join(scratch, registry), 'utf8');
writeFileSync(join(scratch, registry), insertBefore(rows, '    {"B", exact},', '    {.name = "furlong"},\n'));
assert.match(errorsOf('engine/src/units/units.cpp', 'units'), /UnitTolerance/, 'a unit without a tolerance compiles');
writeFileSync(join(scratch, registry), rows);
console.log('a unit without a row, or without a tolerance, does not compile');

writeFileSync(join(scratch, measurement), message.replace('{.log = illuminance_input}', '{}'));
assert.match(errorsOf(measurement, 'kinds'), /DeviceMeasurement::log/, 'a measurement without its input by a log compiles');
console.log(`a row without ${required.join(', ')} or log doesn't compile`);

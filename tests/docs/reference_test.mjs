// reference_test.mjs SOURCE BUILD: each key, exit status, variable, message type, field of JSON, verb and option has a
// text in the pages of the reference. It also adds one of each, which must be found to have none.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { existsSync, readFileSync, readdirSync } from 'node:fs';
import { join } from 'node:path';
import { environmentVariables, exitStatuses, formKeys, keysTable, messageTypes, sensorErrors, verbs, verdictCodes } from '../../tools/site/facts.mjs';
import { publicHeaders } from '../../tools/site/reference.mjs';
import { sectionOf } from '../../tools/site/markdown.mjs';

const [source, build] = process.argv.slice(2);
const read = (file) => readFileSync(join(source, file), 'utf8');
const section = (file, anchor) => sectionOf(read(file), anchor).lines.join('\n');

/** The words in code of a text: `a b` gives a and b; of a block of YAML the keys with a comment behind them. */
const wordsIn = (text) =>
  new Set([
    ...[...text.matchAll(/^ *(\w+):.*# /gm)].map(([, key]) => key),
    ...[...text.replace(/^```[^]*?^```/gm, '').matchAll(/`([^`]+)`/g)].flatMap(([, code]) => code.match(/\w[\w.]*/g) ?? []),
  ]);
const without = (names, text) => {
  const words = wordsIn(text);
  return names.filter((name) => !words.has(name));
};

let failures = 0;
/** Each of `names` must be in the text; a name that nobody has written must not. */
function covers(what, names, text, place) {
  assert(names.length > 0, `no ${what} was found: the sources have changed`);
  const missing = without(names, text);
  if (missing.length) ++failures;
  missing.forEach((name) => console.log(`${what} '${name}' has no text in ${place}`));
  assert.deepEqual(without([...names, 'a_new_one'], text).slice(missing.length), ['a_new_one']);
}

const reference = (names) => names.map((name) => `tools/site/pages/reference/${name}.md`);
const forms = {
  scenario: reference(['scenario', 'bodies', 'inputs', 'actuators', 'noise', 'tolerances', 'expectations', 'variations']),
  map: reference(['map', 'log_ticks', 'tolerances']),
};
const program = join(build, 'bin/rehearse');
/** A page with the tables that are made of forms. */
const readWithTables = (file) => read(file).replace(/^<!-- made: keys (\S+) -->$/gm, (line, name) => keysTable(program, name));
const names = (keys) => keys.map(({ name }) => name);
for (const [schema, files] of Object.entries(forms)) {
  const text = files.map(readWithTables).join('\n');
  for (const { owner, keys } of formKeys(program, schema)) covers(`key of ${owner}`, names(keys), text, files.join(' '));
}

const variables = 'tools/site/pages/reference/environment.md';
covers('variable', environmentVariables(source), read(variables), variables);

const dependencies = 'tools/site/pages/contribute/dependencies.md';
const libraries = [...read('tools/setup').matchAll(/^  ((?:lib\S+|\S+\d)-dev) /gm)].map(([, library]) => library);
const ofUsers = libraries.slice(0, libraries.indexOf('libgtest-dev') + 1);
assert(ofUsers.length > 20, 'no libraries were found in tools/setup');
for (const library of ofUsers)
  if (!read(dependencies).includes(`\`${library}\``)) {
    ++failures;
    console.log(`library '${library}' of tools/setup has no row in ${dependencies}`);
  }

const statuses = exitStatuses(source).map(({ status }) => status);
for (const status of statuses)
  assert(new RegExp(`^\\| ${status}[ ,|]`, 'm').test(read('tools/site/pages/reference/exit.md')), `exit status ${status} has no text`);

const unitsOfErrors = {
  quantity: 'that of the quantity',
  per_root_hertz: 'that of the quantity / sqrt(Hz)',
  per_root_second: 'that of the quantity / sqrt(s)',
  share: 'number, %',
  angle: 'rad, deg',
  per_turn: '',
  none: '',
};
const quantitiesOfErrors = { '': 'all', with_axes: 'those with three axes', displacement: '`displacement`', color: '`color`' };
const noise = 'tools/site/pages/reference/noise.md';
const errors = sensorErrors(source).map(({ key, text, of, unit }) => `| \`${key}\` | ${text} | ${quantitiesOfErrors[of]} | ${unitsOfErrors[unit]} |`);
assert(errors.length > 10, 'no errors of quantities were found: the sources have changed');
assert.ok(read(noise).includes(`${errors.join('\n')}\n`), `${noise} lacks the rows of error_*.cpp:\n${errors.join('\n')}`);

const verdicts = 'tools/site/pages/reference/verdicts.md';
const rows = verdictCodes(source).map(({ code, meaning }) => `| \`${code}\` | ${meaning} |`);
assert(rows.length > 20, 'no codes of verdicts were found: the sources have changed');
assert.deepEqual(read(verdicts).match(/^\| `.*$/gm), rows, `the table of ${verdicts} isn't that of verdict_code.cpp`);

// Types that are only parts of others are described by their fields.
const types = messageTypes(source);
const parts = new Set(types.flatMap(({ fields }) => fields.map(({ type }) => type.replace(/\[\d*\]$/, ''))));
const whole = types.filter(({ type }) => !parts.has(type)).map(({ type }) => type.split('/').at(-1));
covers('message type', whole, section('harness/TRACE_FORMAT.md', 'payloads'), 'harness/TRACE_FORMAT.md#payloads');

const json = reference(['json', 'costs']);
const objects = readdirSync(join(build, 'share/rehearse/schemas')).map((file) => file.replace('.json', ''));
const filesOfPeople = ['scenario', 'map', 'tolerances', 'noise'];
for (const schema of objects.filter((name) => !filesOfPeople.includes(name)))
  for (const { owner, keys } of formKeys(program, schema))
    covers(`member of ${owner} of the schema ${schema}`, names(keys), json.map(read).join('\n'), json.join(' '));

for (const verb of verbs(program).flatMap((one) => [one, ...one.parts])) {
  const silent = [...verb.options, ...verb.positionals].filter(({ text }) => !text).map(({ words }) => words);
  if (silent.length) ++failures;
  silent.forEach((words) => console.log(`rehearse ${verb.name} has no text for ${words}`));
}

// Headers whose public members must all have a comment. The rest of the public headers is to follow.
const documented = ['gtest.h', 'test_support.h', 'controller_bench.h', 'faults.h', 'session.h', 'replay.h', 'host_options.h'];
if (existsSync('/usr/bin/doxygen')) {
  const config =
    read('tools/site/Doxyfile').replace('EXTRACT_ALL            = YES', 'EXTRACT_ALL = NO').replace('WARN_IF_UNDOCUMENTED   = NO', '') +
    `INPUT = ${publicHeaders(source).map(({ file }) => file).join(' ')}\nWARN_IF_UNDOCUMENTED = YES\nGENERATE_XML = NO\n` +
    `INPUT_FILTER = ${source}/tools/site/doxygen_filter\nEXCLUDE_SYMBOLS = rehearse::internal* *::Impl\n`;
  const outcome = spawnSync('doxygen', ['-'], { input: config, encoding: 'utf8' });
  const warnings = outcome.stderr.split('\n').filter((line) => line.includes('is not documented'));
  assert(outcome.status === 0, outcome.stderr);
  const wrong = warnings.filter((line) => documented.some((name) => line.includes(`/${name}:`)));
  if (wrong.length) ++failures;
  wrong.forEach((line) => console.log(line));
  console.log(`${warnings.length} members of other public headers have no comment`);
} else {
  console.log('comments of public headers are not examined: doxygen is not installed (tools/setup docs)');
}
process.exit(failures ? 1 : 0);

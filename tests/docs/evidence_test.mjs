// evidence_test.mjs SOURCE BUILD: the pages "How sure are you?" and "Compared with" are true to the tests. Each row of their
// tables of claims names a test that exists and that CMake builds or runs; each number in `counts` is the one that the
// program of the test lists, or the one of the table to which the row links. It also examines a page with one mistake of
// each kind, which must be found.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { existsSync, readFileSync } from 'node:fs';
import { basename, join } from 'node:path';
import { filesBelow } from '../../tools/site/files.mjs';

const [source, build] = process.argv.slice(2);
const read = (file) => readFileSync(join(source, file), 'utf8');

/** All CMake code below tests/, in which a test that is built is named. */
const cmake = filesBelow(join(source, 'tests'), /^CMakeLists\.txt$|\.cmake$/)
  .map((file) => readFileSync(file, 'utf8'))
  .join('\n');
const isBuilt = (file) => {
  const name = basename(file);
  return [name, name.replace(/\.cpp$/, '')].some((word) => new RegExp(`(^|[\\s/(])${word.replaceAll('.', '\\.')}($|[\\s)])`, 'm').test(cmake));
};

/** How many tests of a suite the program lists. */
function listed(program, suite) {
  const outcome = spawnSync(join(build, 'bin', program), ['--gtest_list_tests'], { encoding: 'utf8' });
  assert(outcome.status === 0, `${program} lists no tests: ${outcome.stderr}`);
  const lines = outcome.stdout.split('\n');
  const first = lines.indexOf(lines.find((line) => line.startsWith(`${suite}.`)) ?? '') + 1;
  assert(first > 0, `${program} has no suite ${suite}`);
  const rest = lines.slice(first).findIndex((line) => !line.startsWith('  '));
  return rest < 0 ? lines.length - first : rest;
}
const rowsOf = (file, row) => read(file).split('\n').filter((line) => row.test(line)).length;
const contribute = (name) => `tools/site/pages/contribute/${name}.md`;

/** A number of the page, where `...` is the number, and the count of which it is a copy. */
const counts = [
  ['one hash in [... environments]', () => rowsOf(contribute('determinism_tests'), /^\| (?!control).*`4d352c4b950c8108`/)],
  ['| ... controls differ', () => rowsOf(contribute('determinism_tests'), /^\| control: .*` \|/)],
  ['... [planted faults]', () => listed('fault_test', 'Of/Faults')],
  ['... groups: renamed', () => listed('innocent_test', 'Innocents')],
  ['... kinds of trouble', () => listed('kinds_test', 'All/Kinds') / 2],
  ['a zoo](audit_zoo.md) of ... controllers', () => listed('zoo_test', 'Of/Zoo')],
  ['... controllers: twenty ways', () => listed('zoo_test', 'Of/Realtime')],
  ['| ... [deeds]', () => listed('guests_test', 'Of/Guests')],
  ['2.7 million inputs of ... in', () => rowsOf(contribute('robustness_tests'), /^\| `\w+` \| .* \| [\d.]+ \| [^|]* \|$/)],
  ['... fuzz targets', () => rowsOf('tests/fuzz/CMakeLists.txt', /^rehearse_add_fuzz\(/)],
  ['all ... in its checkout', () => Number(/ (\d+) compat\)/.exec(read('tests/controllers/compat.cmake'))?.[1])],
  ['at least ... of 167 in 48 repositories', () => Number(/ (\d+) outside\)/.exec(read('tests/controllers/compat.cmake'))?.[1])],
];

/** The mistakes of a page; `examined` are the counts that it must state. */
function mistakesOf(page, text, examined) {
  const mistakes = [];
  let columns = 0;
  let rows = 0;
  text.split('\n').forEach((line, index) => {
    const cells = line.split('|').slice(1, -1);
    const say = (mistake) => mistakes.push(`${page}:${index + 1}: ${mistake}`);
    if (/^\| (claim|motion|Rehearse) \|/.test(line)) columns = cells.length;
    else if (!cells.length) columns = 0;
    else if (columns && !/^\| --- /.test(line)) {
      ++rows;
      const tests = [...line.matchAll(/`(tests\/[\w/.]+)`/g)].map(([, file]) => file);
      if (cells.length !== columns) say(`the row has ${cells.length} cells`);
      if (!tests.length) say('the row names no test');
      for (const file of tests) {
        if (!existsSync(join(source, file))) say(`there is no ${file}`);
        else if (!isBuilt(file)) say(`no CMake code below tests/ names ${file}`);
      }
    }
  });
  for (const [words, count] of examined) {
    const [before, after] = words.split('...').map((part) => part.replace(/[[\]()|.*+?^$]/g, '\\$&'));
    const found = new RegExp(`${before}([\\d,]+)${after}`).exec(text);
    const number = count();
    if (!found) mistakes.push(`${page}: '${words}' isn't there`);
    else if (Number(found[1].replaceAll(',', '')) !== number) mistakes.push(`${page}: '${words}' is ${found[1]}, and counted ${number}`);
  }
  return { mistakes, rows };
}

const wrong = `| claim | measured | repeated by |
| --- | --- | --- |
| a | 3 dogs | nothing |
| b | 4 cats | \`tests/verdict/gone_test.cpp\` |
| c | | \`tests/verdict/standing_robot.h\` |
| d | \`tests/verdict/fault_test.cpp\` |
`;
const planted = [['... dogs', () => 3], ['... cats', () => 5], ['... birds', () => 1]];
assert.deepEqual(
  mistakesOf('a.md', wrong, planted).mistakes.map((text) => text.replace('a.md:', '').trim()),
  [
    '3: the row names no test',
    '4: there is no tests/verdict/gone_test.cpp',
    '5: no CMake code below tests/ names tests/verdict/standing_robot.h',
    '6: the row has 2 cells',
    "'... cats' is 4, and counted 5",
    "'... birds' isn't there",
  ],
);

/** The pages, with the least number of claims and the numbers that they state. */
const pages = [
  ['evidence', 45, counts],
  ['compared', 10, [['[... environments]', counts[0][1]]]],
];
let failures = 0;
for (const [name, least, examined] of pages) {
  const page = `tools/site/pages/concepts/${name}.md`;
  const { mistakes, rows } = mistakesOf(page, read(page), examined);
  assert(rows >= least, `the tables of ${page} have ${rows} rows`);
  mistakes.forEach((text) => console.log(text));
  console.log(`${page}: ${rows} rows, ${examined.length} counts, ${mistakes.length} mistakes`);
  failures += mistakes.length;
}
process.exit(failures ? 1 : 0);

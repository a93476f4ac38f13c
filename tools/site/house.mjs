// house.mjs [SOURCE]: what one has to read to change Rehearse, as numbers: rooms, arrows between them, files, exported
// names, functions, pages. tools/lint --house prints them, and the page Architecture shows them.
import { existsSync, readdirSync, readFileSync } from 'node:fs';
import { basename, dirname, join, resolve } from 'node:path';
import { fileURLToPath } from 'node:url';
import { filesBelow } from './files.mjs';

const sourceFile = /\.(cpp|h|inl)$/;
const linesOf = (file) => readFileSync(file, 'utf8').trimEnd().split('\n');

/** The rooms of the build: {folder, uses, headers}, of which `headers` are those that other rooms may include. */
const roomsIn = (source) =>
  ['engine', 'harness'].flatMap((part) =>
    filesBelow(join(source, part), /^CMakeLists\.txt$/)
      .map((file) => ({ folder: dirname(file), text: readFileSync(file, 'utf8') }))
      .filter(({ text }) => text.includes('rehearse_room('))
      .map(({ folder, text }) => {
        const words = (key) => text.match(new RegExp(`\\b${key}\\b([^A-Z)]*)`))?.[1].match(/[\w.]+/g) ?? [];
        const headers = [
          ...words('PUBLIC').map((name) => join(source, part, 'include/rehearse', name)),
          ...words('DOOR').map((name) => join(folder, name)),
        ];
        return { folder, uses: words('MAY_USE'), headers: headers.filter(existsSync) };
      }),
  );

/** Definitions and declarations that begin in the first column, but no namespaces and preprocessor lines. */
const namesIn = (header) =>
  linesOf(header).filter((line) => /^(?!namespace|extern|template|using namespace)[a-zA-Z[].*[;{(,]/.test(line)).length;

/** {name, lines} of each function that isn't defined within a class: from its first column to the brace that ends it. */
function functionsIn(file) {
  const lines = linesOf(file);
  const found = [];
  lines.forEach((line, begin) => {
    if (!/^(?!namespace|class|struct|enum|union|constexpr|const |static const)[a-zA-Z].*[({,]$/.test(line) || !line.includes('(')) return;
    const end = lines.findIndex((other, i) => i > begin && /^}/.test(other));
    if (end > begin && lines[end] === '}') found.push({ name: `${basename(file)}:${begin + 1}`, lines: end - begin + 1 });
  });
  return found;
}

/** Headers that one file alone includes, beside the source that implements them. */
function headersOfOne(files) {
  const users = new Map();
  for (const file of files)
    for (const [, header] of readFileSync(file, 'utf8').matchAll(/^#include "(?:[\w./]*\/)?([\w]+\.h)"/gm))
      if (header.replace('.h', '') !== basename(file).replace(/\.\w+$/, '')) users.set(header, (users.get(header) ?? 0) + 1);
  return files.filter((file) => file.endsWith('.h') && (users.get(basename(file)) ?? 0) === 1);
}

const wordsIn = (files) => files.reduce((sum, file) => sum + readFileSync(file, 'utf8').split(/\s+/).filter(Boolean).length, 0);

/** The numbers as [name, value]. */
export function houseOf(folder) {
  const source = resolve(folder);
  const rooms = roomsIn(source);
  const files = rooms.flatMap(({ folder }) => readdirSync(folder).filter((name) => sourceFile.test(name)).map((name) => join(folder, name)));
  const core = files.filter((file) => file.includes('/harness/src/core/') || file.includes('/engine/src/'));
  const sizes = core.map((file) => linesOf(file).length);
  const longest = core.flatMap(functionsIn).reduce((most, each) => (each.lines > most.lines ? each : most), { lines: 0, name: '' });
  const pages = filesBelow(join(source, 'tools/site/pages'), /\.md$/);
  return [
    ['rooms', rooms.length],
    ['arrows between rooms', rooms.reduce((sum, { uses }) => sum + uses.length, 0)],
    ['files in rooms', files.length],
    ['lines in rooms', files.reduce((sum, file) => sum + linesOf(file).length, 0)],
    ['files in core and engine', core.length],
    ['of these under 60 lines', sizes.filter((size) => size < 60).length],
    ['of these over 500 lines', sizes.filter((size) => size > 500).length],
    ['names in headers that other rooms may include', rooms.flatMap(({ headers }) => headers).reduce((sum, header) => sum + namesIn(header), 0)],
    ['headers with one user', headersOfOne(files).length],
    ['lines of the longest function', longest.lines],
    ['pages of the site', pages.length],
    ['words of the pages', wordsIn(pages)],
  ];
}

/** The numbers that this script finds in commit aed51e9e of 2026-11-28. */
const before = {
  rooms: 44,
  'arrows between rooms': 251,
  'files in rooms': 1006,
  'lines in rooms': 115845,
  'files in core and engine': 739,
  'of these under 60 lines': 298,
  'of these over 500 lines': 0,
  'names in headers that other rooms may include': 978,
  'headers with one user': 136,
  'lines of the longest function': 65,
  'pages of the site': 127,
  'words of the pages': 94187,
};

/** Numbers that a change may not exceed. One that lowers a number lowers its limit, too. */
const limits = {
  'of these under 60 lines': 375,
  'of these over 500 lines': 0,
  'headers with one user': 165,
  'lines of the longest function': 84,
};

/** Rows of a table: name, number then, number now. */
export const houseRows = (source) => houseOf(source).map(([name, value]) => [name, before[name], value]);

if (process.argv[1] === fileURLToPath(import.meta.url)) {
  for (const [name, value] of houseOf(process.argv[2] ?? '.')) {
    console.log(`${String(value).padStart(8)}  ${name}`);
    if (value <= (limits[name] ?? Infinity)) continue;
    console.log(`error: more than ${limits[name]}: join files that a reader opens together, or divide a long one`);
    process.exitCode = 1;
  }
}

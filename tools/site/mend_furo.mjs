// mend_furo.mjs STATIC: mends Debian's build of the theme furo in a site's folder of static files, so that pages work
// from disk: its script is a module, its first style has an address of a web server, and its compiler left out the
// colours that apply where the reader's system is dark.
import { readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';

const folder = process.argv[2];
const edit = (name, change) => {
  const file = join(folder, name);
  const before = readFileSync(file, 'utf8');
  const after = change(before);
  if (after === before) throw new Error(`${file} has changed: nothing was found to mend`);
  writeFileSync(file, after);
};

edit('scripts/furo.js', (text) =>
  text.replace(/^import Gumshoe from .*$/m, () => readFileSync(join(folder, 'scripts/gumshoe-patched.js'), 'utf8')),
);
edit('styles/furo.css', (text) => {
  const normal = readFileSync('/usr/share/javascript/normalize.css/normalize.css', 'utf8');
  const dark = text.match(/^ {2}body\[data-theme="dark"\] (\{\n(?: {4}--.*\n)+[^\n]*\})/m);
  const followsSystem = `@media screen and (prefers-color-scheme: dark) {\n  body:not([data-theme="light"]) ${dark[1]}\n}\n`;
  return normal + text.replace(/^@import url\(\/javascript.*$/m, '') + followsSystem;
});

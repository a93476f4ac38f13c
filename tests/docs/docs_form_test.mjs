// docs_form_test.mjs SOURCE: the form of READMEs, of pages of the site and of other Markdown files: a cell of a table has at
// most 160 characters, a paragraph or an item of a list at most 90 words, the README of a top folder at most 10,000 bytes,
// a link is on one line, because links are examined line by line, a source that is named with its path exists, and words
// with an unclear reference are absent.
// It also examines a page with one mistake of each kind, which must be found.
import assert from 'node:assert/strict';
import { existsSync, readFileSync } from 'node:fs';
import { join, relative } from 'node:path';
import { filesBelow } from '../../tools/site/files.mjs';

const [source] = process.argv.slice(2);
const longestCell = 160; // characters, without the targets of links
const longestParagraph = 90; // words
const largestReadme = 10000; // bytes

const unclear = /\botherwise than\b|\bthe same of\b|\bthat which\b|\b(?:move|measure|behave|command|round|act)s? otherwise\b/;

const readable = (text) => text.replace(/\]\([^)\s]+\)/g, ']').replace(/[[\]]/g, '');

/** The sources that a line names and that don't exist. A page on tests may name them below tests/; NAME and VERB stand for any. */
const missingSources = (line) =>
  [...line.matchAll(/`((?:harness|engine|tools|controllers)\/[\w/.]+\.(?:h|cpp|inl|mjs|cmake))`/g)]
    .map(([, path]) => path)
    .filter((path) => !/NAME|VERB/.test(path) && ![path, `tests/${path}`].some((place) => existsSync(join(source, place))));

/** The mistakes of a page, as `file:line: text`. */
function mistakesOf(file, text) {
  const mistakes = [];
  let paragraph = { line: 0, words: 0 };
  let inBlock = false;
  const end = () => {
    if (paragraph.words > longestParagraph)
      mistakes.push(`${file}:${paragraph.line}: the paragraph has ${paragraph.words} words, more than ${longestParagraph}`);
    paragraph = { line: 0, words: 0 };
  };
  text.split('\n').forEach((line, index) => {
    if (!inBlock && unclear.test(line)) mistakes.push(`${file}:${index + 1}: '${line.match(unclear)[0]}': say which, or "differently"`);
    for (const path of inBlock ? [] : missingSources(line)) mistakes.push(`${file}:${index + 1}: there is no ${path}`);
    if (/^\s*```/.test(line)) {
      end();
      inBlock = !inBlock;
    } else if (!inBlock && /^\s*\|/.test(line)) {
      end();
      for (const cell of line.split(/(?<!\\)\|/))
        if (readable(cell.trim()).length > longestCell)
          mistakes.push(`${file}:${index + 1}: a cell has ${readable(cell.trim()).length} characters, more than ${longestCell}: ${cell.trim().slice(0, 40)}...`);
    } else if (!inBlock && (!line.trim() || /^(#|<|:{3})/.test(line))) {
      end();
    } else if (!inBlock) {
      if (/^\s*([-*]|\d+\.|:) /.test(line)) end();
      if (/^[^[\]]*\]\([^)\s]+\)/.test(line)) mistakes.push(`${file}:${index + 1}: a link begins on the line before`);
      paragraph.line ||= index + 1;
      paragraph.words += readable(line).split(/\s+/).filter(Boolean).length;
    }
  });
  end();
  const bytes = Buffer.byteLength(text);
  if (/^(harness|fixtures|tools|tests|controllers|engine|golden)\/README\.md$/.test(file) && bytes > largestReadme)
    mistakes.push(`${file}:1: the README has ${bytes} bytes, more than ${largestReadme}: its reference belongs to tools/site/pages`);
  return mistakes;
}

const longText = 'word '.repeat(longestParagraph + 1).trim();
const sample = ['# A', '', longText, '', `| ${'x'.repeat(longestCell + 1)} |`, '', `- ${longText}`, '', '[a', 'link](b.md)', '', '`engine/src/gone.cpp`, which rounds otherwise'].join('\n') + '\n' + '\n'.repeat(largestReadme);
const found = mistakesOf('engine/README.md', sample).map((text) => text.split(': ')[0]);
assert.deepEqual(found, [3, 5, 7, 10, 12, 12, 1].map((line) => `engine/README.md:${line}`));
assert.deepEqual(mistakesOf('README.md', `# A\n\n${longText.slice(5)}\n\n| ${'x'.repeat(longestCell)} |\n`), []);

/** All Markdown files of the sources. */
const files = filesBelow(source, /\.md$/).map((file) => relative(source, file));
assert(files.includes('README.md') && files.includes('tools/site/pages/index.md'), `${source} has no READMEs`);
const mistakes = files.flatMap((file) => mistakesOf(file, readFileSync(join(source, file), 'utf8')));
mistakes.forEach((text) => console.log(text));
console.log(`${files.length} files, ${mistakes.length} mistakes`);
process.exit(mistakes.length ? 1 : 0);

// Reads Markdown: fenced blocks, headings, sections. The pages of the site and the tests of their examples share it.
import { existsSync, readFileSync, statSync } from 'node:fs';
import { dirname, join, normalize } from 'node:path';

/**
 * The fenced blocks of a page: {line, language, text, setup, file, needs, skip}. Comments before a block, which no reader sees:
 *   <!-- docs: COMMAND -->         runs first
 *   <!-- docs file: NAME -->       the block is the content of this file
 *   <!-- docs needs: COMMAND -->   the block isn't run on a machine where this command fails
 *   <!-- docs skip: REASON -->     the block isn't run
 * The language of a directive of MyST is in braces.
 */
export function blocksOf(markdown) {
  const blocks = [];
  const none = () => ({ setup: [], file: '', needs: '', skip: '' });
  let next = none();
  let open = null;
  markdown.split('\n').forEach((line, index) => {
    const fence = line.match(/^```([\w{}-]*)/);
    const comment = line.match(/^<!-- docs( skip| file| needs)?: (.*) -->$/);
    if (open && fence) {
      blocks.push(open);
      open = null;
    } else if (open) {
      open.text.push(line);
    } else if (fence) {
      open = { line: index + 1, language: fence[1], text: [], ...next };
      next = none();
    } else if (comment) {
      if (comment[1]) next[comment[1].trim()] = comment[2];
      else next.setup.push(comment[2]);
    }
  });
  return blocks;
}

/** The anchor of a heading, as GitHub and MyST make it: small letters, no punctuation, hyphens for blanks. */
export const anchorOf = (heading) =>
  heading
    .toLowerCase()
    .replace(/[^\p{L}\p{N} _-]/gu, '')
    .replaceAll(' ', '-');

/** The headings of a page, outside of its blocks: {level, title, anchor, line}, with line counted from 0. */
export function headingsOf(markdown) {
  const headings = [];
  const seen = new Map();
  let inBlock = false;
  markdown.split('\n').forEach((text, line) => {
    if (text.startsWith('```')) inBlock = !inBlock;
    const heading = inBlock ? null : text.match(/^(#+) (.*)/);
    if (!heading) return;
    const plain = anchorOf(heading[2]);
    const count = seen.get(plain) ?? 0;
    seen.set(plain, count + 1);
    headings.push({ level: heading[1].length, title: heading[2], anchor: count ? `${plain}-${count}` : plain, line });
  });
  return headings;
}

/** The anchors of a page, or of the README of a folder. */
export const anchorsOf = (file) =>
  headingsOf(readFileSync(statSync(file).isDirectory() ? join(file, 'README.md') : file, 'utf8')).map((h) => h.anchor);

/**
 * The section below a heading, up to the next heading of its level; without an anchor, the text above the first section.
 * {heading, lines, headings}, with the anchors that its headings have in the file.
 */
export function sectionOf(markdown, anchor) {
  const lines = markdown.split('\n');
  const headings = headingsOf(markdown);
  const index = anchor ? headings.findIndex((heading) => heading.anchor === anchor) : 0;
  if (index < 0) return null;
  const heading = headings[index];
  const end = headings.find((other, i) => i > index && (!anchor || other.level <= heading.level))?.line ?? lines.length;
  return {
    heading,
    lines: lines.slice(heading.line + 1, end),
    headings: headings.filter((other) => other.line > heading.line && other.line < end),
  };
}

/** A link of `page` (both relative to the repository; `/x` is a path from its root) as {path, anchor}. */
export function targetOf(page, link) {
  const [path, anchor = ''] = link.split('#');
  if (!path) return { path: page, anchor };
  return { path: path.startsWith('/') ? path.slice(1) : normalize(join(dirname(page), path)), anchor };
}

/** A folder's README, if the path is a folder that has one. */
export function pageAt(source, path) {
  const readme = join(path, 'README.md');
  return existsSync(join(source, path)) && statSync(join(source, path)).isDirectory() && existsSync(join(source, readme))
    ? readme
    : path;
}

// stage.mjs SOURCE BUILD OUT: composes the pages that Sphinx reads, in OUT, from tools/site/pages, the READMEs and facts
// of the sources. Fails with file and line if a page includes or links something that doesn't exist.
//
//   <!-- include: tests/README.md#choreonoids-traps -->   the section, below the heading before it
//   <!-- text of: tests/README.md#choreonoids-traps -->   the section without its heading, at the place of this line
//   <!-- made: verbs -->                                  a part made by reference.mjs
//   <!-- made: keys scenario.solver -->                   the keys of a form, which `rehearse doc` puts there, too
//
// A link of a README, or one that begins with `/`, leads to the place in the site where the section is. A link to a
// file that isn't part of the site becomes its name. A link between pages must lead to a page and a heading of it.
import { cpSync, existsSync, mkdirSync, readdirSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { basename, dirname, join, normalize, relative } from 'node:path';
import { arrowsOf, drawing, groupsOf } from './graph.mjs';
import { blocksOf, headingsOf, pageAt, sectionOf, targetOf } from './markdown.mjs';
import { headerPages, makers, verbPages } from './reference.mjs';

const [source, build, out] = process.argv.slice(2);
const folder = join(source, 'tools/site/pages');
const faults = [];

/** Lines of a page, each with the file that it comes from, so that its links can be resolved. */
const from = (file, lines) => lines.map((text) => ({ file, text }));

/** Lines with the places of the READMEs' headings noted in `places`, headings moved `by` levels down. */
function sectionLines(file, section, by, page, places) {
  const title = page.title;
  places.set(`${file}#${section.heading.anchor}`, { page: page.path, title });
  if (section.heading.level === 1) places.set(`${file}#`, { page: page.path, title });
  const at = new Map(section.headings.map((heading) => [heading.line - section.heading.line - 1, heading]));
  return section.lines.map((text, line) => {
    const heading = at.get(line);
    if (!heading) return { file, text };
    return { file, text: `${'#'.repeat(heading.level + by)} ${heading.title}`, names: `${file}#${heading.anchor}` };
  });
}

function includeOf(kind, target, level, page, places, line) {
  const [file, anchor = ''] = target.split('#');
  const section = existsSync(join(source, file)) && sectionOf(readFileSync(join(source, file), 'utf8'), anchor);
  if (!section) {
    faults.push(`${page.file}:${line}: there is no section ${target}`);
    return [];
  }
  if (kind === 'text of') return sectionLines(file, section, level - section.heading.level, page, places);
  const lines = sectionLines(file, section, level + 1 - section.heading.level, page, places);
  const heading = { file, text: `${'#'.repeat(level + 1)} ${section.heading.title}`, names: `${file}#${section.heading.anchor}` };
  return [heading, ...lines];
}

/** A page with its parts: [{file, text, names}], where names is the README's heading that a line is. */
function linesOf(page, places) {
  const lines = [];
  let level = 1;
  let inBlock = false;
  page.text.split('\n').forEach((text, index) => {
    if (text.startsWith('```')) inBlock = !inBlock;
    const heading = inBlock ? null : text.match(/^(#+) /);
    if (heading) level = heading[1].length;
    const order = inBlock ? null : text.match(/^<!-- (include|text of|made): (\S+)(?: (\S+))? -->$/);
    if (!order) lines.push({ file: page.file, text });
    else if (order[1] !== 'made') lines.push(...includeOf(order[1], order[2], level, page, places, index + 1));
    else lines.push(...from(page.file, makers[order[2]]({ source, build, name: order[3] }).split('\n')));
  });
  return lines;
}

/** The path of `target` as a link on `page`, both below pages/. */
const linkTo = (page, target) => relative(dirname(page), target) || basename(target);

const depth = (page) => '../'.repeat(page.split('/').length - 1);

/** Copies a picture into the site, and returns its path from its root. */
function picture(path) {
  const target = join('_pictures', path.replaceAll('/', '_'));
  mkdirSync(dirname(join(out, target)), { recursive: true });
  cpSync(join(source, path), join(out, target));
  return target;
}

/** Whether a link of a page leads to a page, and to a heading of it. */
function hasPlace(page, link) {
  const [path, anchor] = link.split('#');
  const target = path ? anchorsOfPages.get(normalize(join(dirname(page.path), path))) : anchorsOfPages.get(page.path);
  return target !== undefined && (!anchor || target.has(anchor));
}

function resolve(page, line, link, places, isPicture) {
  if (/^[a-z]+:/.test(link)) return link;
  const own = line.file === page.file;
  if (own && !link.startsWith('/')) return hasPlace(page, link) ? link : fault(page, line, link);
  const { path, anchor } = targetOf(line.file, link);
  const ofSite = path.match(/^tools\/site\/pages\/(.*)$/);
  if (ofSite) {
    const target = linkTo(page.path, ofSite[1]) + (anchor ? `#${anchor}` : '');
    return hasPlace(page, target) ? target : fault(page, line, link);
  }
  if (isPicture) return existsSync(join(source, path)) ? `${depth(page.path)}${picture(path)}` : fault(page, line, link);
  const readme = pageAt(source, path);
  const place = places.get(`${readme}#${anchor}`);
  if (place) return linkTo(page.path, place.page) + (place.anchor ? `#${place.anchor}` : '');
  if (readme.endsWith('.md')) return fault(page, line, link);
  return existsSync(join(source, path)) ? null : fault(page, line, link);
}

function fault(page, line, link) {
  faults.push(`${page.file}: ${line.file} links ${link}, which is on no page of the site`);
  return null;
}

function withLinks(page, line, places) {
  return line.text
    .replace(/(!?)\[((?:[^\]`]|`[^`]*`)*)\]\(([^)\s]+)\)/g, (all, mark, text, link) => {
      const target = resolve(page, line, link, places, mark === '!');
      return target ? `${mark}[${text}](${target})` : text;
    })
    .replace(/<img src="([^"]+)"/g, (all, link) => `<img src="${resolve(page, line, link, places, true)}"`);
}

const languageOf = (block) =>
  block.text.some((line) => line.startsWith('$ ')) ? 'console' : block.language || 'text';

const escaped = (text) => text.replaceAll('&', '&amp;').replaceAll('<', '&lt;').replace(/`([^`]*)`/g, '<code>$1</code>');

/** The text of a page: blocks with their language, graphs drawn, comments to the tests told to the reader. */
function rendered(page, lines, places) {
  const text = lines.map((line) => line.text).join('\n');
  const blocks = blocksOf(text);
  const result = [];
  let block = null;
  lines.forEach((line, index) => {
    const begun = blocks.find((one) => one.line === index + 1);
    if (block) {
      if (line.text.startsWith('```')) {
        if (block.language === 'mermaid')
          result.push('```{raw} html', drawing(arrowsOf(block.text.join('\n')), { title: page.title, groups: groupsOf(block.text.join('\n')) }));
        result.push('```');
        if (block.skip) result.push('', `<p class="not-run">Not run by the tests: ${escaped(block.skip)}.</p>`, '');
        block = null;
      } else if (block.language !== 'mermaid') {
        result.push(line.text);
      }
    } else if (begun) {
      block = begun;
      if (block.language === 'mermaid') return;
      if (block.language.startsWith('{')) return result.push(line.text);
      if (block.file) result.push('```{code-block} ' + languageOf(block), `:caption: ${block.file}`, '');
      else result.push('```' + languageOf(block));
    } else if (!/^<!-- .* -->$/.test(line.text)) {
      result.push(withLinks(page, line, places));
    }
  });
  return result.join('\n');
}

rmSync(out, { recursive: true, force: true });
const pages = readdirSync(folder, { recursive: true })
  .map(String)
  .filter((name) => name.endsWith('.md'))
  .sort()
  .map((path) => ({ path, file: join('tools/site/pages', path), text: readFileSync(join(folder, path), 'utf8') }));
for (const { path, text } of [...verbPages({ source, build }), ...headerPages({ source, build })])
  pages.push({ path, file: path, text });
for (const page of pages) page.title = page.text.match(/^# (.*)$/m)?.[1] ?? page.path;

const places = new Map();
const anchorsOfPages = new Map();
for (const page of pages) {
  page.lines = linesOf(page, places);
  const anchors = headingsOf(page.lines.map((line) => line.text).join('\n'));
  anchorsOfPages.set(page.path, new Set(anchors.map(({ anchor }) => anchor)));
  for (const heading of anchors) {
    const name = page.lines[heading.line].names;
    if (name) places.set(name, { page: page.path, anchor: heading.anchor });
  }
}
for (const page of pages) {
  mkdirSync(dirname(join(out, page.path)), { recursive: true });
  writeFileSync(join(out, page.path), rendered(page, page.lines, places));
}
faults.forEach((text) => console.error(text));
console.log(`${pages.length} pages, ${faults.length} faults`);
process.exit(faults.length ? 1 : 0);

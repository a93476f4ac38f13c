// Graphs of dependencies as SVG, drawn by Graphviz: colours follow the page, so that they are readable in dark and light.
import { spawnSync } from 'node:child_process';

/** An arrow of a graph for each pair of names in lines like `a --> b & c`. */
export const arrowsOf = (mermaid) =>
  mermaid
    .split('\n')
    .map((line) => line.match(/^\s*(\S+) --> (.+)$/))
    .filter(Boolean)
    .flatMap(([, from, to]) => to.split('&').map((name) => [from, name.trim()]));

/** The boxes of a graph: Map of name to the box in which it is first, for lines between `subgraph BOX` and `end`. */
export function groupsOf(mermaid) {
  const groups = new Map();
  let box = null;
  for (const line of mermaid.split('\n')) {
    const begin = line.match(/^\s*subgraph (\w+)$/);
    if (begin) box = begin[1];
    else if (/^\s*end$/.test(line)) box = null;
    else if (box)
      for (const name of arrowsOf(line).flat()) if (!groups.has(name)) groups.set(name, box);
  }
  return groups;
}

/** The rooms of the build and what each links, from the file that CMake writes: Map of name to names. */
export function roomsOf(text) {
  const room = (target) => target.match(/^rehearse_room_(\w+)$/)?.[1];
  return new Map(
    text
      .split('\n')
      .map((line) => line.split('|'))
      .filter(([target]) => room(target ?? ''))
      .map(([target, , links]) => [room(target), links.split(';').map(room).filter(Boolean)]),
  );
}

/** The part of each room, from the same file: Map of name to `engine`, `core` or the name of a wing. */
export function partsOf(text) {
  const parts = new Map();
  for (const line of text.split('\n')) {
    const [target, folder = ''] = line.split('|');
    const name = target.match(/^rehearse_room_(\w+)$/)?.[1];
    const [, part, ...rest] = folder.match(/\/(engine|harness)\/src\/(\w+)(\/\w+)?$/) ?? [];
    if (name && part) parts.set(name, part === 'harness' && rest[1] ? rest[0] : part);
  }
  return parts;
}

/** The arrows of a graph without those that a path of other arrows makes. */
export function reduced(rooms) {
  const reaches = (from, to, past) =>
    (rooms.get(from) ?? []).some((next) => !past(from, next) && (next === to || reaches(next, to, () => false)));
  const arrows = [...rooms].flatMap(([from, links]) => links.map((to) => [from, to]));
  return arrows.filter(([from, to]) => !reaches(from, to, (a, b) => a === from && b === to));
}

/** An inline SVG of the arrows; `groups` maps a name to the box that it is drawn in. */
export function drawing(arrows, { title, groups = new Map() }) {
  const boxes = new Map();
  for (const [name, box] of groups) boxes.set(box, [...(boxes.get(box) ?? []), name]);
  const dot = `digraph {
    rankdir=LR; bgcolor=transparent; nodesep=0.18; ranksep=0.4;
    node [shape=box, style=rounded, fontname="sans-serif", fontsize=13, height=0.3, margin="0.12,0.06"];
    edge [arrowsize=0.6];
    ${[...boxes].map(([box, names]) => `subgraph "cluster_${box}" { label="${box}"; fontname="sans-serif"; style=rounded; ${names.map((name) => `"${name}"`).join('; ')} }`).join('\n')}
    ${arrows.map(([from, to]) => `"${from}" -> "${to}"`).join('\n')}
  }`;
  const made = spawnSync('dot', ['-Tsvg'], { input: dot, encoding: 'utf8' });
  if (made.status !== 0) throw new Error(`dot can't draw '${title}': ${made.error ?? made.stderr}`);
  return made.stdout
    .slice(made.stdout.indexOf('<svg'))
    .replace(/<!--[^]*?-->\n?/g, '')
    .replace(/<title>[^]*?<\/title>\n?/g, '')
    .replace('<svg', `<svg class="graph" role="img" aria-label="${title}"`)
    .replaceAll(/(stroke|fill)="black"/g, '$1="currentColor"')
    .replaceAll('<text ', '<text fill="currentColor" ')
    .replaceAll(/fill="currentColor" (text-anchor[^>]*?) fill="[^"]*"/g, 'fill="currentColor" $1');
}

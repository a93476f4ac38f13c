// The parts of the site's reference that are made of facts: verbs and options, keys, messages, headers, graphs.
import { existsSync, readdirSync, readFileSync } from 'node:fs';
import { join } from 'node:path';
import { figures } from './figures.mjs';
import { channelKinds, formKeys, keysTable, messageTypes, verbGroups, verbs } from './facts.mjs';
import { houseRows } from './house.mjs';
import { drawing, partsOf, reduced, roomsOf } from './graph.mjs';

const cell = (text) => text.replaceAll('|', '\\|').replaceAll('<', '\\<').replaceAll('*', '\\*');
const code = (text) => '`' + text.replaceAll('|', '\\|') + '`';
const sentence = (text) => (text ? text[0].toUpperCase() + text.slice(1) + (/[.?]$/.test(text) ? '' : '.') : '');
const table = (head, rows) =>
  [`| ${head.join(' | ')} |`, `|${' --- |'.repeat(head.length)}`, ...rows.map((row) => `| ${row.join(' | ')} |`)].join('\n');

function verbText(verb, level) {
  const entries = (title, list) =>
    list.length ? `\n${table([title, ''], list.map(({ words, text }) => [code(words), cell(sentence(text))]))}\n` : '';
  return [
    `${'#'.repeat(level)} rehearse ${verb.name}`,
    `\n${cell(sentence(verb.summary))}\n`,
    '```text\n' + verb.usage + '\n```',
    entries('argument', verb.positionals),
    entries('option', verb.options),
    level === 1 && verb.example
      ? `${'#'.repeat(level + 1)} Examples of ${verb.name}\n\n\`\`\`{code-block} sh\n:force:\n\n${verb.example}\n\`\`\`\n`
      : '',
    ...verb.parts.map((part) => verbText(part, level + 1)),
  ].join('\n');
}

const program = (build) => join(build, 'bin/rehearse');

/** A page for each verb: {path, text}. */
export const verbPages = ({ build }) =>
  verbs(program(build)).map((verb) => ({ path: `reference/verbs/${verb.name}.md`, text: verbText(verb, 1) }));

const verbTable = ({ build }) => {
  const groups = verbGroups(program(build));
  const row = ({ name, summary }) => [`[${name}](verbs/${name}.md)`, cell(sentence(summary))];
  return [
    ...groups.map(({ title, verbs: some }) => `## ${title}\n\n${table(['verb', ''], some.map(row))}\n`),
    '```{toctree}\n:hidden:\n',
    ...groups.flatMap((group) => group.verbs).map(({ name }) => `verbs/${name}`),
    '```',
  ].join('\n');
};

const keyTable = (schema) => ({ build }) =>
  table(
    ['of', 'key', 'type', 'default', 'what'],
    formKeys(program(build), schema).flatMap(({ owner, keys }) =>
      keys.map(({ name, type, fallback, text }) => [owner, code(name), cell(type), fallback && fallback !== 'required' ? code(fallback) : fallback, cell(text)]),
    ),
  );

/** The keys of one form; outside of code, signs of Markdown are text. */
const formTable = ({ build, name }) =>
  keysTable(program(build), name)
    .trimEnd()
    .split(/(`[^`]*`)/)
    .map((part) => (part.startsWith('`') ? part : part.replace(/[<*]/g, '\\$&')))
    .join('');

const messageTable = ({ source }) =>
  messageTypes(source)
    .map(
      ({ type, text, fields }) =>
        `### ${type}\n\n${cell(text)}\n\n` +
        table(['field', 'type', ''], fields.map((field) => [code(field.name), code(field.type), cell(field.text)])),
    )
    .join('\n\n');

const kindTable = ({ source }) =>
  table(
    ['last segment', '', 'message', 'elements', 'stage'],
    channelKinds(source)
      .filter(({ segment }) => segment)
      .map(({ segment, text, type, elements, stage }) => [
        code(segment),
        cell(text),
        code(type),
        elements.map(({ name, unit }) => (name ? `${code(name)} ` : '') + (unit ? `[${unit}]` : '')).join(', '),
        stage,
      ]),
  );

/** The public headers: those that are installed, without the messages, which have a page of their own. */
export const publicHeaders = (source) =>
  ['engine', 'harness'].flatMap((room) =>
    readdirSync(join(source, room, 'include/rehearse'))
      .filter((name) => name.endsWith('.h') && name !== 'messages.h')
      .map((name) => ({ name, file: join(source, room, 'include/rehearse', name) })),
  );

/** The comment at the head of a header. */
const headComment = (file) => {
  const lines = readFileSync(file, 'utf8').split('\n');
  return lines.slice(0, lines.findIndex((line) => !line.startsWith('//'))).map((line) => line.replace(/^\/\/ ?/, ''));
};

const headerTable = ({ source }) =>
  table(
    ['header', ''],
    publicHeaders(source)
      .sort((a, b) => (a.name < b.name ? -1 : 1))
      .map(({ name, file }) => {
        const first = headComment(file).join(' ').match(/^.*?[.:](?= |$)/)?.[0] ?? '';
        return [`[${code(`<rehearse/${name}>`)}](headers/${name.replace('.h', '')}.md)`, cell(first.replace(/:$/, '.'))];
      }),
  ) +
  '\n\n```{toctree}\n:hidden:\n\n' +
  publicHeaders(source)
    .map(({ name }) => `headers/${name.replace('.h', '')}`)
    .sort()
    .join('\n') +
  '\n```';

/** Paragraphs and indented code of a head comment as Markdown. */
function commentText(lines) {
  return lines
    .join('\n')
    .replace(/((?:^ {2,}.*\n?)+)/gm, (all) => `\n\`\`\`{code-block} cpp\n:force:\n\n${all.replace(/^ {2}/gm, '').trimEnd()}\n\`\`\`\n`)
    .split(/(```[^]*?```)/)
    .map((part) => (part.startsWith('```') ? part : part.replace(/[<*_]/g, '\\$&')))
    .join('');
}

/** A page for each public header: {path, text}; Breathe fills in the declarations from Doxygen's XML. */
export const headerPages = ({ source }) =>
  publicHeaders(source).map(({ name, file }) => ({
    path: `reference/headers/${name.replace('.h', '')}.md`,
    text: `# rehearse/${name}\n\n${commentText(headComment(file))}\n\n\`\`\`{doxygenfile} ${name}\n:project: rehearse\n:sections: briefdescription detaileddescription innerclass innernamespace func public-attrib public-func public-static-func public-static-attrib public-type enum typedef define var user-defined\n\`\`\`\n`,
  }));

const architecture = ({ build }) => {
  const file = join(build, 'rooms.txt');
  if (!existsSync(file)) throw new Error(`${file} is missing: CMake writes it when it configures the build`);
  const text = readFileSync(file, 'utf8');
  const rooms = roomsOf(text);
  const groups = partsOf(text);
  return '```{raw} html\n' + drawing(reduced(rooms), { title: 'rooms and the rooms they use', groups }) + '\n```';
};

const houseTable = ({ source }) =>
  table(
    ['', 'at aed51e9e', 'now'],
    houseRows(source).map((row) => row.map((value) => value.toLocaleString('en'))),
  );

export const makers = {
  verbs: verbTable,
  keys: formTable,
  'scenario-keys': keyTable('scenario'),
  'map-keys': keyTable('map'),
  messages: messageTable,
  'channel-kinds': kindTable,
  headers: headerTable,
  architecture,
  house: houseTable,
  ...figures,
};

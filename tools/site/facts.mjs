// What the reference of the site is made of, read from the sources and from the command: keys, variables, verbs, types.
import { execFileSync } from 'node:child_process';
import { readdirSync, readFileSync } from 'node:fs';
import { join } from 'node:path';

const filesBelow = (folder, ending) =>
  readdirSync(folder, { recursive: true })
    .map(String)
    .filter((name) => ending.test(name) && !name.includes('node_modules'))
    .sort()
    .map((name) => join(folder, name));

/** The type of a key in a schema, in words: "number", "text or a list of text", "solver". */
function typeText(schema) {
  if (schema.$ref) return schema.$ref.split('/').at(-1).replaceAll('_', ' ');
  if (schema.anyOf) return [...new Set(schema.anyOf.map(typeText))].join(' or ');
  if (schema.enum) return schema.enum.join(' or ');
  if (schema.type === 'array') return `list of ${typeText(schema.items)}`;
  if (schema.type === 'object') return schema.properties ? `map of ${Object.keys(schema.properties)[0]} ...` : `map of ${typeText(schema.additionalProperties)}`;
  if (schema.type === 'string' && schema.pattern?.includes('[0-9]')) return 'number with a unit';
  if (schema.type === 'boolean') return 'true or false';
  if (schema.type === 'integer') return 'whole number';
  if (schema.type === 'null') return 'nothing';
  return Array.isArray(schema.type) || schema.type === 'string' ? 'text' : (schema.type ?? 'any');
}

/**
 * The keys of a file, or the members of an object, that a schema of the command describes: [{owner: 'joystick entry', keys: [{name, type,
 * fallback, text}]}]. The parsers of files read the same descriptions.
 */
export function formKeys(program, schema) {
  const forms = JSON.parse(execFileSync(program, ['doc', '--schema', schema], { encoding: 'utf8' })).$defs;
  return Object.entries(forms).map(([name, form]) => ({
    owner: name.replaceAll('_', ' '),
    keys: Object.entries(form.properties).map(([key, value]) => ({
      name: key,
      type: typeText(value),
      fallback: form.required?.includes(key) ? 'required' : value.default === undefined ? '' : JSON.stringify(value.default),
      text: value.description ?? '',
    })),
  }));
}

/** The table of the keys of a form, named as scenario.solver, in Markdown. */
export const keysTable = (program, name) => execFileSync(program, ['doc', '--keys', name], { encoding: 'utf8' });

/** The variables of the environment that the libraries and the command read, by name. */
export function environmentVariables(source) {
  const names = new Set();
  for (const folder of ['engine', 'harness', 'controllers/src', 'tools/rehearse', 'tools/cmake'])
    for (const file of filesBelow(join(source, folder), /\.(cpp|h|inl|cmake|in)$/))
      for (const [, inCall, inText, inCMake] of readFileSync(file, 'utf8').matchAll(
        /(?:getenv|environment|environment_or)\("([A-Z_]+)"|"(REHEARSE_[A-Z_]+)"|\$ENV\{([A-Z_]+)\}/g,
      ))
        names.add(inCall ?? inText ?? inCMake);
  return [...names].sort();
}

/** Exit statuses of the command: [{status, name}]. */
export function exitStatuses(source) {
  const text = readFileSync(join(source, 'tools/rehearse/command.h'), 'utf8').match(/enum class Exit \{([^}]*)\}/)[1];
  return [...text.matchAll(/(\w+) = (\d+)/g)].map(([, name, status]) => ({ name, status }));
}

/** The codes of verdicts: [{code, meaning}]. */
export function verdictCodes(source) {
  const text = readFileSync(join(source, 'harness/src/core/check/verdict_code.cpp'), 'utf8');
  return [...text.matchAll(/\{\w+, "([^"]+)", "([^"]+)"\}/g)].map(([, code, meaning]) => ({ code, meaning }));
}

/** The errors of quantities in the order in which they act: [{key, text, unit, of}], each from its file. */
export function sensorErrors(source) {
  const folder = join(source, 'harness/src/core/scenario');
  const names = [...readFileSync(join(folder, 'sensor_errors.inl'), 'utf8').matchAll(/^REHEARSE_ERROR\((\w+)\)/gm)];
  return names.map(([, key]) => {
    const text = readFileSync(join(folder, `error_${key}.cpp`), 'utf8');
    const member = (name, pattern) => text.match(new RegExp(`\\.${name} = ${pattern}`))?.[1] ?? '';
    return { key, text: member('text', '"([^"]*)"'), unit: member('unit', 'ErrorUnit::(\\w+)'), of: member('of', 'ErrorOf::(\\w+)') };
  });
}

const kindsFolder = 'harness/src/core/kinds';

/** The names of the kinds of channels, in the order of their list. */
const kindNames = (source) =>
  [...readFileSync(join(source, kindsFolder, 'kinds.inl'), 'utf8').matchAll(/^REHEARSE_KIND\((\w+)[,)]/gm)].map(([, name]) => name);

/** The kinds of channels: [{name, text, level, segment, type, stage, elements: [{name, unit}]}], each from its file. */
export function channelKinds(source) {
  const types = new Map(messageTypes(source).map(({ name, type }) => [name, type]));
  const headers = ['joint_rows.h', 'range_frame.h'].map((file) => readFileSync(join(source, kindsFolder, file), 'utf8'));
  return kindNames(source).map((name) => {
    const text = readFileSync(join(source, kindsFolder, `${name}.cpp`), 'utf8');
    const member = (key, form) => text.match(new RegExp(`\\.${key} = ${form}`))?.[1] ?? '';
    const list = member('groups', '(\\w+)');
    const groups = list && [text, ...headers].join('\n').match(new RegExp(`${list}\\[\\] = \\{([^;]*)\\};`))[1];
    const elements = [...(groups || '').matchAll(/\{"(\w*)", "([^"]*)"(?:, "(\w+)")?/g)].map(([, element, unit, axes]) => ({
      name: axes ? `${element}/${[...axes].join(' ')}` : element,
      unit,
    }));
    return {
      name,
      text: text.match(/^\/\/ (.*)/)[1],
      level: member('level', 'ChannelForm::Level::(\\w+)'),
      segment: member('segment', '"(\\w*)"'),
      type: types.get(member('type', 'msg::(\\w+)')),
      stage: member('stage', 'Stage::(\\w+)'),
      elements,
    };
  });
}

/** The message types that a recording can have: [{type, text, fields: [{type, name, text}]}]: those of the public header
 * in its order, then those that only a kind of channel uses. */
export function messageTypes(source) {
  const files = ['harness/include/rehearse/messages.h', ...kindNames(source).map((name) => `${kindsFolder}/${name}.cpp`)];
  const lines = files.flatMap((file) => readFileSync(join(source, file), 'utf8').split('\n'));
  const types = [];
  let comment = [];
  let open = null;
  for (const line of lines) {
    const said = line.match(/^\s*\/\/\/? ?(.*)/);
    const begin = line.match(/^struct (\w+) \{/);
    const field = line.match(/^ {2}([\w:<>, ]+) (\w+)(?: = [^;]+|\{[^;]*\})?;(?:\s*\/\/ (.*))?$/);
    if (begin) open = { name: begin[1], type: '', text: comment.join(' '), fields: [] };
    else if (open && line.includes('type_name = "')) open.type = line.match(/"([^"]+)"/)[1];
    else if (open && field && !/static|return|const /.test(line))
      open.fields.push({ type: field[1], name: field[2], text: [...comment, field[3] ?? ''].join(' ').trim() });
    else if (open && line === '};') {
      if (open.type) types.push(open);
      open = null;
    }
    comment = said ? [...comment, said[1]] : [];
  }
  const named = new Map(types.map((type) => [type.name, type.type]));
  const ros = { double: 'float64', float: 'float32', bool: 'bool', 'std::string': 'string', 'std::byte': 'uint8' };
  const rosType = (text) => {
    const inner = text.match(/^std::(?:vector<(.+)>|array<(.+), (\d+)>)$/);
    if (inner) return `${rosType(inner[1] ?? inner[2])}[${inner[3] ?? ''}]`;
    return ros[text] ?? named.get(text) ?? text.replace(/^std::/, '').replace(/_t$/, '');
  };
  for (const type of types) for (const field of type.fields) field.type = rosType(field.type);
  return types;
}

const helpOf = (program, words) => execFileSync(program, [...words, '--help'], { encoding: 'utf8' });

/** The lines below a title of --help: [{words, text}]; a description may continue in the lines below its words. */
function entriesOf(help, title) {
  const section = help.match(new RegExp(`^${title}:\\n((?:.+\\n)*)`, 'm'));
  const entries = [];
  for (const line of (section?.[1] ?? '').split('\n').filter(Boolean)) {
    const begin = line.match(/^ {2}(\S.*?)(?: {2,}(.*))?$/);
    if (begin) entries.push({ words: begin[1], text: begin[2] ?? '' });
    else entries.at(-1).text = `${entries.at(-1).text} ${line.trim()}`.trim();
  }
  return entries;
}

/** A verb, or a part of one: {name, summary, usage, positionals, options, example, parts}. */
function verbOf(program, words, summary) {
  const help = helpOf(program, words);
  return {
    name: words.join(' '),
    summary,
    usage: help.match(/^Usage: (.*)$/m)[1],
    positionals: entriesOf(help, 'Positionals'),
    options: entriesOf(help, 'Options').filter(({ words: option }) => !option.startsWith('-h')),
    example: (help.match(/^Example:\n([^]*)/m)?.[1] ?? '').replace(/^ {2}/gm, '').trim(),
    parts: entriesOf(help, 'Subcommands').map((part) => verbOf(program, [...words, part.words], part.text)),
  };
}

/** The groups of the command's verbs, from its --help: {title, verbs}. */
export function verbGroups(program) {
  const help = helpOf(program, []);
  return [...help.matchAll(/^(\S.*):$/gm)].map(([, title]) => ({
    title,
    verbs: entriesOf(help, title).map(({ words, text }) => verbOf(program, [words], text)),
  }));
}

/** All verbs of the command. */
export const verbs = (program) => verbGroups(program).flatMap((group) => group.verbs);

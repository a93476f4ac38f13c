// docs_test.mjs SOURCE BUILD PAGE: runs the sessions of a README, or of a page of the site, and compares what they print.
// Links of a README must lead to files and headings that exist (tools/site/stage.mjs examines those of the site). The
// main README and its pictures must be small.
//
// A session is a fenced block with lines that begin with "$ ". It runs in a folder with the fixtures and the goldens of
// the checkout and its build; what a session leaves is there for the next. Numbers are masked, white space counts as one
// space, "..." stands for any text, lines that begin with "(step) " are typed. tools/site/markdown.mjs lists the comments
// before a block, which no reader sees. A page of the site must state for each block how it is run, or why not.
// A block marked sh, without "$ ", is run line by line and has to succeed.
import { spawnSync } from 'node:child_process';
import { createHash } from 'node:crypto';
import { cpSync, existsSync, mkdirSync, readFileSync, rmSync, statSync, symlinkSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { dirname, join } from 'node:path';
import { anchorsOf, blocksOf } from '../../tools/site/markdown.mjs';

const [source, build, page] = process.argv.slice(2);
const isOfSite = page.startsWith('tools/site/');

/** The commands of a block, each with what it prints. */
function commandsOf(block) {
  const isSession = block.text.some((line) => line.startsWith('$ '));
  if (!isSession && block.language !== 'sh') return [];
  const commands = [];
  let continued = false;
  for (const line of block.text) {
    if (continued) commands.at(-1).command += '\n' + line;
    else if (isSession && line.startsWith('$ ')) commands.push({ command: line.slice(2), output: [] });
    else if (!isSession && line.trim()) commands.push({ command: line, output: null });
    else if (isSession && commands.length) commands.at(-1).output.push(line);
    continued = line.endsWith('\\') && (continued || line.startsWith('$ ') || !isSession);
  }
  return commands;
}

const masked = (text) =>
  text
    .replace(/\x1b\[[0-9;]*m/g, '')
    .replace(/(?<![A-Za-z_])[-+]?\d+(\.\d+)?(e[-+]?\d+)?/g, '#')
    .replace(/\s+/g, ' ')
    .trim();

/** Where `printed` first isn't as `expected`: null if it is. */
function mismatch(expected, printed) {
  const rest = masked(printed);
  const parts = masked(expected).split('...').map((part) => part.trim());
  let at = 0;
  for (const [index, part] of parts.entries()) {
    const isLast = index === parts.length - 1;
    const found = index === 0 ? rest.startsWith(part) ? 0 : -1 : isLast && part ? rest.lastIndexOf(part) : rest.indexOf(part, at);
    if (found < at) return part;
    at = found + part.length;
    if (isLast && part && at !== rest.length) return rest.slice(at);
  }
  return parts.length === 1 && at !== rest.length ? rest.slice(at) : null;
}

// The same folder in each run: what a page compiles is in the compiler's cache, with this folder's name in it.
const folder = join(tmpdir(), 'rehearse_docs_' + createHash('sha256').update(build + page).digest('hex').slice(0, 12));
rmSync(folder, { recursive: true, force: true });
mkdirSync(folder);
let isFilled = false;
/** A page whose blocks are all left out needs no copies. */
function fill() {
  if (isFilled) return;
  isFilled = true;
  for (const name of ['fixtures', 'golden', 'controllers']) cpSync(join(source, name), join(folder, name), { recursive: true });
  symlinkSync(build, join(folder, 'build'));
}
// The Python module of the build is for Debian's python3.
const modules = join(build, 'lib/python3/dist-packages');
const programs = existsSync(modules) ? `/usr/bin:${process.env.PATH}` : process.env.PATH;
const environment = { ...process.env, PATH: `${build}/bin:${programs}`, SOURCE: source, CMAKE_PREFIX_PATH: build, PYTHONPATH: modules };
for (const name of Object.keys(environment)) if (name === 'CI' || name.startsWith('REHEARSE_')) delete environment[name];
if (spawnSync('ccache', ['--version']).status === 0) environment.CMAKE_CXX_COMPILER_LAUNCHER = 'ccache';
environment.REHEARSE_PENDING = 'rehearse-pending'; // not in the build that tests share
environment.REHEARSE_CALL_STACK = 'never'; // tests of its own have it, and gdb takes seconds
const limit = 120_000; // of a command [ms]
let place = folder; // a session's working directory
const run = (command, input = '') => {
  fill();
  const script = `exec 2>&1; ${command}\nstatus=$?; pwd > ${folder}/.place; exit $status`;
  const outcome = spawnSync('bash', ['-c', script], {
    cwd: place,
    env: environment,
    encoding: 'utf8',
    input,
    timeout: limit,
  });
  if (outcome.error) throw new Error(`${page}: '${command}' was ended after ${limit / 1000} s: ${outcome.error.code}`);
  place = readFileSync(join(folder, '.place'), 'utf8').trim();
  return outcome;
};

let failures = 0;
let done = 0;
const fail = (block, text) => {
  ++failures;
  console.log(`${page}:${block.line}: ${text}`);
};
for (const block of blocksOf(readFileSync(join(source, page), 'utf8'))) {
  if (block.skip) {
    console.log(`${page}:${block.line}: not run: ${block.skip}`);
    continue;
  }
  if (block.needs && run(block.needs).status !== 0) {
    console.log(`${page}:${block.line}: not run on this machine: '${block.needs}' fails`);
    continue;
  }
  const commands = block.file ? [] : commandsOf(block);
  if (!commands.length && !block.file) {
    if (isOfSite && block.language !== 'text' && !block.language.startsWith('{'))
      fail(block, 'the block is neither run (a session), nor a file (docs file), nor left out with a reason (docs skip)');
    continue;
  }
  place = folder;
  for (const command of block.setup) {
    const outcome = run(command);
    if (outcome.status !== 0) fail(block, `the set-up '${command}' ended in ${outcome.status}:\n${outcome.stdout}`);
  }
  if (block.file) {
    fill();
    mkdirSync(dirname(join(folder, block.file)), { recursive: true });
    writeFileSync(join(folder, block.file), block.text.join('\n') + '\n');
  }
  for (const { command, output } of commands) {
    const typed = (output ?? []).filter((line) => line.startsWith('(step) ')).map((line) => line.slice(7) + '\n');
    const outcome = run(command, typed.join(''));
    ++done;
    const shown = output?.filter((line) => !line.startsWith('(step) '));
    const saysNothing = output === null || shown.join('').trim() === '...';
    if (saysNothing && outcome.status !== 0)
      fail(block, `'${command}' ended in ${outcome.status}:\n${outcome.stdout}`);
    const missing = output === null ? null : mismatch(shown.join('\n'), outcome.stdout);
    if (missing !== null) fail(block, `'${command}' doesn't print '${missing}'; it printed:\n${outcome.stdout}`);
  }
}

const text = readFileSync(join(source, page), 'utf8');
(isOfSite ? [] : text.split('\n')).forEach((line, index) => {
  for (const [, picture, target] of line.matchAll(/(!?)\[[^\]]*\]\(([^)\s]+)\)/g)) {
    if (/^https?:/.test(target)) continue;
    const [path, anchor] = target.split('#');
    const file = path ? join(source, dirname(page), path) : join(source, page);
    if (!existsSync(file)) fail({ line: index + 1 }, `the link leads to ${path}, which doesn't exist`);
    else if (anchor && !anchorsOf(file).includes(anchor))
      fail({ line: index + 1 }, `${path || page} has no heading #${anchor}`);
    else if (picture && statSync(file).size > 2e6) fail({ line: index + 1 }, `${path} has more than 2 MB`);
  }
});
if (isOfSite && !/^# .+\n\n[^\n#`|<!-]+/.test(text)) fail({ line: 1 }, 'the page does not begin with its purpose, below its title');
if (page === 'README.md' && Buffer.byteLength(text) > 8192) fail({ line: 1 }, 'the page has more than 8 kB');

rmSync(folder, { recursive: true });
console.log(`${page}: ${done} commands, ${failures} failures`);
process.exit(failures ? 1 : 0);

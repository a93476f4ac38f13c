// action_test.mjs SOURCE BUILD: the steps of .github/actions/check and accept without GitHub: a project whose runs differ, a
// bare repository in the place of GitHub's, files in the place of the runner's, a server on the loopback address in the
// place of the API, and programs that note their words in the place of apt-get. Exit status 77: jq, git or curl is missing.
import assert from 'node:assert/strict';
import { spawn, spawnSync } from 'node:child_process';
import { chmodSync, cpSync, existsSync, mkdirSync, mkdtempSync, readFileSync, readdirSync, rmSync, writeFileSync } from 'node:fs';
import { createServer } from 'node:http';
import { tmpdir } from 'node:os';
import { join } from 'node:path';

const [source, build] = process.argv.slice(2);
for (const program of ['jq', 'git', 'curl'])
  if (spawnSync(program, ['--version']).error) {
    console.log(`skipped: ${program} isn't installed`);
    process.exit(77);
  }

const folder = mkdtempSync(join(tmpdir(), 'rehearse_action_'));
process.on('exit', () => rmSync(folder, { recursive: true, force: true }));
const at = (...parts) => join(folder, ...parts);
const read = (...parts) => readFileSync(at(...parts), 'utf8');
const write = (name, text) => {
  mkdirSync(join(at(name), '..'), { recursive: true });
  writeFileSync(at(name), text);
};

// GitHub's API: the comments of pull request 7, and the requests
const comments = [{ id: 1, body: 'a person says <!-- rehearse check -->' }];
const requests = [];
let refusal = 0; // the status of the answer to each request, if it isn't 0
const server = createServer((request, answer) => {
  let body = '';
  request.on('data', (chunk) => (body += chunk));
  request.on('end', () => {
    const path = new URL(request.url, 'http://here').pathname;
    requests.push({ method: request.method, path, authorization: request.headers.authorization });
    const send = (status, object) => answer.writeHead(status).end(JSON.stringify(object));
    if (path === '/apt/rehearse.asc') return answer.end('a key');
    if (refusal) return send(refusal, { message: 'Resource not accessible by integration' });
    if (request.method === 'GET' && path === '/repos/owner/name/issues/7/comments') return send(200, comments);
    if (request.method === 'POST' && path === '/repos/owner/name/issues/7/comments') {
      comments.push({ id: 2, body: JSON.parse(body).body });
      return send(201, { id: 2, html_url: 'https://here/2' });
    }
    if (request.method === 'PATCH' && path === '/repos/owner/name/issues/comments/2') {
      comments[1].body = JSON.parse(body).body;
      return send(200, { id: 2, html_url: 'https://here/2' });
    }
    return send(404, { message: 'Not Found' });
  });
});
await new Promise((ready) => server.listen(0, '127.0.0.1', ready));
const origin = `http://127.0.0.1:${server.address().port}`;

// the project; a name and a body that try to be Markdown and HTML
const box = (name, golden, mass) => `rehearse: 1
name: ${JSON.stringify(name)}
${golden ? `golden: ${golden}\n` : ''}duration: 0.05
bodies:
  - {name: Box, box: {size: [0.1, 0.1, 0.1]}, mass: ${mass}, position: [0, 0, 1]}
expect:
  - {channel: Box/Box/position/z, above: 0.5, at: end}
`;
const hostile = 'a|b <img src=x> @all `c` [d](e)';
write('project/scenarios/falls.yaml', box('falls', 'Box.Falls', 1));
write('project/scenarios/stays.yaml', box('stays', '', 1));
write('project/scenarios/hostile.yaml', box(hostile, '', 1));
mkdirSync(at('project/golden'));
const project = at('project');
const environment = {
  ...process.env,
  PATH: `${join(build, 'bin')}:${process.env.PATH}`,
  HOME: at('home'),
  GIT_CONFIG_NOSYSTEM: '1',
};
for (const name of Object.keys(environment)) if (/^(CI|REHEARSE_|GITHUB_|GIT_DIR)/.test(name) && name !== 'GITHUB_X') delete environment[name];
mkdirSync(at('home'));
const plain = (program, ...words) => {
  const outcome = spawnSync(program, words, { cwd: project, env: environment, encoding: 'utf8' });
  assert.equal(outcome.status, 0, `${program} ${words.join(' ')}: ${outcome.stdout}${outcome.stderr}`);
  return outcome.stdout;
};
environment.REHEARSE_GOLDEN = 'new';
plain('rehearse', 'check');
delete environment.REHEARSE_GOLDEN;
plain('git', 'init', '--quiet', '--initial-branch', 'topic');
plain('git', 'config', 'user.name', 'A');
plain('git', 'config', 'user.email', 'a@b');
plain('git', 'init', '--quiet', '--bare', at('server/owner/name'));
plain('git', 'remote', 'add', 'origin', at('server/owner/name'));
plain('git', 'add', '--all');
plain('git', 'commit', '--quiet', '--message', 'Begin');
plain('git', 'push', '--quiet', 'origin', 'topic');

// the runner
mkdirSync(at('runner'));
write('event.json', JSON.stringify({ pull_request: { number: 7 } }));
const runner = {
  CI: 'true',
  GITHUB_ACTIONS: 'true',
  GITHUB_OUTPUT: at('output'),
  GITHUB_STEP_SUMMARY: at('summary.md'),
  GITHUB_EVENT_PATH: at('event.json'),
  GITHUB_API_URL: origin,
  GITHUB_SERVER_URL: `file://${at('server')}`,
  GITHUB_REPOSITORY: 'owner/name',
  GITHUB_RUN_ID: '42',
  GITHUB_SHA: '0123456789abcdef0123',
  GITHUB_ACTOR: 'someone',
  RUNNER_TEMP: at('runner'),
  TOKEN: 'secret',
  ARTIFACT: 'rehearse',
  ARGUMENTS: '--strict',
};
/** A step of the action, in the project; `inputs` are more variables. */
const step = (name, inputs = {}) =>
  new Promise((done) => {
    const child = spawn(join(source, '.github/actions/check', name), { cwd: project, env: { ...environment, ...runner, ...inputs } });
    let text = '';
    child.stdout.on('data', (chunk) => (text += chunk));
    child.stderr.on('data', (chunk) => (text += chunk));
    child.on('close', (status) => done({ status, text }));
  });
const outputs = () => Object.fromEntries(read('output').trim().split('\n').map((line) => [line.slice(0, line.indexOf('=')), line.slice(line.indexOf('=') + 1)]));

// install, where no rehearse is in the PATH yet
const others = process.env.PATH.split(':').filter((place) => !existsSync(join(place, 'rehearse'))).join(':');
const installed = `ln -sf ${join(build, 'bin/rehearse')} ${at('programs/rehearse')}`;
write('programs/apt-get', `#!/bin/sh\necho "$@" >> ${at('apt.log')}\ncase "$*" in *rehearse-dev*) ${installed} ;; esac\n`);
write('programs/sudo', '#!/bin/sh\nexec "$@"\n');
for (const name of ['apt-get', 'sudo']) chmodSync(at('programs', name), 0o755);
const apt = { PATH: `${at('programs')}:${others}`, REHEARSE_APT_FOLDER: at('etc') };
const list = () => read('etc/sources.list.d/rehearse.list');
mkdirSync(at('apt'));
let outcome = await step('install', { ...apt, VERSION: '0.1.0', FROM: at('apt'), KEY: '' });
assert.equal(outcome.status, 0, outcome.text);
assert.equal(list(), `deb [trusted=yes] file:${at('apt')} stable main\n`);
assert.match(read('apt.log'), /install rehearse=0\.1\.0-1 rehearse-dev=0\.1\.0-1\n$/);
assert.match(outcome.text, /^rehearse \d/m);
writeFileSync(at('apt.log'), '');
outcome = await step('install', { ...apt, VERSION: '0.1.0', FROM: at('apt'), KEY: '' });
assert.match(outcome.text, /^rehearse 0\.1\.0 is installed$/m);
assert(!read('apt.log').includes('rehearse'), 'an installed version is not fetched again');
rmSync(at('programs/rehearse'));
outcome = await step('install', { ...apt, VERSION: '', FROM: `${origin}/apt`, KEY: '' });
assert.equal(outcome.status, 0, outcome.text);
assert.equal(list(), `deb [signed-by=${at('etc')}/keyrings/rehearse.asc] ${origin}/apt stable main\n`);
assert.equal(read('etc/keyrings/rehearse.asc'), 'a key');
assert.match(read('apt.log'), /install rehearse rehearse-dev\n$/);
for (const [inputs, words] of [
  [{ VERSION: '0.1', FROM: at('apt') }, "version is '0.1'"],
  [{ VERSION: '0.1.0; reboot', FROM: at('apt') }, 'three numbers were expected'],
  [{ VERSION: '', FROM: 'http://example.org/apt' }, "from is 'http://example.org/apt'"],
  [{ VERSION: '', FROM: `${origin}/nowhere` }, 'a repository on the web needs a key'],
  [{ VERSION: '', FROM: '' }, "the action's repository isn't known"],
  [{ VERSION: '', FROM: at('apt'), KEY: at('no.asc') }, 'there is no key'],
]) {
  rmSync(at('programs/rehearse'), { force: true });
  outcome = await step('install', { ...apt, KEY: '', ACTION_REPOSITORY: '', ...inputs });
  assert.notEqual(outcome.status, 0, words);
  assert(outcome.text.includes(words), `${words}: ${outcome.text}`);
}

// green
outcome = await step('check');
assert.equal(outcome.status, 0, outcome.text);
assert.equal(outputs().status, '0');
outcome = await step('table');
assert.match(outcome.text, /^### Rehearse: 3 of 3 scenarios as they should be$/m);
assert(!outcome.text.includes('❌') && !outcome.text.includes('accepts goldens'), outcome.text);

// one scenario, whose JSON has another form
outcome = await step('check', { ARGUMENTS: 'scenarios/stays.yaml' });
assert.equal(outcome.status, 0, outcome.text);
outcome = await step('table');
assert.match(outcome.text, /^### Rehearse: 1 of 1 scenarios as they should be$/m);
assert.match(outcome.text, /^\| ✅ stays \| the expectation holds/m);

// red
write('project/scenarios/falls.yaml', box('falls', 'Box.Falls', 1).replace('position: [0, 0, 1]', 'position: [0, 0, 1.01]'));
write('project/scenarios/hostile.yaml', box(hostile, '', 1).replace('above: 0.5', 'above: 0.999'));
writeFileSync(at('output'), '');
outcome = await step('check');
assert.equal(outcome.status, 0, 'the step leaves the failure to the last step');
assert.equal(outputs().status, '1');
assert.match(outcome.text, /^::error file=scenarios\/hostile\.yaml/m);
assert.match(read('summary.md'), /\| falls \| differs \|/);
const kept = outputs().kept;
assert(existsSync(join(kept, 'check.xml')) && existsSync(join(kept, 'pending/Box.Falls.mcap')) && existsSync(join(kept, 'pending/Box.Falls.html')));

// the table, without pictures and with them
outcome = await step('table');
assert.equal(outcome.status, 0, outcome.text);
const rows = outcome.text.split('\n').filter((line) => line.startsWith('| ❌') || line.startsWith('| ✅'));
assert.equal(rows.length, 3, outcome.text);
assert(rows[2].startsWith('| ✅ stays |'), 'scenarios that differ come first');
const falls = rows.find((row) => row.startsWith('| ❌ falls |'));
assert.match(falls, /beyond|higher|differs|changed/);
assert.match(falls, /\| in the artifact \| 0\.\d+ m: /, 'the margin has its unit');
assert(outcome.text.includes('❌ a\\|b &lt;img src=x> \\@all \\`c\\` \\[d\\](e)'), outcome.text);
assert(!outcome.text.includes('<img'), 'text of the pull request stays text');
assert.match(outcome.text, /with run `42` and goldens `Box\.Falls`/);

outcome = await step('pictures', { BRANCH: 'rehearse-pictures' });
assert.equal(outcome.status, 0, outcome.text);
outcome = await step('pictures', { BRANCH: 'rehearse-pictures', GITHUB_RUN_ID: '43' });
assert.equal(outcome.status, 0, outcome.text);
const pushed = plain('git', '--git-dir', at('server/owner/name'), 'ls-tree', '-r', '--name-only', 'rehearse-pictures');
assert.deepEqual(pushed.trim().split('\n').filter((name) => name.endsWith('/falls.png')), ['42/falls.png', '43/falls.png']);
const png = spawnSync('git', ['--git-dir', at('server/owner/name'), 'show', 'rehearse-pictures:42/falls.png']).stdout;
assert.equal(png.subarray(1, 4).toString(), 'PNG');
outcome = await step('table');
assert(outcome.text.includes(`<img src="file://${at('server')}/owner/name/raw/rehearse-pictures/43/falls.png" width="160" alt="">`), outcome.text);
outcome = await step('pictures', { BRANCH: 'a..b' });
assert.match(outcome.text, /is no name of a branch/);
plain('git', '--git-dir', at('server/owner/name'), 'config', 'receive.denyCurrentBranch', 'refuse');
rmSync(join(kept, 'pictures.url'));
outcome = await step('pictures', { BRANCH: 'rehearse-pictures', GITHUB_REPOSITORY: 'owner/none' });
assert.equal(outcome.status, 0, outcome.text);
assert.match(outcome.text, /^::warning::the pictures can't be pushed/m);
await step('table');

// the comment: a first one, the same one again, and none without the permission
outcome = await step('comment');
assert.equal(outcome.status, 0, outcome.text);
assert.equal(comments.length, 2, outcome.text);
assert(comments[1].body.includes('| ❌ falls |'));
assert(requests.every(({ path, authorization }) => path.startsWith('/apt') || path.startsWith('/nowhere') || authorization === 'Bearer secret'));
write('runner/rehearse/table.md', '<!-- rehearse check -->\nlater\n');
outcome = await step('comment');
assert.equal(outcome.status, 0, outcome.text);
assert.equal(comments.length, 2, 'one comment');
assert.match(comments[1].body, /later/);
assert.match(comments[0].body, /a person/);
refusal = 403;
outcome = await step('comment');
assert.equal(outcome.status, 0, 'a fork may not comment, and its check counts');
assert.match(outcome.text, /^::warning::/m);
assert(!outcome.text.includes('secret'), 'the token is in no output');
refusal = 0;

// accept on request: only named goldens, in a checkout of the branch
write('project/unrelated', 'no golden');
const accept = { PENDING: join(kept, 'pending'), BRANCH: 'topic', RUN: '42' };
for (const [goldens, words] of [
  ['', 'no golden is named'],
  ['--all', "'--all' is no golden's name"],
  ['../x', 'is no golden'],
  ['Box.Gone', 'no run of Box.Gone waits in the artifact: it has Box.Falls'],
]) {
  outcome = await step('accept', { ...accept, GOLDENS: goldens });
  assert.equal(outcome.status, 2, outcome.text);
  assert(outcome.text.includes(words), `${words}: ${outcome.text}`);
}
const before = plain('git', 'rev-parse', 'HEAD');
outcome = await step('accept', { ...accept, GOLDENS: 'Box.Falls', BRANCH: '-x' });
assert.notEqual(outcome.status, 0);
assert.equal(plain('git', 'rev-parse', 'HEAD'), before, 'nothing is committed');
outcome = await step('accept', { ...accept, GOLDENS: 'Box.Falls' });
assert.equal(outcome.status, 0, outcome.text);
const commit = plain('git', '--git-dir', at('server/owner/name'), 'show', '--format=%an%n%B', '--name-only', 'topic');
assert.match(commit, /^someone\nAccept Box\.Falls\n\nRequested by someone, from run 42\.\n\nBox\.Falls: /);
assert.deepEqual(commit.trim().split('\n').slice(-2).sort(), ['golden/Box.Falls.mcap', 'golden/Box.Falls.txt']);

// green again, in a checkout of the pushed branch
const pushedFiles = at('again');
plain('git', 'clone', '--quiet', '--branch', 'topic', at('server/owner/name'), pushedFiles);
cpSync(join(pushedFiles, 'golden'), join(project, 'golden'), { recursive: true });
write('project/scenarios/hostile.yaml', box(hostile, '', 1));
writeFileSync(at('output'), '');
outcome = await step('check');
assert.equal(outputs().status, '0', outcome.text);

// a check that judges nothing fails its step
for (const file of readdirSync(at('project/scenarios'))) rmSync(at('project/scenarios', file));
outcome = await step('check');
assert.notEqual(outcome.status, 0);
assert.match(outcome.text, /^::error::/m);
server.close();
console.log('install, check, table, pictures, comment and accept do their parts');

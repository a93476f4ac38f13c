// release_test.mjs SOURCE: tools/release and tools/publish on scratch tags of a temporary repository, with small packages and a
// small site in the place of those that take a build: refusals, the files of a release, equal checksums from two folders,
// several versions side by side, and the requests to GitHub, which a server on the loopback address answers. Exit status 77: a
// program is missing.
import assert from 'node:assert/strict';
import { spawn, spawnSync } from 'node:child_process';
import { createHash } from 'node:crypto';
import { appendFileSync, cpSync, existsSync, mkdirSync, mkdtempSync, readFileSync, readdirSync, rmSync, writeFileSync } from 'node:fs';
import { createServer } from 'node:http';
import { tmpdir } from 'node:os';
import { dirname, join } from 'node:path';

const [source] = process.argv.slice(2);
for (const program of ['jq', 'git', 'curl', 'gpg', 'dpkg-deb', 'dpkg-scanpackages', 'apt-ftparchive'])
  if (spawnSync(program, ['--version']).error) {
    console.log(`skipped: ${program} isn't installed`);
    process.exit(77);
  }

const folder = mkdtempSync(join(tmpdir(), 'rehearse_release_'));
process.on('exit', () => rmSync(folder, { recursive: true, force: true }));
const at = (...parts) => join(folder, ...parts);
const write = (file, text) => {
  mkdirSync(dirname(file), { recursive: true });
  writeFileSync(file, text);
};
const environment = { ...process.env, HOME: at('home'), GNUPGHOME: at('keys'), LC_ALL: 'C.UTF-8' };
for (const name of Object.keys(environment)) if (/^(CI|REHEARSE_|GITHUB_|GIT_|SOURCE_DATE)/.test(name)) delete environment[name];
mkdirSync(at('home'));
mkdirSync(at('keys'), { mode: 0o700 });

/** A program that has to succeed; its output. */
const plain = (place, program, ...words) => {
  const outcome = spawnSync(program, words, { cwd: place, env: environment, encoding: 'utf8' });
  assert.equal(outcome.status, 0, `${program} ${words.join(' ')}: ${outcome.stdout}${outcome.stderr}`);
  return outcome.stdout;
};
const git = (place, ...words) => plain(place, 'git', '-c', 'user.name=A', '-c', 'user.email=a@b', ...words);
/** A script of tools/, also one that asks the server of this process. */
const tool = (place, name, words, more = {}) =>
  new Promise((done) => {
    const child = spawn(join(place, 'tools', name), words, { cwd: place, env: { ...environment, ...more } });
    let text = '';
    child.stdout.on('data', (chunk) => (text += chunk));
    child.stderr.on('data', (chunk) => (text += chunk));
    child.on('close', (status) => done({ status, text }));
  });
const refuses = async (place, name, words, reason) => {
  const outcome = await tool(place, name, words);
  assert.equal(outcome.status, 2, `${name} ${words.join(' ')}: ${outcome.text}`);
  assert(outcome.text.includes(reason), `${reason}: ${outcome.text}`);
};

// the repository, with the scripts as they are in SOURCE
const repository = at('first');
cpSync(join(source, 'tools'), join(repository, 'tools'), { recursive: true, filter: (file) => !file.includes('node_modules') });
write(join(repository, '.gitignore'), '/build/\n');
const changelog = (sections) => `# Changelog\n\n${sections.map(([heading, text]) => `## ${heading}\n\n${text}\n`).join('\n')}`;
const set_version = (version, heading) => {
  write(join(repository, 'CMakeLists.txt'), `cmake_minimum_required(VERSION 3.25)\nproject(Rehearse VERSION ${version} LANGUAGES CXX)\n`);
  write(join(repository, 'CHANGELOG.md'), changelog([[heading, `### Added\n\n- What ${version} adds.`], ['[0.0.1] - 2026-01-01', '- Older.']]));
};
/** Packages of a version, and its site, as tools/package and tools/docs leave them. */
function build(place, version) {
  rmSync(join(place, 'build'), { recursive: true, force: true });
  mkdirSync(join(place, 'build/packages'), { recursive: true });
  const make = (name, ending, depends) => {
    const content = at('content');
    rmSync(content, { recursive: true, force: true });
    write(join(content, 'usr/share', name), `${name} ${version}\n`);
    write(
      join(content, 'DEBIAN/control'),
      `Package: ${name}\nVersion: ${version}-1\nArchitecture: amd64\nMaintainer: A <a@b>\nDepends: ${depends}\nDescription: a small one\n`,
    );
    const file = join(place, `build/packages/${name}_${version}-1_amd64.${ending}`);
    const outcome = spawnSync('dpkg-deb', ['--root-owner-group', '--build', content, file], { env: { ...environment, SOURCE_DATE_EPOCH: '1700000000' }, encoding: 'utf8' });
    assert.equal(outcome.status, 0, outcome.stderr);
  };
  make('rehearse', 'deb', 'libc6 (>= 2.34), no-such-library | libstdc++6');
  make('rehearse-dev', 'deb', `rehearse (= ${version}-1)`);
  make('rehearse-dbgsym', 'ddeb', `rehearse (= ${version}-1)`);
  write(join(place, 'build/docs/index.html'), `the site of ${version}`);
  write(join(place, 'build/docs/_static/style.css'), '');
}
/** A golden of that version, and its copy for later ones. */
const keep = (version, golden, kept) => {
  write(join(repository, 'golden/Run.mcap'), golden);
  write(join(repository, `tests/upgrades/${version}/Run.mcap`), kept);
};
const release = (version) => {
  set_version(version, `[${version}] - 2026-11-27`);
  keep(version, `the run of ${version}`, `the run of ${version}`);
  git(repository, 'add', '--all');
  git(repository, 'commit', '--quiet', '--message', `Release ${version}`);
  git(repository, 'tag', `v${version}`);
  build(repository, version);
};
git(folder, 'init', '--quiet', '--bare', at('origin'));
git(folder, 'init', '--quiet', '--initial-branch', 'main', repository);
git(repository, 'remote', 'add', 'origin', at('origin'));

// refusals
set_version('9.8.7', '[9.8.7] - unreleased');
git(repository, 'add', '--all');
git(repository, 'commit', '--quiet', '--message', 'Begin');
build(repository, '9.8.7');
await refuses(repository, 'release', ['9.8.7', at('out')], "'9.8.7' is no tag of a release");
await refuses(repository, 'release', ['v9.8.8', at('out')], 'CMakeLists.txt states version 9.8.7');
await refuses(repository, 'release', ['v9.8.7', at('out')], 'there is no tag v9.8.7');
git(repository, 'tag', 'v9.8.7');
await refuses(repository, 'release', ['v9.8.7', at('out')], "'## [9.8.7] - unreleased' has no date");
git(repository, 'tag', '--delete', 'v9.8.7');
for (const [begin, sentence] of [
  [() => {}, 'tests/upgrades/9.8.6 has no recordings for the tests of later versions'],
  [() => keep('9.8.6', 'a run', 'another run'), "tests/upgrades/9.8.6/Run.mcap isn't the golden of this version"],
]) {
  set_version('9.8.6', '[9.8.6] - 2026-11-26');
  begin();
  git(repository, 'add', '--all');
  git(repository, 'commit', '--quiet', '--allow-empty', '--message', 'Release 9.8.6');
  git(repository, 'tag', '--force', 'v9.8.6');
  await refuses(repository, 'release', ['v9.8.6', at('out')], sentence);
}
git(repository, 'tag', '--delete', 'v9.8.6');
release('9.8.7');
rmSync(join(repository, 'build/packages/rehearse-dev_9.8.7-1_amd64.deb'));
await refuses(repository, 'release', ['v9.8.7', at('out')], 'build/packages has no rehearse-dev of version 9.8.7');
build(repository, '9.8.7');
appendFileSync(join(repository, 'CHANGELOG.md'), 'a change\n');
await refuses(repository, 'release', ['v9.8.7', at('out')], 'CHANGELOG.md');
git(repository, 'checkout', '--quiet', 'CHANGELOG.md');
git(repository, 'commit', '--quiet', '--allow-empty', '--message', 'Later');
await refuses(repository, 'release', ['v9.8.7', at('out')], 'the checkout is');
git(repository, 'checkout', '--quiet', 'v9.8.7');
rmSync(join(repository, 'build/docs'), { recursive: true });
await refuses(repository, 'release', ['v9.8.7', at('out')], 'build/docs has no site');
build(repository, '9.8.7');
await refuses(repository, 'release_notes', ['1.2.3'], 'no section ## [1.2.3]');

// the files of a release
plain(folder, 'gpg', '--batch', '--quiet', '--passphrase', '', '--quick-generate-key', 'Test of Rehearse', 'ed25519', 'sign', 'never');
let outcome = await tool(repository, 'publish', ['fetch', at('out')]);
assert.equal(outcome.status, 0, outcome.text);
outcome = await tool(repository, 'release', ['v9.8.7', at('out'), 'Test of Rehearse']);
assert.equal(outcome.status, 0, outcome.text);
const assets = () => readdirSync(at('out/assets')).sort();
const expected = (version) =>
  [
    'SHA256SUMS',
    'SHA256SUMS.asc',
    'notes.md',
    `rehearse-${version}.spdx.json`,
    `rehearse-dbgsym_${version}-1_amd64.ddeb`,
    `rehearse-dev_${version}-1_amd64.deb`,
    `rehearse_${version}-1_amd64.deb`,
  ].sort();
assert.deepEqual(assets(), expected('9.8.7'));
assert.equal(readFileSync(at('out/assets/notes.md'), 'utf8'), '### Added\n\n- What 9.8.7 adds.\n');
const sums = readFileSync(at('out/assets/SHA256SUMS'), 'utf8').trim().split('\n').map((line) => line.split('  '));
assert.deepEqual(sums.map(([, name]) => name), expected('9.8.7').filter((name) => !name.startsWith('SHA256SUMS')));
for (const [sum, name] of sums) assert.equal(createHash('sha256').update(readFileSync(at('out/assets', name))).digest('hex'), sum);
plain(at('out/assets'), 'gpg', '--verify', 'SHA256SUMS.asc', 'SHA256SUMS');

// the list of dependencies
const list = JSON.parse(readFileSync(at('out/assets/rehearse-9.8.7.spdx.json'), 'utf8'));
assert.equal(list.spdxVersion, 'SPDX-2.3');
assert.equal(Date.parse(list.creationInfo.created) / 1000, Number(git(repository, 'log', '-1', '--format=%ct', 'v9.8.7')));
const packages = new Map(list.packages.map((one) => [one.name, one]));
for (const name of ['rehearse', 'rehearse-dev', 'libc6', 'libstdc++6', 'libgcc-s1', 'gcc-12-base']) assert(packages.has(name), `${name} is in the list`);
assert(!packages.has('no-such-library') && !packages.has('rehearse-dbgsym'));
const installed = spawnSync('dpkg-query', ['--show', '--showformat=${Version}', 'libstdc++6'], { encoding: 'utf8' }).stdout;
assert.equal(packages.get('libstdc++6').versionInfo, installed);
assert.match(packages.get('libstdc++6').originator, /^Organization: [^<>]+ \([^()]+@[^()]+\)$/);
assert.match(packages.get('libstdc++6').externalRefs[0].referenceLocator, /^pkg:deb\/debian\/libstdc%2B%2B6@.+\?arch=amd64$/);
assert.equal(packages.get('rehearse').checksums[0].checksumValue, sums.find(([, name]) => name === 'rehearse_9.8.7-1_amd64.deb')[0]);
const ids = new Set(['SPDXRef-DOCUMENT', ...list.packages.map(({ SPDXID }) => SPDXID)]);
assert.equal(ids.size, list.packages.length + 1, 'no id twice');
for (const { spdxElementId, relatedSpdxElement } of list.relationships) assert(ids.has(spdxElementId) && ids.has(relatedSpdxElement));
assert(list.relationships.some(({ spdxElementId, relatedSpdxElement }) => spdxElementId === 'SPDXRef-rehearse' && relatedSpdxElement === 'SPDXRef-libstdc--6'));

// the same from another folder, and once more
const second = at('another/folder/second');
git(folder, 'clone', '--quiet', '--branch', 'v9.8.7', repository, second);
build(second, '9.8.7');
for (let i = 0; i < 2; ++i) {
  outcome = await tool(second, 'release', ['v9.8.7', at('twice')]);
  assert.equal(outcome.status, 0, outcome.text);
}
// the namespace of the list has the origin's address, which is a folder in either
assert.equal(readFileSync(at('twice/assets/SHA256SUMS'), 'utf8'), readFileSync(at('out/assets/SHA256SUMS'), 'utf8'));
assert.equal(
  readFileSync(at('twice/pages/apt/dists/stable/main/binary-amd64/Packages'), 'utf8'),
  readFileSync(at('out/pages/apt/dists/stable/main/binary-amd64/Packages'), 'utf8'),
);

// GitHub: drafts, their files, and when they are published
const releases = [];
let refused = ''; // a file that it doesn't take
const server = createServer((request, answer) => {
  const chunks = [];
  request.on('data', (chunk) => chunks.push(chunk));
  request.on('end', () => {
    const url = new URL(request.url, origin);
    const body = Buffer.concat(chunks);
    const send = (status, object) => answer.writeHead(status).end(JSON.stringify(object));
    if (request.headers.authorization !== 'Bearer secret') return send(401, {});
    if (request.method === 'POST' && url.pathname === '/repos/owner/name/releases') {
      releases.push({ id: releases.length + 1, ...JSON.parse(body), assets: new Map() });
      return send(201, { id: releases.length, upload_url: `${origin}/upload/${releases.length}/assets{?name,label}` });
    }
    const upload = /^\/upload\/(\d+)\/assets$/.exec(url.pathname);
    if (request.method === 'POST' && upload) {
      const name = url.searchParams.get('name');
      if (name === refused) return send(422, { message: 'already_exists' });
      releases[upload[1] - 1].assets.set(name, body);
      return send(201, {});
    }
    const patch = /^\/repos\/owner\/name\/releases\/(\d+)$/.exec(url.pathname);
    if (request.method === 'PATCH' && patch) {
      Object.assign(releases[patch[1] - 1], JSON.parse(body));
      return send(200, { html_url: 'https://here/v' });
    }
    return send(404, {});
  });
});
await new Promise((ready) => server.listen(0, '127.0.0.1', ready));
const origin = `http://127.0.0.1:${server.address().port}`;
const github = { GITHUB_TOKEN: 'secret', GITHUB_API_URL: origin, GITHUB_REPOSITORY: 'owner/name' };
const published = () => spawnSync('git', ['--git-dir', at('origin'), 'ls-tree', '-r', '--name-only', 'gh-pages'], { encoding: 'utf8' }).stdout.split('\n');

appendFileSync(at('out/assets/notes.md'), 'changed\n');
outcome = await tool(repository, 'publish', ['push', 'v9.8.7', at('out')], github);
assert.equal(outcome.status, 2, 'a changed file is published');
assert.equal(releases.length, 0);
outcome = await tool(repository, 'release', ['v9.8.7', at('out'), 'Test of Rehearse']);
assert.equal(outcome.status, 0, outcome.text);
refused = 'SHA256SUMS';
outcome = await tool(repository, 'publish', ['push', 'v9.8.7', at('out')], github);
assert.match(outcome.text, /takes no SHA256SUMS, the release stays a draft/);
assert.equal(outcome.status, 2);
assert.equal(releases[0].draft, true);
assert.deepEqual(published(), [''], 'nothing is published');
refused = '';
outcome = await tool(repository, 'publish', ['push', 'v9.8.7', at('out')], github);
assert.equal(outcome.status, 0, outcome.text);
assert.equal(releases[1].draft, false);
assert.equal(releases[1].name, 'Rehearse 9.8.7');
assert.match(releases[1].body, /What 9\.8\.7 adds/);
assert.deepEqual([...releases[1].assets.keys()].sort(), expected('9.8.7'));
assert(releases[1].assets.get('rehearse_9.8.7-1_amd64.deb').equals(readFileSync(at('out/assets/rehearse_9.8.7-1_amd64.deb'))));
assert(!outcome.text.includes('secret'));
for (const name of ['.nojekyll', 'apt/rehearse.asc', 'apt/dists/stable/InRelease', 'apt/pool/rehearse_9.8.7-1_amd64.deb', 'docs/9.8.7/index.html', 'docs/latest/_static/style.css'])
  assert(published().includes(name), `${name} is published`);

// versions side by side; `latest` is the highest, whichever comes last
for (const version of ['10.0.0', '9.9.1']) {
  release(version);
  rmSync(at('out'), { recursive: true });
  for (const [name, words] of [
    ['publish', ['fetch', at('out')]],
    ['release', [`v${version}`, at('out'), 'Test of Rehearse']],
    ['publish', ['push', `v${version}`, at('out')]],
  ]) {
    outcome = await tool(repository, name, words, github);
    assert.equal(outcome.status, 0, outcome.text);
  }
}
for (const version of ['9.8.7', '9.9.1', '10.0.0'])
  for (const name of [`docs/${version}/index.html`, `apt/pool/rehearse_${version}-1_amd64.deb`]) assert(published().includes(name), name);
const show = (name) => plain(folder, 'git', '--git-dir', at('origin'), 'show', `gh-pages:${name}`);
assert.equal(show('docs/latest/index.html'), 'the site of 10.0.0');
assert.match(show('docs/versions.html'), /10\.0\.0.*\n.*9\.9\.1.*\n.*9\.8\.7/);
assert.equal(show('apt/dists/stable/main/binary-amd64/Packages').match(/^Package: rehearse$/gm).length, 3);
assert(!existsSync(at('out/pages/docs/build')));

// the same version with other bytes isn't published again
git(repository, 'checkout', '--quiet', 'v9.8.7');
build(repository, '9.8.7');
appendFileSync(join(repository, 'build/packages/rehearse_9.8.7-1_amd64.deb'), 'x');
await refuses(repository, 'repository', [at('out/pages/apt')], 'is there with other bytes');
server.close();
console.log('releases of scratch tags have their files, checksums, dependencies and sites, and are published whole or not at all');

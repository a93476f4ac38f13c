// security_test.mjs SOURCE BUILD: the statements of .github/SECURITY.md on data. A recording, a scenario and a model name libraries
// whose code leaves a file when it is loaded: the verbs that only read leave none. `replay`, which loads the library that
// the recording names, leaves one, so that this test can fail; with --controller it loads the given library alone.
// Exit status 77: there is no compiler, or the sample controller isn't built.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { copyFileSync, cpSync, existsSync, mkdirSync, mkdtempSync, readFileSync, readdirSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';

const [source, build] = process.argv.slice(2);
const skip = (reason) => {
  console.log(`skipped: ${reason}`);
  process.exit(77);
};
const libraries = readdirSync(build).filter((name) => name.startsWith('lib'));
const sample = libraries.map((name) => join(build, name, 'rehearse/controllers/SpringController.so')).find((file) => existsSync(file));
if (!sample) skip('SpringController is not built');

const folder = mkdtempSync(join(tmpdir(), 'rehearse_security_'));
process.on('exit', () => rmSync(folder, { recursive: true, force: true }));
const environment = { ...process.env };
for (const name of Object.keys(environment)) if (name === 'CI' || name.startsWith('REHEARSE_')) delete environment[name];
const run = (program, ...words) => spawnSync(program, words, { cwd: folder, env: environment, encoding: 'utf8' });
const rehearse = (...words) => run(join(build, 'bin/rehearse'), ...words);

const loaded = join(folder, 'loaded');
writeFileSync(
  join(folder, 'trap.c'),
  `#include <fcntl.h>\n__attribute__((constructor)) static void load(void) { open("${loaded}", O_CREAT | O_WRONLY, 0600); }\n`,
);
const library = join(folder, 'Named.so');
const compiled = run('cc', '-shared', '-fPIC', '-o', 'trap.so', 'trap.c');
if (compiled.error) skip('there is no compiler');
assert.equal(compiled.status, 0, compiled.stderr);

const model = readFileSync(join(source, 'fixtures/models/spring_mass.urdf'), 'utf8');
mkdirSync(join(folder, 'models'));
// a plugin, as models for Gazebo name them
writeFileSync(join(folder, 'models/robot.urdf'), model.replace('</robot>', `<gazebo><plugin name="p" filename="${library}"/></gazebo></robot>`));
writeFileSync(
  join(folder, 'scenario.yaml'),
  `rehearse: 1\nname: named\nduration: 0.05\nbodies:\n  - name: Rail\n    model: models/robot.urdf\n` +
    `    controllers:\n      - {name: Spring, library: ${library}, options: "{stiffness: 80}"}\n`,
);
copyFileSync(sample, library);
writeFileSync(
  join(folder, 'bare.yaml'),
  'rehearse: 1\nname: bare\nduration: 0.05\nbodies:\n  - {name: Rail, model: models/robot.urdf}\n',
);
const recorded = rehearse('record', 'scenario.yaml', '-o', 'run.mcap');
assert.equal(recorded.status, 0, recorded.stderr);
copyFileSync(join(folder, 'trap.so'), library);
copyFileSync(join(folder, 'run.mcap'), join(folder, 'copy.mcap'));

// each verb of the command is in one of the two lists
const page = readFileSync(join(source, '.github/SECURITY.md'), 'utf8');
const verbsIn = (pattern) => [...page.match(pattern)[1].matchAll(/`([a-z]+)`/g)].map(([, verb]) => verb);
const calling = verbsIn(/Verbs that call controllers do so:([^.]*)\./);
const harmless = verbsIn(/No other verb loads code[^:]*:([^.]*)\./);
const verbs = [...rehearse('--help').stdout.matchAll(/^ {2}([a-z]+) {2,}\S/gm)].map(([, verb]) => verb).sort();
assert(verbs.length > 15, `rehearse --help lists ${verbs.length} verbs`);
assert.deepEqual([...calling, ...harmless].sort(), verbs, '.github/SECURITY.md says of each verb once whether it loads code');

cpSync(join(source, 'fixtures/projects'), join(folder, 'projects'), { recursive: true });
for (const name of ['wagon.body', 'meshes']) cpSync(join(source, 'fixtures/models', name), join(folder, 'models', name), { recursive: true });
copyFileSync(join(folder, 'trap.so'), join(folder, 'projects/WagonController.so'));
writeFileSync(
  join(folder, 'drives.xml'),
  `<mujoco><worldbody><body><joint name="j" damping="0.1"/><geom size="0.1"/></body></worldbody><actuator><motor joint="j"/></actuator></mujoco>`,
);
writeFileSync(
  join(folder, 'falls.yaml'),
  `rehearse: 1\nduration: 0.05\nbodies:\n  - {name: Box, box: {size: [0.2, 0.2, 0.2]}, mass: 1, position: [0, 0, 1]}\n` +
    `expect:\n  - always: Box/Box/position/z > 0.9\n`,
);
const kept = rehearse('check', 'falls.yaml', '--history', 'history.jsonl', '--commit', 'v1', '--date', '2026-11-27');
assert.equal(kept.status, 0, kept.stdout + kept.stderr);

// a robot's loop that ends without closing its tap, and leaves the ring
writeFileSync(
  join(folder, 'loop.c'),
  `#include <rehearse/tap.h>
int main(int count, char** words) {
  const char* names[] = {"SLIDE"};
  const double effort = 0.5;
  const rehearse_tap_options options = {"models/robot.urdf", "Spring", 0.001, 1.0, 1, 0};
  rehearse_tap* const tap = count == 2 ? rehearse_tap_open(words[1], &options) : NULL;
  const int u = rehearse_tap_commands(tap, "Rail", names, 1, REHEARSE_TAP_U);
  rehearse_tap_begin(tap, 0);
  rehearse_tap_write(tap, u, &effort, 1);
  rehearse_tap_end(tap);
  return tap && u >= 0 ? 0 : 1;
}
`,
);
const linked = run('cc', '-I', join(source, 'controllers/include'), 'loop.c', join(build, 'lib/librehearse_tap.so'), '-o', 'loop',
  `-Wl,-rpath,${join(build, 'lib')}`);
assert.equal(linked.status, 0, linked.stderr);
const tap = `security-${process.pid}`;
assert.equal(run(join(folder, 'loop'), tap).status, 0, 'the loop has no tap');

const reading = [
  ['new', 'arm'],
  ['doc'],
  ['history', 'history.jsonl'],
  ['import', 'projects/wagon.cnoid', '-o', 'imported'],
  ['actuators', 'drives.xml'],
  ['map', 'run.mcap', '--model', 'models/robot.urdf'],
  ['info', 'run.mcap', '--full'],
  ['cat', 'run.mcap'],
  ['diff', 'run.mcap', 'copy.mcap'],
  ['doctor', 'run.mcap'],
  ['export', 'run.mcap', '-o', 'tables'],
  ['filter', 'run.mcap', '-o', 'part.mcap'],
  ['fit', 'run.mcap', '--scenario', 'scenario.yaml', '--vary', 'gravity[2]=-10..-9'], // 4: nothing moves
  ['merge', 'run.mcap', 'copy.mcap', '-o', 'both.mcap'],
  ['recover', 'run.mcap', '-o', 'whole.mcap'],
  ['report', 'run.mcap', '-o', 'report.html'],
  ['serve', 'run.mcap', '--port', '0'],
  ['tap', tap, '--recover', '-o', 'flight.mcap'],
  ['inspect', 'models/robot.urdf'],
  ['render', 'scenario.yaml', '-o', 'start.png'],
  ['record', 'bare.yaml', '-o', 'bare.mcap'], // its model names the library as a plugin
];
for (const words of reading) {
  const isServing = words[0] === 'serve'; // it would serve on
  const outcome = isServing ? run('timeout', '--preserve-status', '--signal', 'INT', '2', join(build, 'bin/rehearse'), ...words) : rehearse(...words);
  const isUndecided = words[0] === 'fit' && outcome.status === 4; // nothing moves in the recording
  assert(isServing ? outcome.status === 130 && outcome.stdout.includes('ws://127.0.0.1:') : outcome.status <= 1 || isUndecided,
    `rehearse ${words.join(' ')} ends with ${outcome.status}: ${outcome.stderr}`);
  assert(!existsSync(loaded), `rehearse ${words[0]} has loaded the library that the file names`);
}
const given = rehearse('replay', 'run.mcap', '--controller', `Spring=${sample}`, '-o', 'again.mcap');
assert.equal(given.status, 0, given.stderr);
assert(!existsSync(loaded), 'replay --controller has loaded the library that the recording names');

for (const words of [['replay', 'run.mcap'], ['record', 'scenario.yaml', '-o', 'new.mcap']]) {
  assert.notEqual(rehearse(...words).status, 0, 'the trap is no controller');
  assert(existsSync(loaded), `rehearse ${words[0]} has not loaded the library: the test sees nothing`);
  rmSync(loaded);
}
assert.deepEqual([...new Set(reading.map(([verb]) => verb))].filter((verb) => verb !== 'record').sort(), harmless.sort(),
  'each verb that loads no code has a command here');
console.log(`${reading.length} commands read, and none loads code; replay and record load the library that is named`);

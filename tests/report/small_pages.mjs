// Makes the pages without a recording as a user's commands do: the index of tests, a history, a campaign.
// REHEARSE_COMMAND is in the environment.
import { execFileSync } from 'node:child_process';
import { mkdirSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';

const { REHEARSE_COMMAND } = process.env;

function rehearse(folder, words, environment = {}) {
  try {
    return execFileSync(REHEARSE_COMMAND, words, {
      cwd: folder,
      encoding: 'utf8',
      stdio: ['ignore', 'pipe', 'pipe'],
      env: { ...process.env, CI: '', REHEARSE_CALL_STACK: 'never', ...environment },
    });
  } catch (failure) {
    return failure.stdout; // a check that finds something ends with another status
  }
}

// A project whose commit is stated by the files of a git repository.
function project(folder, commit) {
  mkdirSync(join(folder, '.git/refs/heads'), { recursive: true });
  mkdirSync(join(folder, 'scenarios'), { recursive: true });
  mkdirSync(join(folder, 'golden'), { recursive: true });
  writeFileSync(join(folder, '.git/HEAD'), 'ref: refs/heads/main\n');
  writeFileSync(join(folder, '.git/refs/heads/main'), `${commit}\n`);
}

function scenario(folder, name, lines) {
  writeFileSync(join(folder, `scenarios/${name}.yaml`), ['rehearse: 1', ...lines].join('\n') + '\n');
}

const box = ['bodies:', '  - {name: Box, box: {size: [0.2, 0.2, 0.2]}, mass: 1, position: [0, 0, 1]}'];

/** Three checks: a box that falls too low, right, and too low again; another that is right; a scenario with a mistake. */
function index(folder) {
  const commits = ['a41c2e90', '7be2d115', 'c0ffee12'].map((begin) => begin.repeat(5));
  [0.9, 0.5, 0.9].forEach((least, run) => {
    project(folder, commits[run]);
    const falls = (above) => ['duration: 0.2', ...box, `expect: [{always: "Box/Box/position/z > ${above} m"}]`];
    scenario(folder, 'falls', falls(least));
    scenario(folder, 'stays_above_the_floor', falls(0.1));
    scenario(folder, 'with_a_mistake', ['duration: 0.2', 'expect: 3']);
    const moment = { SOURCE_DATE_EPOCH: String(1_795_000_000 + 86_400 * run) };
    rehearse(folder, ['check', '-j1'], { ...moment, REHEARSE_PENDING: 'pending' });
  });
  return join(folder, 'pending/index.html');
}

/** Margins of 14 commits: one that drifts, one that jumps, one far from its bound, and one that was violated. */
function history(folder) {
  const count = 14;
  const courses = {
    'Arm/SHOULDER/q within 3 deg of -45 deg at the end': ['rad', 0.0524, (i) => 0.0243 - 0.0004 * i],
    'the magnitude of Arm/SHOULDER/u below 40 N·m': ['N·m', 40, (i) => (i < 9 ? 32.2 : 21.5) + 0.05 * (i % 3)],
    'Arm/SHOULDER/dq within 91 rad/s of 0 rad/s': ['rad/s', 91, (i) => 90.0 + 0.002 * ((7 * i) % 5)],
    'Arm/WRIST/position/z above 0.4 m': ['m', 0.4, (i) => 0.03 - (i === 6 ? 0.045 : 0.002 * (i % 4))],
  };
  const lines = Array.from({ length: count }, (_, i) => ({
    history: 1,
    commit: `${(0x3f2a1bc + 7919 * i).toString(16)}`.padEnd(40, '0'),
    changed: false,
    date: `2026-11-${String(5 + i).padStart(2, '0')}`,
    scenario: 'hold',
    code: 'same',
    proved: false,
    first: null,
    margins: Object.entries(courses).map(([text, [unit, bound, of]]) => ({
      text,
      unit,
      bound,
      margin: of(i),
      value: bound - of(i),
      share: of(i) / bound,
      tick: 1999,
    })),
  }));
  writeFileSync(join(folder, 'history.jsonl'), lines.map((line) => JSON.stringify(line) + '\n').join(''));
  rehearse(folder, ['history', 'history.jsonl', '--html', 'history.html']);
  return join(folder, 'history.html');
}

/** 60 cases of a box that falls from other heights, with other masses and gravities. */
function campaign(folder) {
  project(folder, '5'.repeat(40));
  scenario(folder, 'drop', [
    'duration: 0.3',
    ...box,
    'expect:',
    '  - {channel: Box/Box/position/z, above: 0.5, at: end}',
    '  - {always: "Box/Box/position/z < 1.3 m"}',
    'vary:',
    '  height: {path: "bodies.Box.position[2]", uniform: [0.7, 1.4]}',
    '  mass: {path: bodies.Box.mass, log_uniform: [0.5, 8]}',
    '  method: {path: solver.method, choice: [direct, quick]}',
  ]);
  rehearse(folder, ['sweep', 'scenarios/drop.yaml', '--cases', '60', '-o', 'run']);
  return join(folder, 'run/report.html');
}

export const small_pages = { index, history, campaign };

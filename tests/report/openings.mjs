// Takes pictures of reports as they open, on a planted gain, a crash and a picture that differs, in three widths, light
// and dark, for a person to look at:
//   node openings.mjs PAGE FOLDER
// REHEARSE_COMMAND, CHANGED_GAIN, CRASHING (controllers) and SOURCES (the repository) are in the environment.
import { execFileSync } from 'node:child_process';
import { copyFileSync, mkdirSync, readFileSync, writeFileSync } from 'node:fs';
import { join, resolve } from 'node:path';
import { launch, open_report } from './browser.mjs';

const { REHEARSE_COMMAND, CHANGED_GAIN, CRASHING, SOURCES } = process.env;
const [page_file, folder] = process.argv.slice(2).map((path) => resolve(path));

// A check that fails, in a copy of the fixtures; the report's file.
function check(name, scenario, golden, change, words) {
  const project = join(folder, name);
  for (const part of ['fixtures', 'golden']) execFileSync('cp', ['-r', join(SOURCES, part), mkdir(project)]);
  const file = join(project, 'fixtures/scenarios', scenario);
  writeFileSync(file, change(readFileSync(file, 'utf8')));
  try {
    execFileSync(REHEARSE_COMMAND, ['check', file, ...words], {
      cwd: project,
      env: { ...process.env, REHEARSE_REPORT_PAGE: page_file, REHEARSE_PENDING: 'pending' },
      stdio: ['ignore', 'inherit', 'inherit'],
    });
  } catch {
    return join(project, 'pending', `${golden}.html`);
  }
  throw new Error(`${name}: the check passes`);
}

function mkdir(path) {
  mkdirSync(path, { recursive: true });
  return path;
}

const same = (text) => text;
const reports = {
  gain: check('gain', 'sr1_minimum.yaml', 'SR1.StandsUnderItsMinimumController', same, [
    '--controller',
    `SR1Minimum=${CHANGED_GAIN}`,
  ]),
  crash: check('crash', 'sr1_minimum.yaml', 'SR1.StandsUnderItsMinimumController', same, [
    '--controller',
    `SR1Minimum=${CRASHING}`,
  ]),
  picture: check(
    'picture',
    'camera_follower.yaml',
    'CameraFollower.KeepsTheBallInTheMiddle',
    (text) => text.replace('color: [0.9, 0.1, 0.1]', 'color: [0.9, 0.3, 0.1]'),
    [],
  ),
};

const sizes = [
  [1280, 720],
  [1920, 1080],
  [420, 900],
];
const browser = await launch();
for (const [name, file] of Object.entries(reports)) {
  copyFileSync(file, join(folder, `${name}.html`));
  for (const [width, height] of sizes)
    for (const dark of [false, true]) {
      const { page, close } = await open_report(browser, file, { width, height, dark, fonts: true });
      await page.evaluate(() => window.rehearse.settled());
      await page.evaluate(() => document.fonts.ready);
      await page.screenshot({ path: join(folder, `${name}_${width}_${dark ? 'dark' : 'light'}.png`), caret: 'hide' });
      await close();
    }
}
await browser.close();

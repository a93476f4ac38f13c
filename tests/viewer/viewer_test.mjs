// Foxglove Studio shows the robot of an exported recording, and of a served one, with the exported layout. Its code is the viewer's,
// from npm. Its version is older than the panel for pictures and than layers with the description of a topic, so only
// the 3D panel is opened, and only the robot is looked for.
// REHEARSE_COMMAND and SOURCES (the repository) are in the environment, KEPT is the folder for the screenshots.
import assert from 'node:assert/strict';
import { execFileSync, spawn } from 'node:child_process';
import { mkdirSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { launch } from '../report/browser.mjs';
import { serve } from './server.mjs';

const { REHEARSE_COMMAND, SOURCES, KEPT } = process.env;
const here = new URL('.', import.meta.url).pathname;
const scratch = mkdtempSync(join(tmpdir(), 'rehearse_viewer_'));
const patience = 80_000; // [ms]

let browser, server, served;

function file_of(path) {
  if (path === '/') return join(here, 'page.html');
  if (path.startsWith('/npm/')) return join(here, 'node_modules', path.slice('/npm/'.length));
  if (path === '/run.mcap' || path === '/layout.json') return join(scratch, path);
  return join(here, 'node_modules/@foxglove/studio-base/assets', path);
}

before(async () => {
  const rehearse = (...words) => execFileSync(REHEARSE_COMMAND, words, { cwd: SOURCES, stdio: 'pipe' });
  const run = join(scratch, 'recorded.mcap');
  rehearse('record', 'fixtures/scenarios/sr1_minimum.yaml', '--duration', '0.2', '-o', run);
  rehearse('export', run, '--viewer', join(scratch, 'run.mcap'), '--layout', join(scratch, 'exported.json'));
  mkdirSync(KEPT, { recursive: true });
  served = spawn(REHEARSE_COMMAND, ['serve', run, '--port', '0', '--loop'], { stdio: ['ignore', 'pipe', 'inherit'] });
  served.out = '';
  for await (const text of served.stdout) if ((served.out += text).includes('Ctrl-C')) break;
  server = await serve(file_of);
  browser = await launch();
});

after(async () => {
  await browser?.close();
  server?.close();
  served?.kill('SIGINT');
  rmSync(scratch, { recursive: true });
});

/**
 * Counts pixels in the middle of the window's right half, where the 3D panel is. `robot`: those of grey links, which
 * neither the viewer's grid nor its axes contain, `at` their numbers; `axes`: the red ones.
 */
async function count_pixels(page, png) {
  return page.evaluate(async (base64) => {
    const picture = await createImageBitmap(await (await fetch(`data:image/png;base64,${base64}`)).blob());
    const canvas = new OffscreenCanvas(picture.width, picture.height);
    const context = canvas.getContext('2d');
    context.drawImage(picture, 0, 0);
    const [left, top, width, height] = [0.5, 0.15, 0.3, 0.7].map((part, i) =>
      Math.round(part * (i % 2 === 0 ? picture.width : picture.height)),
    );
    const { data } = context.getImageData(left, top, width, height);
    const counts = { all: width * height, robot: 0, axes: 0, at: [] };
    for (let i = 0; i < data.length; i += 4) {
      const [red, green, blue] = data.slice(i, i + 3);
      const spread = Math.max(red, green, blue) - Math.min(red, green, blue);
      if (spread < 16 && red > 30 && red < 200) counts.at[counts.robot++] = i / 4;
      if (red > 80 && green < red / 2 && blue < red / 2) ++counts.axes;
    }
    return counts;
  }, png.toString('base64'));
}

/**
 * Opens the recording in a new page until `done` accepts the counts, and returns them with the viewer's warnings.
 * `later`: the counts after a step in time.
 */
async function look_once(name, done, source) {
  const page = await browser.newPage({ viewport: { width: 1280, height: 800 } });
  const warnings = [];
  page.on('console', (message) => ['warning', 'error'].includes(message.type()) && warnings.push(message.text()));
  await page.goto(`${server.address}/?ds=${source.kind}&ds.url=${encodeURIComponent(source.address)}`, { timeout: patience });
  const counts_now = async (file) => {
    await page.waitForTimeout(1000);
    return count_pixels(page, await page.screenshot({ path: join(KEPT, file), timeout: patience }));
  };
  const end = performance.now() + patience;
  let counts;
  do counts = await counts_now(`${name}.png`);
  while (!done(counts) && performance.now() < end);
  await page.keyboard.press('ArrowLeft');
  const later = await counts_now(`${name}_later.png`);
  await page.close();
  return { ...counts, later, warnings };
}

/** Opens the recording with this layout, once more if the viewer drew nothing: a busy machine can take its 3D context. */
async function look(layout, name, done, source = { kind: 'remote-file', address: `${server.address}/run.mcap` }) {
  writeFileSync(join(scratch, 'layout.json'), JSON.stringify(layout));
  const seen = await look_once(name, done, source);
  return seen.robot + seen.axes > 0 ? seen : look_once(name, done, source);
}

const written = ({ warnings }) => `\nThe viewer's warnings: ${warnings.join('\n') || 'none'}`;

function panel_3d() {
  const exported = JSON.parse(readFileSync(join(scratch, 'exported.json'), 'utf8'));
  return { ...exported, layout: '3D!robot' };
}

test('the robot is drawn where its frames are', async () => {
  const seen = await look(panel_3d(), 'robot', (counts) => counts.robot > 0.02 * counts.all && counts.axes > 50);
  assert.ok(seen.robot > 0.02 * seen.all, `${seen.robot} of ${seen.all} pixels show the robot ${written(seen)}`);
  const of_robot = seen.warnings.filter((warning) => warning.includes('[topics > /robot_description]'));
  assert.deepEqual(of_robot, []);
  // a viewer that doesn't know a link's pose draws it in the description's until the next transform
  const later = new Set(seen.later.at);
  const both = seen.at.filter((pixel) => later.has(pixel)).length;
  assert.ok(both > 0.95 * Math.max(seen.robot, seen.later.robot), `${both} pixels show the robot before and after a step`);
});

test('without its description only the frames are drawn', async () => {
  const layout = panel_3d();
  layout.configById['3D!robot'].topics['/robot_description'] = { visible: false };
  const seen = await look(layout, 'frames', (counts) => counts.axes > 50);
  assert.ok(seen.axes > 50, `${seen.axes} pixels show axes ${written(seen)}`);
  assert.ok(seen.robot < 0.005 * seen.all, `${seen.robot} of ${seen.all} pixels look like the robot`);
});

test('the robot of a served recording is drawn while it plays', async () => {
  const source = { kind: 'foxglove-websocket', address: /ws:\S+/.exec(served.out)[0] };
  const seen = await look(panel_3d(), 'served', (counts) => counts.robot > 0.02 * counts.all && counts.axes > 50, source);
  assert.ok(seen.robot > 0.02 * seen.all, `${seen.robot} of ${seen.all} pixels show the robot ${written(seen)}`);
  const later = new Set(seen.later.at);
  const both = seen.at.filter((pixel) => later.has(pixel)).length;
  assert.ok(both > 0.9 * seen.robot, `${both} of ${seen.robot} pixels show the robot a second later`);
});

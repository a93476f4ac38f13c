// A report made by Rehearse of a planted fault: SR1 under a controller with a different gain of one knee.
// REHEARSE_COMMAND, CHANGED_GAIN (the controller) and SOURCES (the repository) are in the environment.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { readFileSync, statSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { before, test } from 'node:test';
import { scratch_file, settled, state_of, with_file } from './bench.mjs';

const { REHEARSE_COMMAND, CHANGED_GAIN, SOURCES } = process.env;
const golden = join(SOURCES, 'golden/SR1.StandsUnderItsMinimumController.mcap');
const made = {};

function rehearse(...words) {
  return execFileSync(REHEARSE_COMMAND, words, { cwd: SOURCES, encoding: 'utf8', stdio: ['ignore', 'pipe', 'pipe'] });
}

before(() => {
  made.trace = scratch_file('run.mcap');
  made.report = scratch_file('run.html');
  rehearse(
    'record',
    'fixtures/scenarios/sr1_minimum.yaml',
    '-o',
    made.trace,
    '--controller',
    `SR1Minimum=${CHANGED_GAIN}`,
  );
  rehearse('report', made.trace, golden, '-o', made.report);
});

test('a planted fault is on the screen when the report opens', async () => {
  await with_file(made.report, {}, async ({ page, complaints, requests }) => {
    await settled(page);
    assert.equal(await page.textContent('.state'), 'Beyond tolerance');
    const { tick, shown } = await state_of(page);
    assert.match(shown[0], /SR1Minimum\/output\/.*KNEE\/u$/, 'the command that differs first');
    assert.ok((await page.textContent('.sentence')).includes(`tick ${tick} `));
    assert.match(await page.innerText('.plot .difference.beyond'), /Δ/);
    await page.keyboard.press('End');
    await page.keyboard.press('d');
    await settled(page);
    assert.equal((await state_of(page)).tick, tick);
    await page.click('#tab-provenance');
    assert.match(await page.innerText('tr.differs:has-text("controller.SR1")'), /changed_gain/);
    assert.deepEqual(complaints, []);
    assert.equal(requests.length, 1);
  });
});

test('pictures that differ are on the screen when the report opens, and above the robot in a narrow window', async () => {
  const scenario = join(SOURCES, 'fixtures/scenarios/camera_follower.yaml'),
    [recoloured, trace, report] = ['recoloured.yaml', 'camera.mcap', 'camera.html'].map(scratch_file);
  const text = readFileSync(scenario, 'utf8').replaceAll('../models', join(SOURCES, 'fixtures/models'));
  writeFileSync(recoloured, text.replace('color: [0.9, 0.1, 0.1]', 'color: [0.9, 0.3, 0.1]'));
  rehearse('record', recoloured, '-o', trace);
  rehearse('report', trace, join(SOURCES, 'golden/CameraFollower.KeepsTheBallInTheMiddle.mcap'), '-o', report);
  const top_of = async (page, panel) => (await page.locator(`[aria-label="${panel}"]`).first().boundingBox()).y;
  await with_file(report, { width: 1280, height: 720 }, async ({ page }) => {
    await settled(page);
    const picture = await page.locator('.cameras canvas').first().boundingBox();
    assert.ok(picture.height > 60 && picture.y + picture.height < 720);
    assert.ok((await top_of(page, 'cameras')) > (await top_of(page, 'robot')));
  });
  await with_file(report, { width: 420, height: 900 }, async ({ page }) => {
    await settled(page);
    assert.ok((await top_of(page, 'cameras')) < (await top_of(page, 'robot')));
  });
});

test('robot, table and pictures are those of the recording at every tick', async () => {
  await with_file(made.report, {}, async ({ page }) => {
    await page.selectOption('.values select', 'Everything');
    for (const tick of [0, 500, 1000]) {
      await page.evaluate((to) => window.rehearse.go(to), tick);
      await page.fill('.values input', 'SR1/WAIST/position');
      await settled(page);
      const { links, table, frames, joints } = await state_of(page);
      ['x', 'y', 'z'].forEach((axis, i) =>
        assert.equal(Number(table[`SR1/WAIST/position/${axis}`].actual).toFixed(4), links['SR1/WAIST'][i].toFixed(4)),
      );
      assert.ok(links['SR1/WAIST'][2] > 0.5 && links['SR1/RLEG_ANKLE_R'][2] < 0.2, 'it stands');
      await page.fill('.values input', 'SR1/RLEG_KNEE/q');
      await settled(page);
      assert.equal((await state_of(page)).table['SR1/RLEG_KNEE/q'].actual, joints['SR1/RLEG_KNEE/q'].toFixed(6));
      for (const { actual, expected } of Object.values(frames)) {
        assert.equal(actual, expected);
        assert.ok(
          tick === 0 || (actual <= tick && actual > tick - 40),
          `the picture of tick ${actual} at tick ${tick}`,
        );
      }
    }
  });
});

test('its file is at most one and a half times the recordings in it, besides the page', () => {
  const page = statSync(process.env.REPORT_PAGE).size;
  const recordings = statSync(made.trace).size + statSync(golden).size;
  assert.ok(statSync(made.report).size - page <= 1.5 * recordings);
});

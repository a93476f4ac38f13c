// The report and a page of coverage in both widths and themes, by axe's rules; and where the parts of a report stand.
import assert from 'node:assert/strict';
import { before, test } from 'node:test';
import { expect_a_good_page, faults_of, keep_picture, looks } from './axe.mjs';
import { report_file, settled, with_file } from './bench.mjs';
import { coverage_of, walk } from './covered.mjs';

const run = { ticks: 2000, channels: 60, cameras: 1, picture_every: 50, noise: false };
const call_stack = {
  controller: 'Walker/Walk',
  command: 'RIGHT_KNEE/u',
  tick: 640,
  frames: [{ function: 'Walk::control()', file: 'walk.cpp', line: 2, begin: 1, source: ['// walks', 'u = 1;'] }],
};
const covered = { ...run, golden: false, cameras: 0, coverage: coverage_of([walk]) };
const files = {};

before(() => {
  files.coverage = report_file({ ...covered, coverage_alone: true });
  files.report = report_file(run);
});

for (const name of ['report', 'coverage'])
  for (const look of looks)
    test(`${name}, ${look.name}`, async () => {
      await with_file(files[name], look.how, async (opened) => {
        const { page } = opened;
        await settled(page);
        await keep_picture(page, name, look.how, false);
        for (const tab of await page.$$eval('[role=tab]', (all) => all.map(({ id }) => id))) {
          await page.click(`#${tab}`);
          await settled(page);
          assert.deepEqual(await faults_of(page), [], tab);
        }
        await expect_a_good_page(opened, look.how);
      });
    });

test('the report’s tools stand in one row, and its note beside the robot', async () => {
  for (const ticks of [1500, 60_000]) {
    await with_file(report_file({ ...run, ticks, call_stack }), { width: 1280, height: 720 }, async ({ page }) => {
      await settled(page);
      const rows = await page.$$eval('.transport .group', (all) => new Set(all.map((one) => one.offsetTop)).size);
      assert.equal(rows, 1);
      const { robot } = await page.evaluate(() => window.rehearse.state());
      const scene = await page.locator('.scene').boundingBox();
      const note = await page.locator('.robot .note').boundingBox();
      const is_left = note.x + note.width <= scene.x + robot.left;
      const is_above = note.y + note.height <= scene.y + robot.top;
      const is_below = note.y >= scene.y + robot.top + robot.height;
      assert.ok(is_left || is_above || is_below, JSON.stringify({ robot, note, scene }));
    });
  }
});

test('buttons are named as their text says, and splitters state their share', async () => {
  await with_file(files.report, {}, async ({ page }) => {
    await settled(page);
    const named = await page.$$eval('button', (all) =>
      all.filter((one) => /[a-z]/i.test(one.textContent) && (one.ariaLabel ?? one.textContent) !== one.textContent),
    );
    assert.equal(named.length, 0);
    const shares = await page.$$eval('.splitter', (all) => all.map((one) => Number(one.getAttribute('aria-valuenow'))));
    assert.equal(shares.length, 3);
    for (const share of shares) assert.ok(share > 20 && share < 90, `${shares}`);
  });
});

test('the report says where it opens', async () => {
  await with_file(files.report, {}, async ({ page }) => {
    assert.equal(
      (await page.textContent('.opening')).trim(),
      'The page opened there, at the first difference beyond tolerance.',
    );
  });
  await with_file(files.report, { hash: '#tick=900' }, async ({ page }) => {
    assert.equal((await page.textContent('.opening')).trim(), 'Opened at tick 900, which the link names.');
  });
});

test('a coverage is usable on a telephone: code, ticks, files and functions', async () => {
  await with_file(files.coverage, { width: 420, height: 900 }, async ({ page }) => {
    await page.waitForSelector('.lines [role=listitem]');
    const code = await page.locator('.line.executed code').first().boundingBox();
    assert.ok(code.x < 0.4 * 420, `code begins at ${code.x}`);
    assert.ok(await page.isVisible('.outline .entry'));
    assert.equal(await page.getAttribute('.outline .spacer > *', 'role'), 'listitem');
  });
});

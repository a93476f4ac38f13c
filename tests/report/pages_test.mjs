// The pages without a recording in both widths and themes, by axe's rules; filters, charts and keys.
import assert from 'node:assert/strict';
import { mkdirSync } from 'node:fs';
import { before, test } from 'node:test';
import { expect_a_good_page, faults_of, keep_picture, looks } from './axe.mjs';
import { report_file, scratch_file, with_file } from './bench.mjs';
import { small_pages } from './small_pages.mjs';

const files = {};

before(() => {
  for (const [name, make] of Object.entries(small_pages)) {
    const folder = scratch_file(name);
    mkdirSync(folder);
    files[name] = make(folder);
  }
});

for (const name of Object.keys(small_pages))
  for (const look of looks)
    test(`${name}, ${look.name}`, async () => {
      await with_file(files[name], { ...look.how, ready: false }, async (opened) => {
        await opened.page.waitForLoadState('load');
        await keep_picture(opened.page, name, look.how, true);
        assert.deepEqual(await faults_of(opened.page), []);
        await expect_a_good_page(opened, look.how);
      });
    });

const open = (name, use) =>
  with_file(files[name], { ready: false }, async ({ page }) => {
    await page.waitForLoadState('load');
    await use(page);
  });

test('the style sheets of all pages are the same files', async () => {
  const colors = {};
  const all = { ...files, report: report_file({ ticks: 200, channels: 4, cameras: 0 }) };
  for (const name of Object.keys(all))
    await with_file(all[name], { ready: name === 'report' }, async ({ page }) => {
      colors[name] = await page.evaluate(() => {
        const style = getComputedStyle(document.documentElement);
        return ['--ground', '--panel', '--text', '--bad', '--good', '--actual'].map((one) =>
          style.getPropertyValue(one),
        );
      });
    });
  for (const name of Object.keys(files)) assert.deepEqual(colors[name], colors.report, name);
});

test('the theme key works on every page', async () => {
  for (const name of Object.keys(small_pages))
    await open(name, async (page) => {
      const ground = () => page.evaluate(() => getComputedStyle(document.body).backgroundColor);
      const light = await ground();
      await page.keyboard.press('t');
      assert.notEqual(await ground(), light);
      await page.keyboard.press('?');
      assert.ok(await page.isVisible('dialog'));
      await page.click('#close');
      assert.ok(!(await page.isVisible('dialog')));
    });
});

test('the index has commit, moment and duration, previous runs, a filter and a search', async () => {
  await open('index', async (page) => {
    const rows = () =>
      page.$$eval('.tests tbody tr', (all) => all.filter((row) => !row.hidden).map((row) => row.innerText));
    const all = await rows();
    assert.match(all[0], /with_a_mistake/, 'what can’t be judged comes first');
    assert.match(all[1], /falls/, 'then what differs');
    assert.match(all[1], /commit c0ffee1/);
    assert.match(all[1], /2026-11-20 \d\d:\d\d UTC/);
    assert.match(all[1], /\d\.\d\d s/);
    assert.equal((await rows()).length, 3);
    await page.selectOption('select', 'passed');
    assert.deepEqual((await rows()).length, 1);
    await page.selectOption('select', 'failed');
    assert.deepEqual((await rows()).length, 2);
    await page.selectOption('select', '');
    await page.keyboard.press('Escape');
    await page.keyboard.press('/');
    await page.keyboard.type('mistake');
    assert.match((await rows()).join(), /with_a_mistake/);
    assert.equal((await rows()).length, 1);
    assert.equal(await page.textContent('.tools output'), '1 of 3');
    await page.fill('input', '');
    const marks = page.locator('tr:has-text("falls") .runs button');
    assert.deepEqual(await marks.allTextContents(), ['✕', '✓']);
    await marks.first().click();
    assert.match(await page.textContent('tr:has-text("falls") .runs + output'), /^2026-11-18 .*commit a41c2e9: /);
    await page.keyboard.press('n');
    assert.match(await page.evaluate(() => document.activeElement.innerText), /with_a_mistake/);
    await page.keyboard.press('n');
    assert.match(await page.evaluate(() => document.activeElement.innerText), /falls/);
  });
});

test('a history shows the bound, the jump’s commit and the dates, and tells each value', async () => {
  await open('history', async (page) => {
    const panels = await page.$$eval('.trend h2', (all) => all.map((one) => one.textContent));
    assert.match(panels[0], /^Arm\/SHOULDER\/q within/, 'what drifts comes first');
    assert.match(panels[1], /^the magnitude of/, 'then what jumps');
    const jump = page.locator('.trend', { hasText: 'the magnitude of' });
    assert.match(await jump.locator('.across .jump').innerText(), /^[0-9a-f]{7}\n2026-11-14$/);
    assert.match(await page.innerText('.across .first'), /^3f2a1bc\n2026-11-05$/);
    assert.equal(await page.innerText('.up .bound'), 'bound');
    assert.ok((await page.locator('line.rule').count()) === 4);
    const area = page.locator('.area').first();
    const box = await area.boundingBox();
    await page.mouse.move(box.x + 3, box.y + 20);
    const told = page.locator('.chart output').first();
    assert.match(
      await told.textContent(),
      /^commit 3f2a1bc, 2026-11-05: margin 0\.0243 rad, 46\.4 % of the bound, value 0\.0281 rad at tick 1999$/,
    );
    await area.focus();
    await page.keyboard.press('ArrowRight');
    assert.match(await told.textContent(), /2026-11-06: margin 0\.0239 rad/);
    assert.equal(await area.getAttribute('aria-valuetext'), await told.textContent());
    const broken = await page.evaluate(() =>
      [...document.querySelectorAll('.up span, .across span, .last b')].filter(
        (one) => one.getClientRects().length > 2,
      ),
    );
    assert.deepEqual(broken, [], 'numbers stay on a line');
  });
});

test('a campaign begins with its failures and names the violated expectation; axes have labels', async () => {
  await open('campaign', async (page) => {
    assert.match(
      await page.textContent('.sentence'),
      /^Most often violated in \d+ cases: Box\/Box\/position\/z above 0\.5 m/,
    );
    assert.equal(await page.locator('main h2').first().textContent(), 'Failures');
    for (const picture of await page.$$('.pictures svg'))
      assert.ok((await picture.$$eval('.axis', (all) => all.filter((one) => one.textContent).length)) >= 2);
  });
});

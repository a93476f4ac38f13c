// The coverage of controllers beside their sources: in the report of a run, and alone.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { settled, state_of, with_report } from './bench.mjs';
import { contrasts } from './contrasts.mjs';
import { at, coverage_of, covered, walk } from './covered.mjs';

const run = { ticks: 1500, channels: 40, cameras: 0 };
const high = { width: 1280, height: 1500 };

const current_line = '.lines .current:not([hidden])';
const row = (page, line) => page.locator(`.lines .line:not([hidden]):has(.number:text-is("${line}"))`);

async function open_tab(page) {
  await settled(page);
  await page.click('#tab-coverage');
  await page.waitForSelector('.lines .line:nth-child(3)'); // the list has its height
}

test('each line has the tick of its first execution, to which a click moves the cursor', async () => {
  await with_report({ ...run, coverage: coverage_of([walk]) }, high, async ({ page, complaints }) => {
    await open_tab(page);
    assert.equal(await page.innerText('#tab-coverage'), 'Coverage (4 of 7)');
    assert.equal(await row(page, 3).locator('.when').innerText(), 'before the run');
    assert.equal(await row(page, 3).locator('button:visible').count(), 0, 'no tick of the run');
    assert.equal(await row(page, 1).locator('.when').innerText(), '', 'no code');
    assert.equal(await row(page, 10).locator('button').innerText(), 'tick 1400, 1.400 s');
    await row(page, 10).locator('button').click();
    await settled(page);
    assert.equal((await state_of(page)).tick, 1400);
    assert.deepEqual(complaints, []);
  });
});

test('lines that never run have a colour and a word, branches that went one way a mark', async () => {
  await with_report({ ...run, coverage: coverage_of([walk]) }, high, async ({ page }) => {
    await open_tab(page);
    const ground = (line) => row(page, line).evaluate((one) => getComputedStyle(one).backgroundColor);
    for (const line of [7, 8, 12]) {
      assert.equal(await row(page, line).locator('.when').innerText(), 'never');
      assert.notEqual(await ground(line), await ground(5));
    }
    assert.equal(await row(page, 6).locator('.ways').innerText(), '2 of 4 ways');
    assert.notEqual(await ground(6), await ground(5));
    assert.notEqual(await ground(6), await ground(7));
    assert.equal(await row(page, 10).locator('.ways').innerText(), '', 'the other way isn’t known');
    assert.match(
      await row(page, 6).getAttribute('title'),
      /way 1 of its branches: tick 640, 0\.640 s\nway 2 of its branches: never\nway 3 of its branches: unknown/,
    );
  });
});

test('no text of a source becomes a part of the page', async () => {
  await with_report({ ...run, coverage: coverage_of([walk]) }, high, async ({ page, complaints, requests }) => {
    await open_tab(page);
    assert.equal(await row(page, 7).locator('code').textContent(), walk.source[6]);
    assert.equal(await row(page, 8).locator('code').textContent(), '    &amp;fall();');
    assert.equal(await page.locator('.lines b').count(), 0);
    assert.doesNotMatch(await page.title(), /hit/);
    assert.deepEqual(complaints, []);
    assert.equal(requests.length, 1);
  });
});

test('files and functions have their shares, and lead to their lines', async () => {
  const other = { file: '/home/me/gait.cpp', source: ['int gait;'], lines: [covered(1, at(2), { name: 'gait(int)' })] };
  await with_report({ ...run, coverage: coverage_of([walk, other]) }, high, async ({ page }) => {
    await open_tab(page);
    const entries = await page.locator('.outline .entry:visible').allInnerTexts();
    assert.deepEqual(
      entries.slice(0, 4).map((text) => text.split(/\s+/).join(' ')),
      ['walk.cpp 4/7', 'Walk::Walk() 1/1', 'Walk::control() 3/5', 'Walk::stop() 0/1'],
    );
    assert.equal(await page.locator('.outline .incomplete:visible').count(), 3);
    await page.selectOption('.coverage select', { label: 'gait.cpp: 1 of 1 line' });
    await settled(page);
    assert.equal(await row(page, 1).locator('code').innerText(), 'int gait;');
    await page.click('.entry:has-text("Walk::stop()")');
    await settled(page);
    assert.equal(await page.locator(`${current_line} .number`).innerText(), '12');
  });
});

test('keys and buttons lead from one place that never runs to the next, also in another file', async () => {
  const other = { file: '/home/me/gait.cpp', source: ['a', 'b'], lines: [covered(1, at(2)), covered(2, null)] };
  await with_report({ ...run, coverage: coverage_of([walk, other]) }, high, async ({ page }) => {
    const current = async () => {
      await page.waitForSelector(current_line);
      await settled(page);
      const file = await page.locator('.coverage select option:checked').innerText();
      return `${file.split(':')[0]}:${await page.locator(`${current_line} .number`).innerText()}`;
    };
    await settled(page);
    const found = [];
    for (let i = 0; i < 4; ++i) {
      await page.keyboard.press('u');
      found.push(await current());
    }
    assert.deepEqual(found, ['walk.cpp:7', 'walk.cpp:12', 'gait.cpp:2', 'walk.cpp:7'], '8 is of the same place as 7');
    await page.keyboard.press('U');
    assert.equal(await current(), 'gait.cpp:2');
    await page.click('.coverage button:has-text("Previous")');
    assert.equal(await current(), 'walk.cpp:12');
    await page.click('.coverage button:has-text("Next")');
    assert.equal(await current(), 'gait.cpp:2');
    assert.match(await page.innerText('.coverage .tools .note'), /place 3 of 3/);
  });
});

test('a source that can’t be read has the numbers of its lines, and the reason', async () => {
  const unread = { ...walk, source: null, unread: '/home/me/walk.cpp can’t be read: No such file or directory' };
  await with_report({ ...run, coverage: coverage_of([unread]) }, high, async ({ page, complaints }) => {
    await open_tab(page);
    assert.match(await page.innerText('.coverage .unread'), /isn’t shown: .*No such file or directory\.$/);
    assert.equal(await row(page, 7).locator('.when').innerText(), 'never');
    assert.equal(await row(page, 12).locator('code').textContent(), '');
    assert.deepEqual(complaints, []);
  });
});

test('a page of recordings names the one that executes a line first', async () => {
  const lines = [covered(5, at(0, 'golden/Near.mcap'), { recordings: 2 }), covered(6, at(100, 'golden/Far.mcap'))];
  const remark = { severity: 'warning', message: 'gait.so: its lines aren’t known' };
  const coverage = coverage_of([{ ...walk, lines: [...lines, covered(7, null)] }], {
    recordings: ['golden/Near.mcap', 'golden/Far.mcap'],
    remarks: [remark],
    failure: 'Walk threw',
  });
  await with_report({ coverage, coverage_alone: true }, {}, async ({ page, complaints, requests }) => {
    await page.waitForSelector('.lines .line');
    assert.equal(await page.textContent('.state'), 'Coverage');
    assert.equal(await page.textContent('.sentence'), coverage.verdict);
    assert.equal(await row(page, 5).locator('.when').innerText(), 'tick 0, 0.000 s in Near');
    assert.equal(await row(page, 6).locator('.when').innerText(), 'tick 100, 0.100 s in Far');
    assert.match(await row(page, 5).getAttribute('title'), /in 2 of 2 recordings/);
    await page.click('.coverage summary');
    assert.deepEqual(await page.locator('.coverage li').allInnerTexts(), coverage.recordings);
    assert.match(await page.innerText('.coverage .facts'), /lines until then count: Walk threw/);
    assert.match(await page.innerText('.coverage .remark'), /its lines aren’t known/);
    await page.keyboard.press('u');
    await page.waitForSelector(`${current_line}.never`);
    assert.equal(await page.locator('#tab-provenance, .transport').count(), 0);
    assert.deepEqual(complaints, []);
    assert.equal(requests.length, 1);
  });
});

test('a source of 10,000 lines scrolls, and has elements only for the lines on the screen', async () => {
  const count = 10_000;
  const source = Array.from(
    { length: count },
    (_, i) => `  step(${i + 1});${i === 4999 ? ' '.repeat(400) + '// far' : ''}`,
  );
  const lines = source.map((_, i) => covered(i + 1, i === 8999 ? null : at(i % 1500), { name: `f${i % 2000}()` }));
  const coverage = coverage_of([{ file: '/home/me/large.cpp', source, lines }]);
  await with_report({ ...run, coverage }, {}, async ({ page, complaints }) => {
    await open_tab(page);
    await page.keyboard.press('u');
    await page.waitForSelector(`${current_line}.never`);
    await settled(page);
    assert.equal(await page.locator(`${current_line} code`).innerText(), '  step(9000);');
    const box = await page.locator(current_line).boundingBox();
    assert.ok(box.y > 0 && box.y + box.height < 800, 'it is on the screen');
    assert.ok((await page.locator('.lines .line').count()) < 100);
    assert.ok((await page.locator('.outline .entry').count()) < 100);
    const wide = await page.locator('.lines').evaluate((list) => list.scrollWidth > 2000);
    assert.ok(wide, 'the longest line can be scrolled to');
    assert.deepEqual(complaints, []);
  });
});

test('a report without a coverage has no such tab, and no such keys', async () => {
  await with_report(run, {}, async ({ page, complaints }) => {
    await settled(page);
    assert.equal(await page.locator('#tab-coverage').count(), 0);
    await page.keyboard.press('u');
    await page.keyboard.press('?');
    assert.doesNotMatch(await page.innerText('dialog'), /never run/);
    assert.deepEqual(complaints, []);
  });
});

for (const dark of [false, true]) {
  test(`is readable in ${dark ? 'dark' : 'light'}`, async () => {
    await with_report({ ...run, coverage: coverage_of([walk]) }, { ...high, dark }, async ({ page }) => {
      await open_tab(page);
      const found = await page.evaluate(contrasts, '.coverage');
      assert.ok(found.length > 40, `${found.length}`);
      assert.deepEqual(
        found.filter(({ contrast }) => contrast < 4.5),
        [],
      );
    });
  });
}

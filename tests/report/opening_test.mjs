// A report opens from disk, with any link, in dark and light, and reports its missing parts.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { page_text, report_file, settled, state_of, with_file, with_report, write_file } from './bench.mjs';
import { contrasts } from './contrasts.mjs';
import { readFileSync } from 'node:fs';

const small = { ticks: 1500, channels: 40, picture_every: 100 };

test('opens from disk without a complaint, and asks for nothing but itself', async () => {
  await with_report(small, {}, async ({ page, complaints, requests }) => {
    await settled(page);
    assert.deepEqual(complaints, []);
    assert.equal(requests.length, 1);
    assert.match(requests[0], /^file:.*report_\d+\.html$/);
    assert.match(await page.textContent('h1'), /Walk/);
    assert.match(await page.textContent('.sentence'), /Tick 640/);
    assert.equal(await page.textContent('.state'), 'Expectation violated');
  });
});

test('opens at the first divergence; violated series are plotted first, then the command that diverges', async () => {
  await with_report(small, {}, async ({ page }) => {
    await settled(page);
    const { tick, shown, plots } = await state_of(page);
    assert.equal(tick, 640);
    assert.deepEqual(shown.slice(0, 3), ['Walker/RIGHT_KNEE/q', 'Walker/root/z', 'Walker/RIGHT_KNEE/u']);
    assert.equal(plots['Walker/RIGHT_KNEE/u'], 640);
  });
});

test('a link opens at its moment, with its series and its view', async () => {
  const hash = '#tick=900&series=Walker/LEFT_HIP/q,Plant/section_04/signal_36&view=800..1000';
  await with_report(small, { hash }, async ({ page }) => {
    await settled(page);
    const { tick, shown, view } = await state_of(page);
    assert.equal(tick, 900);
    assert.deepEqual(shown, ['Walker/LEFT_HIP/q', 'Plant/section_04/signal_36']);
    assert.deepEqual(view, { begin: 800, end: 1000 });
    await page.evaluate(() => (location.hash = '#tick=42'));
    await page.waitForFunction(() => window.rehearse.tick === 42);
  });
});

test('a link to what isn’t there opens as near as can be', async () => {
  await with_report(
    small,
    { hash: '#tick=999999&series=No/such,Walker/LEFT_HIP/q,%E0%A4%A' },
    async ({ page, complaints }) => {
      const { tick, shown } = await state_of(page);
      assert.equal(tick, 1499);
      assert.deepEqual(shown, ['Walker/LEFT_HIP/q']);
      assert.deepEqual(complaints, []);
    },
  );
});

test('a filter finds messages that are not listed', async () => {
  await with_report({ ...small, lines: 12_345 }, {}, async ({ page, complaints }) => {
    await settled(page);
    await page.click('#tab-messages');
    assert.equal(await page.textContent('#tab-messages'), 'Messages (12345)');
    assert.match(await page.textContent('.messages .note'), /of 12.345 messages, from tick 0; a filter searches all$/);
    await page.fill('.messages input', 'line 12344');
    await page.waitForFunction(() =>
      document.querySelector('.messages .note')?.textContent?.match(/^1 found in 12.345 messages$/),
    );
    const row = '.messages .message:not([hidden])';
    assert.equal(await page.textContent(`${row} .text`), 'line 12344');
    await page.click(row);
    await page.waitForFunction(() => window.rehearse.tick === 1499);
    await page.fill('.messages input', '');
    await page.waitForFunction(() => document.querySelectorAll('.messages .message:not([hidden])').length > 1);
    assert.deepEqual(complaints, []);
  });
});

test('the address follows cursor and plots', async () => {
  await with_report(small, { hash: '#series=Walker/LEFT_HIP/q' }, async ({ page }) => {
    await page.evaluate(() => window.rehearse.go(321));
    await page.waitForFunction(() => location.hash === '#tick=321&series=Walker/LEFT_HIP/q');
  });
});

for (const dark of [false, true]) {
  test(`is readable in ${dark ? 'dark' : 'light'}`, async () => {
    await with_report(small, { dark }, async ({ page }) => {
      await settled(page);
      for (const tab of ['values', 'expectations', 'divergences', 'messages', 'provenance', 'scenario']) {
        await page.click(`#tab-${tab}`);
        await settled(page);
        const found = await page.evaluate(contrasts);
        assert.ok(found.length > 40);
        assert.deepEqual(
          found.filter(({ contrast }) => contrast < 4.5),
          [],
        );
      }
    });
  });
}

test('the theme is that of the system, until a key changes it', async () => {
  const ground = (page) => page.evaluate(() => getComputedStyle(document.body).backgroundColor);
  await with_report(small, { dark: true }, async ({ page }) => {
    const dark = await ground(page);
    await page.keyboard.press('t');
    await settled(page);
    const light = await ground(page);
    assert.notEqual(dark, light);
    await page.emulateMedia({ colorScheme: 'light' });
    assert.equal(await ground(page), light);
  });
});

for (const width of [900, 420]) {
  test(`fits a window of ${width} pixels, with letters of 12 pixels or more`, async () => {
    await with_report(small, { width, height: 900 }, async ({ page }) => {
      await settled(page);
      const wide = await page.evaluate(() => document.documentElement.scrollWidth);
      assert.ok(wide <= width, `it is ${wide} pixels wide`);
      for (const tab of ['values', 'expectations', 'divergences', 'messages', 'provenance', 'scenario']) {
        await page.click(`#tab-${tab}`);
        await settled(page);
        const beyond = await page.evaluate((right) => {
          const parts = [...document.querySelectorAll('button, input, select, .sentence, h1, .note, [role=tab]')];
          return parts
            .filter((part) => part.offsetParent !== null && part.getBoundingClientRect().right > right)
            .map((part) => part.outerHTML.slice(0, 100));
        }, width);
        assert.deepEqual(beyond, []);
        const small_text = await page.evaluate(() =>
          [...document.querySelectorAll('#app *')]
            .filter((part) => part.offsetParent !== null && part.textContent.trim() !== '')
            .filter((part) => parseFloat(getComputedStyle(part).fontSize) < 12)
            .map((part) => part.outerHTML.slice(0, 100)),
        );
        assert.deepEqual(small_text, []);
      }
    });
  });
}

test('the robot is at least 300 pixels high in a window of 1280 x 720, and all panels are on the screen', async () => {
  await with_report(small, { width: 1280, height: 720 }, async ({ page }) => {
    await settled(page);
    const { robot } = await state_of(page);
    assert.ok(robot.height >= 300, `it is ${robot.height} pixels high`);
    const below = await page.evaluate(
      () =>
        [...document.querySelectorAll('.top, .panel, .lower')].filter(
          (panel) => panel.getBoundingClientRect().bottom > innerHeight,
        ).length,
    );
    assert.equal(below, 0);
  });
});

test('the camera goes along with the robot to the end of the run', async () => {
  await with_report({ ...small, ticks: 9000 }, { width: 1280, height: 720 }, async ({ page }) => {
    await settled(page);
    const { robot, links } = await state_of(page);
    await page.keyboard.press('End');
    await settled(page);
    const at_end = await state_of(page);
    assert.ok(at_end.links['Walker/WAIST'][0] - links['Walker/WAIST'][0] > 1.5, 'it walks');
    assert.ok(Math.abs(at_end.robot.height - robot.height) < 0.2 * robot.height);
    const [x, y] = at_end.robot.centre;
    assert.ok(Math.abs(x) < 0.5 && Math.abs(y) < 0.5, `it is at ${x}, ${y} of the view`);
  });
});

test('splitters are seen, dragged, moved by keys, remembered, and restored by a double click', async () => {
  const width_of = (page) => page.evaluate(() => document.querySelector('.left').getBoundingClientRect().width);
  await with_report(small, {}, async ({ page }) => {
    const before = await width_of(page);
    const bars = page.locator('.splitter');
    assert.equal(await bars.count(), 3);
    for (const bar of await bars.all()) {
      const grip = await bar.evaluate((one) => {
        const style = getComputedStyle(one, '::after');
        return { color: style.backgroundColor, size: [parseFloat(style.width), parseFloat(style.height)] };
      });
      assert.notEqual(grip.color, 'rgba(0, 0, 0, 0)');
      assert.ok(Math.min(...grip.size) >= 3 && Math.max(...grip.size) >= 40);
    }
    const upright = page.locator('.splitter.upright');
    const box = await upright.boundingBox();
    await page.mouse.move(box.x + 4, box.y + 100);
    await page.mouse.down();
    await page.mouse.move(box.x + 154, box.y + 100, { steps: 3 });
    await page.mouse.up();
    const dragged = await width_of(page);
    assert.ok(Math.abs(dragged - before - 150) < 4, `${before} became ${dragged}`);
    await page.reload();
    await page.waitForFunction(() => window.rehearse !== undefined);
    assert.ok(Math.abs((await width_of(page)) - dragged) < 2, 'remembered');
    await upright.focus();
    await page.keyboard.press('ArrowLeft');
    assert.ok((await width_of(page)) < dragged - 10);
    await upright.dblclick();
    assert.ok(Math.abs((await width_of(page)) - before) < 2, 'restored');
  });
});

test('a browser that refuses storage shows the page all the same', async () => {
  await with_report(small, { no_storage: true }, async ({ page, complaints }) => {
    await settled(page);
    await page.locator('.splitter.upright').focus();
    await page.keyboard.press('ArrowLeft');
    await page.keyboard.press('t');
    await settled(page);
    assert.deepEqual(complaints, []);
  });
});

test('all violated expectations are in the verdict; a click leads there, a run alone has them, too', async () => {
  for (const golden of [true, false]) {
    await with_report({ ...small, golden, fails: true }, {}, async ({ page }) => {
      await settled(page);
      assert.equal(await page.locator('.violation').count(), 2);
      await page.click('.violation >> nth=1');
      await settled(page);
      assert.equal((await state_of(page)).tick, 1499);
      await page.click('.violation >> nth=0');
      await settled(page);
      assert.equal((await state_of(page)).tick, 1321);
      assert.deepEqual((await state_of(page)).shown.slice(0, 2), ['Walker/RIGHT_KNEE/q', 'Walker/root/z']);
      await page.keyboard.press('Home');
      await page.keyboard.press('v');
      await settled(page);
      assert.equal((await state_of(page)).tick, 1321);
      await page.click('#tab-expectations');
      assert.match(await page.innerText('#panel-expectations'), /2 of 3 expectations are violated[^]*150 N·m/);
    });
  }
});

test('the controller’s source line is one click away, if the report has it', async () => {
  const source = Array.from({ length: 17 }, (_, i) => `  line_of_code(${62 + i});`);
  const frames = [{ function: 'Walk::control', file: '/home/me/walk.cpp', line: 70, begin: 62, source }];
  const call_stack = { controller: 'Walker/Walk', command: 'KNEE/u', tick: 640, frames };
  await with_report({ ...small, call_stack }, { width: 1280, height: 720 }, async ({ page }) => {
    await page.keyboard.press('End');
    await page.click('button:has-text("Source line")');
    await settled(page);
    assert.equal((await state_of(page)).tick, 640);
    assert.match(await page.innerText('.call-stack'), /#0 Walk::control \/home\/me\/walk\.cpp:70/);
    const current = page.locator('.source .current');
    assert.equal(await current.innerText(), '70    line_of_code(70);');
    const box = await current.boundingBox();
    assert.ok(box.y > 0 && box.y + box.height < 720, 'it is on the screen');
  });
  await with_report(small, {}, async ({ page }) => {
    assert.equal(await page.locator('button:has-text("Source line"), #tab-source').count(), 0);
  });
});

test('the times of control() have a histogram, and the longest call is one click away', async () => {
  const times = {
    controller: 'Walker/Walk',
    period: 0.001,
    calls: 1000,
    median: 5e-6,
    p999: 2e-5,
    longest: 0.0012,
    longest_tick: 640,
    histogram: [
      [4.9e-6, 400],
      [5.0e-6, 500],
      [2e-5, 99],
      [0.0012, 1],
    ],
  };
  await with_report({ ...small, control_times: [times] }, {}, async ({ page }) => {
    await page.click('#tab-times');
    const text = await page.innerText('#panel-times');
    assert.match(text, /median 5 µs, 99\.9 % within 20 µs, longest 1200 µs: 120 % of the period/);
    const rows = page.locator('.times > div');
    assert.equal(await rows.count(), 25, 'ten bins a decade, from 5.01 µs to 1.26 ms');
    assert.match(await rows.first().innerText(), /≤ 5\.01 µs\s+900/);
    assert.equal(await page.locator('.times .late').count(), 1);
    await page.click('#panel-times button');
    await settled(page);
    assert.equal((await state_of(page)).tick, 640);
  });
  await with_report(small, {}, async ({ page }) => {
    assert.equal(await page.locator('#tab-times').count(), 0);
  });
});

test('a run alone opens with its root, its contacts and its largest commands', async () => {
  await with_report({ ...small, golden: false, cameras: 0 }, {}, async ({ page }) => {
    await settled(page);
    const { shown } = await state_of(page);
    assert.deepEqual(shown.slice(0, 4), [
      'Walker/root/z',
      'Walker/root/x',
      'contact Walker/LEFT_FOOT – Floor',
      'contact Walker/RIGHT_FOOT – Floor',
    ]);
    assert.match(shown[4], /\/u$/);
  });
});

test('a run without a difference opens where its cameras have their first pictures', async () => {
  for (const [first_picture, golden] of [
    [200, false],
    [0, true],
  ]) {
    await with_report({ ...small, golden, equal: true, first_picture }, {}, async ({ page }) => {
      await settled(page);
      assert.equal((await state_of(page)).tick, first_picture);
    });
  }
});

test('levels are in the order of verdicts, and notes are below the sentence', async () => {
  const levels = { closed: 'differs', controller: 'equal', plant: 'not compared' };
  const notes = ['walk.cpp is newer than Walk.so: built before your last change'];
  await with_report({ ...small, levels, notes }, {}, async ({ page }) => {
    assert.deepEqual(await page.locator('.levels .level').allInnerTexts(), [
      'controller equal',
      'plant not compared',
      'closed differs',
    ]);
    assert.equal(await page.innerText('.verdict .remark'), `note: ${notes[0]}`);
  });
});

test('different bits within tolerance are no red "Beyond tolerance"', async () => {
  await with_report({ ...small, state: 'bits' }, {}, async ({ page }) => {
    assert.equal(await page.textContent('.state'), 'Other bits, within tolerance');
  });
});

const absences = [
  {
    what: 'a golden',
    options: { ...small, golden: false },
    says: ['One run'],
    provenance: /no golden/,
    without: '.plot .difference:not(:empty), .legend, #tab-divergences',
  },
  {
    what: 'differences',
    options: { ...small, equal: true },
    says: ['Equal'],
    provenance: /do not differ in any bit/,
    without: '.primary:not(dialog *), #tab-divergences',
  },
  {
    what: 'cameras',
    options: { ...small, cameras: 0 },
    says: [],
    provenance: /no camera pictures[^]*Point clouds are left out/,
    without: '.cameras, .left .splitter',
  },
  {
    what: 'robots',
    options: { ...small, robot: false, cameras: 0 },
    says: [],
    provenance: /no model of a robot/,
    without: '.scene, .left, .splitter.upright, #tab-expectations',
  },
  {
    what: 'messages',
    options: { ...small, events: false },
    says: [],
    provenance: /no messages/,
    without: '#tab-messages',
  },
  {
    what: 'channels',
    options: { ...small, channels: 0, events: false },
    says: [],
    provenance: /no channels of numbers/,
    without: '.plots, #tab-values',
  },
  {
    what: 'ticks',
    options: { ...small, ticks: 0, channels: 20 },
    says: ['no tick was recorded'],
    provenance: /No tick was recorded/,
    without: '.plots, .timeline, .transport',
  },
];

for (const { what, options, says, provenance, without } of absences) {
  test(`has no empty panel: a report without ${what}`, async () => {
    await with_report(options, {}, async ({ page, complaints }) => {
      await settled(page);
      const text = await page.innerText('#app');
      for (const sentence of says) assert.ok(text.includes(sentence), `"${sentence}" is not in:\n${text}`);
      assert.equal(await page.locator(without).count(), 0);
      await page.click('#tab-provenance');
      assert.match(await page.innerText('#panel-provenance'), provenance);
      for (const key of ['d', 'n', 'ArrowRight', ' ', 'End', 'Home', 'z', 'a']) await page.keyboard.press(key);
      await settled(page);
      assert.deepEqual(complaints, []);
    });
  });
}

test('the page without data says so', async () => {
  await with_file(write_file('empty.html', page_text), { ready: false }, async ({ page, complaints }) => {
    await page.waitForSelector('.absence');
    assert.match(await page.innerText('#app'), /holds no data/);
    assert.deepEqual(complaints, []);
  });
});

test('data of a format to come are refused with a sentence', async () => {
  const text = readFileSync(report_file(small), 'utf8').replace('{"format":1,', '{"format":2,');
  await with_file(write_file('format_2.html', text), { ready: false }, async ({ page }) => {
    await page.waitForSelector('.absence');
    assert.match(await page.innerText('#app'), /have format 2; this page knows format 1/);
  });
});

test('a damaged blob is told in the plot that needs it, and nowhere else', async () => {
  const text = readFileSync(report_file(small), 'utf8');
  const { series } = JSON.parse(text.match(/id="report">(.*)<\/script>/)[1]);
  const { id } = series.find((one) => one.name === 'Plant/section_04/signal_36').values;
  const damaged = text.replace(new RegExp(`(id="${id}">).{40}`), '$1');
  const hash = '#tick=10&series=Plant/section_04/signal_36,Walker/LEFT_HIP/q';
  await with_file(write_file('damaged.html', damaged), { hash }, async ({ page }) => {
    await page.waitForSelector('.absence.error');
    assert.equal(await page.locator('.absence.error').count(), 1);
    assert.equal((await state_of(page)).plots['Walker/LEFT_HIP/q'], 10);
  });
});

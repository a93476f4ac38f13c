// A report opens from disk, with any link, in dark and light, and reports its missing parts.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { page_text, report_file, settled, state_of, with_file, with_report, write_file } from './bench.mjs';
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
    assert.equal(await page.textContent('.state'), 'Beyond tolerance');
  });
});

test('opens at the first divergence, with its series and the command beside it plotted', async () => {
  await with_report(small, {}, async ({ page }) => {
    await settled(page);
    const { tick, shown, plots } = await state_of(page);
    assert.equal(tick, 640);
    assert.equal(shown[0], 'Walker/RIGHT_KNEE/u');
    assert.ok(shown.includes('Walker/RIGHT_KNEE/q'));
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

test('the address follows cursor and plots', async () => {
  await with_report(small, { hash: '#series=Walker/LEFT_HIP/q' }, async ({ page }) => {
    await page.evaluate(() => window.rehearse.go(321));
    await page.waitForFunction(() => location.hash === '#tick=321&series=Walker/LEFT_HIP/q');
  });
});

// WCAG's contrast of text with its background.
function contrasts() {
  const channel = (value) => (value <= 0.03928 ? value / 12.92 : ((value + 0.055) / 1.055) ** 2.4);
  const numbers = (color) => color.match(/[\d.]+/g).map(Number);
  const luminance = ([r, g, b]) => 0.2126 * channel(r / 255) + 0.7152 * channel(g / 255) + 0.0722 * channel(b / 255);
  const ground_of = (element) => {
    for (let at = element; at; at = at.parentElement) {
      const color = numbers(getComputedStyle(at).backgroundColor);
      if (color.length < 4 || color[3] > 0.99) return color;
    }
    return [255, 255, 255];
  };
  const found = [];
  for (const element of document.querySelectorAll(
    'button, span, h1, h2, h3, p, th, td, label, output, select, input',
  )) {
    const text = [...element.childNodes]
      .filter((node) => node.nodeType === 3)
      .map((node) => node.textContent.trim())
      .join('');
    if (!text || element.disabled || element.offsetParent === null) continue;
    const [a, b] = [luminance(numbers(getComputedStyle(element).color)), luminance(ground_of(element))];
    found.push({ text, contrast: (Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05) });
  }
  return found;
}

for (const dark of [false, true]) {
  test(`is readable in ${dark ? 'dark' : 'light'}`, async () => {
    await with_report(small, { dark }, async ({ page }) => {
      await settled(page);
      for (const tab of ['values', 'divergences', 'messages', 'provenance', 'scenario']) {
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

test('fits a window of 900 pixels', async () => {
  await with_report(small, { width: 900 }, async ({ page }) => {
    await settled(page);
    const wide = await page.evaluate(() => document.documentElement.scrollWidth);
    assert.ok(wide <= 900, `it is ${wide} pixels wide`);
  });
});

const absences = [
  {
    what: 'a golden',
    options: { ...small, golden: false },
    says: ['One run'],
    tabs: { divergences: /no golden/ },
    without: '.plot .difference:not(:empty), .legend',
  },
  {
    what: 'differences',
    options: { ...small, equal: true },
    says: ['Equal'],
    tabs: { divergences: /Nothing differs/ },
    without: '.primary:not(dialog *)',
  },
  {
    what: 'cameras',
    options: { ...small, cameras: 0 },
    says: ['no camera pictures'],
    tabs: { provenance: /Point clouds are left out/ },
  },
  { what: 'robots', options: { ...small, robot: false }, says: ['of no robot'], tabs: {} },
  { what: 'messages', options: { ...small, events: false }, says: [], tabs: { messages: /Nobody said anything/ } },
  { what: 'channels', options: { ...small, channels: 0 }, says: ['no channels of numbers'], tabs: {} },
  {
    what: 'ticks',
    options: { ...small, ticks: 0, channels: 20 },
    says: ['no tick was recorded', 'there is nothing to plot'],
    tabs: {},
  },
];

for (const { what, options, says, tabs, without } of absences) {
  test(`says what is missing: a report without ${what}`, async () => {
    await with_report(options, {}, async ({ page, complaints }) => {
      await settled(page);
      const text = await page.innerText('#app');
      for (const sentence of says) assert.ok(text.includes(sentence), `"${sentence}" is not in:\n${text}`);
      for (const [tab, sentence] of Object.entries(tabs)) {
        await page.click(`#tab-${tab}`);
        assert.match(await page.innerText(`#panel-${tab}`), sentence);
      }
      if (without) assert.equal(await page.locator(without).count(), 0);
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

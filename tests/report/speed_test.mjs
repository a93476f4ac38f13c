// The times of opening and scrubbing. The bounds are generous, because machines that run tests have other load. The
// measured values are printed, the best of three.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { report_file, with_file } from './bench.mjs';

const rounds = 3;

async function measured(file, hash, measure) {
  const results = [];
  for (let i = 0; i < rounds; ++i) {
    results.push(
      await with_file(file, { hash }, async (report) => {
        const found = await measure(report);
        assert.deepEqual(report.complaints, []);
        return { open: report.open_seconds, ...found };
      }),
    );
  }
  const best = (name, choose) => choose(...results.map((result) => result[name]));
  return { open: best('open', Math.min), rate: best('rate', Math.max), zoom: best('zoom', Math.min) };
}

async function scrub_and_zoom({ page }) {
  const rate = await page.evaluate(() => window.rehearse.scrub_rate(60));
  const zoom = await page.evaluate(async () => {
    const from = performance.now();
    document.body.dispatchEvent(new KeyboardEvent('keydown', { key: 'z', bubbles: true }));
    await new Promise((resolve) => requestAnimationFrame(() => requestAnimationFrame(resolve)));
    return (performance.now() - from) / 1000;
  });
  return { rate, zoom };
}

function print(t, { open, rate, zoom }) {
  t.diagnostic(
    `interactive in ${open.toFixed(2)} s, scrubs at ${rate.toFixed(0)} frames a second, zooms in ${zoom.toFixed(3)} s`,
  );
}

test('a minute with two cameras', async (t) => {
  const file = report_file({ ticks: 60000, channels: 60, cameras: 2, picture_every: 33, picture_size: [320, 240] });
  const found = await measured(file, '', scrub_and_zoom);
  print(t, found);
  assert.ok(found.open < 6);
  assert.ok(found.rate > 10);
});

test('a hundred thousand ticks of sixty channels, all of them plotted', async (t) => {
  const file = report_file({ ticks: 100000, channels: 60, cameras: 0 });
  const names = await with_file(file, {}, ({ page }) =>
    page.evaluate(() => JSON.parse(document.getElementById('report').textContent).series.map((one) => one.name)),
  );
  assert.equal(names.length, 60);
  const found = await measured(file, `#tick=50000&series=${names.join(',')}`, async (report) => {
    const { page } = report;
    assert.equal(await page.locator('.plot').count(), 60);
    await page.evaluate(async () => {
      const plots = document.querySelector('.plots');
      for (
        plots.scrollTop = 0;
        plots.scrollTop + plots.clientHeight < plots.scrollHeight - 2;
        plots.scrollTop += plots.clientHeight
      )
        await window.rehearse.settled();
    });
    return scrub_and_zoom(report);
  });
  print(t, found);
  assert.ok(found.open < 9);
  assert.ok(found.rate > 6);
  assert.ok(found.zoom < 3);
});

// Takes a picture that screenshot_test.cpp compares: node screenshots.mjs PAGE PICTURE NAME
// REHEARSE_COMMAND is in the environment, for pages without a recording.
import { mkdirSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { launch, open_report } from './browser.mjs';
import { coverage_of, walk } from './covered.mjs';
import { make_report } from './make_report.mjs';
import { small_pages } from './small_pages.mjs';

const options = { ticks: 2000, channels: 60, cameras: 1, picture_every: 50, noise: false };
const covered = {
  hash: '#tick=640',
  tab: 'coverage',
  options: { ...options, golden: false, cameras: 0, coverage: coverage_of([walk]) },
};
const shots = {
  light: { hash: '#tick=900', width: 1280, height: 720 },
  dark: { hash: '#tick=900&view=600..1200', width: 1280, height: 720, dark: true },
  wide_light: { width: 1920, height: 1080 },
  wide_dark: { hash: '#tick=900', width: 1920, height: 1080, dark: true },
  narrow_light: { hash: '#tick=900', width: 420, height: 900 },
  narrow_dark: { hash: '#tick=900', width: 420, height: 900, dark: true },
  alone: {
    hash: '#tick=300',
    width: 1280,
    height: 720,
    options: { ...options, golden: false, cameras: 0, events: false },
  },
  coverage_light: { ...covered, width: 1280, height: 900 },
  coverage_dark: { ...covered, width: 1280, height: 900, dark: true },
};
for (const name of ['coverage_page', ...Object.keys(small_pages)])
  for (const width of [1280, 420])
    for (const dark of [false, true])
      shots[`${name}_${width}_${dark ? 'dark' : 'light'}`] = {
        width,
        height: width > 500 ? 800 : 900,
        dark,
        make: small_pages[name],
        options: { ...covered.options, coverage_alone: true },
      };

const [page_file, picture, name] = process.argv.slice(2);
const shot = shots[name];
if (!shot) throw new Error(`there is no screenshot ${name}`);
const { options: own, tab, make, ...how } = shot;
const page_text = readFileSync(page_file, 'utf8');
const scratch = mkdtempSync(join(tmpdir(), 'rehearse_screenshots_'));
const browser = await launch();
try {
  const report = join(scratch, 'report.html');
  if (!make) writeFileSync(report, make_report(page_text, own ?? options));
  if (make) mkdirSync(join(scratch, 'project'));
  const file = make ? make(join(scratch, 'project')) : report;
  const { page } = await open_report(browser, file, { ...how, fonts: true, ready: !make });
  if (make) await page.waitForLoadState('load');
  else await page.evaluate(() => window.rehearse.settled());
  // how long a check took is another time each time
  if (make) await page.$$eval('.tests td:nth-child(5)', (all) => all.forEach((one) => (one.textContent &&= '0.10 s')));
  if (tab) {
    await page.click(`#tab-${tab}`);
    await page.waitForSelector('.lines .line:nth-child(3)');
  }
  await page.evaluate(() => document.fonts.ready);
  await page.screenshot({ path: picture, caret: 'hide' });
} finally {
  await browser.close();
  rmSync(scratch, { recursive: true, force: true });
}

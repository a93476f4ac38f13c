// Takes a picture that screenshot_test.cpp compares: node screenshots.mjs PAGE PICTURE NAME
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { launch, open_report } from './browser.mjs';
import { coverage_of, walk } from './covered.mjs';
import { make_report } from './make_report.mjs';

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

const [page_file, picture, name] = process.argv.slice(2);
const shot = shots[name];
if (!shot) throw new Error(`there is no screenshot ${name}`);
const { options: own, tab, ...how } = shot;
const page_text = readFileSync(page_file, 'utf8');
const scratch = mkdtempSync(join(tmpdir(), 'rehearse_screenshots_'));
const browser = await launch();
try {
  const file = join(scratch, 'report.html');
  writeFileSync(file, make_report(page_text, own ?? options));
  const { page } = await open_report(browser, file, { ...how, fonts: true });
  await page.evaluate(() => window.rehearse.settled());
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

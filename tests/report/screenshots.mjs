// Takes the pictures that screenshot_test.cpp compares: node screenshots.mjs PAGE FOLDER
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { launch, open_report } from './browser.mjs';
import { make_report } from './make_report.mjs';

const options = { ticks: 2000, channels: 60, cameras: 1, picture_every: 50 };
const shots = [
  { name: 'light', hash: '#tick=900' },
  { name: 'dark', hash: '#tick=900&view=600..1200', dark: true },
  { name: 'narrow', hash: '#tick=640', width: 900, height: 760 },
  { name: 'alone', hash: '#tick=300', options: { ...options, golden: false, cameras: 0, events: false } },
];

const [page_file, folder] = process.argv.slice(2);
const page_text = readFileSync(page_file, 'utf8');
const scratch = mkdtempSync(join(tmpdir(), 'rehearse_screenshots_'));
const browser = await launch();
try {
  for (const { name, options: own, ...how } of shots) {
    const file = join(scratch, `${name}.html`);
    writeFileSync(file, make_report(page_text, own ?? options));
    const { page, close } = await open_report(browser, file, { ...how, fonts: true });
    await page.evaluate(() => window.rehearse.settled());
    await page.evaluate(() => document.fonts.ready);
    await page.screenshot({ path: join(folder, `${name}.png`), caret: 'hide' });
    await close();
  }
} finally {
  await browser.close();
  rmSync(scratch, { recursive: true, force: true });
}

// Runs viewer_test.mjs, or prints why that is impossible and exits with 77, which means "skipped" for ctest.
import { existsSync } from 'node:fs';
import { chromium_path } from '../report/browser.mjs';

const here = (path) => new URL(path, import.meta.url);
const missing = [here('node_modules/@foxglove/studio-base'), here('../report/node_modules/playwright-core')].some(
  (folder) => !existsSync(folder),
);
if (missing || !chromium_path()) {
  const reason = missing ? 'run tools/setup, or `npm ci` in tests/viewer and tests/report' : 'there is no Chromium';
  console.log(`skipped: ${reason}`);
  process.exit(77);
}
await import(here('viewer_test.mjs'));

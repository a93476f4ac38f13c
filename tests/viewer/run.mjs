// Runs the test that its argument names, or prints why that is impossible and exits with 77, which means "skipped" for ctest.
import { existsSync } from 'node:fs';
import { chromium_path } from '../report/browser.mjs';

const here = (path) => new URL(path, import.meta.url);
const test = process.argv[2];
const packages = ['node_modules/@foxglove/studio-base', '../report/node_modules/playwright-core', '../interop/node_modules/@mcap/core'];
const missing = packages.some((folder) => !existsSync(here(folder)));
if (missing || (test !== 'serve_test.mjs' && !chromium_path())) {
  const reason = missing ? 'run tools/setup, or `npm ci` in tests/viewer, tests/report and tests/interop' : 'there is no Chromium';
  console.log(`skipped: ${reason}`);
  process.exit(77);
}
await import(here(test));

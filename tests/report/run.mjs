// Runs a file of tests, or prints why that is impossible and exits with 77, which means "skipped" for ctest.
//   node run.mjs PAGE TEST_FILE
import { existsSync } from 'node:fs';
import { resolve } from 'node:path';
import { pathToFileURL } from 'node:url';
import { chromium_path } from './browser.mjs';

const [page, file] = process.argv.slice(2);

function why_not() {
  if (['playwright-core', 'axe-core'].some((name) => !existsSync(new URL(`node_modules/${name}`, import.meta.url))))
    return 'what drives the browser is not installed: run tools/setup, or `npm ci` in tests/report';
  if (!chromium_path()) return 'Chromium is not installed (REHEARSE_CHROMIUM names one that stands elsewhere)';
  if (!existsSync(page))
    return 'the page of reports was not built: run tools/setup, or `npm ci` in tools/report, and build again';
  return null;
}

const reason = why_not();
if (reason) {
  console.log(`skipped: ${reason}`);
  process.exit(77);
}
process.env.REPORT_PAGE = resolve(page);
await import(pathToFileURL(resolve(file)));

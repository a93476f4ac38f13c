// The common parts of the tests: one browser, and reports in a temporary folder.
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before } from 'node:test';
import { launch, open_report } from './browser.mjs';
import { make_report } from './make_report.mjs';

const bench = { browser: null, folder: null };
const made = new Map();

export const page_text = readFileSync(process.env.REPORT_PAGE, 'utf8');

before(async () => {
  bench.folder = mkdtempSync(join(tmpdir(), 'rehearse_report_'));
  bench.browser = await launch();
});

after(async () => {
  await bench.browser?.close();
  if (bench.folder) rmSync(bench.folder, { recursive: true, force: true });
});

/** A file's name in the folder. */
export function scratch_file(name) {
  return join(bench.folder, name);
}

/** A file with that text. */
export function write_file(name, text) {
  const file = scratch_file(name);
  writeFileSync(file, text);
  return file;
}

/** A synthetic report's file; those of the same options are made once. */
export function report_file(options = {}) {
  const key = JSON.stringify(options);
  if (!made.has(key)) made.set(key, write_file(`report_${made.size}.html`, make_report(page_text, options)));
  return made.get(key);
}

/** Runs `use` with an opened report, then closes it. */
export async function with_file(file, how, use) {
  const report = await open_report(bench.browser, file, how);
  try {
    return await use(report);
  } finally {
    await report.close();
  }
}

export function with_report(options, how, use) {
  return with_file(report_file(options), how, use);
}

export function state_of(page) {
  return page.evaluate(() => window.rehearse.state());
}

/** Once what keys and mouse have caused is shown. */
export function settled(page) {
  return page.evaluate(() => window.rehearse.settled());
}

/** The right knee of the synthetic run at a tick: what its fault adds [rad]. */
export function strays(tick, fault = 640) {
  return 0.25 * (1 - Math.exp(-Math.max(0, tick - fault - 3) / 250));
}

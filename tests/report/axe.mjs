// The rules of axe, and what a page has to be in any window.
import assert from 'node:assert/strict';
import { mkdirSync, readFileSync } from 'node:fs';
import { join } from 'node:path';
import { contrasts } from './contrasts.mjs';

const axe = readFileSync(new URL('node_modules/axe-core/axe.min.js', import.meta.url), 'utf8');

/** What axe finds wrong in a page, in short. */
export async function faults_of(page) {
  await page.evaluate(axe);
  return page.evaluate(async () => {
    const { violations } = await window.axe.run(document, { resultTypes: ['violations'] });
    return violations.flatMap(({ id, nodes }) => nodes.map(({ html }) => `${id}: ${html.slice(0, 160)}`));
  });
}

/** Widths and themes in which each page is opened. */
export const looks = [1280, 420].flatMap((width) =>
  [false, true].map((dark) => ({
    name: `${width} pixels wide, ${dark ? 'dark' : 'light'}`,
    how: { width, height: width > 500 ? 800 : 900, dark, fonts: true },
  })),
);

/** Keeps a picture in the folder that SCREENSHOTS names, for a person to look at. */
export async function keep_picture(page, name, { width, dark }, fullPage) {
  await page.evaluate(() => document.fonts.ready);
  const folder = process.env.SCREENSHOTS;
  if (!folder) return;
  mkdirSync(folder, { recursive: true });
  await page.screenshot({ path: join(folder, `${name}_${width}_${dark ? 'dark' : 'light'}.png`), fullPage });
}

/** No complaint, one file, as wide as its window, with readable colours. */
export async function expect_a_good_page({ page, complaints, requests }, { width }) {
  const wide = await page.evaluate(() => document.documentElement.scrollWidth);
  assert.ok(wide <= width, `it is ${wide} pixels wide`);
  const found = await page.evaluate(contrasts);
  assert.deepEqual(
    found.filter(({ contrast }) => contrast < 4.5),
    [],
  );
  assert.deepEqual(complaints, []);
  assert.equal(requests.length, 1);
}

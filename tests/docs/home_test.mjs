// home_test.mjs SOURCE SITE: the home page of the built site has a picture, five lines of shell, a red verdict, and Learn and
// Playground before the other parts. In a window of 1280 pixels no line of a session is cut. Pages that have become
// sections lead there. Exit status 77: skipped.
import assert from 'node:assert/strict';
import { existsSync } from 'node:fs';
import { join } from 'node:path';
import { chromium_path, launch } from '../report/browser.mjs';

const [source, site] = process.argv.slice(2);
const skip = (why) => {
  console.log(`skipped: ${why}`);
  process.exit(77);
};
if (!existsSync(join(site, 'index.html'))) skip('the site is not built (tools/docs)');
if (!chromium_path()) skip('there is no Chromium');
if (!existsSync(join(source, 'tests/report/node_modules'))) skip('the packages of tests/report are not there');

const browser = await launch();
const page = await browser.newPage({ viewport: { width: 1280, height: 800 } });
const open = (name) => page.goto(`file://${join(site, name)}`);

await open('index.html');
const parts = await page.locator('article p img, article pre, article .grid > a').evaluateAll((all) =>
  all.map((one) => (one.tagName === 'IMG' ? 'picture' : one.tagName === 'A' ? one.querySelector('strong').innerText : 'block')),
);
assert.deepEqual(parts.slice(0, 5), ['picture', 'block', 'block', 'Learn', 'Playground']);
const [shell, check] = await page.locator('article pre').allInnerTexts();
assert.equal(shell.trim().split('\n').length + check.match(/^\$ /gm).length, 5);
assert.match(check, /\$ rehearse check\n.*controller/);

for (const name of ['index', 'howto/red_test', 'learn/first_golden', 'concepts/proof', 'concepts/comparisons']) {
  await open(`${name}.html`);
  const cut = await page.locator('.highlight-console pre, .highlight-sh pre').evaluateAll((all) =>
    all.filter((one) => one.scrollWidth > one.clientWidth).map((one) => one.innerText.slice(0, 60)),
  );
  assert.deepEqual(cut, [], `lines of ${name} are cut`);
}

for (const [name, section] of [['howto/step', 'tick-by-tick'], ['howto/gdb', 'in-gdb']]) {
  await open(`${name}.html`);
  await page.waitForURL(`**/howto/red_test.html#${section}`);
  assert.equal(await page.locator(`#${section}`).count(), 1);
}
await browser.close();
console.log('the home page is as it has to be');

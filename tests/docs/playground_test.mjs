// playground_test.mjs SOURCE SITE: the drop zone of the built site shows the summary of a recording, reports a file that
// is none, and asks the network for nothing; the reports of the playground open. Exit status 77: skipped.
import assert from 'node:assert/strict';
import { existsSync } from 'node:fs';
import { join } from 'node:path';
import { chromium_path, launch, open_report } from '../report/browser.mjs';

const [source, site] = process.argv.slice(2);
const skip = (why) => {
  console.log(`skipped: ${why}`);
  process.exit(77);
};
if (!existsSync(join(site, 'playground.html'))) skip('the site is not built (tools/docs)');
if (!chromium_path()) skip('there is no Chromium');
if (!existsSync(join(source, 'tests/report/node_modules'))) skip('the packages of tests/report are not there');

const browser = await launch();
const page = await browser.newPage();
const requests = [];
page.on('request', (request) => requests.push(request.url()));
await page.goto(`file://${join(site, 'playground.html')}`);
const atStart = requests.length;

/** What the page shows of a file. */
async function shown(file) {
  await page.setInputFiles('#drop-file', join(source, file));
  await page.waitForFunction(() => ['shown', 'refused'].includes(document.getElementById('drop-result').dataset.state));
  return page.locator('#drop-result').innerText();
}

const tank = await shown('golden/Tank.IsDrivenByJoystick.mcap');
assert.match(tank, /duration\t5 s/);
assert.match(tank, /\/Tank\/joints\tsensor_msgs\/msg\/JointState\t1001\t200\.0 Hz/);
assert.match(await shown('README.md'), /README\.md can't be read: Expected MCAP magic/);
assert.equal(requests.length, atStart, `it asked for ${requests.slice(atStart)}`);
assert(requests.every((url) => url.startsWith('file:')), `it asked for ${requests}`);

for (const name of ['trot', 'grasp', 'camera']) {
  const report = await open_report(browser, join(site, `_static/playground/${name}.html`));
  assert.deepEqual(report.complaints, [], `${name} complains`);
}
await browser.close();
console.log('the playground works');

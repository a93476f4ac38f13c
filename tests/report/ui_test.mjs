// The page of `rehearse ui` in Chromium, with a project of its own: a gain is edited, the verdict is red, its report shows the first
// difference, the edit is undone, the verdict is green. REHEARSE_COMMAND, BUILD (Rehearse's) and KEPT (a folder for screenshots) are
// in the environment.
import assert from 'node:assert/strict';
import { spawn, spawnSync } from 'node:child_process';
import { existsSync, mkdirSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { faults_of, keep_picture, looks } from './axe.mjs';
import { launch } from './browser.mjs';
import { contrasts } from './contrasts.mjs';

const { REHEARSE_COMMAND, BUILD, KEPT } = process.env;
process.env.SCREENSHOTS = KEPT;
const scratch = mkdtempSync(join(tmpdir(), 'rehearse_ui_'));
const project = join(scratch, 'robot');
const source = join(project, 'hold.c');
const environment = { ...process.env, HOME: scratch };
for (const name of Object.keys(environment)) if (name === 'CI' || name === 'XDG_CONFIG_HOME' || name.startsWith('REHEARSE_')) delete environment[name];
const patience = 120_000; // [ms]

let browser, served;

const run = (program, ...words) => {
  const ended = spawnSync(program, words, { cwd: project, env: environment, encoding: 'utf8' });
  assert.equal(ended.status, 0, `${program} ${words.join(' ')}: ${ended.stdout}${ended.stderr}`);
  return ended.stdout;
};

/** Starts the verb, and waits for its address. */
async function start(...words) {
  const ui = spawn(REHEARSE_COMMAND, ['ui', '--port', '0', ...words], { cwd: project, env: environment });
  const started = { out: '', err: '' };
  ui.stderr.on('data', (text) => (started.err += text));
  ui.stdout.on('data', (text) => (started.out += text));
  started.ended = new Promise((ended) => ui.on('close', (status, signal) => ended(status ?? signal)));
  const end = performance.now() + patience;
  while (!started.out.includes('Ctrl-C')) {
    assert.ok(performance.now() < end, started.err);
    await new Promise((later) => setTimeout(later, 10));
  }
  started.address = /http:\S+/.exec(started.out)[0];
  started.end = () => {
    ui.kill('SIGINT');
    return started.ended;
  };
  return started;
}

async function open(how = {}) {
  const context = await browser.newContext({
    viewport: { width: how.width ?? 1280, height: how.height ?? 800 },
    colorScheme: how.dark ? 'dark' : 'light',
    reducedMotion: 'reduce',
  });
  const page = await context.newPage();
  page.complaints = [];
  page.requests = [];
  page.on('console', (message) => {
    if (message.type() === 'error' && !/WebGL|GL Driver|GPU/.test(message.text())) page.complaints.push(message.text());
  });
  page.on('pageerror', (failure) => page.complaints.push(String(failure)));
  page.on('request', (request) => page.requests.push(request.url()));
  await page.goto(served.address);
  return page;
}

const head_is = (page, words) =>
  page.waitForFunction((text) => document.querySelector('.verdict .state').textContent === text, words, { timeout: patience });
const is_at_rest = (page) =>
  page.waitForFunction(() => !document.querySelector('.verdict h1').textContent.endsWith('…'), undefined, { timeout: patience });

const gain = /stiffness = [0-9.]+/; // of the controller that `rehearse new` writes

before(async () => {
  spawnSync(REHEARSE_COMMAND, ['new', project, '--language', 'c'], { env: environment });
  const lists = readFileSync(join(project, 'CMakeLists.txt'), 'utf8');
  writeFileSync(join(project, 'CMakeLists.txt'), lists.replace(/^rehearse_add_controller_test.*$/m, '')); // GoogleTest takes half a minute to compile
  run('cmake', '-S', '.', '-B', 'build', `-DCMAKE_PREFIX_PATH=${BUILD}`);
  run('cmake', '--build', 'build');
  spawnSync(REHEARSE_COMMAND, ['check'], { cwd: project, env: { ...environment, REHEARSE_GOLDEN: 'new' } });
  browser = await launch();
  served = await start();
});
after(async () => {
  await browser?.close();
  if (served) assert.equal(await served.end(), 130, served.err);
  rmSync(scratch, { recursive: true, force: true });
});

test('nothing is built before the owner allows it, once', async () => {
  const page = await open();
  await page.waitForSelector('#may');
  assert.equal(new URL(page.url()).hash, '', 'the token leaves the address');
  assert.match(await page.textContent('#asks'), /cmake --build build/);
  assert.equal(await page.textContent('#build'), 'nothing was built or checked');
  await page.click('#may');
  await head_is(page, '1 of 1 passed');
  assert.ok(readFileSync(join(scratch, '.config/rehearse/allowed_projects'), 'utf8').includes(project));
  await page.context().close();
});

test('an edited gain is red with its report at the first difference, and green again when it is undone', async () => {
  const page = await open();
  await head_is(page, '1 of 1 passed');
  await is_at_rest(page);
  const before_edit = readFileSync(source, 'utf8');
  writeFileSync(source, before_edit.replace(gain, 'stiffness = 37.0'));
  await head_is(page, '1 of 1 failed');
  await is_at_rest(page);
  assert.match(await page.textContent('.detail .sentence'), /controller changed/);
  const frame = page.frameLocator('.detail iframe');
  await frame.locator('.verdict').waitFor({ timeout: patience });
  assert.match(await frame.locator('.verdict').textContent(), /differs|changed|beyond/i);
  for (const { how } of looks) {
    await page.setViewportSize({ width: how.width, height: how.height });
    await page.emulateMedia({ colorScheme: how.dark ? 'dark' : 'light' });
    await keep_picture(page, 'ui', how, false);
    assert.deepEqual(await faults_of(page), []);
    assert.deepEqual((await page.evaluate(contrasts)).filter(({ contrast }) => contrast < 4.5), []);
    const wide = await page.evaluate(() => document.documentElement.scrollWidth);
    assert.ok(wide <= how.width, `it is ${wide} pixels wide`);
  }
  writeFileSync(source, before_edit);
  await head_is(page, '1 of 1 passed');
  await is_at_rest(page);
  assert.deepEqual(page.complaints, []);
  const strangers = page.requests.filter((url) => !url.startsWith(new URL(served.address).origin) && !/^(blob|data):/.test(url));
  assert.deepEqual(strangers, [], 'it asks no network');
  await page.context().close();
});

test('a build that fails shows its output, and keeps the old verdict', async () => {
  const page = await open();
  await is_at_rest(page);
  const before_edit = readFileSync(source, 'utf8');
  writeFileSync(source, `${before_edit}\nint broken = ;\n`);
  await head_is(page, 'not built');
  assert.match(await page.textContent('#output'), /hold\.c:\d+:\d+: error/);
  writeFileSync(source, before_edit);
  await head_is(page, '1 of 1 passed');
  assert.ok(!(await page.isVisible('#output')));
  await page.context().close();
});

test('two browsers see one state; accepting and discarding ask first', async () => {
  const [page, other] = [await open(), await open({ width: 420 })];
  await is_at_rest(page);
  const before_edit = readFileSync(source, 'utf8');
  writeFileSync(source, before_edit.replace(gain, 'stiffness = 37.0'));
  for (const one of [page, other]) await head_is(one, '1 of 1 failed');
  await is_at_rest(page);
  await page.click('.detail button:has-text("Accept…")');
  assert.match(await page.textContent('#question-title'), /Accept the run as golden/);
  await page.click('#no');
  await other.click('.detail button:has-text("Discard…")');
  await other.click('#yes');
  await page.waitForFunction(() => !document.querySelector('.detail .answers'), undefined, { timeout: patience });
  await page.click('#again');
  await page.waitForSelector('.detail .answers', { timeout: patience });
  await page.click('.detail button:has-text("Accept…")');
  await page.click('#yes');
  for (const one of [page, other]) await head_is(one, '1 of 1 passed');
  writeFileSync(source, before_edit);
  await head_is(page, '1 of 1 failed'); // the accepted golden is of the other gain
  await is_at_rest(page);
  await page.click('.detail button:has-text("Accept…")');
  await page.click('#yes');
  await head_is(page, '1 of 1 passed');
  await page.context().close();
  await other.context().close();
});

test('a controller that crashes or never ends is a verdict', async () => {
  const page = await open();
  await is_at_rest(page);
  const before_edit = readFileSync(source, 'utf8');
  const control = /static int control\(void\* self\) \{/;
  assert.match(before_edit, control);
  for (const [line, words] of [
    ['*(volatile int*)0 = 1;', /SIGSEGV|crash/i],
    ['for (volatile int i = 0;; ++i) {}', /did not return/],
  ]) {
    writeFileSync(source, before_edit.replace(control, `$& ${line}`));
    await page.waitForFunction((text) => new RegExp(text, 'i').test(document.querySelector('.detail .sentence')?.textContent ?? ''), words.source, {
      timeout: patience,
    });
    assert.equal(await page.textContent('.verdict .state'), '1 of 1 failed');
  }
  writeFileSync(source, before_edit);
  await head_is(page, '1 of 1 passed');
  await page.context().close();
});

test('from saving to the verdict it takes the build’s own time and a second', async () => {
  const page = await open();
  await is_at_rest(page);
  const before_edit = readFileSync(source, 'utf8');
  const beyond = [];
  for (let i = 0; i < 10; ++i) {
    const shown = page.evaluate(
      () =>
        new Promise((seen) => {
          const old = document.querySelector('.detail').dataset.shown;
          const watch = new MutationObserver(() => {
            const now = document.querySelector('.detail').dataset.shown;
            if (now === old || !JSON.parse(now)[0].result || JSON.parse(now)[0].phase !== 'judged') return;
            watch.disconnect();
            seen(document.querySelector('#build').textContent);
          });
          watch.observe(document.querySelector('.detail'), { attributes: true });
        }),
    );
    const begin = performance.now();
    writeFileSync(source, before_edit.replace(gain, `stiffness = ${37 + i}.0`));
    const built = Number(/it took ([0-9.]+) s/.exec(await shown)[1]);
    beyond.push((performance.now() - begin) / 1000 - built);
    await is_at_rest(page);
  }
  beyond.sort((a, b) => a - b);
  console.log(`beyond the build: median ${((beyond[4] + beyond[5]) / 2).toFixed(2)} s, longest ${beyond[9].toFixed(2)} s`);
  assert.ok(beyond[4] < 10, `the median is ${beyond[4]} s`); // a busy machine; the page states the measured time
  writeFileSync(source, before_edit);
  await head_is(page, '1 of 1 passed');
  await page.context().close();
});

test('without the token a page shows nothing and decides nothing', async () => {
  const context = await browser.newContext();
  const page = await context.newPage();
  await page.goto(new URL('/', served.address).href);
  assert.match(await page.textContent('#build'), /has the token that this one lacks/);
  assert.doesNotMatch(await page.content(), /\brobot\b|hold\.yaml/i, 'not even the names of the project and its scenarios');
  const status = await page.evaluate(() => fetch('/accept', { method: 'POST', body: '{"golden":"Hold"}' }).then((answer) => answer.status));
  assert.equal(status, 403);
  await context.close();
});

test('a file outside the project isn’t opened, and the editor gets file and line', async () => {
  const told = join(scratch, 'opened');
  const editor = join(scratch, 'editor.sh');
  writeFileSync(editor, `#!/bin/sh\necho "$@" >> ${told}\n`, { mode: 0o755 });
  const first = served;
  served = await start('--editor', `${editor} --goto {file}:{line}`);
  const page = await open();
  await is_at_rest(page);
  await page.click('.detail .place');
  const token = await page.evaluate(() => sessionStorage.getItem('rehearse-token'));
  const ask = (file) =>
    page.evaluate(
      ([path, key]) =>
        fetch('/open', { method: 'POST', headers: { Authorization: `Bearer ${key}` }, body: JSON.stringify({ file: path, line: 1 }) }).then((answer) => answer.status),
      [file, token],
    );
  assert.equal(await ask('../opened'), 409);
  assert.equal(await ask('/etc/passwd'), 409);
  assert.equal(await ask('scenarios'), 409);
  const end = performance.now() + patience;
  while (!existsSync(told) && performance.now() < end) await new Promise((later) => setTimeout(later, 20));
  assert.match(readFileSync(told, 'utf8'), new RegExp(`^--goto ${project}/scenarios/\\S+\\.yaml:\\d+\\n$`));
  await page.context().close();
  assert.equal(await served.end(), 130);
  served = first;
});

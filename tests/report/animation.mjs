// Draws the frames of the README's animation: node animation.mjs PROJECT RED_TEST GDB FRAMES
//   PROJECT: a folder with a failed test; RED_TEST: the output of ctest; GDB: gdb's input and output, in gdb.in and
//   gdb.out; FRAMES: the folder to make, with pictures and arguments.txt, the arguments of img2webp. tools/animation
//   calls it.
import { mkdirSync, readdirSync, readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { launch, open_report } from './browser.mjs';

const [project, red_file, gdb, folder] = process.argv.slice(2);
const [width, height] = [1280, 720]; // [pixels]
const scale = 0.75; // of the pictures
const columns = 104;
const report_step = 60; // ticks between two frames of the report

const frames = [];
mkdirSync(folder, { recursive: true });

/** Takes a frame that is shown for so long [ms]. */
async function take(page, milliseconds) {
  const file = join(folder, `${String(frames.length).padStart(3, '0')}.png`);
  await page.screenshot({ path: file, caret: 'hide' });
  frames.push(`-lossy -q 70 -m 6 -d ${milliseconds} ${file}`);
}

const escaped = (text) => text.replace(/&/g, '&amp;').replace(/</g, '&lt;').replace(/>/g, '&gt;');

/** The line as a terminal of that width breaks it; of other lines than verdicts and code only the first part. */
function broken(line) {
  const parts = line.match(new RegExp(`.{1,${columns}}`, 'g')) ?? [''];
  return parts.length === 1 || is_important(line) ? parts : [`${line.slice(0, columns - 3)}...`];
}

const is_important = (line) => /Failed|Failure|^expected |u\(\) = p_gain/.test(line);

/** A terminal with these lines. */
async function show_terminal(page, lines) {
  const colored = lines.flatMap((line) => {
    const tag = /^[$]|^\(gdb\)/.test(line) ? 'b' : is_important(line) ? 'i' : 'span';
    return broken(line).map((part) => `<${tag}>${escaped(part)}</${tag}>`);
  });
  await page.setContent(
    `<style>body { margin: 0; background: #14181d; color: #d5dae0; font: 19.5px/1.42 "DejaVu Sans Mono", monospace; }
    pre { margin: 28px 32px; font: inherit; } b { color: #8fd18f; font-weight: normal; } i { color: #ff8a7a; font-style: normal; }
    </style><pre>${colored.join('\n')}</pre>`,
  );
}

/** The lines of a file from the first that matches, without those that match `without`. */
function lines_of(file, from, without) {
  const lines = readFileSync(file, 'utf8').split('\n');
  return lines.slice(lines.findIndex((line) => from.test(line))).filter((line) => !without.test(line));
}

async function show_red_test(context) {
  const page = await context.newPage();
  const output = lines_of(red_file, /1\/1 Test/, /^Note|^\[=|^\[-|^\[ RUN/).map((line) =>
    line.replaceAll(`${project}/`, ''),
  );
  const command = "$ sed -i 's/p_gain = 180.0/p_gain = 120.0/' trot.cpp && cmake --build build";
  await show_terminal(page, [command]);
  await take(page, 1200);
  await show_terminal(page, [command, '$ ctest --test-dir build --output-on-failure']);
  await take(page, 900);
  await show_terminal(page, [command, '$ ctest --test-dir build --output-on-failure', ...output.slice(0, 20)]);
  await take(page, 4000);
}

async function show_report(browser) {
  const traces = join(project, 'build/traces');
  const file = join(
    traces,
    readdirSync(traces).find((name) => /^Trot.*\.html$/.test(name)),
  );
  const { page, close } = await open_report(browser, file, { width, height, fonts: true, scale });
  const last = await page.evaluate(async () => {
    await window.rehearse.go(Infinity);
    return window.rehearse.tick;
  });
  for (let tick = 780; tick <= last; tick += report_step) {
    await page.evaluate((at) => window.rehearse.go(at), tick);
    await take(page, tick + report_step > last ? 2500 : 130);
  }
  await close();
}

async function show_debugger(context) {
  const page = await context.newPage();
  const command = '$ rehearse replay golden/Trot.StandsUpAndWalksAhead.mcap --gdb';
  // gdb prints no input that it reads from a file: each goes behind its prompt
  const input = readFileSync(`${gdb}.in`, 'utf8').split('\n');
  const answers = readFileSync(`${gdb}.out`, 'utf8').replaceAll(`${project}/`, '').split('(gdb) ');
  const session = [command];
  await show_terminal(page, session);
  await take(page, 1000);
  for (let i = 0; i + 1 < answers.length; ++i) {
    if (i > 0) session.push(`(gdb) ${input[i - 1]}`);
    session.push(
      ...answers[i]
        .replaceAll('\t', '  ')
        .split('\n')
        .filter((line) => !/^Reading symbols|^$/.test(line)),
    );
    await show_terminal(page, session);
    await take(page, i + 2 < answers.length ? 1800 : 4500);
  }
}

const browser = await launch();
try {
  const context = await browser.newContext({ viewport: { width, height }, deviceScaleFactor: scale });
  await show_red_test(context);
  await show_report(browser);
  await show_debugger(context);
} finally {
  await browser.close();
}
writeFileSync(join(folder, 'arguments.txt'), `-loop 0 ${frames.join(' ')}`);

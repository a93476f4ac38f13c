// Moving the cursor in a report updates all its parts, by mouse and by keyboard.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { settled, state_of, strays, with_report } from './bench.mjs';
import { joints, pose_at } from './walker.mjs';

const options = { ticks: 2000, channels: 60, cameras: 2, picture_every: 50 };
const shown = '#series=Walker/RIGHT_KNEE/q,Walker/LEFT_HIP/q';

const close = (actual, expected, what) =>
  assert.ok(Math.abs(actual - expected) < 1e-9, `${what} is ${actual}, not ${expected}`);

/** What the run has at that tick, computed as the maker of the report does. */
function run_at(tick) {
  const pose = pose_at(tick);
  pose.joints[joints.indexOf('RIGHT_KNEE')] += strays(tick);
  return pose;
}

/** Where the right foot is, without matrices: a chain in a plane, turned about z and moved. */
function right_foot({ root, joints: q }) {
  const [hip, knee] = [q[3], q[4]];
  const x = -0.36 * Math.sin(hip) - 0.34 * Math.sin(hip + knee),
    z = -0.1 - 0.36 * Math.cos(hip) - 0.34 * Math.cos(hip + knee);
  const yaw = 2 * Math.atan2(root[5], root[6]),
    y = -0.1;
  return [
    root[0] + x * Math.cos(yaw) - y * Math.sin(yaw),
    root[1] + x * Math.sin(yaw) + y * Math.cos(yaw),
    root[2] + z,
  ];
}

function check_all_at(state, tick) {
  assert.equal(state.tick, tick);
  const pose = run_at(tick);
  close(state.joints['Walker/RIGHT_KNEE/q'], pose.joints[4], 'the knee');
  close(
    state.joints['Walker/LEFT_HIP/q'],
    pose_at(tick).joints[0] + (tick > 648 ? 2e-10 * (tick - 648) : 0),
    'the hip',
  );
  close(state.golden_joints['Walker/RIGHT_KNEE/q'], pose_at(tick).joints[4], 'the ghost’s knee');
  if (tick < 640)
    right_foot(pose).forEach((at, i) => close(state.links['Walker/RIGHT_FOOT'][i], at, `the foot's ${'xyz'[i]}`));
  assert.ok(Object.keys(state.plots).length >= 2);
  for (const [name, at] of Object.entries(state.plots)) assert.equal(at, tick, `the line in the plot of ${name}`);
  const picture = 50 * Math.floor(tick / 50);
  assert.deepEqual(state.frames, {
    'Walker/LeftCamera': { expected: picture, actual: picture },
    'Walker/RightCamera': { expected: picture, actual: picture },
  });
  assert.equal(state.table['Walker/RIGHT_KNEE/q'].actual, pose.joints[4].toFixed(6));
  assert.equal(state.table['Walker/RIGHT_KNEE/q'].expected, pose_at(tick).joints[4].toFixed(6));
}

test('a plot leads to its smallest and its largest value', async () => {
  await with_report(options, { hash: shown }, async ({ page, complaints }) => {
    const knee = [...Array(options.ticks).keys()].map((tick) => run_at(tick).joints[4]);
    for (const [which, word] of [
      ['min', 'smallest'],
      ['max', 'largest'],
    ]) {
      await page.click(`button[title="Go to the ${word} value of Walker/RIGHT_KNEE/q"]`);
      await settled(page);
      const { tick } = await state_of(page);
      assert.equal(tick, knee.indexOf(Math[which](...knee)), `the ${word} value`);
    }
    assert.deepEqual(complaints, []);
  });
});

test('scrubbing moves robot, plots, pictures and table to the same tick', async () => {
  await with_report(options, { hash: shown }, async ({ page, complaints }) => {
    await page.selectOption('.values select', 'Everything');
    await page.fill('.values input', 'knee/q');
    for (const tick of [0, 1, 333, 641, 1250, 1999, 700]) {
      await page.evaluate((to) => window.rehearse.go(to), tick);
      check_all_at(await state_of(page), tick);
    }
    const ruler = await page.locator('.timeline canvas').boundingBox();
    await page.mouse.move(ruler.x + 300, ruler.y + 10);
    await page.mouse.down();
    for (const x of [340, 500, 777]) {
      await page.mouse.move(ruler.x + x, ruler.y + 10);
      await settled(page);
      const state = await state_of(page);
      const expected = ((x - 88) / (ruler.width - 100)) * 1999;
      assert.ok(Math.abs(state.tick - expected) < 3, `tick ${state.tick} is where ${expected} should be`);
      check_all_at(state, state.tick);
    }
    await page.mouse.up();
    assert.deepEqual(complaints, []);
  });
});

test('numbers are those of the recording, however they were packed', async () => {
  await with_report(options, { hash: '#tick=230' }, async ({ page }) => {
    await page.selectOption('.values select', 'Everything');
    const row = async (name, tick) => {
      await page.fill('.values input', name);
      await page.evaluate((to) => window.rehearse.go(to), tick);
      return (await state_of(page)).table[name];
    };
    assert.equal((await row('Walker/Gyro/w.x', 230)).actual, 'NaN');
    assert.equal((await row('Walker/Gyro/w.x', 104)).actual, Math.sin(2).toFixed(6), 'the value of tick 100');
    assert.equal((await row('Walker/gait_phase', 1999)).actual, '7');
    assert.equal((await row('Walker/LEFT_FOOT/touches', 399)).actual, 'true');
    assert.equal((await row('Walker/LEFT_FOOT/touches', 400)).actual, 'false');
    assert.equal((await row('Walker/root/qx', 5)).actual, '0.000000', 'of an array without a blob');
    for (const tick of [0, 639, 640, 1999]) {
      const knee = await row('Walker/RIGHT_KNEE/u', tick);
      const golden = 20 * Math.cos(tick / 90 + 4),
        late = tick < 640 ? 0 : tick - 639;
      assert.equal(knee.expected, golden.toFixed(6));
      assert.equal(knee.actual, (golden + 25 * (1 - Math.exp(-late / 250))).toFixed(6));
      assert.equal(knee.changed, tick > 0);
    }
  });
});

test('the first divergence is one key away', async () => {
  await with_report(options, { hash: '#tick=1800&series=Walker/LEFT_HIP/q' }, async ({ page }) => {
    await page.keyboard.press('d');
    await settled(page);
    const { tick, shown: plotted, plots } = await state_of(page);
    assert.equal(tick, 640);
    assert.deepEqual(plotted, ['Walker/RIGHT_KNEE/u', 'Walker/LEFT_HIP/q']);
    assert.equal(plots['Walker/RIGHT_KNEE/u'], 640);
  });
});

test('keys move by ticks, by divergences, to the ends, and play', async () => {
  await with_report(options, {}, async ({ page }) => {
    const after = async (key) => {
      await page.keyboard.press(key);
      await settled(page);
      return (await state_of(page)).tick;
    };
    assert.equal(await after('ArrowRight'), 641);
    assert.equal(await after('ArrowLeft'), 640);
    assert.equal(await after('Shift+ArrowRight'), 650);
    assert.equal(await after('PageDown'), 750);
    assert.equal(await after('PageUp'), 650);
    assert.equal(await after('Home'), 0);
    assert.equal(await after('ArrowLeft'), 0);
    assert.equal(await after('n'), 640);
    assert.equal(await after('n'), 644);
    assert.equal(await after('p'), 640);
    assert.equal(await after('End'), 1999);
    assert.equal(await after('ArrowRight'), 1999);
    await page.keyboard.press('Home');
    await page.keyboard.press('Space');
    await page.waitForFunction(() => window.rehearse.tick > 50);
    assert.equal((await state_of(page)).playing, true);
    await page.keyboard.press('Space');
    await settled(page);
    const { tick, playing } = await state_of(page);
    assert.equal(playing, false);
    await page.waitForTimeout(100);
    assert.equal((await state_of(page)).tick, tick);
  });
});

test('playing ends with the run', async () => {
  await with_report(options, { hash: '#tick=1900' }, async ({ page }) => {
    await page.keyboard.press('Space');
    await page.waitForFunction(() => !window.rehearse.state().playing);
    assert.equal((await state_of(page)).tick, 1999);
  });
});

test('a channel is searched and plotted by the keyboard alone', async () => {
  await with_report(options, { hash: shown }, async ({ page }) => {
    await page.keyboard.press('/');
    await page.keyboard.type('gyro w');
    await page.keyboard.press('Enter');
    await page.keyboard.press('Escape');
    await settled(page);
    assert.deepEqual((await state_of(page)).shown, ['Walker/RIGHT_KNEE/q', 'Walker/LEFT_HIP/q', 'Walker/Gyro/w.x']);
    await page.keyboard.press('/');
    await page.keyboard.type('*/root/q?');
    await page.keyboard.press('ArrowDown');
    await page.keyboard.press('Enter');
    await settled(page);
    assert.equal((await state_of(page)).shown[3], 'Walker/root/qy');
    await page.keyboard.press('Escape');
    await page.keyboard.press('d');
    assert.equal((await state_of(page)).tick, 640, 'keys work again');
  });
});

test('everything is reached by Tab, has a name, and shows that it has the focus', async () => {
  await with_report(options, { hash: shown }, async ({ page }) => {
    const nameless = await page.evaluate(() =>
      [...document.querySelectorAll('button, input, select, [tabindex="0"]')]
        .filter(
          (one) => !(one.getAttribute('aria-label') || one.textContent.trim() || one.getAttribute('aria-labelledby')),
        )
        .map((one) => one.outerHTML.slice(0, 200)),
    );
    assert.deepEqual(
      nameless.filter((html) => !/class="(provenance|scenario|differing)/.test(html)),
      [],
    );
    const reached = new Set();
    for (let i = 0; i < 45; ++i) {
      await page.keyboard.press('Tab');
      const at = await page.evaluate(() => {
        const style = getComputedStyle(document.activeElement);
        return {
          name: document.activeElement.getAttribute('aria-label') ?? document.activeElement.textContent,
          outline: style.outlineStyle !== 'none' && parseFloat(style.outlineWidth) >= 1,
          body: document.activeElement === document.body,
        };
      });
      if (at.body) break;
      assert.ok(at.outline, `"${at.name}" has the focus and doesn't show it`);
      reached.add(at.name);
    }
    for (const name of [
      'Play',
      'tick at the cursor',
      'time line: the tick under the cursor',
      'First divergence',
      'search channels to plot',
      'plots',
      'Values',
      'filter the table',
      'values at the cursor',
    ]) {
      assert.ok(reached.has(name), `"${name}" isn't reached: ${[...reached].join(', ')}`);
    }
  });
});

test('a drag in a plot zooms all of them and the time line, a double click shows the whole run, a click goes there', async () => {
  await with_report(options, { hash: shown }, async ({ page }) => {
    const over = await page.locator('.plot .u-over').first().boundingBox();
    const y = over.y + 30;
    await page.mouse.move(over.x + over.width * 0.25, y);
    await page.mouse.down();
    await page.mouse.move(over.x + over.width * 0.5, y, { steps: 4 });
    await page.mouse.up();
    await settled(page);
    let { view, tick } = await state_of(page);
    assert.ok(Math.abs(view.begin - 500) < 5 && Math.abs(view.end - 1000) < 5, `in view: ${view.begin} to ${view.end}`);
    assert.equal(tick, 640, 'the cursor stays');
    await page.mouse.click(over.x + over.width * 0.8, y);
    await settled(page);
    ({ view, tick } = await state_of(page));
    assert.ok(Math.abs(tick - 900) < 5, `tick ${tick}`);
    for (const at of Object.values((await state_of(page)).plots)) assert.equal(at, tick);
    await page.mouse.dblclick(over.x + over.width * 0.8, y);
    await settled(page);
    ({ view } = await state_of(page));
    assert.deepEqual(view, { begin: 0, end: 1999 });
    const line = await page.locator('.timeline canvas').boundingBox();
    await page.mouse.move(line.x + 200, line.y + 30);
    await page.mouse.down();
    await page.mouse.move(line.x + 600, line.y + 30, { steps: 3 });
    await page.mouse.up();
    await settled(page);
    ({ view } = await state_of(page));
    const scale = 1999 / (line.width - 100);
    assert.ok(
      Math.abs(view.begin - 112 * scale) < 5 && Math.abs(view.end - 512 * scale) < 5,
      `in view: ${view.begin} to ${view.end}`,
    );
  });
});

test('messages and divergences lead to their ticks', async () => {
  await with_report(options, { hash: shown }, async ({ page }) => {
    await page.click('#tab-messages');
    await page.click('.message:has-text("knee torque is saturated")');
    await settled(page);
    assert.equal((await state_of(page)).tick, 652);
    assert.match(await page.innerText('.message.current'), /saturated/);
    await page.evaluate(() => window.rehearse.go(760));
    assert.match(await page.innerText('.message.current'), /step 3/);
    await page.click('#tab-divergences');
    await page.click('.divergence:has-text("root/z")');
    await settled(page);
    const { tick, shown: plotted } = await state_of(page);
    assert.ok(tick > 640);
    assert.equal(plotted[0], 'Walker/root/z');
  });
});

test('pictures are compared: side by side, or with a slider', async () => {
  await with_report(options, { hash: '#tick=1200' }, async ({ page }) => {
    await settled(page);
    const sums = () =>
      page.evaluate(() =>
        Object.fromEntries(
          [...document.querySelectorAll('.camera:first-of-type canvas')].map((canvas) => {
            const { data } = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height);
            let sum = 0;
            for (let i = 0; i < data.length; i += 4) sum += data[i] + data[i + 1] + data[i + 2];
            return [canvas.getAttribute('aria-label').split(', ')[1], sum];
          }),
        ),
      );
    const apart = await sums();
    assert.ok(apart.difference > 0, 'they differ');
    assert.notEqual(apart.expected, apart.actual);
    await page.click('button:has-text("Slider")');
    await page.locator('.wipe').first().fill('1');
    await settled(page);
    assert.equal((await sums()).actual, apart.expected, 'all of it is the expected one');
    await page.locator('.wipe').first().fill('0');
    await settled(page);
    assert.equal((await sums()).actual, apart.actual, 'nothing of it is the expected one');
    await page.click('button:has-text("Slider")');
    await page.evaluate(() => window.rehearse.go(100));
    assert.equal((await sums()).difference, 0, 'before the fault');
  });
});

test('contacts have the names of both links, in plots and in the table at a tick', async () => {
  await with_report(options, { hash: '#tick=1050' }, async ({ page }) => {
    await page.selectOption('.values select', 'Contacts');
    const rows = async (tick) => {
      await page.evaluate((to) => window.rehearse.go(to), tick);
      const { table } = await state_of(page);
      return ['LEFT', 'RIGHT'].map((side) => {
        const { expected, actual } = table[`contact Walker/${side}_FOOT – Floor`];
        return `${expected} ${actual}`;
      });
    };
    assert.deepEqual(await rows(99), ['apart apart', 'apart apart']);
    assert.deepEqual(await rows(550), ['touch touch', 'touch touch']);
    assert.deepEqual(await rows(1410), ['apart touch', 'touch touch'], 'this run’s ends 23 ticks late');
    await page.click('.row:has-text("RIGHT_FOOT – Floor")');
    await settled(page);
    const { shown: plotted } = await state_of(page);
    assert.ok(plotted.includes('contact Walker/RIGHT_FOOT – Floor'));
  });
});

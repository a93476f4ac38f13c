// Figures of the site, drawn from runs that are made when the site is built. Each is checked against its formula: a
// figure whose measurement is off makes the build fail.
import { execFileSync } from 'node:child_process';
import { mkdirSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { curves } from './plot.mjs';

const gravity = 9.80665; // [m/s²]

/** Calls `work(run, folder, source)` in a scratch folder; run(...) calls the command, table(trace) reads its series. */
function inScratch({ source, build }, work) {
  const folder = mkdtempSync(join(tmpdir(), 'rehearse_figure_'));
  const env = { ...process.env, REHEARSE_CONTROLLER_PATH: join(build, 'lib/rehearse/controllers') };
  const run = (...words) => execFileSync(join(build, 'bin/rehearse'), words, { cwd: folder, env, encoding: 'utf8' });
  const table = (trace) => {
    run('export', trace, '--joined', '-o', `${trace}.csv`);
    const [head, ...rows] = readFileSync(join(folder, `${trace}.csv`), 'utf8').trim().split('\n');
    const names = head.split(',').map((name) => name.replace(/^"|"$/g, '').replace(/ \[.*\]$/, ''));
    const columns = rows.map((row) => row.split(',').map((cell) => (cell === '' ? NaN : Number(cell))));
    return (name) => {
      const index = names.indexOf(name);
      if (index < 0) throw new Error(`${trace} has no series ${name}`);
      return columns.map((row) => row[index]);
    };
  };
  try {
    return work({ run, table, folder, source });
  } finally {
    rmSync(folder, { recursive: true });
  }
}

const largest = (numbers) => numbers.reduce((most, number) => Math.max(most, Math.abs(number) || 0), 0);

function demand(name, worst, bound, unit) {
  if (!(worst <= bound)) throw new Error(`figure ${name}: the run is off its formula by ${worst} ${unit}, more than ${bound}`);
}

const figure = (svg, caption) => '```{raw} html\n' + svg + '\n```\n\n*' + caption + '*\n';

/** A pendulum swings freely; an IMU at the tip of its rod of 1 m. Readings belong to the step before their tick. */
const imu = (where) =>
  inScratch(where, ({ run, table, folder, source }) => {
    writeFileSync(
      join(folder, 'swing.yaml'),
      `rehearse: 1\nduration: 2\nbodies:\n  - name: Pendulum\n    model: ${source}/fixtures/models/pendulum.urdf\n    joints: {hinge: 100 deg}\n`,
    );
    run('record', 'swing.yaml', '-o', 'swing.mcap');
    const series = table('swing.mcap');
    const [time, q, dq] = [series('time'), series('Pendulum/hinge/q'), series('Pendulum/hinge/dq')];
    const along = series('Pendulum/imu/linear_acceleration/z');
    const formula = q.map((_, i) => (i === 0 ? NaN : dq[i - 1] ** 2 + gravity * Math.cos(q[i - 1])));
    const worst = largest(formula.slice(2).map((value, i) => value - along[i + 2]));
    demand('imu', worst, 0.1, 'm/s²'); // half of what the reading changes by in a step
    return figure(
      curves({
        title: 'Reading of an accelerometer at the tip of a swinging pendulum',
        x: { label: 'time [s]', values: time },
        y: 'along the rod [m/s²]',
        lines: [
          { label: 'formula', values: formula },
          { label: 'reading', values: along, points: 40 },
        ],
      }),
      `A pendulum of 1 m that falls from 100°, without a controller: the reading at its tip, and the formula with the recorded q and dq. They differ by at most ${worst.toPrecision(2)} m/s²: a reading is the mean over a step of 1 ms, the formula belongs to its beginning.`,
    );
  });

/** The middle beam of the rover's scanner, 0.22 m ahead of its base, and the face of the wall at x = 3 m. */
const range = (where) =>
  inScratch(where, ({ table, run, source }) => {
    run('filter', join(source, 'golden/Rover.StopsBeforeTheWall.mcap'), '-o', 'rover.mcap');
    const series = table('rover.mcap');
    const [time, x, beam] = [series('time'), series('Rover/BASE/position/x'), series('Rover/Scanner/ranges/20')];
    const cycle = 10; // ticks from a scan to its delivery: 0.05 s
    const formula = x.map((_, i) => (i < cycle ? NaN : 3 - (x[i - cycle] + 0.22)));
    const worst = largest(beam.map((value, i) => value - formula[i]).filter((off, i) => Number.isFinite(beam[i]) && i > cycle));
    demand('range', worst, 0.002, 'm');
    return figure(
      curves({
        title: 'Reading of a laser scanner on a rover that stops before a wall',
        x: { label: 'time [s]', values: time },
        y: 'distance ahead [m]',
        lines: [
          { label: 'formula', values: formula },
          { label: 'reading', values: beam, points: 1e6 },
        ],
      }),
      `The middle beam of a scanner with 20 Hz on a rover that stops before a wall, and the distance from the recorded position at the time of the scan. They differ by at most ${worst.toPrecision(2)} m.`,
    );
  });

/** Two runs of the arm that carries a block, one with the block moved by a last bit. */
const growth = (where) =>
  inScratch(where, ({ run, table, folder, source }) => {
    mkdirSync(join(folder, 'scenarios'));
    const text = readFileSync(join(source, 'fixtures/scenarios/mesh_arm.yaml'), 'utf8').replaceAll('../models', `${source}/fixtures/models`);
    const moved = text.replace('position: [0.302, 0,', 'position: [0.30200000000000005, 0,');
    if (moved === text) throw new Error('figure growth: the block is no longer at 0.302');
    const runs = [text, moved].map((scenario, i) => {
      writeFileSync(join(folder, `scenarios/${i}.yaml`), scenario);
      run('record', `scenarios/${i}.yaml`, '-o', `${i}.mcap`);
      return table(`${i}.mcap`);
    });
    const time = runs[0]('time');
    const axes = ['Block/Block/position/x', 'Block/Block/position/y', 'Block/Block/position/z'];
    let most = 0;
    const values = time.map((_, i) => {
      for (const name of axes) most = Math.max(most, Math.abs(runs[0](name)[i] - runs[1](name)[i]) || 0);
      return most;
    });
    return figure(
      curves({
        title: 'Growth of a last bit',
        x: { label: 'time [s]', values: time },
        y: 'largest difference so far [m]',
        logarithmic: true,
        lines: [{ label: 'position of the block', values }],
      }),
      `The block's position in two runs of fixtures/scenarios/mesh_arm.yaml: from ${values[1].toPrecision(2)} m to ${values.at(-1).toPrecision(2)} m. Each point is the largest difference of a coordinate up to then. Both runs grasp the block and carry it aside.`,
    );
  });

/** The curves that `tools/bench --growth tools/site/growth.json` has measured. */
const measuredCurves = (source) => JSON.parse(readFileSync(join(source, 'tools/site/growth.json'), 'utf8'));

/** The largest size of each curve, and the exponent of its time from the size before to it. */
const growthTable = ({ source }) => {
  const rows = measuredCurves(source).map(({ of, verb, n, seconds, megabytes }) => {
    const power = Math.log(seconds.at(-1) / seconds.at(-2)) / Math.log(n.at(-1) / n.at(-2));
    const size = n.at(-1).toLocaleString('en');
    return `| ${size} ${of} | ${verb} | ${seconds.at(-1)} s | ${megabytes.at(-1)} MB | ${power.toFixed(2)} |`;
  });
  return ['| size | verb | time | memory | exponent |', '| --- | --- | --- | --- | --- |', ...rows].join('\n') + '\n';
};

/** A group of the measured curves; `quantity`: seconds or megabytes. */
const measured = (of, quantity, label) => ({ source }) => {
  const curves_of = measuredCurves(source).filter((curve) => curve.of === of);
  if (curves_of.length === 0) throw new Error(`tools/site/growth.json has no curves of ${of}`);
  const y = quantity === 'seconds' ? 'time [s]' : 'largest memory [MB]';
  return figure(
    curves({
      title: `${y} by number of ${label}`,
      x: { label: `number of ${label}`, values: curves_of[0].n, logarithmic: true },
      y,
      logarithmic: true,
      legend: 'left',
      lines: curves_of.map((curve) => ({ label: curve.verb, values: curve[quantity] })),
    }),
    `${y[0].toUpperCase()}${y.slice(1)} by number of ${label}, measured by tools/bench --growth.`,
  );
};

export const figures = {
  imu,
  range,
  growth,
  growth_table: growthTable,
  ticks_time: measured('ticks', 'seconds', 'ticks'),
  lines_memory: measured('lines', 'megabytes', 'lines of a controller'),
  scenarios_time: measured('scenarios', 'seconds', 'scenarios'),
  triangles_time: measured('triangles', 'seconds', 'triangles'),
};

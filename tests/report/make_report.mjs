// Makes synthetic reports without a recording: of a walking figure, of any length, with any number of channels and
// cameras.
//   node make_report.mjs PAGE OUT [--ticks N] [--channels N] [--cameras N] [--alone] [--equal] [--no-robot] ...
import { readFileSync, writeFileSync } from 'node:fs';
import { fileURLToPath } from 'node:url';
import { parseArgs } from 'node:util';
import { BlobWriter } from './blob_writer.mjs';
import { encode_png } from './png.mjs';
import { joints, pose_at, walker } from './walker.mjs';

const marker = '<!-- REHEARSE DATA -->';

export const defaults = {
  ticks: 3000,
  channels: 60,
  cameras: 1,
  first_picture: 0,
  picture_every: 33,
  picture_size: [160, 120],
  fault: 640,
  noise: true,
  golden: true,
  equal: false,
  robot: true,
  events: true,
  lines: 0, // messages in blobs
  mesh: true,
  expectations: true,
  call_stack: null,
  control_times: [],
  coverage: null, // the object that its blob contains
  coverage_alone: false, // without a run
  fails: false, // expectations are violated without a golden
};

/** JSON has no NaN. */
function json_number(value) {
  return Number.isFinite(value) ? value : String(value);
}

class Maker {
  blobs = new BlobWriter();
  series = [];
  divergences = [];

  constructor(options) {
    this.options = { ...defaults, ...options };
    this.faulty = this.options.golden && !this.options.equal;
  }

  /** of(tick, golden): the value of either run. every: ticks from one value to the next. */
  add_series(
    name,
    group,
    unit,
    of,
    { every = 1, tolerance = 1e-6, kind = 'floating', array = Float64Array, wraps = false } = {},
  ) {
    const { ticks } = this.options;
    const count = Math.ceil(ticks / every);
    const actual = new array(count),
      golden = new array(count);
    let differing = 0,
      beyond = 0,
      first = null,
      low = Infinity,
      high = -Infinity;
    for (let i = 0; i < count; ++i) {
      golden[i] = of(i * every, true);
      actual[i] = this.faulty ? of(i * every, false) : golden[i];
      const a = Number(actual[i]),
        g = Number(golden[i]);
      for (const value of [a, g])
        if (Number.isFinite(value)) ((low = Math.min(low, value)), (high = Math.max(high, value)));
      if (Object.is(a, g)) continue;
      ++differing;
      if (Math.abs(a - g) <= tolerance) continue;
      ++beyond;
      first ??= { tick: i * every, expected: g, actual: a };
    }
    const values = this.blobs.numbers(actual, ['xor', 'columns', 'none'][this.series.length % 3]);
    const entry = {
      name,
      topic: `/${name.split('/')[0]}/joints`,
      unit,
      group,
      kind,
      axis: every === 1 ? 0 : 1,
      values,
      tolerance: this.options.golden ? tolerance : null,
      differing,
      beyond,
      wraps,
      golden: !this.options.golden ? null : differing === 0 ? 'same' : this.blobs.numbers(golden, 'xor-base', actual),
      range: low <= high ? [low, high] : null,
    };
    this.series.push(entry);
    if (first) {
      this.divergences.push({
        tick: first.tick,
        time: first.tick / 1000,
        channel: entry.topic,
        element: name.split('/').slice(1).join('/'),
        series: name,
        expected: json_number(first.expected),
        actual: json_number(first.actual),
        difference: json_number(Math.abs(first.actual - first.expected)),
        tolerance,
        ulps: 12345,
        unit,
        note: '',
        stage: group === 'output' ? 'controller' : 'physics',
        beyond: true,
      });
    }
  }

  late(tick, golden, delay) {
    return golden ? 0 : Math.max(0, tick - this.options.fault - delay);
  }

  knee_strays(tick, golden, delay) {
    return 0.25 * (1 - Math.exp(-this.late(tick, golden, delay) / 250));
  }

  root_z(tick, golden) {
    return pose_at(tick).root[2] - 0.02 * (1 - Math.exp(-this.late(tick, golden, 40) / 400));
  }

  // The fault: from a tick on a gain of the right knee is wrong; the values that depend on it change, too.
  add_walker_series() {
    joints.forEach((joint, i) => {
      const of_knee = joint === 'RIGHT_KNEE';
      const strays = (tick, golden, delay) =>
        of_knee ? this.knee_strays(tick, golden, delay) : 2e-10 * this.late(tick, golden, delay + 5);
      this.add_series(
        `Walker/${joint}/q`,
        'state',
        'rad',
        (tick, golden) => pose_at(tick).joints[i] + strays(tick, golden, 3),
      );
      this.add_series(
        `Walker/${joint}/u`,
        'output',
        'N·m',
        (tick, golden) => 20 * Math.cos(tick / 90 + i) + 100 * strays(tick, golden, -1),
        { tolerance: 1e-5 },
      );
      this.add_series(
        `Walker/${joint}/input/q`,
        'input',
        'rad',
        (tick, golden) => pose_at(tick).joints[i] + strays(tick, golden, 4),
      );
    });
    ['x', 'y', 'z', 'qx', 'qy', 'qz', 'qw'].forEach((name, i) => {
      this.add_series(`Walker/root/${name}`, 'state', i < 3 ? 'm' : '', (tick, golden) =>
        i === 2 ? this.root_z(tick, golden) : pose_at(tick).root[i],
      );
    });
    this.add_series(
      'Walker/Gyro/w.x',
      'sensor',
      'rad/s',
      (tick) => (tick > 200 && tick < 260 ? NaN : Math.sin(tick / 50)),
      { every: 5 },
    );
    this.add_series('Walker/gait_phase', 'variable', '', (tick) => BigInt(Math.floor(tick / 250)), {
      kind: 'signed_integer',
      array: BigInt64Array,
    });
    this.add_series('Walker/LEFT_FOOT/touches', 'sensor', '', (tick) => (Math.floor(tick / 400) % 2 === 0 ? 1 : 0), {
      kind: 'boolean',
      array: Uint8Array,
    });
  }

  add_filling() {
    for (let i = this.series.length; i < this.options.channels; ++i) {
      const base = 0.3 * (i % 7),
        wave = 40 + 13 * (i % 11);
      this.add_series(
        `Plant/section_${String(Math.floor(i / 8)).padStart(2, '0')}/signal_${i}`,
        'other',
        'V',
        (tick, golden) =>
          base +
          Math.sin(tick / wave + i) +
          0.05 * Math.sin(tick * 1.7) +
          (golden || i % 9 !== 0 || tick < this.options.fault + 10 * i ? 0 : 1e-3),
      );
    }
  }

  camera(index) {
    const {
      ticks,
      first_picture,
      picture_every,
      picture_size: [width, height],
      fault,
      golden,
      noise,
    } = this.options;
    const pictures = [];
    const paint = (tick, shift) => {
      const rgb = Buffer.alloc(3 * width * height);
      for (let y = 0, at = 0; y < height; ++y) {
        for (let x = 0; x < width; ++x, at += 3) {
          const inside =
            (x - width / 2 - (width / 3) * Math.sin(tick / 400) - shift) ** 2 + (y - height * 0.6) ** 2 <
            (height / 5) ** 2;
          const tile = (((x + Math.floor(tick / 20)) >> 4) + (y >> 4)) & 1;
          rgb[at] = inside ? 210 : 60 + 40 * tile + (noise ? (7 * x + 13 * y + tick) & 15 : 0);
          rgb[at + 1] = inside ? 120 - index * 40 : 70 + 40 * tile;
          rgb[at + 2] = inside ? 40 : 90 + 40 * tile;
        }
      }
      return this.blobs.picture(encode_png(width, height, rgb));
    };
    for (let tick = first_picture; tick < ticks; tick += picture_every) {
      const strays = this.faulty && tick > fault + 60;
      const actual = paint(tick, strays ? 6 : 0);
      pictures.push({
        tick,
        actual,
        golden: !golden ? null : strays ? paint(tick, 0) : 'same',
        differing: !golden ? null : strays ? 312 : 0,
      });
    }
    return {
      name: `Walker/${['Left', 'Right'][index] ?? index}Camera`,
      topic: `/Walker/Camera${index}/image`,
      kind: 'color',
      width,
      height,
      pictures,
    };
  }

  spans() {
    const { fault, ticks } = this.options;
    return this.faulty && fault < ticks
      ? [
          [fault, Math.min(ticks, fault + 900)],
          [fault + 1000, ticks],
        ].filter(([begin, end]) => begin < end && end <= ticks)
      : [];
  }

  /** The series by their largest difference. */
  worst() {
    return this.series.filter(({ beyond }) => beyond > 0).map(({ name }) => name);
  }

  /** Of three, the fault violates two: the knee bends too far, and the run ends too low. */
  expectations() {
    const last = Math.max(0, this.options.ticks - 1);
    const fails = this.faulty || this.options.fails;
    const expected = (pattern, text, low, high, begin = 0) => {
      const entry = { text, holds: true, sentence: '', line: 9, subject: 'series', pattern, series: null, low, high };
      return { ...entry, begin, end: last, sometime: false, first: null, worst: null };
    };
    const violated = (entry, value_at, unit) => {
      let tick = entry.begin;
      const is_wrong = (value) => value > (entry.high ?? Infinity) || value < (entry.low ?? -Infinity);
      while (tick <= last && !is_wrong(value_at(tick))) ++tick;
      if (!fails || tick > last) return entry;
      const value = Number(value_at(tick).toFixed(6)),
        sentence = `expected ${entry.text}: ${value} ${unit} at tick ${tick} (${tick / 1000} s)`;
      return {
        ...entry,
        holds: false,
        series: entry.pattern,
        sentence,
        first: { tick, value },
        worst: { tick, value },
      };
    };
    return [
      expected('Walker/*/u', 'the magnitude of Walker/*/u below 150 N·m', -150, 150),
      violated(
        expected('Walker/root/z', 'Walker/root/z above 0.86 m at the end', 0.86, null, last),
        (tick) => this.root_z(tick, false),
        'm',
      ),
      violated(
        expected('Walker/RIGHT_KNEE/q', 'Walker/RIGHT_KNEE/q below 0.7 rad', null, 0.7),
        (tick) => pose_at(tick).joints[4] + this.knee_strays(tick, false, 3),
        'rad',
      ),
    ];
  }

  /** As many lines as the options say, in blobs of a thousand. */
  messages() {
    const { lines, ticks } = this.options,
      blobs = [];
    for (let first = 0; first < lines; first += 1000) {
      const rows = [];
      for (let i = first; i < Math.min(first + 1000, lines); ++i)
        rows.push([0, Math.floor((i * ticks) / lines), 'note', 'WalkerController', `line ${i}`]);
      blobs.push(this.blobs.text(JSON.stringify(rows), { messages: rows.length }));
    }
    return { all: lines, first: 0, blobs };
  }

  events() {
    const { ticks, fault } = this.options;
    const events = [{ run: 0, tick: 0, severity: 'note', source: 'WalkerController', text: 'gait: standing' }];
    for (let tick = 250; tick < ticks && events.length < 400; tick += 250) {
      events.push({
        run: 0,
        tick,
        severity: 'note',
        source: 'WalkerController',
        text: `gait: step ${tick / 250}, phase ${tick % 500 === 0 ? 'left' : 'right'}`,
      });
    }
    if (this.faulty)
      events.push({
        run: 0,
        tick: fault + 12,
        severity: 'warning',
        source: 'WalkerController',
        text: 'knee torque is saturated: 103.2 N·m of 100 N·m',
      });
    return events.filter((event) => event.tick < ticks).sort((a, b) => a.tick - b.tick);
  }

  contacts() {
    const contacts = [];
    for (let run = 0; run < (this.options.golden ? 2 : 1); ++run) {
      for (let tick = 100, step = 0; tick < this.options.ticks; tick += 400, ++step) {
        const foot = ['Walker/LEFT_FOOT', 'Walker/RIGHT_FOOT'][step % 2];
        contacts.push(
          { run, tick, a: foot, b: 'Floor/Floor', begins: true },
          {
            run,
            tick: tick + 500 + (run === 0 && this.faulty && tick > 700 ? 23 : 0),
            a: foot,
            b: 'Floor/Floor',
            begins: false,
          },
        );
      }
    }
    return contacts.filter((contact) => contact.tick < this.options.ticks).sort((a, b) => a.tick - b.tick);
  }

  run(role) {
    const golden = role === 'golden';
    const facts = {
      rehearse: '0.1.0',
      seed: '42',
      compiler: 'g++ 12.2',
      processor: 'x86-64, 2 cores',
      pinned: 'yes',
      'controller WalkerController': golden ? 'build id 4f1c0a77' : 'build id 93be21d0',
      'model walker.urdf': 'xxh3 5be0cd19137e2179',
    };
    const scenario = `rehearse: 1\nname: Walk\nduration: ${this.options.ticks / 1000}\nbodies:\n  - name: Walker\n    model: walker.urdf\n    controller: WalkerController\n    options: "gain ${golden ? 100 : 140}"\n`;
    return {
      role,
      file: golden ? 'golden/Walk.mcap' : 'Walk.mcap',
      ticks: Math.max(0, this.options.ticks - 1),
      complete: true,
      outcome: '',
      facts,
      scenario,
      remarks: golden || this.options.equal ? [] : ['The controller is another build than the golden’s.'],
    };
  }

  coverage() {
    const { coverage } = this.options;
    if (!coverage) return null;
    const { lines, lines_executed } = coverage;
    return this.blobs.text(JSON.stringify(coverage), { lines, lines_executed });
  }

  /** A page of the coverage of recordings. */
  coverage_object() {
    const sentence = this.options.coverage.verdict;
    return {
      format: 1,
      title: `${this.options.coverage.recordings.length} recordings`,
      rehearse: '0.1.0',
      verdict: { sentence, besides: sentence, state: 'coverage', notes: [] },
      ...{ time_step: 1, begin: 0, end: 0, first: null, call_stack: null, coverage: this.coverage() },
      ...{ runs: [], expectations: [], divergences: [], worst: [], control_times: [], spans: [], axes: [], series: [] },
      ...{ cameras: [], events: [], contacts: [], robots: [], meshes: [], omitted: [] },
    };
  }

  object() {
    if (this.options.coverage_alone) return this.coverage_object();
    const { options } = this;
    const with_series = options.channels > 0;
    if (with_series && options.robot) this.add_walker_series();
    this.add_filling();
    this.divergences.sort((a, b) => a.tick - b.tick);
    const first = this.divergences[0];
    const cameras = Array.from({ length: options.cameras }, (_, i) => this.camera(i));
    const every_fifth = Uint32Array.from({ length: Math.ceil(options.ticks / 5) }, (_, i) => 5 * i);
    const { robots, meshes } = options.robot
      ? walker(this.blobs, options.mesh, with_series)
      : { robots: [], meshes: [] };
    const expectations = options.expectations && with_series && options.robot ? this.expectations() : [];
    const state = !options.golden ? 'alone' : first ? 'beyond' : 'equal';
    const is_violated = expectations.some(({ holds }) => !holds);
    const sentences = {
      alone: 'A run alone: there is nothing to compare it with.',
      equal: 'Every number, picture and event has the same bits as the golden’s.',
      beyond:
        first &&
        `Tick ${first.tick} (${first.time.toFixed(3)} s): ${first.series} is ${Number(first.actual).toFixed(6)} ${first.unit}, expected ${Number(first.expected).toFixed(6)} ${first.unit}; from the same inputs the controller gave another command.`,
    };
    return {
      format: 1,
      title: 'Walk',
      rehearse: '0.1.0',
      verdict: {
        sentence: sentences[state],
        besides: sentences[state],
        state: options.state ?? (is_violated ? 'violated' : state),
        notes: options.notes ?? [],
        ...(options.levels && { levels: options.levels }),
      },
      time_step: 0.001,
      begin: 0,
      end: options.ticks,
      runs: options.golden ? [this.run('actual'), this.run('golden')] : [this.run('actual')],
      expectations,
      divergences: this.divergences,
      worst: this.worst(),
      first: first ? 0 : null,
      call_stack: options.call_stack,
      control_times: options.control_times,
      coverage: this.coverage(),
      spans: this.spans(),
      axes: [{ begin: 0, count: options.ticks }, { ticks: this.blobs.numbers(every_fifth, 'columns') }],
      series: this.series,
      cameras,
      events: options.events ? this.events() : [],
      ...(options.lines > 0 && { messages: this.messages() }),
      contacts: options.events ? this.contacts() : [],
      robots,
      meshes,
      omitted: options.cameras === 0 ? ['Point clouds are left out: the page draws none.'] : [],
    };
  }
}

/** The text of a report. `page`: the text of the built page. */
export function make_report(page, options = {}) {
  const maker = new Maker(options);
  const object = JSON.stringify(maker.object()).replaceAll('<', '\\u003c');
  const data = `<script type="application/json" id="report">${object}</script>\n${maker.blobs.elements.join('\n')}\n`;
  const [head, tail] = page.split(marker);
  return head.replace('<!doctype html>', '<!doctype html><!-- a report of Rehearse -->') + data + tail;
}

function main() {
  const number = { type: 'string' },
    flag = { type: 'boolean' };
  const { values, positionals } = parseArgs({
    allowPositionals: true,
    options: {
      ticks: number,
      channels: number,
      cameras: number,
      fault: number,
      'picture-every': number,
      alone: flag,
      equal: flag,
      'no-robot': flag,
      'no-events': flag,
      large: flag,
    },
  });
  const [page, out] = positionals;
  const options = {
    equal: values.equal,
    golden: !values.alone,
    robot: !values['no-robot'],
    events: !values['no-events'],
  };
  for (const name of ['ticks', 'channels', 'cameras', 'fault'])
    if (values[name] !== undefined) options[name] = Number(values[name]);
  if (values['picture-every']) options.picture_every = Number(values['picture-every']);
  if (values.large) options.picture_size = [320, 240];
  writeFileSync(out, make_report(readFileSync(page, 'utf8'), options));
}

if (process.argv[1] === fileURLToPath(import.meta.url)) main();

// The data of the page: series with the ticks of their values, found by name, decoded on demand and kept in a cache.
import { as_doubles, numbers_of, text_of, type Numbers } from './blobs';
import { contact_entry, contact_values, pairs_of_links, type PairOfLinks } from './contacts';
import type { AxisEntry, ReportData, SeriesEntry } from './format';

type Column = ReturnType<typeof as_doubles>;

/** The ticks that a series has values at, ascending. */
export class Axis {
  private constructor(
    readonly begin: number,
    readonly count: number,
    private readonly ticks: Uint32Array | null,
  ) {}

  static of_ticks(begin: number, count: number): Axis {
    return new Axis(begin, count, null);
  }

  static async load(entry: AxisEntry): Promise<Axis> {
    if (!entry.ticks) return new Axis(entry.begin ?? 0, entry.count ?? 0, null);
    const ticks = (await numbers_of(entry.ticks)) as Uint32Array;
    return new Axis(ticks[0] ?? 0, ticks.length, ticks);
  }

  tick(index: number): number {
    return this.ticks ? this.ticks[index]! : this.begin + index;
  }

  /** Index of the last value at or before that tick, -1 if there is none. */
  index_at(tick: number): number {
    if (!this.ticks) return Math.min(Math.floor(tick) - this.begin, this.count - 1);
    let low = 0,
      high = this.count;
    while (low < high) {
      const middle = (low + high) >> 1;
      if (this.ticks[middle]! <= tick) low = middle + 1;
      else high = middle;
    }
    return low - 1;
  }
}

/** One run's values of a series. */
export interface Values {
  axis: Axis;
  numbers: Column;
  exact: BigInt64Array | BigUint64Array | null;
}

/** What a series is at a tick, and the tick that this value came at. */
export interface Sample {
  tick: number;
  value: number;
  text: string | null;
}

/** Both runs' values of a series; either may be absent. */
export class Columns {
  difference_: Float64Array | null = null;

  constructor(
    readonly series: Series,
    readonly actual: Values | null,
    readonly golden: Values | null,
  ) {}

  /** Golden and run are the same array: bit for bit equal. */
  get same(): boolean {
    return this.actual !== null && this.actual === this.golden;
  }

  get bytes(): number {
    return (this.actual?.numbers.byteLength ?? 0) + (this.same ? 0 : (this.golden?.numbers.byteLength ?? 0));
  }

  /** The first tick with the smallest or largest finite value, of the run, or of the golden if there is no run; null: none. */
  extreme_tick(which: 'min' | 'max'): number | null {
    const values = this.actual ?? this.golden;
    let best = -1;
    values?.numbers.forEach((value, i) => {
      if (!Number.isFinite(value)) return;
      const extreme = best < 0 ? value : values.numbers[best]!;
      if (best < 0 || (which === 'min' ? value < extreme : value > extreme)) best = i;
    });
    return best < 0 ? null : values!.axis.tick(best);
  }

  static sample(values: Values | null, tick: number): Sample | null {
    if (!values) return null;
    const index = values.axis.index_at(tick);
    if (index < 0) return null;
    return {
      tick: values.axis.tick(index),
      value: values.numbers[index]!,
      text: values.exact ? String(values.exact[index]) : null,
    };
  }

  /** Of each of the run's values, run minus golden; NaN where the golden has none. */
  get difference(): Float64Array | null {
    if (!this.actual || !this.golden) return null;
    if (this.difference_) return this.difference_;
    const { axis, numbers } = this.actual;
    const golden = this.golden;
    const difference = new Float64Array(numbers.length);
    for (let i = 0; i < difference.length; ++i) {
      const tick = axis.tick(i);
      const at = golden.axis === axis ? i : golden.axis.index_at(tick);
      const there = at >= 0 && at < golden.numbers.length && golden.axis.tick(at) === tick;
      difference[i] = there ? this.series.difference(golden.numbers[at]!, numbers[i]!) : NaN;
    }
    return (this.difference_ = difference);
  }
}

export class Series {
  private loading: Promise<Columns> | null = null;
  private columns_: Columns | null = null;

  constructor(
    private readonly report: Report,
    readonly entry: SeriesEntry,
    private readonly contact: PairOfLinks | null = null,
  ) {}

  get name() {
    return this.entry.name;
  }

  get compared() {
    if (this.contact) return this.report.compared;
    return this.entry.values !== null && this.entry.golden !== null;
  }

  /** The values if they are decoded. */
  get columns(): Columns | null {
    return this.columns_;
  }

  load(): Promise<Columns> {
    this.loading ??= this.decode();
    return this.loading;
  }

  /** Run minus golden, of angles of one turn the shorter way round; equal numbers that aren't finite differ by 0. */
  difference(golden: number, actual: number): number {
    if (Object.is(golden, actual) || golden === actual) return 0;
    const difference = actual - golden;
    return this.entry.wraps ? difference - 2 * Math.PI * Math.round(difference / (2 * Math.PI)) : difference;
  }

  /** What the run may differ by from the golden; null: nothing is said. */
  get tolerance(): number | null {
    return this.entry.tolerance === null ? null : Number(this.entry.tolerance);
  }

  private async decode(): Promise<Columns> {
    const { entry, report } = this;
    if (this.contact) return this.take(contact_columns(this, report, this.contact));
    const axis = report.axes[entry.axis] ?? null;
    const numbers = entry.values && axis ? await numbers_of(entry.values) : undefined;
    const actual = numbers && axis ? values_of(axis, numbers) : null;
    let golden: Values | null = null;
    if (entry.golden === 'same') {
      golden = actual;
    } else if (entry.golden) {
      const golden_axis = report.axes[entry.golden_axis ?? entry.axis];
      if (golden_axis) golden = values_of(golden_axis, await numbers_of(entry.golden, numbers));
    }
    return this.take(new Columns(this, actual, golden));
  }

  private take(columns: Columns): Columns {
    this.columns_ = columns;
    this.report.keep(this, columns);
    return columns;
  }

  forget() {
    this.loading = this.columns_ = null;
  }
}

function values_of(axis: Axis, numbers: Numbers): Values {
  const exact = numbers instanceof BigInt64Array || numbers instanceof BigUint64Array ? numbers : null;
  return { axis, numbers: as_doubles(numbers), exact };
}

function contact_columns(series: Series, report: Report, pair: PairOfLinks): Columns {
  const axis = Axis.of_ticks(report.data.begin, report.ticks);
  const values = (run: number): Values | null =>
    report.data.runs[run] ? { axis, numbers: contact_values(pair, run, report.data), exact: null } : null;
  return new Columns(series, values(0), values(1));
}

// Size of the cache of decoded numbers.
const room = 600e6;

export class Report {
  axes: Axis[] = [];
  readonly series: Series[];
  readonly pairs: PairOfLinks[];
  private readonly by_name = new Map<string, Series>();
  private readonly kept = new Map<Series, number>();
  private kept_bytes = 0;

  private constructor(readonly data: ReportData) {
    this.pairs = pairs_of_links(data);
    this.series = [
      ...data.series.map((entry) => new Series(this, entry)),
      ...this.pairs.map((pair) => new Series(this, contact_entry(pair, data), pair)),
    ];
    for (const series of this.series) this.by_name.set(series.name, series);
  }

  /** What stands in this page; null if it has no data at all. An error if they aren't what we know. */
  static async load(): Promise<Report | null> {
    const text = await text_of('report');
    if (text === null) return null;
    const data = JSON.parse(text) as ReportData;
    if (data.format !== 1)
      throw new Error(`the data of this report have format ${data.format}; this page knows format 1`);
    const report = new Report(data);
    report.axes = await Promise.all(data.axes.map((axis) => Axis.load(axis)));
    return report;
  }

  find(name: string): Series | null {
    return this.by_name.get(name) ?? null;
  }

  get compared(): boolean {
    return this.data.runs.length > 1;
  }

  get has_numbers(): boolean {
    return this.ticks > 0 && this.series.length > 0;
  }

  get ticks(): number {
    return this.data.end - this.data.begin;
  }

  get last(): number {
    return Math.max(this.data.begin, this.data.end - 1);
  }

  /** [s] */
  time(tick: number): number {
    return tick / (1 / this.data.time_step);
  }

  tick_at(time: number): number {
    return time * (1 / this.data.time_step);
  }

  /** Forgets those that were decoded longest ago, if these are too many. Who uses them holds on to them. */
  keep(series: Series, columns: Columns) {
    this.kept.set(series, columns.bytes);
    this.kept_bytes += columns.bytes;
    for (const [oldest, bytes] of this.kept) {
      if (this.kept_bytes <= room || oldest === series) break;
      this.kept.delete(oldest);
      this.kept_bytes -= bytes;
      oldest.forget();
    }
  }
}

// Moves from divergence to divergence, and selects the series to plot for one.
import { go_to_expectation, tick_of, violations } from './expectations';
import type { DivergenceEntry } from './format';
import type { Report, Series } from './report';
import type { Store } from './store';

const most_plots = 9;

/** SR1/RLEG_KNEE of SR1/RLEG_KNEE/q. */
function owner_of(name: string): string {
  return name.slice(0, name.lastIndexOf('/'));
}

export class Tour {
  constructor(
    private readonly store: Store,
    private readonly report: Report,
  ) {}

  get first(): DivergenceEntry | null {
    const { first, divergences } = this.report.data;
    return first === null ? null : (divergences[first] ?? null);
  }

  /** The tick at which the page opens: of the first divergence, else of the first violation; null: there is none. */
  get start(): number | null {
    return this.first ? this.first.tick : this.first_violation;
  }

  /** A sentence: where the page opens, and why. `linked`: the tick in the address; null: none. `before`: the text that it
   * follows. Empty: at the beginning. */
  opening(linked: number | null, before: string): string {
    const { first, first_violation } = this;
    if (linked !== null && linked !== this.start) return `Opened at tick ${linked}, which the link names.`;
    if (first) {
      const kind = first.beyond ? 'difference beyond tolerance' : 'difference';
      const is_named = new RegExp(`\\btick ${first.tick}\\b`, 'i').test(before);
      if (is_named) return `The page opened there, at the first ${kind}.`;
      return `Opened at the first ${kind}: tick ${first.tick}, ${first.series ?? first.channel}.`;
    }
    return first_violation === null ? '' : `Opened at the first violated expectation: tick ${first_violation}.`;
  }

  /** Whether the first divergence is in pictures. */
  get is_about_pictures(): boolean {
    return this.report.data.cameras.some((camera) => camera.topic === this.first?.channel);
  }

  /** The tick of the first violated expectation; null: all hold. */
  get first_violation(): number | null {
    const [violated] = violations(this.report);
    return violated ? tick_of(violated) : null;
  }

  /** The first tick with a picture of each camera; null: there is no camera. */
  get first_complete_view(): number | null {
    const firsts = this.report.data.cameras.map((camera) => camera.pictures[0]?.tick ?? 0);
    return firsts.length > 0 ? Math.max(...firsts) : null;
  }

  /** Ticks at which something diverges or violates an expectation, without repetition. */
  private get ticks(): number[] {
    const ticks = [...this.report.data.divergences.map((entry) => entry.tick), ...violations(this.report).map(tick_of)];
    return [...new Set(ticks)].sort((a, b) => a - b);
  }

  go_to_violation() {
    const [violated] = violations(this.report);
    if (violated) go_to_expectation(this.store, violated);
  }

  /** To the first; its series is plotted if it isn't. */
  go_to_first() {
    if (this.first) this.go_to(this.first);
  }

  go_to(entry: DivergenceEntry) {
    this.store.go(entry.tick);
    if (entry.series && !this.store.shown.includes(entry.series)) this.store.show([entry.series, ...this.store.shown]);
  }

  next() {
    const tick = this.ticks.find((one) => one > this.store.tick);
    if (tick !== undefined) this.store.go(tick);
  }

  previous() {
    const tick = this.ticks.findLast((one) => one < this.store.tick);
    if (tick !== undefined) this.store.go(tick);
  }

  /** Series in the order in which they diverge beyond tolerance; those that don't behind them, as they were. */
  static in_order(report: Report, series: readonly Series[]): Series[] {
    const place = new Map<string, number>();
    report.data.divergences.forEach((entry, i) => {
      if (entry.beyond && entry.series && !place.has(entry.series)) place.set(entry.series, i);
    });
    const rank = ({ name, entry }: Series) => place.get(name) ?? (entry.beyond > 0 ? 1e9 : Infinity);
    return [...series].sort((a, b) => (rank(a) === rank(b) ? 0 : rank(a) - rank(b)));
  }

  /** The series to plot first: those of violated expectations, then the first divergence with the commands beside it,
   * then the worst differences. Of a run that isn't compared, or is equal: see series_of_a_run(). */
  series_to_open_with(): string[] {
    const { report, first } = this;
    const names = new Set<string>();
    const add = (name: string | null | undefined, most = most_plots) => {
      if (name && names.size < most && report.find(name)) names.add(name);
    };
    for (const entry of violations(report)) add(entry.series, most_plots - 1);
    if (first?.series && first.beyond) {
      add(first.series);
      const owner = owner_of(first.series);
      const beside = report.series.filter((series) => owner_of(series.name) === owner);
      for (const { name } of beside.filter(({ entry }) => entry.group === 'output')) add(name);
    }
    // /tf repeats poses that other series state
    const repeats = (name: string) => Number(report.find(name)?.entry.group === 'other');
    for (const name of [...report.data.worst].sort((a, b) => repeats(a) - repeats(b))) add(name);
    if (names.size < 2) for (const name of this.series_of_a_run()) add(name);
    return [...names];
  }

  /** The root's position, contacts, and the largest commands. */
  private series_of_a_run(): string[] {
    const { report } = this;
    const moves = (name: string) => {
      const range = report.find(name)?.entry.range;
      return range ? range[1] > range[0] : false;
    };
    const roots = report.data.robots
      .map(({ links }) => ({ links, position: (links[0]?.pose ?? []).slice(0, 3) }))
      .filter(({ position }) => position.some(moves))
      .sort((a, b) => b.links.length - a.links.length);
    const [x, y, z] = roots[0]?.position ?? [];
    const size = ({ entry: { range } }: Series) => (range ? Math.max(-range[0], range[1]) : 0);
    const commands = report.series.filter(({ entry }) => entry.group === 'output').sort((a, b) => size(b) - size(a));
    const names = [z, x, y].filter((name): name is string => name !== undefined && moves(name)).slice(0, 2);
    names.push(...report.pairs.slice(0, 4).map((pair) => pair.name), ...commands.slice(0, 3).map(({ name }) => name));
    return names.length > 0 ? names : report.series.slice(0, 3).map(({ name }) => name);
  }
}

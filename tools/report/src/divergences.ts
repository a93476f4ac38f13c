// Moves from divergence to divergence, and selects the series to plot for one.
import type { DivergenceEntry } from './format';
import type { Report, Series } from './report';
import type { Store } from './store';

const most_plots = 6;

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

  /** Ticks at which something diverges, without repetition. */
  private get ticks(): number[] {
    return [...new Set(this.report.data.divergences.map((entry) => entry.tick))].sort((a, b) => a - b);
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

  /** What one wants to see first: the series that diverges first, commands and inputs beside it, and what diverges next;
   * of a run alone, its first commands. */
  series_to_open_with(): string[] {
    const { report, first } = this;
    const names: string[] = [];
    const add = (series: Series | null | undefined) => {
      if (series && !names.includes(series.name) && names.length < most_plots) names.push(series.name);
    };
    if (first?.series) {
      add(report.find(first.series));
      const owner = owner_of(first.series);
      const beside = report.series.filter((series) => owner_of(series.name) === owner);
      for (const series of beside.filter(({ entry }) => entry.group === 'output')) add(series);
    }
    const diverging = report.data.divergences.filter((entry) => entry.beyond);
    for (const entry of diverging.slice(0, 40)) {
      if (names.length >= 4) break;
      if (entry.series) add(report.find(entry.series));
    }
    if (names.length === 0) {
      const commands = report.series.filter(({ entry }) => entry.group === 'output');
      for (const series of (commands.length > 0 ? commands : report.series).slice(0, 3)) add(series);
    }
    return names;
  }
}

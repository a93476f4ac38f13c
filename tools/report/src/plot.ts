// A plot of one series: golden, run and tolerance, below them their difference.
import uPlot from 'uplot';
import { curves_in_view, type Curves } from './decimate';
import { button, element, set_name, set_text } from './dom';
import { concerns } from './expectations';
import type { ExpectationEntry } from './format';
import { axis_texts, difference_text, short_text, value_text } from './numbers';
import { Columns, type Report, type Series } from './report';
import type { Store } from './store';
import { palette } from './theme';

const values_height = 96,
  difference_height = 64,
  state_height = 30, // of two states, as contacts
  axis_width = 66;

/** Zoom and cursor of all plots go through the store; the line under the mouse is shared by this key. */
const sync_key = 'rehearse';

interface Chart {
  width: number;
  height: number;
  series: uPlot.Series[];
  times: boolean; // whether times are shown below the plot
  space: number; // between the numbers beside it, at least [pixels]
  range: () => [number, number];
}

export class Plot {
  readonly root: HTMLElement;
  private readonly readout = element('span', { class: 'readout' });
  private readonly charts = element('div', { class: 'charts' });
  private readonly markers: HTMLElement[] = [];
  private values: uPlot | null = null;
  private difference: uPlot | null = null;
  private readonly bounds: ExpectationEntry[]; // expectations of this series that bound its values
  private columns: Columns | null = null;
  private curves: Curves | null = null;
  visible = false;

  constructor(
    private readonly store: Store,
    private readonly report: Report,
    readonly series: Series,
  ) {
    const { name, unit } = series.entry;
    this.bounds = report.data.expectations.filter(
      (entry) => (entry.low !== null || entry.high !== null) && concerns(entry, series),
    );
    const title = element('h3', { title: name });
    set_name(title, name);
    this.root = element(
      'section',
      { class: 'plot', 'aria-label': `plot of ${name}`, 'data-series': name },
      element(
        'header',
        {},
        title,
        element('span', { class: 'unit' }, unit ? `[${unit}]` : ''),
        this.readout,
        this.extreme('min', 'smallest'),
        this.extreme('max', 'largest'),
        button('×', `Close the plot of ${name}`, () => store.toggle(name), { class: 'quiet' }),
      ),
      this.charts,
    );
    this.charts.style.minHeight = `${this.height}px`;
    this.charts.append(element('p', { class: 'absence' }, 'Decoding…'));
  }

  /** A button that moves the cursor to the first tick with that value of the run, as the most expensive control(). */
  private extreme(which: 'min' | 'max', word: string) {
    const go = async () => {
      const tick = (await this.series.load()).extreme_tick(which);
      if (tick !== null) this.store.go(tick);
    };
    return button(which, `Go to the ${word} value of ${this.series.name}`, () => void go(), { class: 'quiet' });
  }

  private get has_two_states() {
    return ['boolean', 'contact'].includes(this.series.entry.kind);
  }

  private get has_difference() {
    return this.series.compared && this.series.entry.differing > 0 && !this.has_two_states;
  }

  private get height() {
    if (this.has_two_states) return state_height;
    return values_height + (this.has_difference ? difference_height : 22);
  }

  /** The tick at which the line stands, by where it is on the screen; null if it isn't in view. */
  get drawn_tick(): number | null {
    const marker = this.markers[0];
    if (!marker || !this.values || marker.hidden) return null;
    const left = marker.getBoundingClientRect().left - this.values.over.getBoundingClientRect().left;
    return Math.round(this.report.tick_at(this.values.posToVal(left, 'x')));
  }

  async load() {
    try {
      this.columns = await this.series.load();
      if (this.visible) this.draw();
    } catch (error) {
      this.charts.replaceChildren(
        element('p', { class: 'absence error' }, error instanceof Error ? error.message : String(error)),
      );
    }
  }

  set_visible(visible: boolean) {
    if (visible === this.visible) return;
    this.visible = visible;
    if (!visible) this.clear();
    else if (this.columns) this.draw();
    else void this.load();
  }

  clear() {
    this.values?.destroy();
    this.difference?.destroy();
    this.values = this.difference = null;
    this.markers.length = 0;
  }

  /** From the start: a new width, new colours. */
  redraw() {
    if (!this.visible || !this.columns) return;
    this.clear();
    this.draw();
  }

  private draw() {
    if (this.values) return;
    this.charts.replaceChildren();
    const width = this.charts.clientWidth;
    if (width === 0) return;
    this.cut_curves(width);
    const compared = this.has_difference;
    this.values = this.chart({
      width,
      height: compared ? values_height : this.height,
      series: this.value_series(),
      times: !compared && !this.has_two_states,
      space: 20,
      range: () => this.value_range(),
    });
    if (compared)
      this.difference = this.chart({
        width,
        height: difference_height,
        series: this.difference_series(),
        times: true,
        space: 15,
        range: () => this.difference_range(),
      });
    this.give_data();
    this.move_cursor();
  }

  private cut_curves(width: number) {
    this.curves = curves_in_view(this.columns!, this.store.view, width - axis_width, (tick) => this.report.time(tick));
  }

  /** The view has changed. */
  update_view() {
    if (!this.values || !this.columns) return;
    this.cut_curves(this.charts.clientWidth);
    this.give_data();
    this.move_cursor();
  }

  private give_data() {
    const { time, golden, actual, lower, upper, difference, beyond, bound } = this.curves!;
    const down = bound.map((value) => (typeof value === 'number' ? -value : value));
    this.values?.setData([time, lower, upper, golden, actual] as uPlot.AlignedData);
    this.difference?.setData([time, down, bound, difference, beyond] as uPlot.AlignedData);
  }

  private value_series(): uPlot.Series[] {
    const colors = palette();
    const points = { show: (_: uPlot, __: number) => this.few_points, size: 4 };
    const stepped = this.series.entry.kind === 'floating' ? undefined : uPlot.paths.stepped!({ align: 1 });
    const line = (stroke: string, width: number): uPlot.Series => ({
      stroke,
      width,
      points,
      ...(stepped ? { paths: stepped } : {}),
    });
    return [
      {},
      { points: { show: false } },
      { points: { show: false } },
      line(colors.golden, 2.5),
      line(colors.actual, 1.25),
    ];
  }

  private difference_series(): uPlot.Series[] {
    const colors = palette();
    const bound = { stroke: colors.golden, width: 1, dash: [4, 3], points: { show: false } };
    return [
      {},
      bound,
      bound,
      { stroke: colors.muted, width: 1, points: { show: false } },
      { stroke: colors.bad, width: 1.5, points: { show: () => this.few_points, size: 4 } },
    ];
  }

  private get few_points() {
    return this.curves!.raw && this.curves!.time.length < 120;
  }

  // Shows the tolerance only as far as the curves stay readable.
  private value_range(): [number, number] {
    const curves = this.curves!;
    if (this.has_two_states) return [-0.2, 1.2];
    if (curves.low > curves.high) return [-1, 1];
    const spread = curves.high - curves.low;
    const room = Math.max(
      spread * 0.08,
      Math.abs(curves.high) * 1e-9,
      spread === 0 ? Math.max(Math.abs(curves.high) * 0.05, 1e-6) : 0,
    );
    let { low, high } = curves;
    for (let i = 0; i < curves.time.length; ++i) {
      const lower = curves.lower[i],
        upper = curves.upper[i];
      if (typeof lower === 'number') low = Math.min(low, Math.max(lower, curves.low - spread));
      if (typeof upper === 'number') high = Math.max(high, Math.min(upper, curves.high + spread));
    }
    for (const bound of this.bounds.flatMap((entry) => [entry.low, entry.high])) {
      if (bound === null || bound < curves.low - 2 * spread || bound > curves.high + 2 * spread) continue;
      low = Math.min(low, bound);
      high = Math.max(high, bound);
    }
    return [low - room, high + room];
  }

  private difference_range(): [number, number] {
    const curves = this.curves!;
    let largest = curves.largest;
    for (const bound of curves.bound) {
      if (typeof bound === 'number')
        largest = Math.max(largest, curves.largest > 0 ? Math.min(bound, 3 * curves.largest) : bound);
    }
    if (largest === 0) largest = 1e-6;
    return [-1.15 * largest, 1.15 * largest];
  }

  private chart({ width, height, series, times, space, range }: Chart): uPlot {
    const colors = palette();
    const { store, report } = this;
    const font = `12px ${getComputedStyle(document.documentElement).getPropertyValue('--sans')}`;
    const grid = { stroke: colors.line, width: 1 };
    const axis = { stroke: colors.muted, grid, font, ticks: { show: false } };
    const chart = new uPlot(
      {
        width,
        height,
        series,
        pxAlign: false,
        padding: [6, 14, times ? 0 : 4, 0],
        legend: { show: false },
        scales: {
          x: { time: false, range: () => [report.time(store.view.begin), report.time(store.view.end)] },
          y: { range },
        },
        axes: [
          {
            ...axis,
            show: times,
            size: 22,
            gap: 4,
            space: 70,
            values: (_, splits) => splits.map((split) => `${Number(split.toPrecision(9))} s`),
          },
          {
            ...axis,
            size: axis_width,
            gap: 6,
            space,
            values: (_, splits) =>
              this.has_two_states ? [] : axis_texts(splits.map((split) => Number(split.toPrecision(9)))),
          },
        ],
        bands: [{ series: [2, 1], fill: colors.band }],
        cursor: {
          y: false,
          points: { show: false },
          drag: { x: true, y: false, setScale: false },
          sync: { key: sync_key, scales: ['x', null] },
          bind: { dblclick: () => () => (store.look_at_all(), null) },
        },
        hooks: {
          draw: [
            (self) => {
              if (self === this.values || !this.values) this.draw_bounds(self);
              this.move_cursor();
            },
          ],
          setSelect: [
            (self) => {
              if (self.select.width < 3) return;
              const [from, to] = [self.select.left, self.select.left + self.select.width].map((left) =>
                report.tick_at(self.posToVal(left, 'x')),
              );
              self.setSelect({ left: 0, top: 0, width: 0, height: 0 }, false);
              store.look_at(from!, to!);
            },
          ],
        },
      },
      [[], [], [], [], []] as uPlot.AlignedData,
      this.charts,
    );
    const marker = element('div', { class: 'cursor-line', 'aria-hidden': 'true' });
    chart.over.append(marker);
    let pressed = 0;
    chart.over.addEventListener('mousedown', (event) => (pressed = event.clientX));
    chart.over.addEventListener('click', (event) => {
      // the end of a drag also causes a click
      if (Math.abs(event.clientX - pressed) < 3)
        store.go(report.tick_at(chart.posToVal(event.clientX - chart.over.getBoundingClientRect().left, 'x')));
    });
    this.markers.push(marker);
    return chart;
  }

  // Of an expectation, the bounds over the judged ticks with their margin, and the first violation.
  private draw_bounds(chart: uPlot) {
    if (this.bounds.length === 0) return;
    const colors = palette(),
      { ctx: context, bbox } = chart,
      scale = window.devicePixelRatio || 1;
    const x_of = (tick: number) => chart.valToPos(this.report.time(tick), 'x', true);
    context.save();
    context.beginPath();
    context.rect(bbox.left, bbox.top, bbox.width, bbox.height);
    context.clip();
    for (const entry of this.bounds) {
      context.strokeStyle = context.fillStyle = entry.holds ? colors.good : colors.bad;
      context.lineWidth = 1.5 * scale;
      context.setLineDash([6 * scale, 4 * scale]);
      const [begin, end] = [x_of(entry.begin), x_of(entry.end)];
      const margin = entry.sometime ? 0 : (entry.margin ?? 0); // else no sample is nearer to a bound
      for (const [bound, nearest] of [
        [entry.low, (entry.low ?? 0) + margin],
        [entry.high, (entry.high ?? 0) - margin],
      ] as const) {
        if (bound === null) continue;
        const y = chart.valToPos(bound, 'y', true);
        const left = Math.min(begin, end - 12 * scale);
        context.globalAlpha = 0.15; // of the band between the bound and the value nearest to it, or farthest beyond it
        context.fillRect(left, y, end - left, chart.valToPos(nearest, 'y', true) - y);
        context.globalAlpha = 1;
        context.beginPath();
        context.moveTo(left, y);
        context.lineTo(end, y);
        context.stroke();
      }
      if (!entry.first || entry.series !== this.series.name) continue;
      const sample = Columns.sample(this.columns?.actual ?? null, entry.first.tick);
      if (!sample) continue;
      context.beginPath();
      context.arc(x_of(entry.first.tick), chart.valToPos(sample.value, 'y', true), 4 * scale, 0, 2 * Math.PI);
      context.fill();
    }
    context.restore();
  }

  /** The line at the cursor's tick, and what the series is there. */
  move_cursor() {
    const { store, report, columns } = this;
    const chart = this.values;
    if (!chart) return;
    const left = chart.valToPos(report.time(store.tick), 'x');
    const outside = !(left >= -0.5 && left <= chart.over.clientWidth + 0.5);
    for (const marker of this.markers) {
      marker.hidden = outside;
      marker.style.transform = `translateX(${left.toFixed(2)}px)`;
    }
    if (columns) this.read_out(columns);
  }

  private read_out(columns: Columns) {
    const { store, series } = this;
    const golden = Columns.sample(columns.golden, store.tick),
      actual = Columns.sample(columns.actual, store.tick);
    const { kind } = series.entry;
    if (this.readout.childElementCount === 0) {
      this.readout.append(...['golden', 'actual', 'difference'].map((part) => element('span', { class: part })));
    }
    const [golden_part, actual_part, difference_part] = [...this.readout.children] as HTMLElement[];
    const compared = series.compared && golden && actual;
    const difference = compared ? series.difference(golden.value, actual.value) : null;
    const bound = compared ? series.tolerance : null;
    const beyond = difference !== null && series.entry.beyond > 0 && !(Math.abs(difference) <= (bound ?? 0));
    set_text(golden_part!, this.report.compared ? (golden?.text ?? value_text(golden?.value ?? null, kind)) : '');
    set_text(actual_part!, actual?.text ?? value_text(actual?.value ?? null, kind));
    set_text(
      difference_part!,
      !series.compared
        ? ''
        : columns.same
          ? 'same bits'
          : `Δ ${difference_text(difference)}${bound === null ? '' : ` of ±${short_text(bound)}`}`,
    );
    difference_part!.classList.toggle('beyond', beyond);
  }
}

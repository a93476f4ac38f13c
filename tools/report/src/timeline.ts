// The time line: differences, contacts, messages, and the cursor. Dragging along the ruler moves the cursor, dragging
// below it zooms; the strip at the bottom shows the whole run and moves the view.
import { element, fit_canvas } from './dom';
import { short_text, time_text } from './numbers';
import type { Report } from './report';
import type { Store } from './store';
import { palette, type Palette } from './theme';
import { series_of_expectation, tick_of, violations } from './expectations';

const gutter = 88,
  right = 12;
const ruler = 22,
  lane = 16,
  contact_row = 9,
  strip = 12;
const most_contact_rows = 5;

interface Hint {
  x: number;
  y: number;
  height: number;
  width: number;
  text: string;
  tick: number;
  series?: string; // which a click plots
}

export class Timeline {
  readonly root: HTMLElement;
  private readonly canvas = element('canvas', {
    tabindex: '0',
    role: 'slider',
    'aria-label': 'time line: the tick under the cursor',
    'aria-orientation': 'horizontal',
  });
  private readonly band = element('div', { class: 'zoom-band', hidden: true });
  private readonly cursor = element('div', { class: 'cursor', 'aria-hidden': 'true' });
  private readonly strip_cursor = element('div', { class: 'strip-cursor', 'aria-hidden': 'true' });
  private readonly context: CanvasRenderingContext2D;
  private hints: Hint[] = [];
  private width = 0;

  constructor(
    private readonly store: Store,
    private readonly report: Report,
  ) {
    this.root = element('div', { class: 'timeline' }, this.canvas, this.band, this.cursor, this.strip_cursor);
    this.context = this.canvas.getContext('2d')!;
    this.canvas.setAttribute('aria-valuemin', String(report.data.begin));
    this.canvas.setAttribute('aria-valuemax', String(report.last));
    store.on(['view', 'theme'], () => this.draw());
    store.on(['tick'], () => this.place_cursor());
    new ResizeObserver(() => this.draw()).observe(this.root);
    this.listen();
  }

  private get contacts_height() {
    const rows = Math.min(this.report.pairs.length, most_contact_rows);
    return rows > 0 ? rows * contact_row + 5 : 0;
  }
  private get differences_height() {
    return this.report.compared ? lane : 0;
  }
  private get expectations_height() {
    return this.report.data.expectations.length > 0 ? lane : 0;
  }
  private get events_height() {
    return this.report.data.events.length > 0 ? lane : 0;
  }
  private get height() {
    return (
      ruler + this.expectations_height + this.differences_height + this.contacts_height + this.events_height + strip + 4
    );
  }
  private get plain() {
    return Math.max(1, this.width - gutter - right);
  }

  x_of(tick: number): number {
    const { begin, end } = this.store.view;
    return gutter + ((tick - begin) / (end - begin)) * this.plain;
  }

  private tick_at(x: number): number {
    const { begin, end } = this.store.view;
    return begin + ((x - gutter) / this.plain) * (end - begin);
  }

  private tick_of_strip(x: number): number {
    const { begin, end } = this.store.whole;
    return begin + ((x - gutter) / this.plain) * (end - begin);
  }

  draw() {
    this.width = this.root.clientWidth;
    if (this.width === 0) return;
    const { context, height } = this;
    this.canvas.style.height = `${height}px`;
    fit_canvas(this.canvas, this.width, height);
    const scale = this.canvas.width / this.width;
    context.setTransform(scale, 0, 0, scale, 0, 0);
    context.clearRect(0, 0, this.width, height);
    context.font = `12px ${getComputedStyle(document.documentElement).getPropertyValue('--sans')}`;
    context.textBaseline = 'middle';
    this.hints = [];
    const colors = palette();
    let y = ruler;
    this.draw_ruler(colors, height);
    if (this.expectations_height > 0) this.draw_expectations(colors, y);
    y += this.expectations_height;
    if (this.report.compared) this.draw_differences(colors, y);
    y += this.differences_height;
    this.draw_contacts(colors, y);
    y += this.contacts_height;
    if (this.events_height > 0) this.draw_events(colors, y);
    y += this.events_height;
    this.draw_strip(colors, y + 2);
    this.place_cursor();
  }

  /** Moves what stands at the cursor; nothing is drawn anew for that. */
  private place_cursor() {
    if (this.width === 0) return;
    const { tick, whole } = this.store;
    const x = this.x_of(tick),
      top = this.height - strip - 2;
    this.cursor.hidden = x < gutter - 1 || x > this.width - right + 1;
    this.cursor.style.transform = `translateX(${x.toFixed(1)}px)`;
    this.cursor.style.height = `${top - 14}px`;
    this.strip_cursor.style.transform = `translate(${(gutter + ((tick - whole.begin) / (whole.end - whole.begin)) * this.plain).toFixed(1)}px, ${top}px)`;
    this.strip_cursor.style.height = `${strip}px`;
    this.canvas.setAttribute('aria-valuenow', String(tick));
    this.canvas.setAttribute(
      'aria-valuetext',
      `tick ${tick}, ${time_text(this.report.time(tick), this.report.data.time_step)}`,
    );
  }

  private label(colors: Palette, text: string, y: number) {
    this.context.fillStyle = colors.muted;
    this.context.textAlign = 'left';
    this.context.fillText(text, 10, y);
  }

  private draw_ruler(colors: Palette, height: number) {
    const { context, report } = this;
    if (report.ticks === 0) return this.label(colors, 'no ticks', 9);
    const { begin, end } = this.store.view;
    const step = nice_step((report.time(end) - report.time(begin)) / Math.max(2, this.plain / 90));
    context.strokeStyle = colors.line;
    context.fillStyle = colors.muted;
    context.textAlign = 'center';
    context.lineWidth = 1;
    context.beginPath();
    for (let i = Math.ceil(report.time(begin) / step - 1e-9); i * step <= report.time(end) * (1 + 1e-12); ++i) {
      const x = Math.round(this.x_of(report.tick_at(i * step))) + 0.5;
      context.moveTo(x, ruler - 4);
      context.lineTo(x, height - strip - 4);
      const near_edge = x > this.width - 24;
      context.textAlign = near_edge ? 'right' : 'center';
      context.fillText(`${Number((i * step).toPrecision(12))} s`, near_edge ? this.width - 2 : x, 9);
    }
    context.stroke();
  }

  // A line over the judged ticks, green as long as all holds; a cross at each violation.
  private draw_expectations(colors: Palette, y: number) {
    const { context, report } = this;
    const { expectations } = report.data;
    const middle = y + lane / 2;
    this.label(colors, 'expected', middle);
    context.save();
    context.beginPath();
    context.rect(gutter - 6, y, this.plain + 12, lane);
    context.clip();
    const spans = [...expectations].sort((a, b) => Number(b.holds) - Number(a.holds));
    for (const entry of spans) {
      const begin = entry.holds ? entry.begin : tick_of(entry);
      const x = Math.max(gutter, this.x_of(begin)),
        x_end = Math.min(this.x_of(entry.end), this.width - right);
      context.fillStyle = entry.holds ? colors.good : colors.bad_fill;
      if (x_end >= x) context.fillRect(x, middle - (entry.holds ? 1 : 3), Math.max(2, x_end - x), entry.holds ? 2 : 6);
    }
    context.strokeStyle = colors.bad;
    context.lineWidth = 2.5;
    for (const entry of violations(report)) {
      const tick = tick_of(entry),
        x = this.x_of(tick);
      context.beginPath();
      context.moveTo(x - 4, middle - 4);
      context.lineTo(x + 4, middle + 4);
      context.moveTo(x - 4, middle + 4);
      context.lineTo(x + 4, middle - 4);
      context.stroke();
      this.hints.push({
        x: x - 5,
        y,
        width: 10,
        height: lane,
        tick,
        series: series_of_expectation(report, entry) ?? undefined,
        text: entry.sentence,
      });
    }
    context.restore();
  }

  private draw_differences(colors: Palette, y: number) {
    const { context, report } = this;
    this.label(colors, 'differs', y + lane / 2);
    context.fillStyle = colors.sunken;
    context.fillRect(gutter, y + 3, this.plain, lane - 6);
    context.save();
    context.beginPath();
    context.rect(gutter - 5, y, this.plain + 10, lane);
    context.clip();
    context.fillStyle = colors.bad_fill;
    for (const [begin, end] of report.data.spans) {
      const x = Math.max(gutter, this.x_of(begin)),
        x_end = Math.min(this.x_of(end), this.width - right);
      if (x_end >= x) context.fillRect(x, y + 3, Math.max(1, x_end - x), lane - 6);
    }
    // divergences within tolerance first, so that they don't cover those beyond it
    const sorted = [...report.data.divergences].sort((a, b) => Number(a.beyond) - Number(b.beyond));
    for (const entry of sorted) {
      const x = this.x_of(entry.tick);
      context.fillStyle = entry.beyond ? colors.bad : colors.warning;
      context.beginPath();
      context.moveTo(x, y + 2);
      context.lineTo(x + 4, y + lane / 2);
      context.lineTo(x, y + lane - 2);
      context.lineTo(x - 4, y + lane / 2);
      context.fill();
      const what = `${entry.series ?? `${entry.channel} ${entry.element}`.trim()}`;
      this.hints.push({
        x: x - 4,
        y,
        width: 8,
        height: lane,
        tick: entry.tick,
        text: `tick ${entry.tick}: ${what}, first ${entry.beyond ? 'beyond tolerance' : 'difference in any bit'}`,
      });
    }
    context.restore();
  }

  private draw_contacts(colors: Palette, y: number) {
    const { context, report } = this;
    const shown = report.pairs.slice(0, most_contact_rows);
    if (shown.length === 0) return;
    const more = report.pairs.length - shown.length;
    this.label(colors, more > 0 ? `contacts +${more}` : 'contacts', y + this.contacts_height / 2);
    context.save();
    context.beginPath();
    context.rect(gutter, y, this.plain, this.contacts_height);
    context.clip();
    shown.forEach(({ name, links, spans }, row) => {
      for (const span of spans) {
        if (span.end < this.store.view.begin || span.begin > this.store.view.end) continue;
        const x = this.x_of(span.begin),
          width = Math.max(1, this.x_of(span.end) - x);
        const of_golden = report.data.runs[span.run]?.role === 'golden';
        const top = y + 2 + row * contact_row + (report.compared && !of_golden ? 4 : 0);
        context.fillStyle = of_golden ? colors.golden : colors.actual;
        context.fillRect(x, top, width, report.compared ? 3 : 6);
        const whose = !report.compared ? '' : of_golden ? 'golden: ' : 'this run: ';
        this.hints.push({
          x,
          y: top - 2,
          width,
          height: 6,
          tick: span.begin,
          series: name,
          text: `${whose}${links} touch, ticks ${span.begin} to ${span.end - 1}; click to plot`,
        });
      }
    });
    context.restore();
  }

  private draw_events(colors: Palette, y: number) {
    const { context, report } = this;
    this.label(colors, 'messages', y + lane / 2);
    const { begin, end } = this.store.view;
    for (const event of report.data.events) {
      if (event.tick < begin || event.tick > end) continue;
      const x = Math.round(this.x_of(event.tick));
      context.fillStyle =
        event.severity === 'error' ? colors.bad : event.severity === 'warning' ? colors.warning : colors.muted;
      context.fillRect(x - 1, y + 3, 2, lane - 6);
      this.hints.push({
        x: x - 3,
        y,
        width: 6,
        height: lane,
        tick: event.tick,
        text: `tick ${event.tick}, ${event.source}: ${event.text}`,
      });
    }
  }

  private draw_strip(colors: Palette, y: number) {
    const { context, store } = this;
    const { whole, view } = store;
    const x_of = (tick: number) => gutter + ((tick - whole.begin) / (whole.end - whole.begin)) * this.plain;
    this.label(colors, 'whole run', y + strip / 2);
    context.fillStyle = colors.sunken;
    context.fillRect(gutter, y, this.plain, strip);
    context.fillStyle = colors.bad_fill;
    for (const [begin, end] of this.report.data.spans)
      context.fillRect(x_of(begin), y, Math.max(1, x_of(end) - x_of(begin)), strip);
    context.strokeStyle = store.zoomed ? colors.accent : colors.line;
    context.lineWidth = 1;
    context.strokeRect(
      Math.round(x_of(view.begin)) + 0.5,
      y + 0.5,
      Math.max(3, Math.round(x_of(view.end) - x_of(view.begin)) - 1),
      strip - 1,
    );
  }

  private listen() {
    const { canvas, store } = this;
    let mode: 'scrub' | 'zoom' | 'move' | null = null,
      from = 0;
    canvas.addEventListener('pointerdown', (event) => {
      if (event.button !== 0) return;
      canvas.setPointerCapture(event.pointerId);
      const { offsetX: x, offsetY: y } = event;
      mode = y < ruler ? 'scrub' : y > this.height - strip - 4 ? 'move' : 'zoom';
      from = x;
      if (mode === 'scrub') store.go(this.tick_at(x));
      if (mode === 'move') this.centre(x);
    });
    canvas.addEventListener('pointermove', (event) => {
      const x = Math.min(Math.max(event.offsetX, gutter), this.width - right);
      if (mode === 'scrub') store.go(this.tick_at(x));
      else if (mode === 'move') this.centre(x);
      else if (mode === 'zoom') this.show_band(from, x);
      else this.hint(event.offsetX, event.offsetY);
    });
    const finish = (event: PointerEvent) => {
      const x = event.offsetX;
      if (mode === 'zoom' && event.type === 'pointerup') {
        if (Math.abs(x - from) > 3) store.look_at(this.tick_at(Math.min(from, x)), this.tick_at(Math.max(from, x)));
        else this.click(x, event.offsetY);
      }
      mode = null;
      this.band.hidden = true;
    };
    canvas.addEventListener('pointerup', finish);
    canvas.addEventListener('pointercancel', finish);
    canvas.addEventListener('dblclick', () => store.look_at_all());
    canvas.addEventListener(
      'wheel',
      (event) => {
        event.preventDefault();
        const { begin, end } = store.view;
        if (event.shiftKey || Math.abs(event.deltaX) > Math.abs(event.deltaY)) {
          const by = ((event.deltaX + event.deltaY) / this.plain) * (end - begin);
          store.look_at(begin + by, end + by);
        } else {
          store.zoom_by(Math.exp(event.deltaY * 0.002), this.tick_at(event.offsetX));
        }
      },
      { passive: false },
    );
  }

  private centre(x: number) {
    const { begin, end } = this.store.view;
    const tick = this.tick_of_strip(x);
    if (this.store.zoomed) this.store.look_at(tick - (end - begin) / 2, tick + (end - begin) / 2);
    this.store.go(tick);
  }

  private show_band(from: number, to: number) {
    this.band.hidden = Math.abs(to - from) < 3;
    this.band.style.left = `${Math.min(from, to)}px`;
    this.band.style.width = `${Math.abs(to - from)}px`;
  }

  private found(x: number, y: number): Hint | undefined {
    return this.hints.findLast(
      (hint) => x >= hint.x && x <= hint.x + hint.width && y >= hint.y && y <= hint.y + hint.height,
    );
  }

  // a mark leads to its tick, a bar to the place that was clicked; both plot their series
  private click(x: number, y: number) {
    const hint = this.found(x, y);
    if (hint?.series && !this.store.shown.includes(hint.series)) this.store.show([hint.series, ...this.store.shown]);
    this.store.go(hint && hint.width <= 10 ? hint.tick : this.tick_at(x));
  }

  private hint(x: number, y: number) {
    const text = this.found(x, y)?.text ?? (y < ruler ? `tick ${short_text(Math.round(this.tick_at(x)))}` : '');
    if (this.canvas.title !== text) this.canvas.title = text;
  }
}

/** 1, 2 or 5 times a power of ten, at least that. */
function nice_step(least: number): number {
  const power = 10 ** Math.floor(Math.log10(least));
  return [1, 2, 5, 10].map((factor) => factor * power).find((step) => step >= least * 0.999) ?? 10 * power;
}

// Messages of controllers and harness; a click on one moves the cursor to its tick.
import { json_of } from './blobs';
import { element, set_name, set_text } from './dom';
import type { DivergenceEntry, EventEntry, MessageRow } from './format';
import { difference_text, number_of, plural, short_text, time_text, value_text } from './numbers';
import type { Report } from './report';
import type { Store } from './store';
import { VirtualList } from './virtual_list';

const most_found = 100_000;

function event_of([run, tick, severity, source, text]: MessageRow): EventEntry {
  return { run, tick, severity: severity as EventEntry['severity'], source, text };
}

export class Messages {
  readonly root: HTMLElement;
  private readonly list: VirtualList<HTMLElement>;
  private events: EventEntry[];
  private current = -1;
  private wanted = '';
  private readonly note = element('span', { class: 'note', 'aria-live': 'polite' });

  constructor(
    private readonly store: Store,
    private readonly report: Report,
  ) {
    this.events = report.data.events;
    this.list = new VirtualList(
      24,
      () => this.make_row(),
      (row, i) => this.fill(row, i),
      { role: 'list', 'aria-label': 'messages' },
    );
    const input = element('input', {
      type: 'search',
      placeholder: 'Filter',
      'aria-label': 'filter the messages',
      oninput: () => void this.filter(input.value),
    });
    const tools = element('div', { class: 'tools' }, input, this.note);
    this.root = element('div', { class: 'messages' }, tools, this.list.root);
    set_text(this.note, this.extent());
    store.on(['tick'], () => this.follow());
    this.list.set_count(this.events.length);
    // scrolling is possible only after the list is shown
    new ResizeObserver(() => ((this.current = -1), this.follow())).observe(this.list.root);
  }

  /** Which of all messages are listed without a filter; empty: all. */
  private extent(): string {
    const { events, messages } = this.report.data;
    if (!messages) return '';
    return `${events.length} of ${plural(messages.all, 'message')}, from tick ${events[0]?.tick ?? 0}; a filter searches all`;
  }

  /** Lists the messages that contain a text. Those in blobs are searched blob by blob, until the text changes. */
  private async filter(text: string) {
    const wanted = (this.wanted = text.toLowerCase());
    const fits = (event: EventEntry) =>
      `${event.source} ${event.text} ${event.severity}`.toLowerCase().includes(wanted);
    const { events, messages } = this.report.data;
    if (wanted === '' || !messages) {
      set_text(this.note, this.extent());
      return this.show(events.filter(fits));
    }
    const found: EventEntry[] = [];
    let searched = 0;
    for (const blob of messages.blobs) {
      const rows = (await json_of(blob)) as MessageRow[];
      if (wanted !== this.wanted) return;
      found.push(...rows.map(event_of).filter(fits));
      searched += blob.messages;
      set_text(this.note, `${found.length} found in ${plural(searched, 'message')}`);
      this.show(found);
      if (found.length >= most_found) break;
    }
  }

  private show(events: EventEntry[]) {
    this.events = events;
    this.current = -1;
    this.list.set_count(events.length);
    this.follow();
  }

  /** The last message until the cursor. */
  follow() {
    const current = this.events.findLastIndex((event) => event.tick <= this.store.tick);
    if (current === this.current) return;
    this.current = current;
    if (current >= 0) this.list.reveal(current);
    this.list.update();
  }

  private make_row(): HTMLElement {
    const row = element(
      'button',
      { type: 'button', class: 'message' },
      ...['tick', 'time', 'run', 'severity', 'source', 'text'].map((name) => element('span', { class: name })),
    );
    row.addEventListener('click', () => {
      const event = this.events[Number(row.dataset.index)];
      if (event) this.store.go(event.tick);
    });
    return row;
  }

  private fill(row: HTMLElement, index: number) {
    const event = this.events[index]!,
      { report } = this;
    row.dataset.index = String(index);
    row.classList.toggle('current', index === this.current);
    row.dataset.severity = event.severity;
    row.title = event.text;
    const run = report.compared ? (report.data.runs[event.run]?.role === 'golden' ? 'golden' : 'run') : '';
    const texts = [
      String(event.tick),
      time_text(report.time(event.tick), report.data.time_step),
      run,
      event.severity,
      event.source,
      event.text,
    ];
    [...row.children].forEach((cell, i) => set_text(cell, texts[i]!));
  }
}

/** The divergences, by tick. */
export class Divergences {
  readonly root: HTMLElement;
  private readonly list: VirtualList<HTMLElement>;

  constructor(
    private readonly store: Store,
    private readonly report: Report,
    private readonly go: (index: number) => void,
  ) {
    const { divergences } = report.data;
    this.list = new VirtualList(
      24,
      () => this.make_row(),
      (row, i) => this.fill(row, i),
      { role: 'list', 'aria-label': 'divergences' },
    );
    const beyond = divergences.filter((entry) => entry.beyond).length;
    const summary = element(
      'span',
      { class: 'note' },
      `${plural(divergences.length, 'place')}: of each channel the first beyond tolerance, ${beyond} of these, and the first in any bit`,
    );
    const head = element(
      'div',
      { class: 'divergence head', 'aria-hidden': 'true' },
      ...['tick', 'time', 'series', 'expected', 'actual', 'difference', 'tolerance', 'stage', 'note'].map((name) =>
        element('span', { class: name }, name),
      ),
    );
    this.root = element(
      'div',
      { class: 'divergences' },
      element('div', { class: 'tools' }, summary),
      head,
      this.list.root,
    );
    store.on(['tick'], () => this.follow());
    this.list.set_count(divergences.length);
    // scrolling is possible only after the list is shown
    new ResizeObserver(() => this.follow()).observe(this.list.root);
  }

  /** The one at the cursor in sight, one beyond tolerance if there is. */
  private follow() {
    const { divergences } = this.report.data,
      { tick } = this.store;
    const beyond = divergences.findIndex((entry) => entry.tick === tick && entry.beyond);
    const at = beyond >= 0 ? beyond : divergences.findIndex((entry) => entry.tick === tick);
    if (at >= 0) this.list.reveal(at);
    this.list.update();
  }

  private make_row(): HTMLElement {
    const row = element(
      'button',
      { type: 'button', class: 'divergence' },
      ...['tick', 'time', 'series', 'expected', 'actual', 'difference', 'tolerance', 'stage', 'note'].map((name) =>
        element('span', { class: name }),
      ),
    );
    row.addEventListener('click', () => this.go(Number(row.dataset.index)));
    return row;
  }

  private fill(row: HTMLElement, index: number) {
    const entry = this.report.data.divergences[index]!;
    row.dataset.index = String(index);
    row.classList.toggle('current', entry.tick === this.store.tick);
    row.classList.toggle('first', index === this.report.data.first);
    row.classList.toggle('beyond', entry.beyond);
    row.title = `${divergence_name(entry)}${entry.note ? `: ${entry.note}` : ''}`;
    const number = (value: DivergenceEntry['expected'], text: (value: number) => string) =>
      value === null ? '' : text(Number(value));
    const texts = [
      String(entry.tick),
      time_text(entry.time, this.report.data.time_step),
      divergence_name(entry),
      entry.note ? '' : number(entry.expected, value_text),
      entry.note ? '' : number(entry.actual, value_text),
      entry.note ? '' : difference_text(number_of(entry.difference)).replace('+', ''),
      entry.note ? '' : number(entry.tolerance, (value) => `±${short_text(value)}`),
      entry.stage,
      entry.note || (entry.beyond ? 'beyond tolerance' : 'other bits'),
    ];
    [...row.children].forEach((cell, i) => (i === 2 ? set_name(cell, texts[i]!) : set_text(cell, texts[i]!)));
  }
}

export function divergence_name(entry: DivergenceEntry): string {
  return entry.series ?? `${entry.channel} ${entry.element}`.trim();
}

// Numbers at the cursor. Only rows on the screen are decoded; values that changed since the tick before are marked.
import { Tour } from './divergences';
import { element, set_name, set_text } from './dom';
import { difference_text, plural, short_text, value_text } from './numbers';
import { Columns, type Report, type Series } from './report';
import { search } from './search';
import type { Store } from './store';
import { VirtualList } from './virtual_list';

const choices: Record<string, (series: Series) => boolean> = {
  'Inputs and commands': ({ entry }) => ['input', 'output', 'variable'].includes(entry.group),
  Everything: () => true,
  'What differs': ({ entry }) => entry.differing > 0 || entry.beyond > 0,
  Contacts: ({ entry }) => entry.group === 'contact',
  Inputs: ({ entry }) => entry.group === 'input',
  Commands: ({ entry }) => entry.group === 'output',
  Variables: ({ entry }) => entry.group === 'variable',
  Costs: ({ entry }) => entry.group === 'cost',
  State: ({ entry }) => entry.group === 'state',
  Sensors: ({ entry }) => entry.group === 'sensor',
};

export interface TableRow {
  expected: string;
  actual: string;
  difference: string;
  changed: boolean;
}

export class Table {
  readonly root: HTMLElement;
  private readonly input: HTMLInputElement;
  private readonly select: HTMLSelectElement;
  private readonly summary = element('span', { class: 'note' });
  private readonly list: VirtualList<HTMLElement>;
  private rows: Series[] = [];
  private filled = new Map<HTMLElement, Series>();

  constructor(
    private readonly store: Store,
    private readonly report: Report,
  ) {
    this.input = element('input', {
      type: 'search',
      placeholder: 'Filter',
      'aria-label': 'filter the table',
      autocomplete: 'off',
      spellcheck: 'false',
      oninput: () => this.refresh(),
    });
    const available = Object.entries(choices).filter(
      ([name, choice]) => name === 'Everything' || report.series.some(choice),
    );
    this.select = element(
      'select',
      { 'aria-label': 'which series', onchange: () => this.refresh() },
      ...available.map(([name]) => element('option', { value: name }, name)),
    );
    const compared = report.compared;
    const head = element(
      'div',
      { class: 'row head', role: 'row' },
      ...['series', 'unit', ...(compared ? ['expected', 'actual', 'difference', 'tolerance'] : ['value'])].map(
        (title) => element('span', { class: title, role: 'columnheader' }, title),
      ),
    );
    this.list = new VirtualList(
      24,
      () => this.make_row(),
      (row, i) => this.fill(row, this.rows[i]!),
      { role: 'rowgroup', 'aria-label': 'values at the cursor' },
    );
    this.root = element(
      'div',
      { class: `values ${compared ? 'compared' : 'alone'}` },
      element('div', { class: 'tools' }, this.select, this.input, this.summary),
      element(
        'div',
        { class: 'grid', role: 'table', 'aria-label': 'inputs and commands at the cursor' },
        head,
        this.list.root,
      ),
    );
    store.on(['tick', 'data'], () => this.list.update());
    store.on(['shown'], () => this.list.update());
    this.refresh();
  }

  focus() {
    this.input.focus();
  }

  private refresh() {
    const choice = choices[this.select.value] ?? (() => true);
    this.rows = Tour.in_order(this.report, search(this.report.series.filter(choice), this.input.value));
    set_text(this.summary, `${plural(this.rows.length, 'series', 'series')}; • changed in this tick`);
    this.list.root.scrollTop = 0;
    this.list.set_count(this.rows.length);
  }

  private make_row(): HTMLElement {
    const cell = (name: string) => element('span', { class: name, role: 'cell' });
    const cells = [
      'series',
      'unit',
      ...(this.report.compared ? ['expected', 'actual', 'difference', 'tolerance'] : ['actual']),
    ];
    const row = element('div', { class: 'row', role: 'row' }, ...cells.map(cell));
    row.addEventListener('click', () => {
      const series = this.filled.get(row);
      if (series) this.store.toggle(series.name);
    });
    return row;
  }

  private fill(row: HTMLElement, series: Series) {
    this.filled.set(row, series);
    row.classList.toggle('plotted', this.store.shown.includes(series.name));
    row.title = `${series.name}: click to ${this.store.shown.includes(series.name) ? 'close its plot' : 'plot it'}`;
    const cells = [...row.children] as HTMLElement[];
    set_name(cells[0]!, series.name);
    set_text(cells[1]!, series.entry.unit);
    const { columns } = series;
    if (!columns) {
      for (const cell of cells.slice(2)) set_text(cell, '…');
      void series.load().then(
        () => this.store.changed('data'),
        (error) => set_text(cells[2]!, String(error)),
      );
      return;
    }
    const at = this.values(series, columns);
    const texts = this.report.compared ? [at.expected, at.actual, at.difference, at.tolerance] : [at.actual];
    texts.forEach((text, i) => set_text(cells[i + 2]!, text));
    row.classList.toggle('beyond', at.beyond);
    row.classList.toggle('changed', at.changed);
    row.classList.toggle('stale', at.stale);
    if (at.stale) row.title = `${row.title}; the value is that of tick ${at.tick}`;
  }

  private values(series: Series, columns: Columns) {
    const { tick } = this.store,
      { kind } = series.entry;
    const actual = Columns.sample(columns.actual, tick),
      golden = Columns.sample(columns.golden, tick);
    const before = Columns.sample(columns.actual, tick - 1);
    const both = series.compared && actual !== null && golden !== null;
    const difference = both ? series.difference(golden.value, actual.value) : null;
    const bound = both ? series.tolerance : null;
    return {
      expected: golden?.text ?? value_text(golden?.value ?? null, kind),
      actual: actual?.text ?? value_text(actual?.value ?? null, kind),
      difference: difference_text(difference),
      tolerance: bound === null ? '' : `±${short_text(bound)}`,
      beyond: difference !== null && series.entry.beyond > 0 && !(Math.abs(difference) <= (bound ?? 0)),
      changed: actual !== null && before !== null && !Object.is(actual.value, before.value),
      stale: actual !== null && actual.tick < tick,
      tick: actual?.tick ?? tick,
    };
  }

  /** Of the rows on the screen. */
  shown(): Record<string, TableRow> {
    const shown: Record<string, TableRow> = {};
    for (const [row, series] of this.filled) {
      if (row.hidden || !series.columns) continue;
      const { expected, actual, difference, changed } = this.values(series, series.columns);
      const text = (name: string) => row.querySelector(`.${name}`)?.textContent ?? '';
      shown[series.name] = {
        expected: this.report.compared ? text('expected') : expected,
        actual: text('actual') || actual,
        difference: this.report.compared ? text('difference') : difference,
        changed,
      };
    }
    return shown;
  }

  async drawn() {
    await Promise.all(
      [...this.filled].filter(([row]) => !row.hidden).map(([, series]) => series.load().catch(() => null)),
    );
  }
}

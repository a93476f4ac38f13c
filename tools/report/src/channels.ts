// Selection of plotted series: first the series with differences, then all by group.
import { Tour } from './divergences';
import { button, element, set_name, set_text } from './dom';
import type { Group } from './format';
import { plural } from './numbers';
import type { Report, Series } from './report';
import { search } from './search';
import type { Store } from './store';
import { VirtualList } from './virtual_list';

const group_names: Record<Group, string> = {
  contact: 'Contacts',
  state: 'State of the bodies',
  sensor: 'Sensors',
  input: 'Inputs of the controllers',
  output: 'Commands of the controllers',
  variable: 'Variables of the controllers',
  cost: 'Costs of control()',
  other: 'Others',
};

const most_at_once = 100;

export class Channels {
  readonly root: HTMLElement;
  private readonly input: HTMLInputElement;
  private readonly panel: HTMLElement;
  private readonly summary = element('span', { class: 'note', 'aria-live': 'polite' });
  private readonly list: VirtualList<HTMLElement>;
  private found: Series[] = [];
  private rows: (Series | string)[] = [];
  private active = -1;

  constructor(
    private readonly store: Store,
    private readonly report: Report,
  ) {
    this.input = element('input', {
      type: 'search',
      placeholder: 'Channels: knee q, */u, …',
      'aria-label': 'search channels to plot',
      'aria-controls': 'channel-list',
      'aria-expanded': 'false',
      role: 'combobox',
      'aria-autocomplete': 'list',
      autocomplete: 'off',
      spellcheck: 'false',
      oninput: () => this.refresh(),
      onfocus: () => this.open(),
      onkeydown: ((event: KeyboardEvent) => this.key(event)) as EventListener,
    });
    this.list = new VirtualList(
      24,
      () => this.make_row(),
      (row, i) => this.fill(row, i),
      { id: 'channel-list', role: 'listbox', 'aria-label': 'channels', 'aria-multiselectable': 'true' },
    );
    this.list.root.tabIndex = -1;
    const all = button('Plot all of these', 'Plot all channels found', () => this.show_all(), { class: 'quiet' });
    const none = button('Plot none', 'Close all plots', () => store.show([]), { class: 'quiet' });
    this.panel = element(
      'div',
      { class: 'channel-panel', hidden: true },
      element('div', { class: 'tools' }, this.summary, all, none),
      this.list.root,
    );
    this.root = element('div', { class: 'channels' }, this.input, this.panel);
    store.on(['shown'], () => this.list.update());
    document.addEventListener('pointerdown', (event) => {
      if (!this.root.contains(event.target as Node)) this.close();
    });
    this.root.addEventListener('focusout', (event) => {
      if (event.relatedTarget && !this.root.contains(event.relatedTarget as Node)) this.close();
    });
  }

  focus() {
    this.input.focus();
    this.input.select();
  }

  private open() {
    if (!this.panel.hidden) return;
    this.panel.hidden = false;
    this.input.setAttribute('aria-expanded', 'true');
    this.refresh();
  }

  private close() {
    this.panel.hidden = true;
    this.input.setAttribute('aria-expanded', 'false');
  }

  private refresh() {
    this.found = search(this.report.series, this.input.value);
    const beyond = Tour.in_order(
      this.report,
      this.found.filter((series) => series.entry.beyond > 0),
    );
    const differing = this.found.filter((series) => series.entry.beyond === 0 && series.entry.differing > 0);
    this.rows = [];
    const add = (title: string, series: Series[]) => {
      if (series.length > 0) this.rows.push(`${title} (${series.length})`, ...series);
    };
    add('Beyond tolerance', beyond);
    add('Other bits, within tolerance', differing);
    for (const [group, title] of Object.entries(group_names)) {
      add(
        title,
        this.found.filter(
          (series) => series.entry.group === group && series.entry.differing === 0 && series.entry.beyond === 0,
        ),
      );
    }
    this.active = this.input.value && this.rows.length > 0 ? 1 : -1;
    set_text(
      this.summary,
      this.found.length === 0
        ? 'no channel of that name'
        : `${this.found.length} of ${plural(this.report.series.length, 'channel')}`,
    );
    this.list.root.scrollTop = 0;
    this.list.set_count(this.rows.length);
  }

  private show_all() {
    const names = this.rows
      .filter((row): row is Series => typeof row !== 'string')
      .slice(0, most_at_once)
      .map((series) => series.name);
    this.store.show([...this.store.shown, ...names]);
  }

  private make_row(): HTMLElement {
    const row = element(
      'div',
      { class: 'channel', role: 'option' },
      element('span', { class: 'check', 'aria-hidden': 'true' }),
      element('span', { class: 'name' }),
      element('span', { class: 'unit' }),
      element('span', { class: 'count' }),
    );
    row.addEventListener('click', () => {
      const series = this.rows[Number(row.dataset.index)];
      if (series && typeof series !== 'string') this.store.toggle(series.name);
    });
    return row;
  }

  private fill(row: HTMLElement, index: number) {
    const entry = this.rows[index]!;
    row.dataset.index = String(index);
    const [check, name, unit, count] = [...row.children] as HTMLElement[];
    const heading = typeof entry === 'string';
    row.classList.toggle('heading', heading);
    row.classList.toggle('active', index === this.active);
    row.setAttribute('role', heading ? 'presentation' : 'option');
    const shown = !heading && this.store.shown.includes(entry.name);
    if (!heading) row.setAttribute('aria-selected', String(shown));
    set_text(check!, shown ? '✓' : '');
    if (heading) set_text(name!, entry);
    else set_name(name!, entry.name);
    set_text(unit!, heading || !entry.entry.unit ? '' : `[${entry.entry.unit}]`);
    set_text(
      count!,
      heading
        ? ''
        : entry.entry.beyond > 0
          ? `${plural(entry.entry.beyond, 'tick')} beyond`
          : entry.entry.differing > 0
            ? `${plural(entry.entry.differing, 'tick')} differ`
            : '',
    );
    count!.classList.toggle('beyond', !heading && entry.entry.beyond > 0);
  }

  private key(event: KeyboardEvent) {
    if (event.key === 'Escape') {
      this.close();
      this.input.blur();
    } else if (event.key === 'ArrowDown' || event.key === 'ArrowUp') {
      this.open();
      const step = event.key === 'ArrowDown' ? 1 : -1;
      let next = this.active + step;
      while (typeof this.rows[next] === 'string') next += step;
      if (this.rows[next]) this.active = next;
      this.list.reveal(this.active);
      this.list.update();
    } else if (event.key === 'Enter') {
      const series = this.rows[this.active];
      if (series && typeof series !== 'string') this.store.toggle(series.name);
    } else {
      return;
    }
    event.preventDefault();
    event.stopPropagation();
  }
}

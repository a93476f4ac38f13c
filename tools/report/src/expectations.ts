// Expectations of the scenario: their series, their place in the run, and the list of them.
import { element, set_text } from './dom';
import type { ExpectationEntry } from './format';
import { count_text, plural, time_text } from './numbers';
import type { Report, Series } from './report';
import { glob_expression } from './search';
import type { Store } from './store';

/** The violated ones in the order in which the run violates them. */
export function violations(report: Report): ExpectationEntry[] {
  const known_at = (entry: ExpectationEntry) => (entry.first && !entry.sometime ? entry.first.tick : Infinity);
  return report.data.expectations
    .filter((entry) => !entry.holds)
    .sort((a, b) => (known_at(a) === known_at(b) ? 0 : known_at(a) - known_at(b)));
}

/** Whether the expectation is about the series. */
export function concerns(entry: ExpectationEntry, series: Series): boolean {
  return entry.subject === 'series' && glob_expression(entry.pattern).test(series.name);
}

/** Its series: the violating one, or else the first that it is about. */
export function series_of_expectation(report: Report, entry: ExpectationEntry): string | null {
  return entry.series ?? report.series.find((series) => concerns(entry, series))?.name ?? null;
}

/** The tick of the first violation; without a violating sample the last judged tick. */
export function tick_of(entry: ExpectationEntry): number {
  return entry.first ? entry.first.tick : entry.end;
}

/** Moves the cursor there and plots the series. */
export function go_to_expectation(store: Store, entry: ExpectationEntry) {
  const name = series_of_expectation(store.report, entry);
  if (name && !store.shown.includes(name)) store.show([name, ...store.shown]);
  store.go(tick_of(entry));
}

/** The violations as buttons, for the head of the page; null if there are none. */
export function violation_list(store: Store, report: Report): HTMLElement | null {
  const violated = violations(report);
  if (violated.length === 0) return null;
  return element(
    'ul',
    { class: 'violations', 'aria-label': 'violated expectations', tabindex: '0' },
    ...violated.map((entry) =>
      element(
        'li',
        {},
        element(
          'button',
          { type: 'button', class: 'violation', title: entry.sentence, onclick: () => go_to_expectation(store, entry) },
          entry.sentence,
        ),
      ),
    ),
  );
}

/** All expectations, violated ones first; a click on one moves the cursor to its tick. */
export class Expectations {
  readonly root: HTMLElement;

  constructor(store: Store, report: Report) {
    const all = [...violations(report), ...report.data.expectations.filter((entry) => entry.holds)];
    const violated = all.filter((entry) => !entry.holds).length;
    const row = (entry: ExpectationEntry) => {
      const tick = tick_of(entry);
      const place = entry.holds
        ? span_text(entry, report)
        : `tick ${count_text(tick)}, ${time_text(report.time(tick), report.data.time_step)}`;
      const button = element(
        'button',
        {
          type: 'button',
          class: `expectation ${entry.holds ? 'holds' : 'violated'}`,
          title: [entry.sentence || entry.text, entry.closest].filter(Boolean).join('\n'),
          onclick: () => go_to_expectation(store, entry),
        },
        element('span', { class: 'mark' }, entry.holds ? 'holds' : 'violated'),
        element('span', { class: 'text' }, entry.holds ? entry.text : entry.sentence.replace(/^expected /, '')),
        element('span', { class: 'place' }, place),
      );
      store.on(['tick'], () => button.classList.toggle('current', !entry.holds && tick === store.tick));
      return element('li', {}, button);
    };
    const summary = element('span', { class: 'note' });
    set_text(
      summary,
      violated > 0
        ? `${violated} of ${plural(all.length, 'expectation')} ${violated === 1 ? 'is' : 'are'} violated`
        : `${all.length === 1 ? 'the expectation holds' : `all ${all.length} expectations hold`}`,
    );
    this.root = element(
      'div',
      { class: 'expectations' },
      element('div', { class: 'tools' }, summary),
      element('ul', { class: 'scrolled', tabindex: '0', 'aria-label': 'expectations' }, ...all.map(row)),
    );
  }
}

function span_text({ begin, end }: ExpectationEntry, report: Report): string {
  if (begin === end) return `tick ${count_text(end)}`;
  return begin === report.data.begin && end === report.last
    ? 'whole run'
    : `ticks ${count_text(begin)} to ${count_text(end)}`;
}

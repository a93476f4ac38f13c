// How long control() took in the run, by the clock of the machine: a histogram for each controller.
import { button, element } from './dom';
import type { ControlTimesEntry } from './format';
import { count_text } from './numbers';
import type { Store } from './store';

const bins_per_decade = 10;

function microseconds(seconds: number): string {
  return `${Number((seconds * 1e6).toPrecision(3))} µs`;
}

/** The calls by their times, in bins of equal width on a logarithmic scale, from the first with a call to the last. */
export function bins_of({ histogram }: ControlTimesEntry): { end: number; calls: number }[] {
  const calls_in = new Map<number, number>();
  for (const [end, calls] of histogram) {
    const bin = Math.ceil(Math.log10(end) * bins_per_decade - 1e-9);
    calls_in.set(bin, (calls_in.get(bin) ?? 0) + calls);
  }
  const first = Math.min(...calls_in.keys()),
    last = Math.max(...calls_in.keys());
  if (calls_in.size === 0) return [];
  return Array.from({ length: last - first + 1 }, (_, i) => ({
    end: 10 ** ((first + i) / bins_per_decade),
    calls: calls_in.get(first + i) ?? 0,
  }));
}

function histogram(entry: ControlTimesEntry): HTMLElement {
  const bins = bins_of(entry);
  const most = Math.max(...bins.map(({ calls }) => calls));
  // few long calls are the interesting ones: the length of a bar is the logarithm of its calls
  const share = (calls: number) => (calls === 0 ? 0 : Math.log(calls + 1) / Math.log(most + 1));
  return element(
    'div',
    { class: 'times', role: 'img', 'aria-label': `histogram of ${entry.calls} calls` },
    ...bins.map(({ end, calls }) =>
      element(
        'div',
        { class: end > entry.period ? 'late' : '' },
        element('span', { class: 'end' }, `≤ ${microseconds(end)}`),
        element('span', { class: 'bar', style: `width: ${(60 * share(calls)).toFixed(1)}%` }),
        element('span', { class: 'calls' }, calls > 0 ? count_text(calls) : ''),
      ),
    ),
  );
}

export function control_times(store: Store, all: ControlTimesEntry[]): HTMLElement {
  return element(
    'div',
    { class: 'control-times' },
    element('p', { class: 'note' }, 'Times of control() by the clock of the machine of the run; no recording has them.'),
    ...all.map((entry) =>
      element(
        'section',
        {},
        element('h3', {}, entry.controller),
        element(
          'p',
          {},
          `median ${microseconds(entry.median)}, 99.9 % within ${microseconds(entry.p999)}, longest ` +
            `${microseconds(entry.longest)}: ${((100 * entry.longest) / entry.period).toPrecision(3)} % of the period `,
          button(`tick ${entry.longest_tick}`, 'Go to the longest call', () => store.go(entry.longest_tick)),
        ),
        histogram(entry),
      ),
    ),
  );
}

// The verdict, and the files of the compared runs.
import { button, element } from './dom';
import { violation_list } from './expectations';
import { plural, time_text } from './numbers';
import type { Report } from './report';
import type { Store } from './store';
import { toggle_theme } from './theme';

const words = {
  coverage: 'Coverage',
  alone: 'One run',
  equal: 'Equal',
  within: 'Within tolerance',
  bits: 'Other bits, within tolerance',
  beyond: 'Beyond tolerance',
  violated: 'Expectation violated',
  failed: 'Failed',
};

/** `opening`: where the page opens, a sentence after that text. */
export function verdict(
  store: Store,
  report: Report,
  opening: (before: string) => string,
  help: () => void,
): HTMLElement {
  const { data } = report;
  const { state, sentence, besides, notes, levels } = data.verdict;
  const steps = data.runs[0]?.ticks ?? 0;
  const length =
    report.ticks === 0
      ? 'no tick was recorded'
      : `${plural(steps, 'tick')}, ${time_text(steps * data.time_step, data.time_step)}`;
  const violated = violation_list(store, report);
  const text = violated ? besides : sentence;
  const opened = opening(text);
  const runs = data.runs.map((run) =>
    element(
      'span',
      { class: `run ${run.role}`, title: run.outcome || run.file },
      element('span', { class: 'role' }, run.role === 'golden' ? 'golden' : report.compared ? 'this run' : 'run'),
      ` ${run.file}${run.complete ? '' : ' (cut off)'}`,
    ),
  );
  const outcomes = data.runs
    .filter((run) => run.outcome !== '' && !sentence.includes(run.outcome))
    .map((run) => element('span', { class: 'outcome' }, `${run.role === 'golden' ? 'golden: ' : ''}${run.outcome}`));
  return element(
    'header',
    { class: `verdict ${state}` },
    element(
      'div',
      { class: 'heading' },
      element('span', { class: 'state' }, words[state] ?? state),
      element('h1', {}, data.title || 'Report'),
      data.runs.length > 0 && element('p', { class: 'runs' }, ...runs, element('span', {}, length), ...outcomes),
      levels &&
        element(
          'p',
          { class: 'levels' },
          ...['controller', 'plant', 'closed'].map((level) => {
            const state = levels[level] ?? 'not compared';
            return element('span', { class: `level ${state.replace(' ', '_')}` }, element('b', {}, level), ` ${state}`);
          }),
        ),
      element(
        'div',
        { class: 'corner' },
        button('Theme', 'Light or dark (t)', toggle_theme, { class: 'quiet' }),
        button('?', 'Keys and help (?)', help, { class: 'quiet' }),
      ),
    ),
    violated,
    (text !== '' || opened !== '') &&
      element('p', { class: 'sentence' }, text, opened !== '' && element('span', { class: 'opening' }, ` ${opened}`)),
    ...notes.map((note) => element('p', { class: 'remark' }, element('b', {}, 'note: '), note)),
  );
}

// The verdict, and the files of the compared runs.
import { button, element } from './dom';
import { plural, time_text } from './numbers';
import type { Report } from './report';
import { toggle_theme } from './theme';

const words = {
  alone: 'One run',
  equal: 'Equal',
  within: 'Within tolerance',
  beyond: 'Beyond tolerance',
  failed: 'Failed',
};

export function verdict(report: Report, help: () => void): HTMLElement {
  const { data } = report;
  const { state, sentence, levels } = data.verdict;
  const length =
    report.ticks === 0
      ? 'no tick was recorded'
      : `${plural(report.ticks, 'tick')}, ${time_text(report.ticks * data.time_step, data.time_step)}`;
  const runs = data.runs.map((run) =>
    element(
      'span',
      { class: `run ${run.role}`, title: run.outcome || run.file },
      element('span', { class: 'role' }, run.role === 'golden' ? 'golden' : report.compared ? 'this run' : 'run'),
      ` ${run.file}${run.complete ? '' : ' (cut off)'}`,
    ),
  );
  const outcomes = data.runs
    .filter((run) => run.outcome !== '')
    .map((run) => element('span', { class: 'outcome' }, `${run.role === 'golden' ? 'golden: ' : ''}${run.outcome}`));
  return element(
    'header',
    { class: `verdict ${state}` },
    element('span', { class: 'state' }, words[state] ?? state),
    element(
      'div',
      { class: 'statement' },
      element('h1', {}, data.title || 'Report'),
      element('p', { class: 'sentence' }, sentence),
      element('p', { class: 'runs' }, ...runs, element('span', {}, length), ...outcomes),
      levels &&
        element(
          'p',
          { class: 'levels' },
          ...Object.entries(levels).map(([level, state]) =>
            element('span', { class: `level ${state}` }, element('b', {}, level), ` ${state}`),
          ),
        ),
    ),
    element(
      'div',
      { class: 'corner' },
      button('Theme', 'Light or dark (t)', toggle_theme, { class: 'quiet' }),
      button('?', 'Keys and help (?)', help, { class: 'quiet' }),
    ),
  );
}

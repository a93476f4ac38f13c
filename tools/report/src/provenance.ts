// The provenance of the runs: facts of both, different ones first; the parts left out; the scenario.
import { element } from './dom';
import type { Run } from './format';
import { count_text } from './numbers';
import type { Report } from './report';

function facts_of(run: Run): [string, string][] {
  return [
    ['file', run.file],
    ['ticks', count_text(run.ticks)],
    ['complete', run.complete ? 'yes' : 'no: its recording ends early'],
    ...(run.outcome ? [['outcome', run.outcome] as [string, string]] : []),
    ...Object.entries(run.facts),
  ];
}

// A panel without content isn't shown; these sentences state the reason.
function absences({ data, compared }: Report): string[] {
  return [
    data.end === data.begin && 'No tick was recorded.',
    data.series.length === 0 && 'The recording has no channels of numbers.',
    data.robots.length === 0 && 'The recording has no model of a robot to draw.',
    data.cameras.length === 0 && 'The recording has no camera pictures.',
    data.events.length === 0 && 'The recording has no messages.',
    !compared && 'There is no golden to compare with.',
    compared && data.divergences.length === 0 && 'Run and golden do not differ in any bit.',
    data.expectations.length === 0 && 'The scenario has no expectations.',
    data.runs.every((run) => run.scenario === '') && 'The recording has no scenario.',
  ].filter((sentence): sentence is string => sentence !== false);
}

/** A table of facts, run and golden side by side. */
export function provenance(report: Report): HTMLElement {
  const runs = [...report.data.runs].sort((a, b) => Number(b.role === 'golden') - Number(a.role === 'golden'));
  const sides = runs.map((run) => new Map(facts_of(run)));
  const names = [...new Set(sides.flatMap((side) => [...side.keys()]))];
  const differs = (name: string) => sides.length > 1 && new Set(sides.map((side) => side.get(name))).size > 1;
  const sorted = [...names.filter(differs), ...names.filter((name) => !differs(name))];
  const row = (name: string) =>
    element(
      'tr',
      { class: differs(name) ? 'differs' : '' },
      element('th', { scope: 'row' }, name, differs(name) && element('span', { class: 'note' }, ' differs')),
      ...sides.map((side) => element('td', {}, side.get(name) ?? '–')),
    );
  const table = element(
    'table',
    {},
    element(
      'thead',
      {},
      element(
        'tr',
        {},
        element('th', { scope: 'col' }, 'fact'),
        ...runs.map((run) => element('th', { scope: 'col' }, run.role === 'golden' ? 'golden' : 'this run')),
      ),
    ),
    element('tbody', {}, ...sorted.map(row)),
  );
  const sentences = (title: string, list: string[]) =>
    list.length > 0 &&
    element('section', {}, element('h3', {}, title), element('ul', {}, ...list.map((text) => element('li', {}, text))));
  return element(
    'div',
    { class: 'provenance', tabindex: '0' },
    ...runs.map((run) => sentences(run.role === 'golden' ? 'Of the golden' : 'Of this run', run.remarks)),
    sentences('Not in this report', [...absences(report), ...report.data.omitted]),
    table,
    element('p', { class: 'note' }, `Written by Rehearse ${report.data.rehearse}.`),
  );
}

type Line = { mark: ' ' | '-' | '+'; text: string };

// Merges the lines of both texts in order, by their longest common subsequence.
function merged_lines(golden: string[], actual: string[]): Line[] {
  if (golden.length * actual.length > 4e6)
    return [...golden.map((text): Line => ({ mark: '-', text })), ...actual.map((text): Line => ({ mark: '+', text }))];
  const common = Array.from({ length: golden.length + 1 }, () => new Uint16Array(actual.length + 1));
  for (let i = golden.length - 1; i >= 0; --i) {
    for (let j = actual.length - 1; j >= 0; --j) {
      common[i]![j] =
        golden[i] === actual[j] ? common[i + 1]![j + 1]! + 1 : Math.max(common[i + 1]![j]!, common[i]![j + 1]!);
    }
  }
  const lines: Line[] = [];
  let i = 0,
    j = 0;
  while (i < golden.length || j < actual.length) {
    if (i < golden.length && j < actual.length && golden[i] === actual[j])
      (lines.push({ mark: ' ', text: golden[i]! }), ++i, ++j);
    else if (j >= actual.length || (i < golden.length && common[i + 1]![j]! >= common[i]![j + 1]!))
      lines.push({ mark: '-', text: golden[i++]! });
    else lines.push({ mark: '+', text: actual[j++]! });
  }
  return lines;
}

/** The text of the scenario; where golden and run have different ones, both, line by line. */
export function scenario(report: Report): HTMLElement {
  const actual = report.data.runs.find((run) => run.role === 'actual')?.scenario ?? '';
  const golden = report.data.runs.find((run) => run.role === 'golden')?.scenario ?? actual;
  if (actual === golden) return element('pre', { class: 'scenario', tabindex: '0' }, actual);
  const lines = merged_lines(golden.split('\n'), actual.split('\n'));
  return element(
    'div',
    { class: 'differing-scenarios', tabindex: '0' },
    element(
      'p',
      { class: 'note' },
      'The two scenarios differ: lines with - are the golden’s, those with + this run’s.',
    ),
    element(
      'pre',
      { class: 'scenario' },
      ...lines.map(({ mark, text }) =>
        element('span', { class: mark === '-' ? 'removed' : mark === '+' ? 'added' : '' }, `${mark} ${text}\n`),
      ),
    ),
  );
}

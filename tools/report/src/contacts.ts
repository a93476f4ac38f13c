// Contacts between links: their names, their first and last ticks, and a series for each pair of links.
import type { ReportData, SeriesEntry } from './format';

export interface ContactSpan {
  run: number;
  begin: number;
  end: number; // one past the last tick
}

/** Two links that touch in one of the runs. */
export interface PairOfLinks {
  name: string; // of the series
  links: string;
  spans: ContactSpan[]; // by tick
}

/** Floor of Floor/Floor. */
function short_name(link: string): string {
  const [body, name, ...more] = link.split('/');
  return more.length === 0 && body === name ? body! : link;
}

/** The moving link first. Recordings name both links in any order. */
function links_of(a: string, b: string, moving: Set<string>): string {
  const rank = (link: string) => (moving.has(link.split('/')[0]!) ? 0 : 1);
  const swapped = rank(a) === rank(b) ? b < a : rank(b) < rank(a);
  return (swapped ? [b, a] : [a, b]).map(short_name).join(' – ');
}

/** One past the last tick that the run has. */
function end_of(run: number, data: ReportData): number {
  const { complete, ticks } = data.runs[run]!;
  return complete ? data.end : Math.min(data.end, Math.max(data.begin, ticks));
}

/** In the order of their first contact. Contacts that don't end last until the run does. */
export function pairs_of_links(data: ReportData): PairOfLinks[] {
  const moving = new Set(
    data.robots.filter((robot) => robot.links.some((link) => link.pose)).map((robot) => robot.name),
  );
  const pairs = new Map<string, PairOfLinks>();
  const open = new Map<string, ContactSpan>();
  for (const { run, tick, a, b, begins } of data.contacts) {
    const links = links_of(a, b, moving),
      key = `${run} ${links}`;
    let pair = pairs.get(links);
    if (!pair) pairs.set(links, (pair = { name: `contact ${links}`, links, spans: [] }));
    let span = open.get(key);
    if (span ? begins : !begins && pair.spans.some((one) => one.run === run)) continue;
    if (!span) pair.spans.push((span = { run, begin: begins ? tick : data.begin, end: end_of(run, data) }));
    if (begins) {
      open.set(key, span);
    } else {
      span.end = tick;
      open.delete(key);
    }
  }
  return [...pairs.values()];
}

/** 1 at the ticks at which the links touch. */
export function contact_values({ spans }: PairOfLinks, run: number, data: ReportData): Uint8Array {
  const values = new Uint8Array(data.end - data.begin);
  for (const span of spans) if (span.run === run) values.fill(1, span.begin - data.begin, span.end - data.begin);
  return values;
}

export function contact_entry(pair: PairOfLinks, data: ReportData): SeriesEntry {
  const compared = data.runs.length > 1;
  let differing = 0;
  if (compared) {
    const golden = contact_values(pair, 1, data);
    contact_values(pair, 0, data).forEach((value, i) => (differing += Number(value !== golden[i])));
  }
  return {
    name: pair.name,
    topic: '/contacts',
    unit: '',
    group: 'contact',
    kind: 'contact',
    axis: -1,
    values: null,
    golden: null,
    tolerance: null,
    differing,
    beyond: 0,
    range: [0, 1],
  };
}

// Contacts between links, with their first and last ticks.
import type { ReportData } from './format';

export interface ContactSpan {
  run: number;
  pair: string;
  begin: number;
  end: number; // one past the last tick
}

/** Contacts that don't end last until the run does. */
export function contact_spans(data: ReportData): ContactSpan[] {
  const open = new Map<string, ContactSpan>();
  const spans: ContactSpan[] = [];
  for (const contact of data.contacts) {
    const pair = `${contact.a} – ${contact.b}`,
      key = `${contact.run} ${pair}`;
    const span = open.get(key);
    if (contact.begins && !span) {
      open.set(key, { run: contact.run, pair, begin: contact.tick, end: data.end });
    } else if (!contact.begins) {
      spans.push(
        span ? { ...span, end: contact.tick } : { run: contact.run, pair, begin: data.begin, end: contact.tick },
      );
      open.delete(key);
    }
  }
  spans.push(...open.values());
  return spans.sort((a, b) => a.begin - b.begin);
}

// Numbers and times as text.
import type { JsonNumber } from './format';

export function number_of(value: JsonNumber | null | undefined): number | null {
  return value === null || value === undefined ? null : Number(value);
}

/** Six decimals, or an exponent where these would say nothing. */
export function value_text(value: number | null, kind = 'floating'): string {
  if (value === null) return '–';
  if (kind === 'contact') return value ? 'touch' : 'apart';
  if (!Number.isFinite(value)) return String(value);
  if (kind !== 'floating') return kind === 'boolean' ? (value ? 'true' : 'false') : String(value);
  const size = Math.abs(value);
  if (size === 0) return Object.is(value, -0) ? '-0.000000' : '0.000000';
  return size >= 1e7 || size < 1e-4 ? value.toExponential(5) : value.toFixed(6);
}

/** A difference: three digits tell how large it is. */
export function difference_text(value: number | null): string {
  if (value === null) return '–';
  if (!Number.isFinite(value)) return String(value);
  if (value === 0) return '0';
  const text = Math.abs(value) >= 1e5 || Math.abs(value) < 1e-3 ? value.toExponential(2) : value.toPrecision(3);
  return value > 0 ? `+${text}` : text;
}

export function short_text(value: number): string {
  if (!Number.isFinite(value)) return String(value);
  if (value === 0) return '0';
  const size = Math.abs(value);
  return size >= 1e5 || size < 1e-3 ? value.toExponential(1).replace('e+', 'e') : String(Number(value.toPrecision(4)));
}

/** The numbers beside a plot. Where they would look equal, those after the first are differences from it. */
export function axis_texts(values: number[]): string[] {
  const texts = values.map(short_text);
  if (new Set(texts).size === texts.length) return texts;
  return values.map((value, i) =>
    i === 0 ? String(Number(value.toPrecision(7))) : `+${short_text(Number((value - values[0]!).toPrecision(3)))}`,
  );
}

/** Decimals that tell one tick from the next. */
export function time_text(time: number, time_step: number): string {
  const decimals = Math.min(9, Math.max(3, Math.ceil(-Math.log10(time_step) - 1e-9)));
  return `${time.toFixed(decimals)} s`;
}

export function count_text(count: number): string {
  return count.toLocaleString('en').replaceAll(',', '\u2009');
}

export function plural(count: number, one: string, many = `${one}s`): string {
  return `${count_text(count)} ${count === 1 ? one : many}`;
}

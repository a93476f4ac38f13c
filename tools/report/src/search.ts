// Finds series by text that a person types: parts of their names in any order, a glob, or letters in their order.
import type { Series } from './report';

export function glob_expression(glob: string): RegExp {
  const escaped = glob
    .replace(/[.+^${}()|[\]\\]/g, '\\$&')
    .replaceAll('*', '.*')
    .replaceAll('?', '.');
  return new RegExp(`^${escaped}$`, 'i');
}

function has_letters_in_order(name: string, letters: string): boolean {
  let at = 0;
  for (const letter of letters) {
    at = name.indexOf(letter, at) + 1;
    if (at === 0) return false;
  }
  return true;
}

export function search(series: readonly Series[], text: string): Series[] {
  const wanted = text.trim().toLowerCase();
  if (wanted === '') return [...series];
  if (/[*?]/.test(wanted)) {
    const expression = glob_expression(wanted);
    return series.filter((one) => expression.test(one.name));
  }
  const words = wanted.split(/\s+/);
  const found = series.filter((one) => words.every((word) => one.name.toLowerCase().includes(word)));
  return found.length > 0
    ? found
    : series.filter((one) => has_letters_in_order(one.name.toLowerCase(), words.join('')));
}

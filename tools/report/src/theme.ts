// Light and dark theme: the system's setting until the user selects one.
import { store_setting, stored_setting } from './storage';

export interface Palette {
  text: string;
  muted: string;
  line: string;
  panel: string;
  sunken: string;
  golden: string;
  band: string;
  actual: string;
  bad: string;
  bad_fill: string;
  warning: string;
  good: string;
  accent: string;
}

const names: (keyof Palette)[] = [
  'text',
  'muted',
  'line',
  'panel',
  'sunken',
  'golden',
  'band',
  'actual',
  'bad',
  'bad_fill',
  'warning',
  'good',
  'accent',
];

let cached: Palette | null = null;

/** The colours of the style sheet, for what is drawn on canvases. */
export function palette(): Palette {
  if (cached) return cached;
  const style = getComputedStyle(document.documentElement);
  return (cached = Object.fromEntries(
    names.map((name) => [name, style.getPropertyValue(`--${name.replace('_', '-')}`).trim()]),
  ) as unknown as Palette);
}

export function is_dark(): boolean {
  const chosen = document.documentElement.dataset.theme;
  return chosen ? chosen === 'dark' : matchMedia('(prefers-color-scheme: dark)').matches;
}

const key = 'rehearse-report-theme';

export function toggle_theme() {
  const theme = is_dark() ? 'light' : 'dark';
  document.documentElement.dataset.theme = theme;
  store_setting(key, theme);
  document.dispatchEvent(new Event('themechange'));
}

export function watch_theme(changed: () => void) {
  const theme = stored_setting(key);
  if (theme === 'dark' || theme === 'light') document.documentElement.dataset.theme = theme;
  const update = () => {
    cached = null;
    changed();
  };
  matchMedia('(prefers-color-scheme: dark)').addEventListener('change', update);
  document.addEventListener('themechange', update);
}

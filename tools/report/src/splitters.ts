// Splitters between panels: dragging one, or arrow keys, changes the share of both panels; a double click restores it.
import { element } from './dom';
import { store_setting, stored_setting } from './storage';

const least_share = 0.12,
  key_step = 0.02;

interface Splitter {
  label: string;
  name: string; // of the variable and the setting
  upright: boolean;
}

/** A splitter of `container`, whose grid template uses the variable `--name`: the share of the panel before it. */
export function splitter(container: HTMLElement, { label, name, upright }: Splitter): HTMLElement {
  const key = `rehearse-report-${name}`;
  const bar = element('div', {
    class: `splitter ${upright ? 'upright' : 'level'}`,
    role: 'separator',
    tabindex: '0',
    title: `${label}: drag to resize, double click to restore`,
    'aria-label': label,
    'aria-orientation': upright ? 'vertical' : 'horizontal',
    'aria-valuemin': '0',
    'aria-valuemax': '100',
    'aria-valuenow': '50',
  });
  const show = (share: number | null) => {
    if (share === null) container.style.removeProperty(`--${name}`);
    else container.style.setProperty(`--${name}`, `${(share * 100).toFixed(1)}%`);
    tell(share ?? present());
  };
  const tell = (share: number) => bar.setAttribute('aria-valuenow', String(Math.round(share * 100)));
  const bounds = () => {
    const { left, top, width, height } = container.getBoundingClientRect();
    return upright ? { begin: left, length: width } : { begin: top, length: height };
  };
  const share_at = (place: number) => (place - bounds().begin) / Math.max(1, bounds().length);
  const present = () => {
    const { left, top } = bar.getBoundingClientRect();
    return share_at(upright ? left : top);
  };
  const move = (share: number) => {
    const kept = Math.min(Math.max(share, least_share), 1 - least_share);
    show(kept);
    store_setting(key, kept.toFixed(3));
  };
  let grip: number | null = null;
  const place = (event: PointerEvent) => (upright ? event.clientX : event.clientY);
  bar.addEventListener('pointerdown', (event) => {
    bar.setPointerCapture(event.pointerId);
    grip = share_at(place(event)) - present();
    event.preventDefault();
  });
  bar.addEventListener('pointermove', (event) => {
    if (grip !== null) move(share_at(place(event)) - grip);
  });
  for (const end of ['pointerup', 'pointercancel'] as const) bar.addEventListener(end, () => (grip = null));
  bar.addEventListener('dblclick', () => {
    store_setting(key, null);
    show(null);
  });
  bar.addEventListener('keydown', (event) => {
    const step = { ArrowLeft: -key_step, ArrowRight: key_step, ArrowUp: -key_step, ArrowDown: key_step }[event.key];
    if (step === undefined) return;
    event.preventDefault();
    event.stopPropagation();
    move(present() + step);
  });
  const stored = Number(stored_setting(key) ?? NaN);
  if (stored >= least_share && stored <= 1 - least_share) show(stored);
  // the share that the style gives is known when the page has a layout
  new ResizeObserver(() => tell(present())).observe(container);
  return bar;
}

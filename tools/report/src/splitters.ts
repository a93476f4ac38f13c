// Splitters between the panels: dragging them, or arrow keys, changes the panels' sizes.
import { element } from './dom';

function splitter(
  properties: { class: string; label: string; upright: boolean },
  at: () => number,
  move: (to: number) => void,
): HTMLElement {
  const { upright, label } = properties;
  const bar = element('div', {
    class: `splitter ${properties.class}`,
    role: 'separator',
    tabindex: '0',
    'aria-label': label,
    'aria-orientation': upright ? 'vertical' : 'horizontal',
  });
  let grip: number | null = null;
  const place = (event: PointerEvent) => (upright ? event.clientX : event.clientY);
  bar.addEventListener('pointerdown', (event) => {
    bar.setPointerCapture(event.pointerId);
    grip = place(event) - at();
    event.preventDefault();
  });
  bar.addEventListener('pointermove', (event) => {
    if (grip !== null) move(place(event) - grip);
  });
  for (const end of ['pointerup', 'pointercancel'] as const) bar.addEventListener(end, () => (grip = null));
  bar.addEventListener('keydown', (event) => {
    const step = { ArrowLeft: -16, ArrowRight: 16, ArrowUp: -16, ArrowDown: 16 }[event.key];
    if (step === undefined) return;
    event.preventDefault();
    event.stopPropagation();
    move(at() + step);
  });
  return bar;
}

function within(value: number, low: number, high: number): string {
  return `${Math.round(Math.min(Math.max(value, low), Math.max(low, high)))}px`;
}

/** Between robot and plots, and above the tables. */
export function add_splitters(app: HTMLElement) {
  const main = app.querySelector('main')!,
    left = app.querySelector<HTMLElement>('.left')!,
    lower = app.querySelector<HTMLElement>('.lower')!;
  const upright = splitter(
    { class: 'upright', label: 'between robot and plots', upright: true },
    () => left.getBoundingClientRect().right,
    (to) =>
      app.style.setProperty('--left', within(to - main.getBoundingClientRect().left, 240, main.clientWidth - 360)),
  );
  new ResizeObserver(() => (upright.style.left = `${left.offsetWidth}px`)).observe(left);
  main.append(upright);
  lower.append(
    splitter(
      { class: 'level', label: 'above the tables', upright: false },
      () => lower.getBoundingClientRect().top,
      (to) =>
        app.style.setProperty('--lower', within(lower.getBoundingClientRect().bottom - to, 90, app.clientHeight - 520)),
    ),
  );
}

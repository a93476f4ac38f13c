// Play, pause, step; and the position of the cursor.
import { button, element, set_text } from './dom';
import type { Tour } from './divergences';
import { count_text, time_text } from './numbers';
import type { Report } from './report';
import type { Store } from './store';

const speeds = [0.1, 0.25, 0.5, 1, 2, 4];

export class Transport {
  readonly root: HTMLElement;
  private readonly play_button: HTMLButtonElement;
  private readonly tick_field: HTMLInputElement;
  private readonly time = element('output', { class: 'time', 'aria-label': 'time at the cursor' });
  private readonly speed_field: HTMLSelectElement;
  private exact = 0; // the tick with its fraction, while playing

  constructor(
    private readonly store: Store,
    private readonly report: Report,
    tour: Tour,
  ) {
    const { begin } = report.data;
    this.play_button = button('Play', 'Play or pause (space)', () => this.toggle(), { class: 'play' });
    this.tick_field = element('input', {
      type: 'number',
      min: begin,
      max: report.last,
      value: begin,
      'aria-label': 'tick at the cursor',
      onchange: () => store.go(this.tick_field.valueAsNumber),
    });
    this.speed_field = element(
      'select',
      { 'aria-label': 'speed', onchange: () => (store.speed = Number(this.speed_field.value)) },
      ...speeds.map((speed) => element('option', { value: speed, selected: speed === 1 }, `${speed} ×`)),
    );
    this.root = element(
      'div',
      { class: 'transport', role: 'toolbar', 'aria-label': 'moving through the run' },
      element(
        'div',
        { class: 'group' },
        button('|◀', 'First tick (Home)', () => store.go(begin)),
        button('◀', 'One tick back (←)', () => store.go(store.tick - 1)),
        this.play_button,
        button('▶', 'One tick on (→)', () => store.go(store.tick + 1)),
        button('▶|', 'Last tick (End)', () => store.go(report.last)),
        this.speed_field,
      ),
      element(
        'div',
        { class: 'group where' },
        element('label', {}, 'tick ', this.tick_field),
        element('span', { class: 'note' }, ` of ${count_text(report.last)}`),
        this.time,
      ),
      (tour.first || tour.first_violation !== null) &&
        element(
          'div',
          { class: 'group divergences-group' },
          tour.first_violation !== null &&
            button('Violation', 'To the first violated expectation (v)', () => tour.go_to_violation(), {
              class: 'primary',
            }),
          tour.first &&
            button('First divergence', 'To the first divergence (d)', () => tour.go_to_first(), { class: 'primary' }),
          button('Previous', 'Previous divergence or violation (p)', () => tour.previous()),
          button('Next', 'Next divergence or violation (n)', () => tour.next()),
        ),
      element(
        'div',
        { class: 'group zoom' },
        button('Zoom in', 'To the ticks around the cursor (z)', () => this.zoom_to_cursor()),
        button('Whole run', 'The whole run (a, or a double click)', () => store.look_at_all()),
      ),
    );
    store.on(['tick'], () => this.update());
    store.on(['playing'], () => this.play());
    this.update();
    if (report.ticks === 0) {
      this.root
        .querySelectorAll<HTMLButtonElement>('button, input, select')
        .forEach((field) => (field.disabled = true));
    }
  }

  /** A button in the group of divergences. */
  add(button: HTMLElement) {
    this.root.querySelector('.divergences-group')?.append(button);
  }

  zoom_to_cursor() {
    const { tick, view } = this.store;
    const width = Math.max(20, Math.min(400, (view.end - view.begin) / 8));
    this.store.look_at(tick - width / 2, tick + width / 2);
  }

  toggle() {
    const { store } = this;
    if (!store.playing && store.tick >= this.report.last) store.go(this.report.data.begin);
    store.set_playing(!store.playing);
  }

  faster(step: number) {
    const at = speeds.indexOf(this.store.speed);
    this.store.speed = speeds[Math.min(Math.max(at + step, 0), speeds.length - 1)]!;
    this.speed_field.value = String(this.store.speed);
  }

  private update() {
    const { tick } = this.store;
    if (document.activeElement !== this.tick_field || this.store.playing) this.tick_field.value = String(tick);
    set_text(this.time, time_text(this.report.time(tick), this.report.data.time_step));
  }

  private play() {
    const { store, report } = this;
    set_text(this.play_button, store.playing ? 'Pause' : 'Play');
    this.play_button.setAttribute('aria-pressed', String(store.playing));
    if (!store.playing) return;
    let before = performance.now();
    this.exact = store.tick;
    const frame = (now: number) => {
      if (!store.playing) return;
      // if the user moves the cursor during play, play continues from there
      if (Math.round(this.exact) !== store.tick) this.exact = store.tick;
      this.exact = Math.min(this.exact + report.tick_at(((now - before) / 1000) * store.speed), report.last);
      before = now;
      store.go(this.exact);
      if (this.exact >= report.last) store.set_playing(false);
      else requestAnimationFrame(frame);
    };
    requestAnimationFrame(frame);
  }
}

// The state of the view: the tick under the cursor, the ticks in view, the plotted series. Parts of the page subscribe
// to it; they are notified once per frame, of all changes together.
import type { Report } from './report';

export type Change = 'tick' | 'view' | 'shown' | 'theme' | 'playing' | 'ghost' | 'data';

export interface View {
  begin: number;
  end: number;
}

export class Store {
  tick_: number;
  view_: View;
  shown_: string[] = [];
  playing_ = false;
  speed = 1;
  ghost_ = true;
  private readonly listeners: { changes: Set<Change>; listener: () => void }[] = [];
  private readonly pending = new Set<Change>();
  private frame = 0;
  private waiting: (() => void)[] = [];

  constructor(readonly report: Report) {
    this.tick_ = report.data.begin;
    this.view_ = this.whole;
  }

  get tick() {
    return this.tick_;
  }
  get view() {
    return this.view_;
  }
  get shown(): readonly string[] {
    return this.shown_;
  }
  get playing() {
    return this.playing_;
  }
  get ghost() {
    return this.ghost_;
  }

  /** Everything there is; at least one tick wide. */
  get whole(): View {
    const { begin } = this.report.data;
    return { begin, end: Math.max(this.report.last, begin + 1) };
  }

  get zoomed() {
    const { whole, view } = this;
    return view.begin > whole.begin || view.end < whole.end;
  }

  go(tick: number) {
    const { begin } = this.report.data;
    const to = Math.min(Math.max(Math.round(tick), begin), this.report.last);
    if (!Number.isFinite(to) || to === this.tick_) return;
    this.tick_ = to;
    this.changed('tick');
    const { view } = this;
    if (to < view.begin || to > view.end) {
      // keep the width of the view and the cursor's place in it
      const width = view.end - view.begin;
      this.look_at(
        to - width * (to < view.begin ? 0.1 : this.playing_ ? 0.02 : 0.9),
        to + width * (to < view.begin ? 0.9 : this.playing_ ? 0.98 : 0.1),
      );
    }
  }

  look_at(begin: number, end: number) {
    const { whole } = this;
    const width = Math.min(Math.max(end - begin, 4), whole.end - whole.begin);
    const centred = (begin + end - width) / 2;
    const from = Math.min(Math.max(centred, whole.begin), whole.end - width);
    const view = { begin: from, end: from + width };
    if (view.begin === this.view_.begin && view.end === this.view_.end) return;
    this.view_ = view;
    this.changed('view');
  }

  look_at_all() {
    this.look_at(this.whole.begin, this.whole.end);
  }

  zoom_by(factor: number, around: number) {
    const { begin, end } = this.view_;
    this.look_at(around - (around - begin) * factor, around + (end - around) * factor);
  }

  show(names: readonly string[]) {
    const known = [...new Set(names)].filter((name) => this.report.find(name));
    if (known.join('\n') === this.shown_.join('\n')) return;
    this.shown_ = known;
    this.changed('shown');
  }

  toggle(name: string) {
    this.show(this.shown_.includes(name) ? this.shown_.filter((one) => one !== name) : [...this.shown_, name]);
  }

  set_playing(playing: boolean) {
    if (playing === this.playing_) return;
    this.playing_ = playing;
    this.changed('playing');
  }

  set_ghost(ghost: boolean) {
    this.ghost_ = ghost;
    this.changed('ghost');
  }

  on(changes: Change[], listener: () => void) {
    this.listeners.push({ changes: new Set(changes), listener });
  }

  changed(change: Change) {
    this.pending.add(change);
    this.frame ||= requestAnimationFrame(() => this.tell());
  }

  /** Once all that has changed is told. */
  told(): Promise<void> {
    if (!this.frame) return Promise.resolve();
    return new Promise((resolve) => this.waiting.push(resolve));
  }

  private tell() {
    this.frame = 0;
    const pending = new Set(this.pending);
    this.pending.clear();
    for (const { changes, listener } of this.listeners) {
      if ([...changes].some((change) => pending.has(change))) listener();
    }
    if (this.frame) return;
    const waiting = this.waiting;
    this.waiting = [];
    for (const resolve of waiting) resolve();
  }
}

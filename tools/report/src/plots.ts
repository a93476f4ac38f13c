// The plots of the selected series, one below the other. Only plots on the screen are drawn.
import { absence, element } from './dom';
import { Plot } from './plot';
import type { Report } from './report';
import type { Store } from './store';

export class Plots {
  readonly root = element('div', { class: 'plots', tabindex: '0', role: 'region', 'aria-label': 'plots' });
  private readonly plots = new Map<string, Plot>();
  private readonly observer: IntersectionObserver;

  constructor(
    private readonly store: Store,
    private readonly report: Report,
  ) {
    this.observer = new IntersectionObserver(
      (entries) => {
        for (const entry of entries)
          this.plots.get((entry.target as HTMLElement).dataset.series!)?.set_visible(entry.isIntersecting);
      },
      { root: this.root, rootMargin: '200px 0px' },
    );
    store.on(['shown'], () => this.arrange());
    store.on(['view'], () => this.each((plot) => plot.update_view()));
    store.on(['tick'], () => this.each((plot) => plot.move_cursor()));
    store.on(['theme'], () => this.each((plot) => plot.redraw()));
    let width = 0;
    new ResizeObserver(() => {
      if (this.root.clientWidth === width) return;
      width = this.root.clientWidth;
      this.each((plot) => plot.redraw());
    }).observe(this.root);
    this.root.addEventListener('wheel', (event) => this.zoom(event), { passive: false });
    this.arrange();
  }

  private each(action: (plot: Plot) => void) {
    for (const plot of this.plots.values()) if (plot.visible) action(plot);
  }

  private arrange() {
    const shown = new Set(this.store.shown);
    for (const [name, plot] of this.plots) {
      if (shown.has(name)) continue;
      this.observer.unobserve(plot.root);
      plot.clear();
      plot.root.remove();
      this.plots.delete(name);
    }
    this.root.querySelector(':scope > .absence')?.remove();
    for (const name of shown) {
      let plot = this.plots.get(name);
      if (!plot) {
        plot = new Plot(this.store, this.report, this.report.find(name)!);
        this.plots.set(name, plot);
        this.observer.observe(plot.root);
      }
      this.root.append(plot.root);
    }
    if (shown.size === 0) {
      this.root.append(absence('No channel is plotted. Choose some above ( / ), or click a row of the table below.'));
    }
  }

  // zooms with Ctrl, as in maps; otherwise the list scrolls
  private zoom(event: WheelEvent) {
    if (!event.ctrlKey && !event.metaKey) return;
    const over = (event.target as HTMLElement).closest<HTMLElement>('.u-over');
    if (!over) return;
    event.preventDefault();
    const { begin, end } = this.store.view;
    const box = over.getBoundingClientRect();
    this.store.zoom_by(
      Math.exp(event.deltaY * 0.002),
      begin + ((event.clientX - box.left) / box.width) * (end - begin),
    );
  }

  /** Once what is on the screen is drawn. */
  async drawn() {
    await new Promise((resolve) => requestAnimationFrame(() => setTimeout(resolve)));
    await Promise.all(
      [...this.plots.values()].filter((plot) => plot.visible).map((plot) => plot.series.load().catch(() => null)),
    );
    await new Promise((resolve) => setTimeout(resolve));
  }

  /** Of the plots that are drawn: at which tick their line stands. */
  cursors(): Record<string, number | null> {
    const cursors: Record<string, number | null> = {};
    this.each((plot) => (cursors[plot.series.name] = plot.drawn_tick));
    return cursors;
  }
}

// A list that creates only the rows on the screen. All rows have the same height.
import { element } from './dom';

export class VirtualList<Row extends HTMLElement> {
  readonly root: HTMLElement;
  private readonly spacer = element('div', { class: 'spacer' });
  private readonly rows: Row[] = [];
  private readonly places: HTMLElement[] = []; // what is moved: a row, or the item of a list around it
  private readonly is_list: boolean;
  private count = 0;
  first = 0;

  constructor(
    private readonly row_height: number,
    private readonly make: () => Row,
    private readonly fill: (row: Row, index: number) => void,
    properties: Record<string, string> = {},
  ) {
    this.root = element('div', { class: 'virtual', tabindex: '0', ...properties }, this.spacer);
    this.is_list = properties.role === 'list';
    if (this.is_list) this.spacer.role = 'presentation';
    this.root.addEventListener('scroll', () => this.update(), { passive: true });
    new ResizeObserver(() => this.update()).observe(this.root);
  }

  set_count(count: number) {
    this.count = count;
    this.spacer.style.height = `${count * this.row_height}px`;
    this.update();
  }

  /** Fills the rows on the screen anew. */
  update() {
    const height = this.root.clientHeight;
    this.first = Math.max(0, Math.floor(this.root.scrollTop / this.row_height));
    const shown = Math.max(0, Math.min(Math.ceil(height / this.row_height) + 1, this.count - this.first));
    while (this.rows.length < shown) {
      const row = this.make();
      const place = this.is_list && !row.role ? element('div', { role: 'listitem' }, row) : row;
      row.style.height = place.style.height = `${this.row_height}px`;
      this.rows.push(row);
      this.places.push(place);
      this.spacer.append(place);
    }
    this.rows.forEach((row, i) => {
      const place = this.places[i]!;
      row.hidden = place.hidden = i >= shown;
      if (i >= shown) return;
      place.style.transform = `translateY(${(this.first + i) * this.row_height}px)`;
      this.fill(row, this.first + i);
    });
  }

  /** Scrolls no more than is needed to have that row on the screen. */
  reveal(index: number) {
    const top = index * this.row_height,
      { scrollTop, clientHeight } = this.root;
    if (clientHeight === 0) return;
    if (top < scrollTop) this.root.scrollTop = Math.max(0, top - this.row_height);
    else if (top + this.row_height > scrollTop + clientHeight)
      this.root.scrollTop = top - clientHeight + 2 * this.row_height;
  }
}

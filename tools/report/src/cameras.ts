// Pictures of cameras at the cursor: expected, actual, difference; or one picture with a slider between expected and
// actual.
import { button, element, set_text } from './dom';
import type { CameraEntry } from './format';
import { count_text, short_text } from './numbers';
import { draw_difference, picture_of, shown_at, type Shown } from './pictures';
import type { Report } from './report';
import type { Store } from './store';

type Part = 'expected' | 'actual' | 'difference';
const parts: Part[] = ['expected', 'actual', 'difference'];

/** A camera may make pictures and distances. */
function label_of(camera: CameraEntry): string {
  return camera.kind === 'depth' ? `${camera.name} depth` : camera.name;
}

export interface FrameState {
  expected: number | null;
  actual: number | null;
}

class CameraView {
  readonly root: HTMLElement;
  private readonly note = element('span', { class: 'note' });
  private readonly canvases: Record<Part, HTMLCanvasElement>;
  private readonly wipe: HTMLInputElement;
  private wanted = 0;
  private shown_key = '';
  private split = 0.5;
  private width: number;
  private height: number;
  drawn: FrameState = { expected: null, actual: null };
  drawing: Promise<void> = Promise.resolve();

  constructor(
    private readonly camera: CameraEntry,
    private readonly compared: boolean,
    private readonly mode: () => { wipe: boolean; gain: number },
  ) {
    ({ width: this.width, height: this.height } = camera);
    const canvas = (part: Part) =>
      element('canvas', {
        width: camera.width,
        height: camera.height,
        role: 'img',
        'aria-label': `${label_of(camera)}, ${part}`,
      });
    this.canvases = { expected: canvas('expected'), actual: canvas('actual'), difference: canvas('difference') };
    this.wipe = element('input', {
      type: 'range',
      min: 0,
      max: 1,
      step: 0.01,
      value: 0.5,
      class: 'wipe',
      'aria-label': `${label_of(camera)}: expected left of here, actual right of it`,
      oninput: () => ((this.split = this.wipe.valueAsNumber), this.redraw()),
    });
    const figures = (compared ? parts : (['actual'] as Part[])).map((part) =>
      element('figure', { class: part }, this.canvases[part], element('figcaption', {}, compared ? part : '')),
    );
    const range =
      camera.kind === 'depth' && camera.near !== undefined
        ? `, white ${short_text(camera.near)} m to black ${short_text(camera.far ?? camera.near)} m`
        : '';
    this.root = element(
      'section',
      { class: 'camera', 'aria-label': `camera ${label_of(camera)}` },
      element(
        'header',
        {},
        element('h3', {}, label_of(camera)),
        element('span', { class: 'unit' }, camera.width > 0 ? `${camera.width} × ${camera.height}${range}` : ''),
        this.note,
      ),
      element('div', { class: 'frames' }, ...figures, this.wipe),
    );
  }

  update(tick: number) {
    const shown = shown_at(this.camera, tick);
    const { wipe, gain } = this.mode();
    const key = `${shown?.expected?.id} ${shown?.actual?.id} ${shown?.expected_tick} ${shown?.actual_tick} ${wipe} ${gain}`;
    this.root.classList.toggle('wiping', wipe && this.compared);
    if (key === this.shown_key) return;
    this.shown_key = key;
    this.drawing = this.draw(shown, ++this.wanted);
  }

  private redraw() {
    this.shown_key = '';
    this.root.dispatchEvent(new Event('redraw', { bubbles: true }));
  }

  private async draw(shown: Shown | null, request: number) {
    try {
      const [expected, actual] = await Promise.all([
        shown?.expected && picture_of(shown.expected),
        shown?.actual && picture_of(shown.actual),
      ]);
      if (request !== this.wanted) return; // the cursor has moved since
      this.paint(expected ?? null, actual ?? null, shown);
      this.drawn = { expected: shown?.expected_tick ?? null, actual: shown?.actual_tick ?? null };
      set_text(this.note, this.describe(shown));
    } catch (error) {
      if (request === this.wanted) set_text(this.note, error instanceof Error ? error.message : String(error));
    }
  }

  private describe(shown: Shown | null): string {
    if (!shown) return this.camera.pictures.length === 0 ? 'it made no picture' : 'no picture yet';
    const { differing } = shown.entry;
    const tick = `tick ${shown.entry.tick}`;
    if (!this.compared) return tick;
    if (!shown.entry.actual) return `${tick}: the run has no picture here`;
    if (!shown.entry.golden) return `${tick}: the golden has no picture here`;
    if (shown.entry.golden === 'same') return `${tick}: the same bits`;
    return `${tick}: ${differing === null ? 'not compared' : differing === 0 ? 'within tolerance' : `${count_text(differing)} pixels beyond tolerance`}`;
  }

  // The recording may not state the size before the first picture.
  private resize(picture: ImageBitmap | null) {
    if (!picture) return;
    ({ width: this.width, height: this.height } = picture);
    for (const canvas of Object.values(this.canvases)) ((canvas.width = this.width), (canvas.height = this.height));
  }

  private paint(expected: ImageBitmap | null, actual: ImageBitmap | null, shown: Shown | null) {
    const { wipe, gain } = this.mode();
    if (this.width === 0) this.resize(actual ?? expected);
    const put = (part: Part, picture: ImageBitmap | null) => {
      const context = this.canvases[part].getContext('2d')!;
      context.clearRect(0, 0, this.width, this.height);
      if (picture) context.drawImage(picture, 0, 0, this.width, this.height);
    };
    if (!this.compared) return put('actual', actual);
    if (wipe) {
      put('actual', actual);
      if (!expected) return;
      const context = this.canvases.actual.getContext('2d')!,
        edge = Math.round(this.split * this.width);
      if (edge > 0) context.drawImage(expected, 0, 0, edge, expected.height, 0, 0, edge, this.height);
      if (edge > 0 && edge < this.width) {
        context.fillStyle = '#fff';
        context.fillRect(edge - 0.5, 0, 1, this.height);
      }
      return;
    }
    put('expected', expected);
    put('actual', actual);
    const context = this.canvases.difference.getContext('2d')!;
    context.clearRect(0, 0, this.width, this.height);
    if (!expected || !actual) return;
    context.fillStyle = '#000';
    context.fillRect(0, 0, this.width, this.height);
    if (shown?.expected?.id !== shown?.actual?.id) draw_difference(context, expected, actual, gain);
  }
}

export class Cameras {
  readonly root = element('div', { class: 'cameras', role: 'region', 'aria-label': 'pictures', tabindex: '0' });
  private readonly views: CameraView[];
  private wipe = false;
  private gain = 8;

  constructor(
    private readonly store: Store,
    private readonly report: Report,
  ) {
    this.views = report.data.cameras.map(
      (camera) => new CameraView(camera, report.compared, () => ({ wipe: this.wipe, gain: this.gain })),
    );
    this.root.append(...this.views.map((view) => view.root));
    this.root.addEventListener('redraw', () => this.update());
    store.on(['tick', 'data'], () => this.update());
    this.update();
  }

  /** For the head of the panel. */
  get tools(): HTMLElement | null {
    if (!this.report.compared) return null;
    const wipe = button(
      'Slider',
      'Expected and actual in one picture, with a slider between them',
      () => {
        this.wipe = !this.wipe;
        wipe.setAttribute('aria-pressed', String(this.wipe));
        this.update();
      },
      { 'aria-pressed': 'false' },
    );
    const gain = element(
      'select',
      {
        'aria-label': 'how much differences are amplified',
        onchange: () => ((this.gain = Number(gain.value)), this.update()),
      },
      ...[1, 2, 4, 8, 16, 64].map((factor) =>
        element('option', { value: factor, selected: factor === this.gain }, `difference × ${factor}`),
      ),
    );
    return element('div', { class: 'tools' }, wipe, gain);
  }

  private update() {
    for (const view of this.views) view.update(this.store.tick);
  }

  async drawn() {
    await Promise.all(this.views.map((view) => view.drawing));
  }

  frames(): Record<string, FrameState> {
    return Object.fromEntries(this.views.map((view, i) => [label_of(this.report.data.cameras[i]!), { ...view.drawn }]));
  }
}

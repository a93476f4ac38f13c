// The controllers' sources with their coverage: the first tick of each line, lines that never run, branches of which
// only one way was taken.
import { json_of } from './blobs';
import { absence, button, element, set_text, type Child } from './dom';
import type {
  CoverageData,
  CoverageEntry,
  CoveredFileEntry,
  CoveredLineEntry,
  ExecutionEntry,
  WayEntry,
} from './format';
import { plural, time_text } from './numbers';
import type { Report } from './report';
import type { Store } from './store';
import { VirtualList } from './virtual_list';

const row_height = 18; // [pixels]
const narrow = 700; // width of the panel in which lines have less beside their code [pixels], as in the style
const tab_width = 4; // [characters], as in the style

const name_of = (path: string) => path.slice(path.lastIndexOf('/') + 1);

/** "Filter::update(double) const": "Filter::update()" */
export function without_parameters(name: string): string {
  let depth = 0;
  for (let at = name.lastIndexOf(')'); at >= 0; --at) {
    depth += name[at] === ')' ? 1 : name[at] === '(' ? -1 : 0;
    if (depth === 0) return `${name.slice(0, at)}()`;
  }
  return name;
}

/** A branch with a way that is known to be never taken, in a line that was executed. */
function goes_one_way(line: CoveredLineEntry): boolean {
  return line.first !== null && line.ways.some((way) => way.first === null && way.known);
}

interface Share {
  lines: number;
  executed: number;
}

function share_of(lines: CoveredLineEntry[]): Share {
  return { lines: lines.length, executed: lines.filter((line) => line.first !== null).length };
}

/** A file or a function in the outline: its share, and the line that it begins at. */
interface OutlineEntry extends Share {
  file: number;
  line: number;
  name: string;
  is_file: boolean;
}

function outline_of(files: CoveredFileEntry[]): OutlineEntry[] {
  return files.flatMap(({ file, lines }, index) => {
    const functions = new Map<string, CoveredLineEntry[]>();
    for (const line of lines) {
      const own = functions.get(line.function);
      if (own) own.push(line);
      else functions.set(line.function, [line]);
    }
    return [
      { file: index, line: 1, name: name_of(file), is_file: true, ...share_of(lines) },
      ...[...functions].map(([name, own]) => ({
        file: index,
        line: own[0]!.line,
        name: without_parameters(name) || 'no function',
        is_file: false,
        ...share_of(own),
      })),
    ];
  });
}

interface Place {
  file: number;
  line: number;
}

/** Lines that were never executed; of those that follow each other in a function the first. */
function unexecuted_in(files: CoveredFileEntry[]): Place[] {
  return files.flatMap(({ lines }, file) =>
    lines
      .filter((line, i) => {
        const before = lines[i - 1];
        return line.first === null && !(before && before.first === null && before.function === line.function);
      })
      .map(({ line }) => ({ file, line })),
  );
}

function width_of(text: string): number {
  return text.length + (tab_width - 1) * (text.split('\t').length - 1);
}

/** The panel of a decoded coverage. */
class CoveragePanel {
  readonly root: HTMLElement;
  private readonly list: VirtualList<HTMLElement>;
  private readonly outline: VirtualList<HTMLElement>;
  private readonly entries: OutlineEntry[];
  private readonly unexecuted: Place[];
  private readonly by_line: Map<number, CoveredLineEntry>[];
  private readonly files: HTMLSelectElement;
  private readonly reason = element('p', { class: 'note unread', hidden: true });
  private readonly place_note = element('span', { class: 'note', 'aria-live': 'polite' });
  private file = 0;
  private current = 0; // line; 0: none
  private is_narrow = false;

  constructor(
    private readonly store: Store,
    private readonly report: Report,
    private readonly data: CoverageData,
  ) {
    this.entries = outline_of(data.files);
    this.unexecuted = unexecuted_in(data.files);
    this.by_line = data.files.map(({ lines }) => new Map(lines.map((line) => [line.line, line])));
    this.list = new VirtualList(
      row_height,
      () => this.make_row(),
      (row, i) => this.fill(row, i + 1),
      {
        role: 'list',
        'aria-label': 'lines of the source',
        class: `virtual lines${data.recordings.length > 1 ? ' several' : ''}`,
      },
    );
    this.outline = new VirtualList(
      24,
      () => this.make_entry(),
      (row, i) => this.fill_entry(row, this.entries[i]!),
      { role: 'list', 'aria-label': 'files and functions', class: 'virtual outline' },
    );
    this.files = element(
      'select',
      { 'aria-label': 'file', onchange: () => this.show_file(Number(this.files.value)) },
      ...data.files.map((file, i) => {
        const { lines, executed } = share_of(file.lines);
        return element('option', { value: i }, `${name_of(file.file)}: ${executed} of ${plural(lines, 'line')}`);
      }),
    );
    const has_none = this.unexecuted.length === 0;
    const tools = element(
      'div',
      { class: 'tools' },
      this.files,
      button('Previous', 'To the lines before that never run (U)', () => this.previous(), { disabled: has_none }),
      button('Next', 'To the next lines that never run (u)', () => this.next(), { disabled: has_none }),
      this.place_note,
    );
    this.root = element(
      'div',
      { class: 'coverage' },
      element('div', { class: 'facts' }, ...this.facts()),
      tools,
      this.reason,
      element('div', { class: 'beside' }, this.outline.root, this.list.root),
    );
    this.outline.set_count(this.entries.length);
    this.show_file(this.unexecuted[0]?.file ?? 0);
    // scrolling is possible only after the list is shown
    new ResizeObserver(() => {
      this.is_narrow = this.root.clientWidth <= narrow;
      this.list.update();
      this.reveal();
    }).observe(this.list.root);
  }

  next() {
    this.go_to(
      this.unexecuted.find(({ file, line }) => file > this.file || (file === this.file && line > this.current)) ??
        this.unexecuted[0],
    );
  }

  previous() {
    this.go_to(
      this.unexecuted.findLast(({ file, line }) => file < this.file || (file === this.file && line < this.current)) ??
        this.unexecuted.at(-1),
    );
  }

  private go_to(place: Place | undefined) {
    if (!place) return;
    if (place.file !== this.file) this.show_file(place.file);
    this.current = place.line;
    const at = this.unexecuted.findIndex(({ file, line }) => file === place.file && line === place.line);
    set_text(this.place_note, at >= 0 ? `place ${at + 1} of ${this.unexecuted.length} that never run` : '');
    this.reveal();
    this.list.update();
  }

  private reveal() {
    if (this.current > 0) this.list.reveal(this.current - 1);
  }

  private facts(): Child[] {
    const { verdict, recordings, failure, remarks } = this.data;
    const is_alone = this.report.data.runs.length === 0; // then the verdict is above
    return [
      !is_alone && element('p', {}, `${verdict}.`),
      recordings.length > 1 &&
        element(
          'details',
          {},
          element('summary', {}, plural(recordings.length, 'recording')),
          element('ul', {}, ...recordings.map((path) => element('li', {}, path))),
        ),
      failure !== null && element('p', { class: 'failure' }, `A controller failed; lines until then count: ${failure}`),
      ...remarks.map(({ message }) => element('p', { class: 'remark' }, element('b', {}, 'note: '), message)),
    ];
  }

  private show_file(index: number) {
    this.file = index;
    this.current = 0;
    const file = this.data.files[index];
    if (!file) return;
    this.files.value = String(index);
    this.files.title = file.file;
    this.reason.hidden = file.source !== null;
    set_text(this.reason, `The source isn’t shown: ${file.unread}.`);
    set_text(this.place_note, this.unexecuted.length === 0 ? 'no line is left out' : '');
    const count = Math.max(file.source?.length ?? 0, file.lines.at(-1)?.line ?? 0);
    const widest = (file.source ?? []).reduce((most, text) => Math.max(most, width_of(text)), 0);
    this.list.root.style.setProperty('--widest', `${widest}ch`);
    this.list.root.scrollTop = 0;
    this.list.set_count(count);
    this.outline.update();
  }

  private make_row(): HTMLElement {
    const first = element('button', { type: 'button', class: 'first' });
    first.addEventListener('click', () => this.store.go(Number(first.dataset.tick)));
    return element(
      'div',
      { class: 'line', role: 'listitem' },
      element('span', { class: 'number' }),
      element('span', { class: 'when' }, first, element('span', { class: 'text' })),
      element('span', { class: 'ways' }),
      element('code', {}),
    );
  }

  /** The tick comes first: a long name may be cut. `is_short`: the tick alone, where there is no room. */
  private when(first: ExecutionEntry, is_short = false): string {
    if (is_short) return first.tick < 0 || first.time === null ? 'before' : `tick ${first.tick}`;
    const where = this.data.recordings.length > 1 ? ` in ${name_of(first.recording).replace(/\.mcap$/, '')}` : '';
    if (first.tick < 0 || first.time === null) return `before the run${where}`;
    const own = this.report.data.runs.length > 0 ? this.report.data.time_step : first.time / Math.max(1, first.tick);
    return `tick ${first.tick}, ${time_text(first.time, own || 0.001)}${where}`;
  }

  private way_text(way: WayEntry): string {
    if (way.first) return this.when(way.first);
    return way.known ? 'never' : 'unknown: it was no longer watched';
  }

  private fill(row: HTMLElement, number: number) {
    const file = this.data.files[this.file]!;
    const line = this.by_line[this.file]!.get(number);
    const [numbered, when, ways, code] = [...row.children] as HTMLElement[];
    const [first, text] = [...when!.children] as HTMLElement[];
    const is_never = line !== undefined && line.first === null;
    const is_one_way = line !== undefined && goes_one_way(line);
    row.className = `line${is_never ? ' never' : line ? ' executed' : ''}${is_one_way ? ' one-way' : ''}`;
    row.classList.toggle('current', number === this.current);
    row.title = line
      ? [
          without_parameters(line.function),
          line.first ? `first: ${this.when(line.first)}` : 'never executed',
          this.data.recordings.length > 1 &&
            `in ${line.recordings} of ${plural(this.data.recordings.length, 'recording')}`,
          ...line.ways.map((way, i) => `way ${i + 1} of its branches: ${this.way_text(way)}`),
        ]
          .filter(Boolean)
          .join('\n')
      : '';
    set_text(numbered!, String(number));
    const { begin, end } = this.report.data;
    const tick = line?.first?.tick ?? -1;
    const leads = tick >= begin && tick < end;
    first!.hidden = !leads;
    first!.dataset.tick = String(tick);
    const words = is_never ? 'never' : line?.first ? this.when(line.first, this.is_narrow) : '';
    set_text(first!, leads ? words : '');
    first!.setAttribute('aria-label', leads ? `Go to ${words}, when line ${number} runs first` : '');
    set_text(text!, leads ? '' : words);
    const taken = line?.ways.filter((way) => way.first !== null).length ?? 0;
    const counts = [taken, line?.ways.length ?? 0];
    set_text(ways!, is_one_way ? (this.is_narrow ? counts.join('/') : `${counts.join(' of ')} ways`) : '');
    set_text(code!, file.source?.[number - 1] ?? '');
  }

  private make_entry(): HTMLElement {
    const row = element(
      'button',
      { type: 'button', class: 'entry' },
      element('span', { class: 'name' }),
      element('span', { class: 'share' }),
    );
    row.addEventListener('click', () => {
      this.go_to({ file: Number(row.dataset.file), line: Number(row.dataset.line) });
    });
    return row;
  }

  private fill_entry(row: HTMLElement, { file, line, name, is_file, lines, executed }: OutlineEntry) {
    row.dataset.file = String(file);
    row.dataset.line = String(line);
    row.classList.toggle('file', is_file);
    row.classList.toggle('shown', is_file && file === this.file);
    row.classList.toggle('incomplete', executed < lines);
    row.title = is_file ? this.data.files[file]!.file : name;
    set_text(row.children[0]!, name);
    set_text(row.children[1]!, `${executed}/${lines}`);
  }
}

/** The tab: its content is decoded when it is first shown. */
export class Coverage {
  readonly root = element('div', {}, absence('The coverage is being read.'));
  private panel: Promise<CoveragePanel> | null = null;

  constructor(
    private readonly store: Store,
    private readonly report: Report,
    private readonly entry: CoverageEntry,
  ) {
    new ResizeObserver(() => void this.shown()).observe(this.root);
  }

  get title(): string {
    return `Coverage (${this.entry.lines_executed} of ${this.entry.lines})`;
  }

  async next() {
    (await this.decoded()).next();
  }

  async previous() {
    (await this.decoded()).previous();
  }

  private async shown() {
    if (this.root.clientHeight > 0) await this.decoded();
  }

  private decoded(): Promise<CoveragePanel> {
    this.panel ??= json_of(this.entry).then((data) => {
      const panel = new CoveragePanel(this.store, this.report, data as CoverageData);
      this.root.replaceChildren(panel.root);
      return panel;
    });
    return this.panel;
  }
}

// Assembles the page: parts, keys, address.
import 'uplot/dist/uPlot.min.css';
import './style/theme.css';
import './style/base.css';
import './style/page.css';
import './style/parts.css';
import { go_to_place, keep_address, parse_address } from './address';
import { call_stack, show_source_line } from './call_stack';
import { control_times } from './control_times';
import { Coverage } from './coverage';
import { Cameras } from './cameras';
import { Channels } from './channels';
import { Tour } from './divergences';
import { button, element, type Child } from './dom';
import { Expectations } from './expectations';
import { help_dialog, listen_to_keys, type Key } from './keys';
import { Divergences, Messages } from './messages';
import { Plots } from './plots';
import { provenance, scenario } from './provenance';
import { Report } from './report';
import { Scene } from './scene';
import { splitter } from './splitters';
import { Store } from './store';
import { Table } from './table';
import { Tabs } from './tabs';
import { test_interface } from './test_interface';
import { toggle_theme, watch_theme } from './theme';
import { Timeline } from './timeline';
import { Transport } from './transport';
import { verdict } from './verdict';

const app = document.getElementById('app')!;

function keys_of(
  store: Store,
  report: Report,
  tour: Tour,
  transport: Transport,
  channels: Channels,
  help: () => void,
  ghost: () => void,
  unexecuted: Key[],
): Key[] {
  const by = (event: KeyboardEvent) => (event.shiftKey ? 10 : 1);
  const look: Key[] = [
    { keys: ['t'], shown: 't', does: 'light or dark', action: toggle_theme },
    { keys: ['?'], shown: '?', does: 'this help', action: help },
  ];
  if (report.data.runs.length === 0) return [...unexecuted, ...look];
  return [
    { keys: ['d'], shown: 'd', does: 'the first divergence', action: () => tour.go_to_first() },
    { keys: ['v'], shown: 'v', does: 'the first violated expectation', action: () => tour.go_to_violation() },
    { keys: ['n'], shown: 'n', does: 'the next divergence', action: () => tour.next() },
    { keys: ['p'], shown: 'p', does: 'the previous divergence', action: () => tour.previous() },
    {
      keys: ['ArrowRight'],
      shown: '→',
      does: 'one tick on; with Shift ten',
      action: (event) => store.go(store.tick + by(event)),
    },
    {
      keys: ['ArrowLeft'],
      shown: '←',
      does: 'one tick back; with Shift ten',
      action: (event) => store.go(store.tick - by(event)),
    },
    { keys: ['PageDown'], shown: 'Page↓', does: 'a hundred ticks on', action: () => store.go(store.tick + 100) },
    { keys: ['PageUp'], shown: 'Page↑', does: 'a hundred ticks back', action: () => store.go(store.tick - 100) },
    { keys: ['Home'], shown: 'Home', does: 'the first tick', action: () => store.go(report.data.begin) },
    { keys: ['End'], shown: 'End', does: 'the last tick', action: () => store.go(report.last) },
    { keys: [' '], shown: 'Space', does: 'play or pause', action: () => transport.toggle() },
    { keys: ['+', ']'], shown: '+', does: 'faster', action: () => transport.faster(1) },
    { keys: ['-', '['], shown: '-', does: 'slower', action: () => transport.faster(-1) },
    { keys: ['z'], shown: 'z', does: 'zoom to the ticks around the cursor', action: () => transport.zoom_to_cursor() },
    { keys: ['a'], shown: 'a', does: 'show all of the run', action: () => store.look_at_all() },
    { keys: ['g'], shown: 'g', does: 'the golden’s ghost on or off', action: ghost },
    { keys: ['/'], shown: '/', does: 'search channels to plot', action: () => channels.focus() },
    ...unexecuted,
    ...look,
  ];
}

/** The keys that lead from one place to another that never runs; none without a coverage. */
function unexecuted_keys(coverage: Coverage | null, open: () => void): Key[] {
  if (!coverage) return [];
  const go = (step: () => Promise<void>) => () => {
    open();
    void step();
  };
  return [
    { keys: ['u'], shown: 'u', does: 'the next lines that never run', action: go(() => coverage.next()) },
    { keys: ['U'], shown: 'U', does: 'the lines before that never run', action: go(() => coverage.previous()) },
  ];
}

function scene_tools(store: Store, report: Report, scene: Scene) {
  const toggle = (text: string, label: string, on: boolean, action: () => void) =>
    button(text, label, action, { 'aria-pressed': String(on) });
  const ghost = toggle('Ghost', 'The golden as a ghost (g)', true, () => set_ghost());
  const set_ghost = () => {
    store.set_ghost(!store.ghost);
    ghost.setAttribute('aria-pressed', String(store.ghost));
  };
  const follow = toggle('Follow', 'The camera goes along with the robot', true, () => {
    scene.follow = !scene.follow;
    follow.setAttribute('aria-pressed', String(scene.follow));
  });
  const look = button('Reset', 'Look at the whole robot again', () => (scene.look(), store.changed('ghost')));
  const tools = report.data.robots.length > 0 ? [report.compared && ghost, follow, look] : [];
  return { tools, set_ghost };
}

function robot_panel(scene: Scene, tools: Child[]) {
  return element(
    'section',
    { class: 'panel robot', 'aria-label': 'robot' },
    scene.root,
    element('header', {}, scene.note, element('div', { class: 'tools' }, ...tools)),
  );
}

function cameras_panel(cameras: Cameras) {
  return element(
    'section',
    { class: 'panel', 'aria-label': 'cameras' },
    element('header', {}, element('h2', {}, 'Cameras'), cameras.tools),
    cameras.root,
  );
}

function plots_panel(report: Report, channels: Channels, plots: Plots) {
  const legend =
    report.compared &&
    element(
      'p',
      { class: 'legend', 'aria-label': 'colours of the curves' },
      element('span', { class: 'golden' }, 'golden'),
      element('span', { class: 'actual' }, 'this run'),
      element('span', { class: 'band' }, 'tolerance'),
      element('span', { class: 'bad' }, 'beyond it'),
    );
  return element(
    'section',
    { class: 'panel', 'aria-label': 'channels' },
    element('header', {}, element('h2', {}, 'Channels'), channels.root, legend),
    plots.root,
  );
}

/** A column of one or two panels with a splitter between them; null without a panel. */
function panels_beside(
  name: string,
  upper: HTMLElement | false,
  lower: HTMLElement | false,
  label: string,
): HTMLElement | null {
  if (!upper && !lower) return null;
  const column = element('div', { class: `column ${name}${upper && lower ? ' two' : ''}` }, upper);
  if (upper && lower) column.append(splitter(column, { label, name: `${name}-rows`, upright: false }));
  if (lower) column.append(lower);
  return column;
}

function put_together(report: Report) {
  const store = new Store(report);
  const tour = new Tour(store, report);
  const transport = new Transport(store, report, tour),
    timeline = new Timeline(store, report);
  const scene = new Scene(store, report),
    cameras = new Cameras(store, report);
  const plots = new Plots(store, report),
    channels = new Channels(store, report),
    table = new Table(store, report);
  const { tools, set_ghost } = scene_tools(store, report, scene);
  const coverage = report.data.coverage ? new Coverage(store, report, report.data.coverage) : null;
  const unexecuted = unexecuted_keys(coverage, () => tabs.open('coverage'));
  const keys = keys_of(store, report, tour, transport, channels, () => dialog.showModal(), set_ghost, unexecuted);
  const dialog = help_dialog(keys);
  const count = report.data.divergences.length;
  const { expectations, events } = report.data;
  const tabs = new Tabs([
    report.has_numbers && { name: 'values', title: 'Values', content: table.root },
    expectations.length > 0 && {
      name: 'expectations',
      title: `Expectations (${expectations.length})`,
      content: new Expectations(store, report).root,
    },
    count > 0 && {
      name: 'divergences',
      title: `Divergences (${count})`,
      content: new Divergences(store, report, (index) => tour.go_to(report.data.divergences[index]!)).root,
    },
    events.length > 0 && {
      name: 'messages',
      title: `Messages (${report.data.messages?.all ?? events.length})`,
      content: new Messages(store, report).root,
    },
    report.data.call_stack && { name: 'source', title: 'Source', content: call_stack(report.data.call_stack) },
    report.data.control_times.length > 0 && {
      name: 'times',
      title: 'Times',
      content: control_times(store, report.data.control_times),
    },
    coverage && { name: 'coverage', title: coverage.title, content: coverage.root },
    report.data.runs.length > 0 && { name: 'provenance', title: 'Provenance', content: provenance(report) },
    report.data.runs.some((run) => run.scenario !== '') && {
      name: 'scenario',
      title: 'Scenario',
      content: scenario(report),
    },
  ]);
  const place = parse_address(location.hash);
  const top = element(
    'section',
    { class: 'top', 'aria-label': 'verdict and time line' },
    verdict(
      store,
      report,
      (before) => tour.opening(place.tick, before),
      () => dialog.showModal(),
    ),
    report.ticks > 0 && transport.root,
    report.ticks > 0 && timeline.root,
  );
  const left = panels_beside(
    'left',
    report.data.robots.length > 0 && robot_panel(scene, tools),
    report.data.cameras.length > 0 && cameras_panel(cameras),
    'between robot and cameras',
  );
  if (left && tour.is_about_pictures) left.classList.add('about_pictures');
  const right = panels_beside(
    'right',
    report.has_numbers && plots_panel(report, channels, plots),
    tabs.root,
    'between plots and tables',
  );
  const stack = report.data.call_stack;
  if (stack) {
    const open = () => {
      store.go(stack.tick);
      tabs.open('source');
      show_source_line();
    };
    transport.add(button('Source line', 'The controller’s source line of the first differing command', open));
  }
  const main = element('main', { class: left ? '' : 'wide' }, left);
  if (left) main.append(splitter(main, { label: 'between robot and plots', name: 'columns', upright: true }));
  main.append(right!);
  app.replaceChildren(top, main, dialog);
  document.title = `${report.data.title || 'Report'} – ${report.data.verdict.state} – Rehearse`;
  watch_theme(() => store.changed('theme'));
  store.show(place.series ?? tour.series_to_open_with());
  const start = tour.start ?? tour.first_complete_view;
  if (start !== null) store.go(start);
  go_to_place(store, place);
  keep_address(store);
  listen_to_keys(keys);
  const ready = open_page(store, scene, plots, cameras);
  window.rehearse = test_interface(store, ready, { scene, plots, cameras, table });
  return ready;
}

// Ready after the robot, the plots and the pictures on the screen are drawn.
async function open_page(store: Store, scene: Scene, plots: Plots, cameras: Cameras) {
  performance.mark('rehearse-begin');
  await Promise.all([scene.load(), plots.drawn()]);
  store.changed('data');
  await store.told();
  await cameras.drawn();
  performance.mark('rehearse-ready');
}

function say(sentence: string) {
  app.replaceChildren(element('p', { class: 'absence page' }, sentence));
}

async function begin() {
  const report = await Report.load();
  if (!report)
    return say('This page holds no data. Either it is the form that `rehearse report` fills, or the file was cut off.');
  await put_together(report);
}

begin().catch((error: unknown) => {
  if (app.childElementCount === 0)
    say(`This report can’t be shown: ${error instanceof Error ? error.message : String(error)}`);
  throw error;
});

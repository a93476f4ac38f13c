// The types of FORMAT.md.

/** JSON has no such numbers; they are texts there. */
export type JsonNumber = number | 'NaN' | 'Infinity' | '-Infinity';

export interface BlobReference {
  id: string;
  bytes: number;
  coding: 'deflate' | 'none';
  media_type?: string;
}

export type NumberType = 'f64' | 'f32' | 'i64' | 'u64' | 'u32' | 'u8';

export interface StoredArray extends BlobReference {
  type: NumberType;
  count: number;
  filter: 'none' | 'columns' | 'xor' | 'xor-base';
}

/** All of its elements are the same bits. */
export interface ConstantArray {
  type: NumberType;
  count: number;
  constant: JsonNumber | string;
}

export type NumberArray = StoredArray | ConstantArray;

export type VerdictState = 'coverage' | 'alone' | 'equal' | 'within' | 'bits' | 'beyond' | 'violated' | 'failed';

export interface Run {
  role: 'actual' | 'golden';
  file: string;
  ticks: number;
  complete: boolean;
  outcome: string;
  facts: Record<string, string>;
  scenario: string;
  remarks: string[];
}

export interface DivergenceEntry {
  tick: number;
  time: number;
  channel: string;
  element: string;
  series: string | null;
  expected: JsonNumber | null;
  actual: JsonNumber | null;
  difference: JsonNumber | null;
  tolerance: JsonNumber | null;
  ulps: JsonNumber | null;
  unit: string;
  note: string;
  stage: string;
  beyond: boolean;
}

export interface SampleEntry {
  tick: number;
  value: JsonNumber | null;
}

export interface ExpectationEntry {
  text: string;
  holds: boolean;
  sentence: string;
  line: number;
  closest?: string;
  subject: 'series' | 'event' | 'no_event' | 'expression';
  pattern: string;
  series: string | null;
  low: number | null;
  high: number | null;
  margin?: number | null;
  begin: number;
  end: number;
  sometime: boolean;
  first: SampleEntry | null;
  worst: SampleEntry | null;
}

export interface AxisEntry {
  begin?: number;
  count?: number;
  ticks?: NumberArray;
}

export type ValueKind = 'floating' | 'signed_integer' | 'unsigned_integer' | 'boolean' | 'contact';

export type Group = 'contact' | 'state' | 'sensor' | 'input' | 'output' | 'variable' | 'cost' | 'other';

export interface SeriesEntry {
  name: string;
  topic: string;
  unit: string;
  group: Group;
  kind: ValueKind;
  axis: number;
  golden_axis?: number;
  values: NumberArray | null;
  golden: NumberArray | 'same' | null;
  tolerance: JsonNumber | null;
  differing: number;
  beyond: number;
  range: [number, number] | null;
  wraps?: boolean;
}

export interface PictureEntry {
  tick: number;
  actual: BlobReference | null;
  golden: BlobReference | 'same' | null;
  differing: number | null;
}

export interface CameraEntry {
  name: string;
  topic: string;
  kind: 'color' | 'depth';
  width: number;
  height: number;
  near?: number;
  far?: number;
  pictures: PictureEntry[];
}

export interface EventEntry {
  run: number;
  tick: number;
  severity: 'note' | 'warning' | 'error';
  source: string;
  text: string;
}

/** All messages, if `events` are only some of them. */
export interface MessageBlobs {
  all: number;
  first: number; // index of the first of `events`
  blobs: (BlobReference & { messages: number })[];
}

/** A message in a blob: run, tick, severity, source, text. */
export type MessageRow = [number, number, string, string, string];

export interface ContactEntry {
  run: number;
  tick: number;
  a: string;
  b: string;
  begins: boolean;
}

/** x, y, z [m], then a quaternion x, y, z, w. */
export type PoseEntry = [number, number, number, number, number, number, number];

export interface ShapeEntry {
  pose: PoseEntry;
  color: [number, number, number, number];
  box?: [number, number, number];
  sphere?: number;
  cylinder?: { radius: number; length: number };
  mesh?: number;
  scale?: [number, number, number];
  checker?: { color: [number, number, number, number]; size: number }; // of a box: squares of a second colour
}

export interface LinkEntry {
  name: string;
  parent: number;
  joint: {
    type: 'revolute' | 'prismatic' | 'fixed';
    axis: [number, number, number];
    q: string | null;
    q0?: number;
  } | null;
  offset: PoseEntry;
  pose?: string[] | null; // of a root, or behind a floating joint
  fixed?: PoseEntry;
  shapes: ShapeEntry[];
}

export interface RobotEntry {
  name: string;
  links: LinkEntry[];
}

export interface MeshEntry {
  positions: NumberArray;
  indices: NumberArray;
  color?: NumberArray;
}

export interface FrameEntry {
  function: string;
  file: string;
  line: number;
  begin: number;
  source: string[];
}

/** The wall times of a controller's control() in the run, in seconds. */
export interface ControlTimesEntry {
  controller: string;
  period: number;
  calls: number;
  median: number;
  p999: number;
  longest: number;
  longest_tick: number;
  histogram: [number, number][]; // upper end of a bin, and its calls
}

/** The first execution of code; tick -1 and no time: before the run. */
export interface ExecutionEntry {
  recording: string;
  tick: number;
  time: number | null;
}

/** A way of a branch; known: false if it may have been taken after it was no longer watched. */
export interface WayEntry {
  first: ExecutionEntry | null;
  known: boolean;
}

export interface CoveredLineEntry {
  line: number;
  function: string;
  recordings: number;
  first: ExecutionEntry | null;
  ways: WayEntry[];
}

export interface CoveredFileEntry {
  file: string;
  lines: CoveredLineEntry[];
  source: string[] | null;
  unread: string;
}

/** The object of `rehearse audit --coverage --json`, with sources. */
export interface CoverageData {
  verdict: string;
  lines: number;
  lines_executed: number;
  recordings: string[];
  files: CoveredFileEntry[];
  failure: string | null;
  remarks: { severity: string; message: string }[];
}

/** Its blob. */
export interface CoverageEntry extends BlobReference {
  lines: number;
  lines_executed: number;
}

export interface ReportData {
  format: number;
  title: string;
  rehearse: string;
  verdict: {
    sentence: string;
    besides: string;
    state: VerdictState;
    notes: string[];
    levels?: Record<string, string>;
  };
  time_step: number;
  begin: number;
  end: number;
  runs: Run[];
  expectations: ExpectationEntry[];
  divergences: DivergenceEntry[];
  first: number | null;
  worst: string[]; // series
  call_stack: { controller: string; command: string; tick: number; frames: FrameEntry[] } | null;
  control_times: ControlTimesEntry[];
  coverage: CoverageEntry | null;
  spans: [number, number][];
  axes: AxisEntry[];
  series: SeriesEntry[];
  cameras: CameraEntry[];
  events: EventEntry[];
  messages?: MessageBlobs;
  contacts: ContactEntry[];
  robots: RobotEntry[];
  meshes: MeshEntry[];
  omitted: string[];
}

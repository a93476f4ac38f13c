// Reduces curves to the resolution of the screen: for each pixel the lowest and the highest of many values.
//
// All curves of a plot share their times. If there are more values than pixels, a pixel has two points: for each curve
// the two extremes in their order in time, so that no peak is lost. `undefined` means no point (the curve continues);
// `null` means a value that can't be drawn, NaN or infinite (the curve is interrupted).
import type { Columns, Values } from './report';
import type { View } from './store';

export type Points = (number | null | undefined)[];

export interface Curves {
  time: number[]; // [s]
  golden: Points;
  actual: Points;
  lower: Points; // golden - tolerance
  upper: Points;
  difference: Points;
  beyond: Points; // the part of the difference that is beyond tolerance
  bound: Points; // tolerance
  low: number; // of golden and actual in view
  high: number;
  largest: number; // |difference| in view, finite
  raw: boolean; // each value is a point
}

/** Indices [first, end) of the values in view and one more at either side, for the line that leaves it. */
function part_in_view(values: Values, view: View): [number, number] {
  const first = Math.max(0, values.axis.index_at(view.begin - 1e-9));
  const end = Math.min(values.axis.count, values.axis.index_at(view.end) + 2);
  return [first, Math.max(first, end)];
}

export function curves_in_view(columns: Columns, view: View, pixels: number, time: (tick: number) => number): Curves {
  const { actual, golden } = columns;
  const most = Math.max(
    ...[actual, golden].map((values) => (values ? part_in_view(values, view)[1] - part_in_view(values, view)[0] : 0)),
  );
  const curves =
    most <= 2 * pixels
      ? every_value(columns, view, time)
      : extremes(columns, view, Math.max(8, Math.round(pixels)), time);
  add_bounds(columns, curves);
  measure(curves);
  return curves;
}

function empty(raw: boolean): Curves {
  return {
    time: [],
    golden: [],
    actual: [],
    lower: [],
    upper: [],
    difference: [],
    beyond: [],
    bound: [],
    low: Infinity,
    high: -Infinity,
    largest: 0,
    raw,
  };
}

function drawable(value: number): number | null {
  return Number.isFinite(value) ? value : null;
}

function every_value(columns: Columns, view: View, time: (tick: number) => number): Curves {
  const curves = empty(true);
  const { actual, golden } = columns;
  const difference = columns.same ? null : columns.difference;
  let [a, a_end] = actual ? part_in_view(actual, view) : [0, 0];
  let [g, g_end] = golden ? part_in_view(golden, view) : [0, 0];
  while (a < a_end || g < g_end) {
    const a_tick = a < a_end ? actual!.axis.tick(a) : Infinity;
    const g_tick = g < g_end ? golden!.axis.tick(g) : Infinity;
    const tick = Math.min(a_tick, g_tick);
    curves.time.push(time(tick));
    curves.golden.push(g_tick === tick ? drawable(golden!.numbers[g]!) : undefined);
    curves.actual.push(a_tick === tick ? drawable(actual!.numbers[a]!) : undefined);
    curves.difference.push(a_tick !== tick || !golden ? undefined : difference ? drawable(difference[a]!) : 0);
    if (a_tick === tick) ++a;
    if (g_tick === tick) ++g;
  }
  return curves;
}

// Writes the lowest and highest value of [first, end) to a pair of points, in their order.
function push_extremes(points: Points, numbers: ArrayLike<number>, first: number, end: number) {
  let lowest = Infinity,
    highest = -Infinity,
    lowest_at = -1,
    highest_at = -1;
  let broken = false;
  for (let i = first; i < end; ++i) {
    const value = numbers[i]!;
    if (value - value !== 0) {
      broken = true;
      continue;
    }
    if (value < lowest) ((lowest = value), (lowest_at = i));
    if (value > highest) ((highest = value), (highest_at = i));
  }
  if (lowest_at < 0) {
    const nothing = broken ? null : undefined;
    points.push(nothing, nothing);
  } else if (lowest_at <= highest_at) {
    points.push(lowest, broken ? null : highest);
  } else {
    points.push(highest, broken ? null : lowest);
  }
}

function extremes(columns: Columns, view: View, pixels: number, time: (tick: number) => number): Curves {
  const curves = empty(false);
  const width = (view.end - view.begin) / pixels;
  const edge = (pixel: number) => view.begin + pixel * width;
  for (let pixel = 0; pixel < pixels; ++pixel) {
    curves.time.push(time(edge(pixel + 0.25)), time(edge(pixel + 0.75)));
  }
  const fill = (points: Points, values: Values | null, numbers: ArrayLike<number> | null) => {
    if (!values || !numbers) {
      for (let i = 0; i < 2 * pixels; ++i) points.push(undefined);
      return;
    }
    let first = values.axis.index_at(edge(0) - 1e-9) + 1;
    for (let pixel = 0; pixel < pixels; ++pixel) {
      const last =
        pixel + 1 === pixels ? values.axis.index_at(edge(pixels)) : values.axis.index_at(edge(pixel + 1) - 1e-9);
      push_extremes(points, numbers, first, last + 1);
      first = last + 1;
    }
  };
  fill(curves.actual, columns.actual, columns.actual?.numbers ?? null);
  if (columns.same) {
    curves.golden = curves.actual.slice();
    curves.difference = curves.actual.map((value) => (value === undefined ? undefined : 0));
  } else {
    fill(curves.golden, columns.golden, columns.golden?.numbers ?? null);
    fill(curves.difference, columns.actual, columns.difference);
  }
  return curves;
}

function add_bounds(columns: Columns, curves: Curves) {
  const { series } = columns;
  const bounded = series.entry.tolerance !== null && series.compared;
  for (let i = 0; i < curves.time.length; ++i) {
    const golden = curves.golden[i];
    const bound = bounded && typeof golden === 'number' ? series.tolerance : null;
    if (bound === null) {
      const nothing = golden === null ? null : undefined;
      curves.lower.push(nothing);
      curves.upper.push(nothing);
      curves.bound.push(undefined);
    } else {
      curves.lower.push((golden as number) - bound);
      curves.upper.push((golden as number) + bound);
      curves.bound.push(bound);
    }
    const difference = curves.difference[i];
    // without a tolerance every different bit is a difference
    const is_beyond =
      typeof difference === 'number' &&
      series.entry.beyond > 0 &&
      Math.abs(difference) > (bound ?? (bounded ? Infinity : 0));
    curves.beyond.push(is_beyond ? difference : null);
  }
}

function measure(curves: Curves) {
  for (const points of [curves.golden, curves.actual]) {
    for (const value of points) {
      if (typeof value !== 'number') continue;
      if (value < curves.low) curves.low = value;
      if (value > curves.high) curves.high = value;
    }
  }
  for (const value of curves.difference) {
    if (typeof value === 'number') curves.largest = Math.max(curves.largest, Math.abs(value));
  }
}

// Curves as an inline SVG, in the colours of the page.

const size = { width: 640, height: 280, left: 64, right: 16, top: 16, bottom: 40 };
const colours = ['var(--color-brand-primary)', '#d2691e', '#2e8b57', '#8a5cd6', '#b03060'];

/** About `count` round numbers from low to high. */
function ticksOf(low, high, count) {
  const rough = (high - low) / count;
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = power * [1, 2, 5, 10].find((factor) => factor * power >= rough);
  const ticks = [];
  for (let i = Math.ceil(low / step); i * step <= high + step * 1e-9; ++i) ticks.push(i * step);
  return ticks;
}

const short = (number) => String(Number(number.toPrecision(6)));

/**
 * `x` is {label, values, logarithmic}; `lines` are [{label, values, points}]: `points` draws that many dots instead of a line.
 * `logarithmic`: powers of ten on the axis; values of 0 are left out. `legend`: the upper corner for the labels.
 */
export function curves({ title, x, y, lines, logarithmic = false, legend = 'right' }) {
  const scale = logarithmic ? Math.log10 : (value) => value;
  const all = lines.flatMap(({ values }) => values.map(scale)).filter(Number.isFinite);
  let [low, high] = [Math.min(...all), Math.max(...all)];
  if (logarithmic) [low, high] = [Math.floor(low), Math.ceil(high)];
  const along = x.logarithmic ? Math.log10 : (value) => value;
  const [first, last] = [along(x.values[0]), along(x.values.at(-1))];
  const across = (value) => size.left + ((value - first) / (last - first)) * (size.width - size.left - size.right);
  const down = (value) => size.height - size.bottom - ((value - low) / (high - low || 1)) * (size.height - size.top - size.bottom);
  const text = (content, at, anchor, more = '') =>
    `<text x="${at[0].toFixed(1)}" y="${at[1].toFixed(1)}" text-anchor="${anchor}" ${more}>${content}</text>`;
  const parts = [];
  for (const tick of ticksOf(low, high, 5).filter((at) => !logarithmic || Number.isInteger(at))) {
    parts.push(`<path class="grid-line" d="M${size.left} ${down(tick).toFixed(1)}H${size.width - size.right}"/>`);
    parts.push(text(logarithmic ? `1e${short(tick)}` : short(tick), [size.left - 6, down(tick) + 4], 'end'));
  }
  for (const tick of ticksOf(first, last, x.logarithmic ? 2 : 6).filter((at) => !x.logarithmic || Number.isInteger(at)))
    parts.push(text(x.logarithmic ? `1e${short(tick)}` : short(tick), [across(tick), size.height - size.bottom + 16], 'middle'));
  parts.push(text(x.label, [(size.left + size.width) / 2, size.height - 6], 'middle'));
  parts.push(text(y, [14, size.height / 2 - 10], 'middle', `transform="rotate(-90 14 ${size.height / 2 - 10})"`));
  lines.forEach(({ label, values, points }, index) => {
    const colour = colours[index % colours.length];
    const places = values.map((value, i) => [across(along(x.values[i])), down(scale(value))]).filter((at) => at.every(Number.isFinite));
    const every = Math.max(1, Math.round(places.length / (points ?? 600)));
    const some = places.filter((_, i) => i % every === 0);
    if (points) parts.push(...some.map(([a, b]) => `<circle cx="${a.toFixed(1)}" cy="${b.toFixed(1)}" r="2.6" fill="${colour}"/>`));
    else parts.push(`<path d="M${some.map((at) => at.map((value) => value.toFixed(1)).join(' ')).join('L')}" fill="none" stroke="${colour}" stroke-width="2"/>`);
    const [corner, anchor] = legend === 'left' ? [size.left + 8, 'start'] : [size.width - size.right - 4, 'end'];
    parts.push(text(label, [corner, size.top + 14 + 18 * index], anchor, `style="fill:${colour}"`));
  });
  return `<svg class="figure" role="img" aria-label="${title}" viewBox="0 0 ${size.width} ${size.height}" width="${size.width}">${parts.join('')}</svg>`;
}

// Creates elements with one expression.

export type Child = Node | string | null | undefined | false;
type Properties = Record<string, string | number | boolean | EventListener | null | undefined>;

/** Properties that are functions are listeners (`onclick`); false, null and undefined leave an attribute out. */
export function element<K extends keyof HTMLElementTagNameMap>(
  tag: K,
  properties: Properties = {},
  ...children: Child[]
): HTMLElementTagNameMap[K] {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(properties)) {
    if (typeof value === 'function') made.addEventListener(name.slice(2), value);
    else if (value !== false && value !== null && value !== undefined)
      made.setAttribute(name, value === true ? '' : String(value));
  }
  made.append(
    ...children.filter((child): child is Node | string => child !== null && child !== undefined && child !== false),
  );
  return made;
}

/** Its name is its text; of a sign, which isn't read, it is the hint. The hint is also shown under the mouse. */
export function button(text: string, hint: string, onclick: () => void, properties: Properties = {}) {
  const name = /[a-z]/i.test(text) ? null : hint;
  return element('button', { type: 'button', title: hint, 'aria-label': name, onclick, ...properties }, text);
}

/** A sentence in the place of what isn't there. */
export function absence(sentence: string) {
  return element('p', { class: 'absence' }, sentence);
}

/** Sets a text only if it is another: the browser needn't lay it out again then. */
export function set_text(where: Element, text: string) {
  if (where.textContent !== text) where.textContent = text;
}

/** A series' name, of which the end is seen where there is no room for all of it: SR1/RLEG_KNEE/q ends as many do. */
export function set_name(where: Element, name: string) {
  if (where.textContent === name) return;
  const parts = name.split('/');
  const cut = name.length - parts.slice(-2).join('/').length;
  where.classList.add('series-name');
  where.replaceChildren(
    element('span', { class: 'path' }, name.slice(0, cut)),
    element('span', { class: 'leaf' }, name.slice(cut)),
  );
}

/** A canvas's pixels are made those of the screen; true if it has changed. */
export function fit_canvas(canvas: HTMLCanvasElement, width: number, height: number): boolean {
  const scale = window.devicePixelRatio || 1;
  const columns = Math.max(1, Math.round(width * scale)),
    rows = Math.max(1, Math.round(height * scale));
  if (canvas.width === columns && canvas.height === rows) return false;
  canvas.width = columns;
  canvas.height = rows;
  return true;
}

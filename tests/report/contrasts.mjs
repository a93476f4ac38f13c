// Evaluated in a page.

/** WCAG's contrast of each visible text below `root` with its background, of which layers may be translucent. */
export function contrasts(root = 'body') {
  const channel = (value) => (value <= 0.03928 ? value / 12.92 : ((value + 0.055) / 1.055) ** 2.4);
  const numbers = (color) => color.match(/[\d.]+/g).map(Number);
  const luminance = ([r, g, b]) => 0.2126 * channel(r / 255) + 0.7152 * channel(g / 255) + 0.0722 * channel(b / 255);
  const ground_of = (element) => {
    if (!element) return [255, 255, 255];
    const [r, g, b, alpha = 1] = numbers(getComputedStyle(element).backgroundColor);
    if (alpha > 0.99) return [r, g, b];
    const below = ground_of(element.parentElement);
    return [r, g, b].map((value, i) => alpha * value + (1 - alpha) * below[i]);
  };
  const found = [];
  for (const element of document
    .querySelector(root)
    .querySelectorAll('button, span, h1, h2, h3, p, th, td, label, output, select, input, code')) {
    const text = [...element.childNodes]
      .filter((node) => node.nodeType === 3)
      .map((node) => node.textContent.trim())
      .join('');
    if (!text || element.disabled || element.offsetParent === null) continue;
    const [a, b] = [luminance(numbers(getComputedStyle(element).color)), luminance(ground_of(element))];
    found.push({ text, contrast: (Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05) });
  }
  return found;
}

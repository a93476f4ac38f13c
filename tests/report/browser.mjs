// Opens reports in Chromium and records errors on the console and requests to the network, which are forbidden.
import { existsSync } from 'node:fs';
import { pathToFileURL } from 'node:url';

const places = ['/usr/bin/chromium', '/usr/bin/chromium-browser', '/usr/bin/google-chrome'];

/** The one that REHEARSE_CHROMIUM names, and no other then; null: there is none. */
export function chromium_path() {
  const named = process.env.REHEARSE_CHROMIUM;
  return (named ? [named] : places).find((place) => existsSync(place)) ?? null;
}

/** 3D is drawn by the processor, the same everywhere; letters without the screen's subpixels. */
export async function launch() {
  const { chromium } = await import('playwright-core');
  return chromium.launch({
    executablePath: chromium_path(),
    args: [
      '--enable-unsafe-swiftshader',
      '--font-render-hinting=none',
      '--disable-lcd-text',
      '--force-color-profile=srgb',
      ...(process.getuid() === 0 ? ['--no-sandbox'] : []),
    ],
  });
}

/** A page with what it complained of and asked for. `file` is opened from disk. */
export async function open_report(
  browser,
  file,
  {
    hash = '',
    width = 1280,
    height = 800,
    scale = 1,
    dark = false,
    ready = true,
    fonts = false,
    no_storage = false,
  } = {},
) {
  const context = await browser.newContext({
    viewport: { width, height },
    deviceScaleFactor: scale,
    colorScheme: dark ? 'dark' : 'light',
    reducedMotion: 'reduce',
  });
  const page = await context.newPage();
  const complaints = [],
    requests = [];
  page.on('console', (message) => {
    if (['error', 'warning'].includes(message.type()) && !is_about_the_machine(message.text()))
      complaints.push(message.text());
  });
  page.on('pageerror', (error) => complaints.push(String(error)));
  page.on('request', (request) => requests.push(request.url()));
  if (fonts) await use_our_fonts(page);
  if (no_storage) await page.addInitScript(refuse_storage);
  const begin = performance.now();
  await page.goto(pathToFileURL(file).href + hash, { waitUntil: 'commit' });
  if (ready) {
    await page.waitForFunction(() => window.rehearse !== undefined, undefined, { polling: 'raf' });
    await page.evaluate(() => window.rehearse.ready);
  }
  const open_seconds = (performance.now() - begin) / 1000;
  return { page, context, complaints, requests, open_seconds, close: () => context.close() };
}

// As browsers do for pages from files, by their settings.
function refuse_storage() {
  Object.defineProperty(window, 'localStorage', {
    get() {
      throw new DOMException('The operation is insecure.', 'SecurityError');
    },
  });
}

// Messages of the browser about software rendering don't concern the page.
function is_about_the_machine(text) {
  return /GPU stall|GL Driver Message|software WebGL/i.test(text);
}

/** The letters that Debian's fonts-dejavu-core has, whatever else is installed. */
async function use_our_fonts(page) {
  await page.addInitScript(() => {
    document.addEventListener('DOMContentLoaded', () => {
      document.documentElement.style.setProperty('--sans', '"DejaVu Sans"');
      document.documentElement.style.setProperty('--mono', '"DejaVu Sans Mono"');
    });
  });
}

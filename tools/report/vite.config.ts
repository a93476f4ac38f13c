// Builds one self-contained file: the page contains scripts and styles.
import { readFileSync } from 'node:fs';
import { deflateSync } from 'node:zlib';
import { defineConfig, type Plugin } from 'vite';

const marker = '<!-- REHEARSE DATA -->';

// Their licences ask for their notices to go along.
function notices(): string {
  const texts = ['three', 'uplot'].map(
    (name) => `${name}: ${readFileSync(`node_modules/${name}/LICENSE`, 'utf8').trim()}`,
  );
  return `<!--\nThis page contains libraries.\n\n${texts.join('\n\n')}\n-->`;
}

// A report of a second is smaller than the page's code, so the code is deflated in the page.
function packed(code: string): string {
  const text = deflateSync(`${code.trim()}\n//# sourceURL=rehearse_report.js`, { level: 9 }).toString('base64');
  return `<script type="text/plain" id="page_code">${text}</script>
<script>
async function start_page() {
  const text = atob(document.getElementById('page_code').textContent);
  const bytes = new Blob([Uint8Array.from(text, (c) => c.charCodeAt(0))]);
  const script = document.createElement('script');
  script.textContent = await new Response(bytes.stream().pipeThrough(new DecompressionStream('deflate'))).text();
  document.head.append(script);
}
start_page().catch((error) => {
  document.getElementById('app').textContent = 'This report can’t be shown: ' + error.message;
});
</script>`;
}

// Puts all loaded files into the page. The classic script comes before the data, so it starts before the browser has
// read them.
function inline(): Plugin {
  return {
    name: 'inline',
    enforce: 'post',
    generateBundle(_options, bundle) {
      const page = bundle['report.html'];
      if (page?.type !== 'asset') this.error('there is no report.html among what was built');
      let html = String(page.source);
      for (const [name, file] of Object.entries(bundle)) {
        if (file === page) continue;
        const reference = new RegExp(`\\s*<(script|link)\\b[^>]*["'][./]*${name}["'][^>]*>(</script>)?`);
        if (!reference.test(html)) this.error(`report.html doesn't load ${name}`);
        html = html.replace(reference, '');
        if (file.type === 'chunk') {
          html = html.replace(marker, () => `${packed(file.code)}\n${marker}`);
        } else {
          html = html.replace('</head>', () => `<style>${String(file.source).trim()}</style>\n</head>`);
        }
        delete bundle[name];
      }
      html = html.replace('</head>', () => `${notices()}\n</head>`);
      if (html.split(marker).length !== 2) this.error(`report.html has to contain ${marker} once`);
      page.source = html;
    },
  };
}

// `REPORT=some.html npm run dev` shows that report's data in the page at hand.
function data_of(report: string | undefined): Plugin {
  return {
    name: 'data',
    apply: 'serve',
    transformIndexHtml(html) {
      if (!report) return html;
      const text = readFileSync(report, 'utf8');
      return html.replace(marker, () => text.slice(text.indexOf('<script type="application/json"')));
    },
  };
}

export default defineConfig({
  base: './',
  plugins: [inline(), data_of(process.env.REPORT)],
  build: {
    target: 'es2022',
    modulePreload: false,
    cssCodeSplit: false,
    chunkSizeWarningLimit: 2000,
    rollupOptions: { input: 'report.html', output: { format: 'iife' } },
  },
  server: { open: '/report.html' },
});

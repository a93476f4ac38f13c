// Builds one file that needs nothing else: scripts and styles stand in the page.
import { readFileSync } from 'node:fs';
import { defineConfig, type Plugin } from 'vite';

const marker = '<!-- REHEARSE DATA -->';

// Their licences ask for their notices to go along.
function notices(): string {
  const texts = ['three', 'uplot'].map(
    (name) => `${name}: ${readFileSync(`node_modules/${name}/LICENSE`, 'utf8').trim()}`,
  );
  return `<!--\nThis page contains libraries.\n\n${texts.join('\n\n')}\n-->`;
}

// What the page loads is put into it. A classic script, in front of the data: it starts before the browser has read them.
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
          const code = file.code.replaceAll('</script', '<\\/script').replaceAll('<!--', '\\x3C!--').trim();
          html = html.replace(marker, () => `<script>${code}</script>\n${marker}`);
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

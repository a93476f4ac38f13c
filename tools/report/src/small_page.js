// The script of pages without a recording: theme, keys, filters of tables, the value under the pointer of a chart.
'use strict';
{
  const key = 'rehearse-report-theme'; // as theme.ts has it
  const root = document.documentElement;
  const stored = () => {
    try {
      return localStorage.getItem(key);
    } catch {
      return null; // pages from files may be refused it
    }
  };
  const theme = stored();
  if (theme === 'dark' || theme === 'light') root.dataset.theme = theme;

  const toggle_theme = () => {
    const dark = root.dataset.theme
      ? root.dataset.theme === 'dark'
      : matchMedia('(prefers-color-scheme: dark)').matches;
    root.dataset.theme = dark ? 'light' : 'dark';
    try {
      localStorage.setItem(key, root.dataset.theme);
    } catch {
      // it lasts as long as the page
    }
  };

  /** Shows the rows that contain the text and have the state; their count stands beside. */
  const filter = (panel) => {
    const text = panel.querySelector('input[type=search]').value.toLowerCase();
    const state = panel.querySelector('select').value;
    let shown = 0;
    const rows = [...panel.querySelectorAll('tbody tr')];
    for (const row of rows) {
      const fits = !state || (state === 'failed') === !row.classList.contains('passed');
      row.hidden = !fits || !row.textContent.toLowerCase().includes(text);
      if (!row.hidden) ++shown;
    }
    panel.querySelector('output').textContent = shown === rows.length ? '' : `${shown} of ${rows.length}`;
  };

  /** To the next finding, or the one before it. */
  const go = (step) => {
    const findings = [...document.querySelectorAll('[data-finding]')].filter((one) => one.offsetParent !== null);
    if (findings.length === 0) return;
    const now = findings.indexOf(document.activeElement);
    const at = now < 0 ? (step > 0 ? 0 : findings.length - 1) : (now + step + findings.length) % findings.length;
    findings[at].tabIndex = -1;
    findings[at].focus();
  };

  /** A chart tells the point under the pointer, or the one that arrow keys select. */
  const watch_chart = (area) => {
    const points = [...area.querySelectorAll('circle')];
    const told = area.parentElement.querySelector('output');
    const hand = area.querySelector('.hand');
    const show = (at) => {
      const place = Math.min(Math.max(at, 0), points.length - 1);
      const { text } = points[place].dataset;
      area.setAttribute('aria-valuenow', String(place + 1));
      area.setAttribute('aria-valuetext', text);
      told.textContent = text;
      hand.style.left = points[place].getAttribute('cx');
      hand.hidden = false;
    };
    area.addEventListener('pointermove', (event) => {
      const { left, width } = area.getBoundingClientRect();
      const share = (100 * (event.clientX - left)) / Math.max(1, width);
      const distances = points.map((point) => Math.abs(parseFloat(point.getAttribute('cx')) - share));
      show(distances.indexOf(Math.min(...distances)));
    });
    area.addEventListener('keydown', (event) => {
      const now = Number(area.getAttribute('aria-valuenow')) - 1;
      const to = { ArrowLeft: now - 1, ArrowRight: now + 1, Home: 0, End: points.length - 1 }[event.key];
      if (to === undefined) return;
      event.preventDefault();
      show(to);
    });
  };

  document.addEventListener('DOMContentLoaded', () => {
    const dialog = document.querySelector('dialog.help');
    const actions = {
      t: toggle_theme,
      '?': () => dialog.showModal(),
      n: () => go(1),
      p: () => go(-1),
      '/': () => document.querySelector('input[type=search]')?.focus(),
    };
    document.querySelector('#theme').addEventListener('click', toggle_theme);
    document.querySelector('#help').addEventListener('click', actions['?']);
    document.querySelector('#close').addEventListener('click', () => dialog.close());
    document.addEventListener('keydown', (event) => {
      const in_field = event.target.matches('input, select');
      if (event.key === 'Escape' && in_field) return event.target.blur();
      if (in_field || event.ctrlKey || event.metaKey || event.altKey || event.target.closest('dialog[open]')) return;
      const action = actions[event.key];
      if (!action) return;
      event.preventDefault();
      action();
    });
    for (const panel of document.querySelectorAll('.filtered')) {
      panel.querySelector('.tools').hidden = false;
      panel.querySelector('input').addEventListener('input', () => filter(panel));
      panel.querySelector('select').addEventListener('input', () => filter(panel));
    }
    for (const mark of document.querySelectorAll('.runs button'))
      mark.addEventListener('click', () => {
        mark.closest('td').querySelector('output').textContent = mark.title;
      });
    for (const area of document.querySelectorAll('.chart .area')) watch_chart(area);
  });
}

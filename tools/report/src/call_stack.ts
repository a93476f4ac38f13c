// The call stack of the controller whose command differs first, with the source lines around each frame.
import { element } from './dom';
import type { FrameEntry, ReportData } from './format';

function source(frame: FrameEntry): HTMLElement | null {
  if (frame.source.length === 0) return null;
  const width = String(frame.begin + frame.source.length).length;
  return element(
    'pre',
    { class: 'source' },
    ...frame.source.map((text, i) => {
      const line = frame.begin + i;
      return element(
        'span',
        { class: line === frame.line ? 'current' : '' },
        `${String(line).padStart(width)}  ${text}`,
      );
    }),
  );
}

/** Scrolls to the line at which the controller stands. */
export function show_source_line() {
  document.querySelector('.source .current')?.scrollIntoView({ block: 'center' });
}

export function call_stack({ controller, command, tick, frames }: NonNullable<ReportData['call_stack']>): HTMLElement {
  return element(
    'div',
    { class: 'call-stack', tabindex: '0', 'aria-label': 'call stack' },
    element('p', { class: 'note' }, `${controller} at tick ${tick}: ${command || 'a command'} differs first.`),
    ...frames.map((frame, i) =>
      element(
        'section',
        {},
        element(
          'h3',
          {},
          `#${i} ${frame.function}`,
          element('span', { class: 'note' }, frame.file ? ` ${frame.file}:${frame.line}` : ''),
        ),
        source(frame),
      ),
    ),
  );
}

// The keyboard: every frequent action has one key.
import { button, element } from './dom';

export interface Key {
  keys: string[]; // values of KeyboardEvent.key
  shown: string;
  does: string;
  action: (event: KeyboardEvent) => void;
}

export function help_dialog(keys: Key[]): HTMLDialogElement {
  const dialog: HTMLDialogElement = element(
    'dialog',
    { class: 'help', 'aria-labelledby': 'help-title' },
    element('h2', { id: 'help-title' }, 'Keys'),
    element(
      'table',
      {},
      element(
        'tbody',
        {},
        ...keys.map(({ shown, does }) =>
          element(
            'tr',
            {},
            element('th', { scope: 'row' }, ...shown.split(' ').map((key) => element('kbd', {}, key))),
            element('td', {}, does),
          ),
        ),
      ),
    ),
    element('h2', {}, 'Mouse'),
    element(
      'p',
      {},
      'Time line: drag along the ruler to move the cursor, below it to zoom; the wheel zooms, with Shift it moves. Plots: click to go to a tick, drag to zoom, Ctrl and the wheel zoom, a double click shows the whole run.',
    ),
    element(
      'p',
      {},
      'The address of this page follows the cursor and the plots: copy it to show somebody this moment.',
    ),
    button('Close', 'Close', () => dialog.close(), { class: 'primary' }),
  );
  return dialog;
}

const fields = 'input, select, textarea';
// elements that use arrow keys and space themselves
const own_keys: Record<string, string[]> = {
  BUTTON: [' ', 'Enter'],
  SELECT: ['ArrowLeft', 'ArrowRight', 'ArrowUp', 'ArrowDown', ' ', 'Home', 'End'],
};

function is_taken(event: KeyboardEvent): boolean {
  const target = event.target as HTMLElement;
  if (event.ctrlKey || event.metaKey || event.altKey) return true;
  if (target.closest('dialog[open]')) return true;
  if (target.matches(fields) && target.tagName !== 'SELECT' && event.key !== 'Escape') return true;
  return own_keys[target.tagName]?.includes(event.key) ?? false;
}

export function listen_to_keys(keys: Key[]) {
  // after a click on a button, Space must play and not press the button again
  document.addEventListener('click', (event) => {
    const button = (event.target as HTMLElement).closest<HTMLElement>('button');
    if (event.detail > 0 && button && !button.closest('dialog')) button.blur();
  });
  document.addEventListener('keydown', (event) => {
    if (event.key === 'Escape' && (event.target as HTMLElement).matches(fields)) {
      (event.target as HTMLElement).blur();
      return;
    }
    if (is_taken(event)) return;
    const key = keys.find((one) => one.keys.includes(event.key));
    if (!key) return;
    event.preventDefault();
    key.action(event);
  });
}

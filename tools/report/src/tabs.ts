// The lower part of the page: one of several panels at a time.
import { element } from './dom';

export interface Tab {
  name: string;
  title: string;
  content: HTMLElement;
}

export class Tabs {
  readonly root: HTMLElement;
  private readonly buttons: HTMLButtonElement[];
  private readonly panels: HTMLElement[];
  private readonly tabs: Tab[];

  constructor(given: (Tab | false | null)[]) {
    const tabs = given.filter((tab): tab is Tab => Boolean(tab));
    this.tabs = tabs;
    this.buttons = tabs.map((tab, i) =>
      element(
        'button',
        {
          type: 'button',
          role: 'tab',
          id: `tab-${tab.name}`,
          'aria-controls': `panel-${tab.name}`,
          onclick: () => this.select(i),
        },
        tab.title,
      ),
    );
    this.panels = tabs.map((tab) =>
      element('div', { role: 'tabpanel', id: `panel-${tab.name}`, 'aria-labelledby': `tab-${tab.name}` }, tab.content),
    );
    const list = element('div', { role: 'tablist', 'aria-label': 'what is shown below' }, ...this.buttons);
    list.addEventListener('keydown', (event) => this.key(event));
    this.root = element('section', { class: 'lower' }, list, ...this.panels);
    this.select(0);
  }

  select(index: number) {
    this.buttons.forEach((button, i) => {
      button.setAttribute('aria-selected', String(i === index));
      button.tabIndex = i === index ? 0 : -1;
      this.panels[i]!.hidden = i !== index;
    });
  }

  open(name: string) {
    this.select(
      Math.max(
        0,
        this.tabs.findIndex((tab) => tab.name === name),
      ),
    );
  }

  private key(event: KeyboardEvent) {
    const at = this.buttons.findIndex((button) => button.tabIndex === 0);
    const step = event.key === 'ArrowRight' ? 1 : event.key === 'ArrowLeft' ? -1 : 0;
    if (step === 0) return;
    event.preventDefault();
    event.stopPropagation();
    const next = (at + step + this.buttons.length) % this.buttons.length;
    this.select(next);
    this.buttons[next]!.focus();
  }
}

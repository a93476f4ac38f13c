// The moment and the plotted series in the page's address, so that a link opens the page at that moment:
// #tick=640&series=SR1/RLEG_KNEE/q,SR1/RLEG_KNEE/u&view=600..700
import type { Store } from './store';

export interface Place {
  tick: number | null;
  series: string[] | null;
  view: [number, number] | null;
}

export function parse_address(hash: string): Place {
  const place: Place = { tick: null, series: null, view: null };
  for (const part of hash.replace(/^#/, '').split('&')) {
    const [name, value = ''] = part.split(/=(.*)/s);
    if (name === 'tick' && /^\d+$/.test(value)) place.tick = Number(value);
    if (name === 'series') place.series = value.split(',').filter(Boolean).map(decoded);
    const view = name === 'view' ? /^(\d+)\.\.(\d+)$/.exec(value) : null;
    if (view) place.view = [Number(view[1]), Number(view[2])];
  }
  return place;
}

// Addresses that a person typed may contain unencoded characters.
function decoded(text: string): string {
  try {
    return decodeURIComponent(text);
  } catch {
    return text;
  }
}

function encoded(name: string): string {
  return encodeURIComponent(name)
    .replaceAll('%2F', '/')
    .replaceAll('%3A', ':')
    .replaceAll('%5B', '[')
    .replaceAll('%5D', ']');
}

export function address_of(store: Store): string {
  const { tick, shown, view, zoomed } = store;
  const parts = [`tick=${tick}`];
  if (shown.length > 0) parts.push(`series=${shown.map(encoded).join(',')}`);
  if (zoomed) parts.push(`view=${Math.round(view.begin)}..${Math.round(view.end)}`);
  return `#${parts.join('&')}`;
}

export function go_to_place(store: Store, place: Place) {
  if (place.series) store.show(place.series);
  if (place.view) store.look_at(...place.view);
  if (place.tick !== null) store.go(place.tick);
}

/** Keeps the address true, once the cursor rests: browsers refuse to have it changed too often. */
export function keep_address(store: Store) {
  let timer = 0;
  store.on(['tick', 'shown', 'view'], () => {
    window.clearTimeout(timer);
    if (store.playing) return;
    timer = window.setTimeout(() => {
      if (location.hash !== address_of(store)) history.replaceState(null, '', address_of(store));
    }, 250);
  });
  store.on(['playing'], () => {
    if (!store.playing) store.changed('tick');
  });
  window.addEventListener('hashchange', () => go_to_place(store, parse_address(location.hash)));
}

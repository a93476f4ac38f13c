// Settings that the browser keeps from page to page.

/** Null: there is none. A browser may refuse storage to a page from a file. */
export function stored_setting(key: string): string | null {
  try {
    return localStorage.getItem(key);
  } catch {
    return null;
  }
}

/** Null removes the setting. Without storage it is lost when the page is closed. */
export function store_setting(key: string, value: string | null) {
  try {
    if (value === null) localStorage.removeItem(key);
    else localStorage.setItem(key, value);
  } catch {
    // the page works without it
  }
}

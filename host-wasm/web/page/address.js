// The page's address: it stores the name of the scene, the changed values by key, and the display options.

/** The names of the display options. All other names are keys of the scene. */
const SHOWN = ["material", "detail", "strain", "compare", "text", "draw"];

/** Reads {scene, changes: {key: value}, shown: {name: text}} from the address. */
export function read() {
  const changes = {};
  const shown = {};
  let scene;
  for (const [name, text] of new URLSearchParams(location.hash.slice(1))) {
    if (name === "scene") scene = text;
    else if (SHOWN.includes(name)) shown[name] = text;
    else changes[name] = valued(text);
  }
  return { scene, changes, shown };
}

/** The value as `write` stored it, or the text itself if somebody typed a word. */
function valued(text) {
  try {
    return text === "none" ? undefined : JSON.parse(text);
  } catch {
    return text;
  }
}

/**
 * Stores the state. Another scene is an entry of the history of its own, so that the browser goes back to the one before; `stays`:
 * it takes the place of the present entry, whose scene was refused.
 */
export function write({ scene, changes, shown }, stays) {
  const parts = new URLSearchParams({ scene, ...shown });
  for (const [key, value] of Object.entries(changes)) parts.set(key, value === undefined ? "none" : JSON.stringify(value));
  const last = read();
  const isOther = !stays && last.scene !== undefined && (last.scene !== scene || last.shown.text !== shown.text);
  history[isOther ? "pushState" : "replaceState"](null, "", `#${parts}`);
}

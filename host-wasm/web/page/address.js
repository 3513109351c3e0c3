// What is in view as the page's address: the scene's name, other values at its keys, what is shown.

/** What is shown, in words; all other names are keys of the scene. */
const SHOWN = ["material", "detail", "strain", "compare", "text", "draw"];

/** {scene, changes: {key: value}, shown: {name: text}} of the address. */
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

/** As it was written, or a word that somebody typed. */
function valued(text) {
  try {
    return text === "none" ? undefined : JSON.parse(text);
  } catch {
    return text;
  }
}

export function write({ scene, changes, shown }) {
  const parts = new URLSearchParams({ scene, ...shown });
  for (const [key, value] of Object.entries(changes)) parts.set(key, value === undefined ? "none" : JSON.stringify(value));
  history.replaceState(null, "", `#${parts}`);
}

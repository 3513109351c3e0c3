// What is in view as the page's address: the scene's name, other values at its keys, what is shown.

/** {scene, changes: {key: value}, shown: {name: text}} of the address. */
export function read() {
  const changes = {};
  const shown = {};
  let scene;
  for (const [name, text] of new URLSearchParams(location.hash.slice(1))) {
    if (name === "scene") scene = text;
    else if (name.includes(".")) changes[name] = text === "none" ? undefined : JSON.parse(text);
    else shown[name] = text;
  }
  return { scene, changes, shown };
}

export function write({ scene, changes, shown }) {
  const parts = new URLSearchParams({ scene, ...shown });
  for (const [key, value] of Object.entries(changes)) parts.set(key, value === undefined ? "none" : JSON.stringify(value));
  history.replaceState(null, "", `#${parts}`);
}

// Scenes as objects: reads them from TOML and changes values at keys.

import { parse } from "smol-toml";

/** Parses the TOML text of a scene. A syntax error names line and column. */
export function read(text) {
  return parse(text);
}

/** Parses a value as the command line does: TOML, or a bare word. */
export function value(text) {
  try {
    return parse(`value = ${text}`).value;
  } catch {
    return text;
  }
}

/** Parts of a key that are refused: the empty one, and names that would change more than the scene. */
const FORBIDDEN = ["", "__proto__", "constructor", "prototype"];

/** A copy of the scene with new values at keys such as "integrator.step". `undefined` removes a key. */
export function changed(scene, changes) {
  const copy = structuredClone(scene);
  for (const [key, value] of Object.entries(changes)) {
    const path = key.split(".");
    if (path.some((part) => FORBIDDEN.includes(part))) throw new Error(`"${key}" is no key; write one such as integrator.step`);
    put(copy, path, value, key);
  }
  return copy;
}

/** The scene's wind section, with its velocity replaced, m/s. Without wind in the scene, with the coefficients of light cloth. */
export function windy(scene, velocity) {
  return { normal: 0.6, tangential: 0.03, ...scene.drag?.wind, velocity };
}

function put(owner, [first, ...rest], value, key) {
  if (Array.isArray(owner)) {
    if (owner.length === 0) throw new Error(`${key}: there is nothing that could have ${first}: the list is empty`);
    const index = /^\d+$/.test(first) ? Number(first) : undefined;
    // A key of a list, without an index, applies to each of its items.
    if (index === undefined) return owner.forEach((item) => put(item, [first, ...rest], value, key));
    if (index >= owner.length) throw new Error(`${key}: there is no number ${index}; the last is ${owner.length - 1}`);
    first = index;
  } else if (typeof owner !== "object") {
    throw new Error(`${key}: ${first} is inside a value that is no section`);
  }
  if (rest.length > 0) {
    if (owner[first] === undefined && value === undefined) return;
    put((owner[first] ??= {}), rest, value, key);
  } else if (value === undefined) {
    delete owner[first];
  } else {
    // Each item of a list gets a copy of its own.
    owner[first] = structuredClone(value);
  }
}

// Scenes by name, as text or as an object.

import { loaded } from "./module.js";
import { complete, type Given, plain, read, type Scene } from "./scene.js";

/** The names of the built-in scenes. Call it after `await load()`. */
export function scenes(): string[] {
  return loaded().wasm.sceneNames();
}

/** Parses a scene from TOML text, returns the built-in scene with that name, or copies an object. */
export function scene(given: string | Given<Scene>): Scene {
  if (typeof given !== "string" && (typeof given !== "object" || given === null)) {
    throw new TypeError(`a scene is a text, the name of a built-in one, or an object, not ${given}`);
  }
  if (typeof given !== "string") return complete(plain(given) as Scene);
  if (/[=[\n]/.test(given)) return read(given);
  const { wasm } = loaded();
  const text = wasm.sceneText(given.trim());
  if (text !== undefined) return read(text);
  throw new Error(`there is no scene ${given}; there are ${wasm.sceneNames().join(", ")}`);
}

/** The TOML text of a built-in scene. */
export function source(name: string): string | undefined {
  return loaded().wasm.sceneText(name);
}

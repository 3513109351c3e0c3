// The package with the module inside it: nothing has to be fetched, and bundlers need no word.

import { load as loadFrom } from "./module.js";
// The bundler makes bytes of it.
import bytes from "./muslin_wasm_bg.wasm";

export * from "./muslin.js";

/** Starts the module, once. */
export function load(): Promise<void> {
  return loadFrom(bytes);
}

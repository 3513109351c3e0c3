/// <reference lib="dom" preserve="true" />

// The WebAssembly module: it is loaded once, and its errors are explained.

import init, * as wasm from "./muslin_wasm.js";

let memory: WebAssembly.Memory | undefined;
let loading: Promise<void> | undefined;

/** Address or bytes of the module. */
export type Source = string | URL | Request | Response | BufferSource | WebAssembly.Module;

/**
 * Loads the module, once. If the module does not lie beside this file, give its address (bundlers) or its bytes
 * (Node.js). `muslin/inline` needs neither.
 */
export function load(source?: Source): Promise<void> {
  loading ??= init(source === undefined ? undefined : { module_or_path: source }).then(
    (exports) => {
      memory = exports.memory;
    },
    (error) => {
      // Another attempt may succeed.
      loading = undefined;
      if (source === undefined && "process" in globalThis && /fetch/.test(error.message)) {
        throw new Error(`${error.message}: in Node.js, give load() the bytes of the module, or import muslin/inline`, { cause: error });
      }
      if (!/magic word|MIME/.test(error.message)) throw error;
      throw new Error(`the address of the module leads to another file: ${error.message}`, { cause: error });
    },
  );
  return loading;
}

/** @internal The functions of the loaded module, and its memory. */
export function loaded() {
  if (memory === undefined) throw new Error("await load() first");
  return { wasm, memory };
}

/** @internal Whether the module failed, after which the cloth of the call is lost. */
export const isTrap = (error: unknown): error is WebAssembly.RuntimeError => error instanceof WebAssembly.RuntimeError;

/** @internal The error with an explanation, if it is a trap in the module. */
export function explained(error: unknown) {
  if (!isTrap(error)) return error;
  const text = `the module failed (${error.message}): it ran out of memory, or it has a bug; make a new Cloth, with fewer cells`;
  return new Error(text, { cause: error });
}

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
      throw error;
    },
  );
  return loading;
}

/** @internal The functions of the loaded module, and its memory. */
export function loaded() {
  if (memory === undefined) throw new Error("await load() first");
  return { wasm, memory };
}

/** @internal Calls into the module. A trap inside it becomes an `Error` that explains it. */
export function guarded<T>(call: () => T): T {
  try {
    return call();
  } catch (error) {
    throw explained(error);
  }
}

/** @internal The error with an explanation, if it is a trap in the module. */
export function explained(error: unknown) {
  if (!(error instanceof WebAssembly.RuntimeError)) return error;
  const text = `muslin broke off inside (${error.message}): no memory was left, or it made a mistake; make a new Cloth, of fewer cells`;
  return new Error(text, { cause: error });
}

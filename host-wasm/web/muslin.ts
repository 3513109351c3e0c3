// Muslin for pages and Node.js. All units are SI: metres, kilograms, seconds, newtons, joules.

import * as wasm from "./muslin_wasm.js";

export { scene, scenes, source } from "./built_in.js";
export { Cloth, type Options } from "./cloth.js";
export { load, type Source } from "./module.js";
export type * from "./results.js";
export { type Changes, changed, type Scene, value, windy } from "./scene.js";

/** @internal The number of allocations, if the module was built to count them. */
export const { allocations } = wasm as { allocations?: () => number };

// Muslin for pages and Node.js. All units are SI: metres, kilograms, seconds, newtons, joules.

import * as wasm from "./muslin_wasm.js";

export { scene, scenes, source } from "./built_in.js";
export type { Coordinates } from "./checks.js";
export { Cloth, type Options } from "./cloth.js";
export type { Meshes } from "./meshes.js";
export { load, type Source } from "./module.js";
export type * from "./results.js";
export type * from "./scene.js";
export { changed, value, windy } from "./scene.js";

/** @internal The number of allocations, if the module was built to count them. */
export const { allocations } = wasm as { allocations?: () => number };

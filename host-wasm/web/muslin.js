// Muslin for pages: scenes in, columns of numbers out. All units are SI; types are in muslin.d.ts.

import init, * as wasm from "./muslin_wasm.js";
import { changed, read, value, windy } from "./scene.js";

const { Simulation, sceneNames, sceneText } = wasm;

/** The number of allocations, if the module was built to count them. */
export const { allocations } = wasm;

let memory;
let loading;

/** Fetches and starts the module, once. */
export function load(source) {
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

const ready = () => {
  if (memory === undefined) throw new Error("await load() first");
};

export function scenes() {
  ready();
  return sceneNames();
}

/** Parses a scene from TOML text, returns the built-in scene with that name, or copies an object. */
export function scene(given) {
  ready();
  if (typeof given !== "string") return structuredClone(given);
  const text = sceneText(given.trim());
  if (text === undefined && !/[=[\n]/.test(given)) {
    throw new Error(`there is no scene ${given}; there are ${sceneNames().join(", ")}`);
  }
  return read(text ?? given);
}

/** The TOML text of a built-in scene, or undefined. */
export function source(name) {
  ready();
  return sceneText(name);
}

export { changed, value, windy };

const ENERGIES = ["kinetic", "stretch", "shear", "bend", "seam", "gravity"];
const COUNTS = ["candidates", "proximity", "impacts", "zones", "rejected", "forceEvaluations", "cgIterations"];
const PARTS = ["predict", "broadPhase", "narrowPhase", "response"];
const SHAPES = ["plane", "sphere", "capsule", "box", "mesh"];

const named = (names, numbers, from = 0) => Object.fromEntries(names.map((name, k) => [name, numbers[from + k]]));

/** Calls into the module. A trap inside it becomes an `Error` that explains it. */
function guarded(work) {
  try {
    return work();
  } catch (error) {
    throw told(error);
  }
}

function told(error) {
  if (!(error instanceof WebAssembly.RuntimeError)) return error;
  const text = `muslin broke off inside (${error.message}): no memory was left, or it made a mistake; make a new Cloth, of fewer cells`;
  return new Error(text, { cause: error });
}

/** A cloth in motion. */
export class Cloth {
  #own;
  #scene;
  // Views of columns by address. They are replaced when the memory of the module has moved.
  #views = new Map();
  #busy = false;

  constructor(given) {
    this.#scene = scene(given);
    this.#own = guarded(() => new Simulation(this.#scene));
  }

  /** The simulation in the module. Throws while it is busy, or after `free()`. */
  get #idle() {
    if (this.#busy) throw new Error("a step is under way; await awaitStep() first");
    if (!this.#own) throw new Error("this cloth was given back by free()");
    return this.#own;
  }

  #view(kind, address, length) {
    const known = this.#views.get(address);
    if (known?.buffer === memory.buffer && known.length === length && known instanceof kind) return known;
    if (known?.buffer !== memory.buffer) this.#views.clear();
    const view = new kind(memory.buffer, address, length);
    this.#views.set(address, view);
    return view;
  }

  step(count = 1) {
    const own = this.#idle;
    guarded(() => {
      for (let k = 0; k < count; k++) own.step();
    });
  }

  async awaitStep(count = 1) {
    const own = this.#idle;
    this.#busy = true;
    try {
      for (let k = 0; k < count; k++) await own.awaitStep();
    } catch (error) {
      throw told(error);
    } finally {
      this.#busy = false;
    }
  }

  async openDevice() {
    const own = this.#idle;
    if (!globalThis.navigator?.gpu) throw new Error("there is no WebGPU here");
    this.#busy = true;
    try {
      // Browsers may hide the name.
      return (await own.openDevice()) || "a GPU without a name";
    } catch (error) {
      throw told(error);
    } finally {
      this.#busy = false;
    }
  }

  /** Whether a step, or the opening of a device, is under way. All other calls throw until it ends. */
  get busy() {
    return this.#busy;
  }

  get hasDevice() {
    return this.#idle.hasDevice;
  }

  takeNote() {
    return this.#idle.takeNote();
  }

  positions() {
    return this.#view(Float32Array, this.#idle.positions(), 3 * this.#own.vertexCount);
  }

  velocities() {
    return this.#view(Float32Array, this.#idle.velocities(), 3 * this.#own.vertexCount);
  }

  normals() {
    return this.#view(Float32Array, this.#idle.normals(), 3 * this.#own.vertexCount);
  }

  strains() {
    return this.#view(Float32Array, this.#idle.strains(), this.#own.vertexCount);
  }

  triangles() {
    return this.#view(Uint32Array, this.#idle.triangles(), 3 * this.#own.triangleCount);
  }

  bodies() {
    const all = this.#idle.bodies();
    const bodies = [];
    for (let at = 0; at < all.length; ) {
      const [shape, radius, x, y, z, count] = all.subarray(at, at + 6);
      const points = all.subarray(at + 6, (at += 6 + 3 * count));
      bodies.push({ shape: SHAPES[shape], radius, normal: [x, y, z], points });
    }
    return bodies;
  }

  /** A copy of the current scene. */
  get scene() {
    return structuredClone(this.#scene);
  }

  warnings() {
    const all = this.#idle.warnings();
    const warnings = [];
    for (let at = 0; at < all.length; at += 4) {
      const [code, value, beside, doubtful] = all.slice(at);
      warnings.push({ code, value, beside, doubtful });
    }
    return warnings;
  }

  set(key, value) {
    const own = this.#idle;
    const next = changed(this.#scene, typeof key === "string" ? { [key]: value } : key);
    guarded(() => own.goOnAs(next));
    this.#scene = next;
  }

  wind(velocity) {
    this.set("drag.wind", windy(this.#scene, velocity));
  }

  moveTo(vertex, [x, y, z], seconds = 0) {
    const own = this.#idle;
    guarded(() => own.moveTo(vertex, x, y, z, seconds));
  }

  pin(vertex) {
    const place = this.positions().subarray(3 * vertex, 3 * vertex + 3);
    this.moveTo(vertex, place.length === 3 ? place : [0, 0, 0]);
  }

  release(vertex) {
    const own = this.#idle;
    return guarded(() => own.release(vertex));
  }

  pins() {
    return this.#idle.pins();
  }

  get vertexCount() {
    return this.#idle.vertexCount;
  }

  get steps() {
    return this.#idle.steps;
  }

  get time() {
    return this.#idle.time;
  }

  get stepLength() {
    return this.#idle.stepLength;
  }

  get stepError() {
    return this.#idle.stepError;
  }

  get frameRate() {
    return this.#idle.frameRate;
  }

  get duration() {
    return this.#idle.duration;
  }

  stateHash() {
    return this.#idle.stateHash();
  }

  takeTimes() {
    return named(PARTS, this.#idle.takeTimes());
  }

  summary() {
    const numbers = this.#idle.numbers();
    return {
      stretch: named(["max", "mean"], numbers),
      energy: named(ENERGIES, numbers, 2),
      ...named(COUNTS, numbers, 2 + ENERGIES.length),
    };
  }

  free() {
    this.#idle.free();
    this.#own = undefined;
  }
}

// Muslin for pages. All units are SI: metres, kilograms, seconds, newtons, joules.

/**
 * Loads the module, once. If the module does not lie beside this file, give its address (bundlers) or its bytes
 * (Node.js).
 */
export function load(source?: string | URL | Response | BufferSource | WebAssembly.Module): Promise<void>;

/** The names of the built-in scenes. Call it after `await load()`. */
export function scenes(): string[];

/** A scene: the keys of a scene file, of which `duration` and `cloth` are required. */
export type Scene = { [key: string]: unknown };

/** Parses a scene from TOML text, or returns the built-in scene with that name. */
export function scene(given: string | Scene): Scene;

/** The TOML text of a built-in scene. */
export function source(name: string): string | undefined;

/** New values for keys such as "integrator.step". If a part of the key is a list, such as `cloth`, every item is changed. `undefined` removes a key. */
export type Changes = { [key: string]: unknown };

/** A copy of the scene with changed values. */
export function changed(scene: Scene, changes: Changes): Scene;

/**
 * The scene's wind section, with its velocity replaced by this one, m/s. If the scene has no wind, the coefficients
 * are those of light cloth.
 */
export function windy(scene: Scene, velocity: [number, number, number]): { [key: string]: unknown };

/** Parses a value as the command line does: TOML, or a bare word. */
export function value(text: string): unknown;

/** Time of each stage, ms. */
export interface Times {
  predict: number;
  broadPhase: number;
  narrowPhase: number;
  response: number;
}

/** Diagnostics of the run so far. */
export interface Summary {
  /** Current length over rest length of all edges. */
  stretch: { max: number; mean: number };
  /** Current energies, J. */
  energy: { kinetic: number; stretch: number; shear: number; bend: number; seam: number; gravity: number };
  /** Candidates, total of all steps. */
  candidates: number;
  /** Contacts, total. */
  proximity: number;
  /** Impacts, total. */
  impacts: number;
  /** Impact zones, total. */
  zones: number;
  /** Steps that were repeated as two half steps. */
  rejected: number;
  /** Force evaluations, total. */
  forceEvaluations: number;
  /** Iterations of conjugate gradients, total. */
  cgIterations: number;
}

/** A warning, as `muslin run` gives it, of the run since the scene was last set. */
export interface Warning {
  /**
   * The subject, and the meaning of `value` and `beside`:
   * - `step`: the step of the scene, which does not divide a frame, and the one that is taken, s
   * - `duration`: the duration of the scene, which is no whole number of frames, and the one that is meant, s
   * - `thickness`: the thickness of contact, which does not suit the edges, and their mean length, m
   * - `rigidity`: the largest rigidity of hinges over the one asked for, and the largest that needs no warning
   * - `motion`: how far pins or colliders are, within a fixed step, from the straight and even way that it takes them,
   *   and the distance that needs no warning, m
   * - `error`: the largest error of error control, and the one that needs no warning for the smallest cloth, m
   * - `masses`: step x (step x stiffness + damping) over the mass of a vertex, and the largest value that single
   *   precision bears
   * - `unstable`: the step, and the longest stable step of the explicit method at the start, s
   * - `energy`: energy that appeared from nowhere, and the largest energy that moved, J
   * - `stretch`: the largest ratio of edge length to rest length in any frame, and the largest of cloth
   * - `unconverged`: solves that ended above their tolerance, and steps
   * - `rounding`: the largest rounding of a position over the length of an edge, and the largest that does not show
   * - `overlap`: energy by moving overlapping surfaces apart, and the largest energy that moved, J
   * - `method`: energy that the method took, and the largest energy that moved, J
   * - `exceeding`: substeps with too large an error, and all substeps
   * - `newton`: limit of the iterations of Newton's method, which leaves contacts out; 1 needs no warning
   */
  code:
    | "step"
    | "duration"
    | "thickness"
    | "rigidity"
    | "motion"
    | "error"
    | "masses"
    | "unstable"
    | "energy"
    | "stretch"
    | "unconverged"
    | "rounding"
    | "overlap"
    | "method"
    | "exceeding"
    | "newton";
  /** The number that is too large or too small. */
  value: number;
  /** The number that it is compared with. */
  beside: number;
  /** Whether the result of the run is probably wrong. */
  doubtful: boolean;
}

/** A collider at the current time. */
export interface Body {
  shape: "plane" | "sphere" | "capsule" | "box" | "mesh";
  /** Radius around its points, m. */
  radius: number;
  /** Normal of a plane. */
  normal: [number, number, number];
  /** Coordinates x, y, z, m. Plane: a point; sphere: the centre; capsule: both ends; box: eight corners; mesh: all vertices. */
  points: Float32Array;
}

/**
 * A simulated cloth. If a call fails, it throws an `Error` with the reason. A step that fails leaves the cloth
 * unchanged.
 */
export class Cloth {
  /** From TOML text, the name of a built-in scene, or an object. Call it after `await load()`. */
  constructor(scene: string | Scene);

  /** Takes steps on this thread. */
  step(count?: number): void;
  /** Takes steps. If a device was opened, it finds the candidates. Call nothing else until the promise is settled. */
  awaitStep(count?: number): Promise<void>;
  /** Opens a WebGPU device for `awaitStep` and returns its name. */
  openDevice(): Promise<string>;
  /** Whether `awaitStep` has a device. */
  readonly hasDevice: boolean;
  /** Whether `awaitStep` is running. */
  readonly busy: boolean;
  /** Returns the latest message about the device, and clears the message. It says that the device was lost and opened
  again, or that it was given up. */
  takeNote(): string | undefined;

  // These are views of the module's memory, not copies. Get them again after each call that changes the cloth:
  // steps swap columns and may move memory.
  /** x, y, z of each vertex, m. */
  positions(): Float32Array;
  /** x, y, z of each vertex, m/s. */
  velocities(): Float32Array;
  /** Unit normal of each vertex. */
  normals(): Float32Array;
  /** For each vertex the largest strain of its edges, l / l0 - 1. */
  strains(): Float32Array;
  /** Three vertices per triangle. */
  triangles(): Uint32Array;
  /** The colliders, as copies. */
  bodies(): Body[];

  /**
   * The warnings up to now. Frames are observed, as by `muslin run`, and a change of the scene begins anew. The first call under
   * error control takes about as long as 200 solver iterations.
   */
  warnings(): Warning[];
  /** A copy of the current scene. */
  readonly scene: Scene;
  /**
   * Changes one or several keys of the scene: `set("integrator.step", 0.005)`. If the number of vertices stays the
   * same, the cloth keeps its state; otherwise it starts again.
   */
  set(key: string, value: unknown): void;
  set(changes: Changes): void;
  /** Sets a steady wind, m/s. */
  wind(velocity: [number, number, number]): void;

  /**
   * Moves a vertex at constant speed to `place` (m) within `seconds` of simulated time, or at once without `seconds`.
   * From then on it is fixed. Many scenes fail if a vertex moves by more than an edge at once.
   */
  moveTo(vertex: number, place: ArrayLike<number>, seconds?: number): void;
  /** Fixes a vertex at its place. */
  pin(vertex: number): void;
  /** Frees a vertex, also from a pin of the scene. Returns whether it was fixed. */
  release(vertex: number): boolean;
  /** The fixed vertices. */
  pins(): Uint32Array;

  readonly vertexCount: number;
  /** Steps taken. If the step length changes, this number becomes the simulated time divided by the new length. */
  readonly steps: number;
  /** Simulated time, s. */
  readonly time: number;
  /** The step in use, s: the longest step that divides a frame evenly and is at most 0.1 % longer than the scene's. */
  readonly stepLength: number;
  /** The largest error of a step, m: where the estimate exceeds it, the step is divided. `undefined`: steps are not divided. */
  readonly stepError: number | undefined;
  /** Frames per simulated second. */
  readonly frameRate: number;
  /** Duration of the scene, s. */
  readonly duration: number;

  /** The hash chain over the states of all steps, as `muslin run` prints it. */
  stateHash(): string;
  /** Time of each stage since the last call, ms. */
  takeTimes(): Times;
  /** Diagnostics of the state and of the work. */
  summary(): Summary;
  /** Frees the memory. Do not use the cloth afterwards. */
  free(): void;
}

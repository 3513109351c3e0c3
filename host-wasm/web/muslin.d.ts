// Muslin for pages. All units are SI: metres, kilograms, seconds, newtons, joules.

/**
 * Fetches and starts the module, once; `source` where it does not lie beside this file: its address (bundlers), or
 * its bytes (Node.js).
 */
export function load(source?: string | URL | Response | BufferSource | WebAssembly.Module): Promise<void>;

/** The names of the built-in scenes; after `await load()`. */
export function scenes(): string[];

/** A scene: the keys of a scene file, of which `duration` and `cloth` are needed. */
export type Scene = { [key: string]: unknown };

/** The scene of a text in TOML, or the built-in scene of that name. */
export function scene(given: string | Scene): Scene;

/** The text of a built-in scene, in TOML. */
export function source(name: string): string | undefined;

/** Other values at keys such as "integrator.step"; a key of a list is that of each item; undefined removes it. */
export type Changes = { [key: string]: unknown };

/** A copy of the scene with other values. */
export function changed(scene: Scene, changes: Changes): Scene;

/** The wind section of a scene with this velocity, m/s. */
export function windy(scene: Scene, velocity: [number, number, number]): { [key: string]: unknown };

/** A value as the command line takes it: TOML, or a bare word. */
export function value(text: string): unknown;

/** ms in the parts of steps. */
export interface Times {
  predict: number;
  broadPhase: number;
  narrowPhase: number;
  response: number;
}

/** What came of a run so far. */
export interface Summary {
  /** Length over rest length of all edges, now. */
  stretch: { max: number; mean: number };
  /** J, now. */
  energy: { kinetic: number; stretch: number; shear: number; bend: number; seam: number; gravity: number };
  /** Pairs of features looked at, all steps together. */
  candidates: number;
  /** Contacts of what is near. */
  proximity: number;
  /** Contacts of what would have met. */
  impacts: number;
  /** Zones of impacts solved together. */
  zones: number;
  /** Steps that were taken in halves. */
  rejected: number;
  /** Evaluations of all forces. */
  forceEvaluations: number;
  /** Iterations of conjugate gradients. */
  cgIterations: number;
}

/** What the cloth touches besides itself, now. */
export interface Body {
  shape: "plane" | "sphere" | "capsule" | "box" | "mesh";
  /** m around its points. */
  radius: number;
  /** Of a plane. */
  normal: [number, number, number];
  /** x, y, z of each, m: a point of the plane, the centre, the two ends, eight corners, the vertices. */
  points: Float32Array;
}

/**
 * A cloth in motion. What cannot be done throws an `Error` that says why; a step that cannot be taken leaves
 * the cloth as it was.
 */
export class Cloth {
  /** Of a scene's text in TOML, the name of a built-in scene, or an object; after `await load()`. */
  constructor(scene: string | Scene);

  /** Takes steps on this thread. */
  step(count?: number): void;
  /** Takes steps whose candidates a device finds, where one was opened; nothing else may be asked meanwhile. */
  awaitStep(count?: number): Promise<void>;
  /** Opens a WebGPU device for `awaitStep`; its name. */
  openDevice(): Promise<string>;
  /** Whether `awaitStep` has a device. */
  readonly hasDevice: boolean;
  /** Whether an awaited step is under way. */
  readonly busy: boolean;
  /** What the device said that it should not, once: it was lost and opened again, or given up. */
  takeNote(): string | undefined;

  // Views of the module's own columns, not copies: steps exchange them and move memory, so take them anew
  // after each call that changes the cloth.
  /** x, y, z of each vertex, m. */
  positions(): Float32Array;
  /** Of each vertex, m/s. */
  velocities(): Float32Array;
  /** Of each vertex, of length 1. */
  normals(): Float32Array;
  /** Of each vertex the greatest strain of its edges, l / l0 - 1. */
  strains(): Float32Array;
  /** Three vertices a triangle. */
  triangles(): Uint32Array;
  /** Copies. */
  bodies(): Body[];

  /** A copy of the scene as it is now. */
  readonly scene: Scene;
  /**
   * Another value at a key of the scene, or several: `set("integrator.step", 0.005)`. The cloth stays where it
   * is where it has as many vertices as before, and starts anew where it has not.
   */
  set(key: string, value: unknown): void;
  set(changes: Changes): void;
  /** A steady wind, m/s. */
  wind(velocity: [number, number, number]): void;

  /**
   * Leads a vertex to a place, m, evenly within so many simulated seconds, or at once; it is held from then on.
   * Farther than an edge at once is more than many scenes can stand.
   */
  lead(vertex: number, place: ArrayLike<number>, seconds?: number): void;
  /** Holds a vertex where it is. */
  pin(vertex: number): void;
  /** Lets go of a vertex, whatever held it; whether anything did. */
  release(vertex: number): boolean;
  /** The vertices that are held. */
  pins(): Uint32Array;

  readonly vertexCount: number;
  /** Steps taken; after another step length was set, how many of these the time is. */
  readonly steps: number;
  /** Simulated time, s. */
  readonly time: number;
  /** s; the longest not above the scene's that divides a picture's time. */
  readonly stepLength: number;
  /** Pictures of the scene per simulated second. */
  readonly frameRate: number;
  /** Simulated time that the scene is made for, s. */
  readonly duration: number;

  /** The chain over the states after all steps, as `muslin run` prints it. */
  stateHash(): string;
  /** ms in the parts of the steps since this was last asked. */
  takeTimes(): Times;
  /** Numbers about the state and the work. */
  summary(): Summary;
  /** Gives the memory back; the cloth cannot be asked anything afterwards. */
  free(): void;
}

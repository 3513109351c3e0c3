/// <reference lib="esnext.disposable" preserve="true" />

// Results of the calls of a cloth. Units are SI.

import type { Call, Saved } from "./muslin_wasm.js";
import type { Scene } from "./scene.js";

/** A vector x, y, z. */
export type Vector = [number, number, number];

/** A rotation: the quaternion x, y, z, w. */
export type Quaternion = [number, number, number, number];

/** A triangle mesh. */
export interface Mesh {
  /** x, y, z of each vertex, m. */
  positions: ArrayLike<number>;
  /** Three vertices per triangle. */
  indices: ArrayLike<number>;
  /** Two texture coordinates per vertex; they may be absent. */
  uvs?: ArrayLike<number>;
}

/** A mesh for drawing with a texture. Where the texture has a seam, a vertex of the cloth appears more than once. */
export interface Surface {
  /** For each vertex the vertex of the cloth, whose position and normal it has. */
  vertices: Uint32Array;
  /** Two texture coordinates per vertex, as the mesh has them: those of grids, tubes and discs are in metres. */
  uvs: Float32Array;
  /** Three vertices per triangle, in the order of `Cloth.triangles()`. */
  triangles: Uint32Array;
}

/** Place and orientation of a collider. */
export interface Pose {
  /** Its centre, m. */
  position: Vector;
  /** The rotation from its orientation in the scene. */
  rotation: Quaternion;
}

/** The impulse of the cloth on a collider. */
export interface Impulse {
  /** Impulse, N s. */
  linear: Vector;
  /** Its moment about the centre of the collider, N m s; of one that deforms, about the origin of the world. */
  angular: Vector;
}

/** A surface in a contact: a cloth or a collider of the scene, by its number. */
export interface Side {
  kind: "cloth" | "collider";
  index: number;
}

/** A contact that pushes. */
export interface Touch {
  /** The two surfaces. */
  sides: [Side, Side];
  /** Vertices of both features. Those of colliders come after those of the cloth. */
  vertices: [number, number, number, number];
  /** Their weights in the nearest points: positive on the first side, negative on the second. */
  weights: [number, number, number, number];
  /** The nearest point of a cloth, m. */
  position: Vector;
  /** Unit vector from the second side to the first. */
  normal: Vector;
  /** Force on the first side, with friction, N. */
  force: Vector;
}

/** A point of a cloth. */
export interface SurfacePoint {
  /** m */
  position: Vector;
  /** m/s */
  velocity: Vector;
  /** Unit normal of its triangle. */
  normal: Vector;
}

/** Where a ray hits the cloth. */
export interface Hit {
  triangle: number;
  /** Barycentric coordinates on it, for `Cloth.point`. */
  weights: Vector;
  /** Distance from the origin of the ray, m. */
  distance: number;
}

/** @internal A motion of a collider: the call, and its numbers for a time, s. */
export type Motion = readonly [Call, (seconds: number) => number[]];

/** A copy of the state of a cloth, by `Cloth.snapshot`. */
export class Snapshot {
  /** @internal */
  readonly scene: Scene;
  /** @internal */
  readonly time: number;
  /** @internal */
  readonly due: number;
  /** @internal */
  readonly arrivals: ReadonlyMap<number, Motion>;
  #saved: Saved | undefined;

  /** @internal */
  constructor(saved: Saved, scene: Scene, time: number, due: number, arrivals: ReadonlyMap<number, Motion>) {
    this.#saved = saved;
    this.scene = scene;
    this.time = time;
    this.due = due;
    this.arrivals = arrivals;
  }

  /** @internal The copy in the module. */
  get saved(): Saved {
    if (this.#saved) return this.#saved;
    throw new Error("this snapshot was given back by free()");
  }

  /** Frees its memory, which otherwise happens once nothing refers to it. A second call does nothing. */
  free(): void {
    this.#saved?.free();
    this.#saved = undefined;
  }

  [Symbol.dispose](): void {
    this.free();
  }
}

/** The result of `Cloth.advance`. */
export interface Advanced {
  /** Steps taken. */
  steps: number;
  /** Time that was dropped because the budget was used up, s. */
  dropped: number;
}

/** The argument of `Cloth.onDiverge`. */
export interface Divergence {
  /** What happened. */
  message: string;
  /** The simulated time at which it happened, s. */
  time: number;
  /** The time to which the cloth went back, s. All calls since then are undone. */
  back: number;
}

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
  normal: Vector;
  /** Coordinates x, y, z, m. Plane: a point; sphere: the centre; capsule: both ends; box: eight corners; mesh: all vertices. */
  points: Float32Array;
}

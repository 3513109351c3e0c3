// A simulated cloth: steps, views of its columns, and the calls by which a program changes and reads it.

import { scene } from "./built_in.js";
import { amount, type Coordinates, coordinates, keys, list, shown, truth, whole } from "./checks.js";
import { type Meshes, named as namedMeshes } from "./meshes.js";
import { explained, isTrap, loaded } from "./module.js";
import { Call, type Simulation as Own, Simulation } from "./muslin_wasm.js";
import type {
  Advanced,
  Body,
  Divergence,
  Hit,
  Impulse,
  Motion,
  Pose,
  Quaternion,
  Side,
  Summary,
  Surface,
  SurfacePoint,
  Times,
  Touch,
  Vector,
  Warning,
} from "./results.js";
import { Snapshot } from "./results.js";
import {
  type Changes,
  changed,
  type Given,
  hasSameBodies,
  hasSameColliders,
  isAlike,
  type Key,
  type Scene,
  type Value,
  windy,
} from "./scene.js";

const ENERGIES = ["kinetic", "stretch", "shear", "bend", "seam", "gravity"];
const COUNTS = ["candidates", "proximity", "impacts", "zones", "rejected", "forceEvaluations", "cgIterations"];
const PARTS = ["predict", "broadPhase", "narrowPhase", "response"];
const SHAPES = ["plane", "sphere", "capsule", "box", "mesh"] as const;

/** Numbers of a contact in the list of the module. */
const TOUCH = 21;

/** The largest number of vertices without the option. */
const MOST_VERTICES = 100_000;

/** Ratio of the length of an edge to its rest length from which a run counts as diverged. */
const DIVERGED = 4;

/** Simulated time between copies of the state, to which a run that diverges goes back, s. */
const BETWEEN_COPIES = 0.5;

/** Time after which `advance` gives up a step, ms. One that is refused in the end can take a thousand times as long. */
const LONGEST_STEP = 2000;

const AT_REST: Quaternion = [0, 0, 0, 1];

const named = (names: string[], all: ArrayLike<number>, from = 0) => Object.fromEntries(names.map((name, k) => [name, all[from + k]]));

const vector = (all: Float64Array, at = 0) => [...all.subarray(at, at + 3)] as Vector;

function pose(position: Coordinates, rotation: Coordinates) {
  const quaternion = coordinates("the rotation", rotation, 4);
  if (quaternion.every((x) => x === 0)) throw new TypeError("the rotation must be a quaternion x, y, z, w, not zeros");
  return [...coordinates("the position", position), ...quaternion];
}

const side = (kind = 0, index = 0): Side => ({ kind: kind === 0 ? "cloth" : "collider", index });

type Column = Float32ArrayConstructor | Uint32ArrayConstructor;

/** Choices of a new cloth. */
export interface Options {
  /** The meshes that the scene names, by name: as `mesh` of a cloth or as `file` of a collider. */
  meshes?: Meshes;
  /**
   * The largest number of vertices of all cloths and meshes of colliders: a scene with more is refused before it takes memory.
   * Default: 100,000.
   */
  mostVertices?: number;
}

/**
 * A simulated cloth. If a call fails, it throws an `Error` with the reason and changes nothing. A step that fails leaves
 * the cloth unchanged.
 */
export class Cloth {
  #own: Own | undefined;
  #scene: Scene;
  #options: Options;
  // Views of columns by address. They are replaced when the memory of the module has moved.
  #views = new Map<number, Float32Array | Uint32Array>();
  #busy = false;
  /** Why the cloth cannot be used any more. */
  #failure: Error | undefined;
  /** Time that no step of `advance` has covered yet, s: at most half a step, more or less. */
  #due = 0;
  /** Motions of colliders that end with the next steps. */
  #arrivals = new Map<number, Motion>();
  /** The latest copy of a good state. */
  #good: Snapshot | undefined;
  #hasDiverged = false;

  /**
   * The event of a run that diverges: `advance` calls this function when a step fails, takes more than two seconds, or stretches
   * an edge to four times its length. The cloth is back at a good state then, at most half a second before; all calls since that
   * state are undone. `advance` stands still until `set`, `goBack`, `restart` or `resume`.
   */
  onDiverge?: (divergence: Divergence) => void;

  /** From TOML text, the name of a built-in scene, or an object. Call it after `await load()`. */
  constructor(given: string | Given<Scene>, options: Options = {}) {
    this.#scene = scene(given);
    this.#options = keys("the options", options, ["meshes", "mostVertices"]);
    this.#own = this.#build();
  }

  #build() {
    const { meshes, mostVertices = MOST_VERTICES } = this.#options;
    if (mostVertices !== Number.POSITIVE_INFINITY) whole("mostVertices", mostVertices);
    const given = namedMeshes(this.#scene, meshes, mostVertices);
    try {
      return new Simulation(this.#scene, given, mostVertices);
    } catch (error) {
      throw explained(error);
    }
  }

  /** The simulation in the module. Throws while it is busy, after `free()`, and once it has failed. */
  get #idle() {
    if (this.#failure) throw this.#failure;
    if (this.#busy) throw new Error("a step is under way; await awaitStep() first");
    if (!this.#own) throw new Error("this cloth was given back by free()");
    return this.#own;
  }

  /** Calls the module. If it fails inside, the cloth is lost. */
  #call<T>(make: (own: Own) => T): T {
    const own = this.#idle;
    try {
      return make(own);
    } catch (error) {
      throw this.#lost(error);
    }
  }

  #lost(error: unknown) {
    const why = explained(error);
    if (isTrap(error)) {
      this.#failure = why as Error;
      this.#own = undefined;
    }
    return why;
  }

  /** Makes a call of the live interface. */
  #live(call: Call, given: number[] = []): Float64Array {
    return this.#call((own) => own.call(call, Float64Array.from(given)));
  }

  #view<T extends Column>(kind: T, address: number, length: number) {
    const { memory } = loaded();
    const known = this.#views.get(address);
    if (known?.buffer === memory.buffer && known.length === length && known instanceof kind) return known as InstanceType<T>;
    if (known?.buffer !== memory.buffer) this.#views.clear();
    const view = new kind(memory.buffer, address, length);
    this.#views.set(address, view);
    return view as InstanceType<T>;
  }

  #vertex(vertex: number) {
    const count = this.#idle.vertexCount;
    if (Number.isInteger(vertex) && vertex >= 0 && vertex < count) return vertex;
    throw new TypeError(`there is no vertex ${shown(vertex)}; there are ${count}, from 0`);
  }

  /** Takes steps on this thread. */
  step(count = 1): void {
    whole("the number of steps", count);
    this.#arrive(count);
    this.#call((own) => {
      for (let k = 0; k < count; k++) own.step(Number.POSITIVE_INFINITY);
    });
  }

  /**
   * Takes the whole steps that come nearest to the time of all calls, `seconds` in this one: call it in every frame. After
   * `budget` ms it drops the rest of the time, so that a slow scene runs in slow motion: subtract `dropped` from the time of
   * what moves the colliders. If a step fails, it does not throw but calls `onDiverge`.
   */
  advance(seconds: number, options: { budget?: number } = {}): Advanced {
    const { budget = 12 } = keys("the options of advance", options, ["budget"]);
    amount("the time", seconds);
    if (budget !== Number.POSITIVE_INFINITY) amount("the budget", budget);
    const own = this.#idle;
    if (this.#hasDiverged) return { steps: 0, dropped: seconds };
    this.#keepGood();
    const began = performance.now();
    const length = own.stepLength;
    this.#due += seconds;
    // Half a step early or late, so that frames of uneven length take the same number of steps.
    const wanted = Math.min(Math.floor(this.#due / length + 0.5), 2 ** 31);
    this.#due = Math.min(this.#due - wanted * length, length);
    this.#arrive(wanted);
    let steps = 0;
    let trouble: string | undefined;
    while (steps < wanted && trouble === undefined && (steps === 0 || performance.now() - began < budget)) {
      trouble = this.#step();
      if (trouble === undefined) steps += 1;
    }
    if (trouble !== undefined) this.#diverge(trouble);
    return { steps, dropped: (wanted - steps) * length };
  }

  /** Takes a step and returns why it is not good. */
  #step(): string | undefined {
    try {
      this.#call((own) => own.step(LONGEST_STEP));
    } catch (error) {
      // The module's failure loses the cloth.
      if (this.#failure) throw error;
      return error instanceof Error ? error.message : String(error);
    }
    const stretch = this.#idle.stretch();
    return stretch < DIVERGED ? undefined : `diverged: an edge is stretched to ${stretch.toPrecision(3)} times its length`;
  }

  /** Gives motions that end with the next steps the time of those steps. */
  #arrive(count: number) {
    if (count > 1) for (const [call, given] of this.#arrivals.values()) this.#live(call, given(count * this.stepLength));
    if (count > 0) this.#arrivals.clear();
  }

  /** Whether `advance` stands still because the run has diverged. */
  get hasDiverged(): boolean {
    return this.#hasDiverged;
  }

  /** Lets `advance` go on after a run that diverged, for example after a change of gravity or of a pin. */
  resume(): void {
    this.#hasDiverged = false;
  }

  /** Copies a good state from time to time. */
  #keepGood() {
    if (this.#good && this.time < this.#good.time + BETWEEN_COPIES) return;
    if (!(this.#idle.stretch() < DIVERGED)) return;
    this.#forgetGood();
    this.#good = this.snapshot();
  }

  #forgetGood() {
    this.#good?.free();
    this.#good = undefined;
  }

  #diverge(message: string) {
    const { time } = this;
    if (this.#good) this.#goBack(this.#good);
    this.#hasDiverged = true;
    this.onDiverge?.({ message, time, back: this.time });
  }

  async #awaited<T>(make: (own: Own) => Promise<T>): Promise<T> {
    const own = this.#idle;
    this.#busy = true;
    try {
      return await make(own);
    } catch (error) {
      throw this.#lost(error);
    } finally {
      this.#busy = false;
    }
  }

  /** Takes steps. If a device was opened, it finds the candidates. Call nothing else until the promise is settled. */
  async awaitStep(count = 1): Promise<void> {
    whole("the number of steps", count);
    this.#arrive(count);
    await this.#awaited(async (own) => {
      for (let k = 0; k < count; k++) await own.awaitStep();
    });
  }

  /** Opens a WebGPU device for `awaitStep` and returns its name. */
  async openDevice(): Promise<string> {
    if (!("gpu" in (globalThis.navigator ?? {}))) throw new Error("there is no WebGPU here");
    // Browsers may hide the name.
    return (await this.#awaited((own) => own.openDevice())) || "a GPU without a name";
  }

  /** Whether a step, or the opening of a device, is under way. All other calls throw until it ends. */
  get busy(): boolean {
    return this.#busy;
  }

  /** Whether `awaitStep` has a device. */
  get hasDevice(): boolean {
    return this.#idle.hasDevice;
  }

  /** Returns the latest message about the device, and clears it: the device was lost and opened again, or given up. */
  takeNote(): string | undefined {
    return this.#idle.takeNote();
  }

  // Steps swap columns and may move memory, so views do not last.

  /** x, y, z of each vertex, m. A view: get it again after each call that changes the cloth. */
  positions(): Float32Array {
    const own = this.#idle;
    return this.#view(Float32Array, own.positions(), 3 * own.vertexCount);
  }

  /** x, y, z of each vertex, m/s. A view, as `positions`. */
  velocities(): Float32Array {
    const own = this.#idle;
    return this.#view(Float32Array, own.velocities(), 3 * own.vertexCount);
  }

  /** Unit normal of each vertex. A view, as `positions`. */
  normals(): Float32Array {
    const own = this.#idle;
    return this.#view(Float32Array, own.normals(), 3 * own.vertexCount);
  }

  /** For each vertex the strain of largest magnitude of its edges, l / l0 - 1. A view, as `positions`. */
  strains(): Float32Array {
    const own = this.#idle;
    return this.#view(Float32Array, own.strains(), own.vertexCount);
  }

  /** Three vertices per triangle. A view, as `positions`. */
  triangles(): Uint32Array {
    const own = this.#idle;
    return this.#view(Uint32Array, own.triangles(), 3 * own.triangleCount);
  }

  /** The mesh for drawing with a texture. */
  surface(): Surface {
    const { vertices, uvs, triangles } = this.#call((own) => own.surface());
    return { vertices, uvs, triangles };
  }

  /** The colliders, as copies. */
  bodies(): Body[] {
    const all = this.#idle.bodies();
    const bodies: Body[] = [];
    for (let at = 0; at < all.length; ) {
      const [shape = 0, radius = 0, x = 0, y = 0, z = 0, count = 0] = all.subarray(at, at + 6);
      const end = at + 6 + 3 * count;
      bodies.push({ shape: SHAPES[shape] ?? "mesh", radius, normal: [x, y, z], points: all.subarray(at + 6, end) });
      at = end;
    }
    return bodies;
  }

  /** A copy of the current scene. */
  get scene(): Scene {
    return structuredClone(this.#scene);
  }

  /**
   * The warnings up to now. Frames are observed, as by `muslin run`, and a change of the scene begins anew. The first call under
   * error control takes about as long as 200 solver iterations.
   */
  warnings(): Warning[] {
    const all = this.#call((own) => own.warnings());
    return Array.from({ length: all.length / 4 }, (_, k) => {
      const [code, value, beside, doubtful] = all.slice(4 * k);
      return { code, value, beside, doubtful };
    });
  }

  /**
   * Changes one or several keys of the scene: `set("integrator.step", 0.005)`. Materials, forces, thickness and friction
   * change in place; other keys build the scene anew, and the list of `touches` is empty until the next step. If the number of
   * vertices stays the same, the cloth keeps its state, pins and colliders; otherwise it starts again. Colliders change only
   * before the first step: then move them with `moveCollider` and switch them off with `switchCollider`.
   */
  set<K extends Key>(key: K, value: Value<K> | undefined): void;
  set(changes: Changes): void;
  set(key: unknown, value?: unknown): void {
    const isObject = typeof key === "object" && key !== null && !Array.isArray(key) && !(key instanceof Map);
    if (!isObject && typeof key !== "string") throw new TypeError(`the key must be a word such as "integrator.step", not ${shown(key)}`);
    const changes = isObject ? key : { [String(key)]: value };
    const next = changed(this.#scene, changes as Changes);
    this.#call((own) => {
      if (isAlike(this.#scene, next) && own.setMaterials(next)) return;
      this.#goOnAs(own, next);
    });
    this.#scene = next;
    this.#forgetGood();
    this.#hasDiverged = false;
  }

  #goOnAs(own: Own, next: Scene) {
    const keep = hasSameColliders(this.#scene, next);
    if (!keep && own.steps > 0) {
      throw new Error(
        "set does not change colliders in a run, because they would jump through the cloth: use moveCollider and switchCollider, or restart with another scene",
      );
    }
    own.goOnAs(next, keep);
  }

  /** Starts again, with another scene or the present one. The meshes stay the same. */
  restart(given?: string | Given<Scene>): void {
    if (!this.#failure) this.#idle;
    const before = this.#scene;
    const old = this.#own;
    try {
      if (given !== undefined) this.#scene = scene(given);
      this.#own = this.#build();
    } catch (error) {
      this.#scene = before;
      throw error;
    }
    this.#failure = undefined;
    this.#hasDiverged = false;
    this.#due = 0;
    this.#arrivals.clear();
    this.#forgetGood();
    old?.free();
  }

  /** Sets a steady wind, m/s. The first one of a scene without wind builds it anew; give the scene a wind of 0 to avoid that. */
  wind(velocity: Coordinates): void {
    const [x, y, z] = coordinates("the wind", velocity) as unknown as Vector;
    const wind = this.#scene.drag?.wind;
    if (!wind) {
      this.set("drag.wind", windy(this.#scene, [x, y, z]));
      return;
    }
    this.#live(Call.SetWind, [x, y, z]);
    wind.velocity = [x, y, z];
  }

  /** Sets a steady gravity, m/s^2. */
  gravity(acceleration: Coordinates): void {
    const [x, y, z] = coordinates("gravity", acceleration) as unknown as Vector;
    this.#live(Call.SetGravity, [x, y, z]);
    this.#scene.gravity = [x, y, z];
  }

  /**
   * Moves a vertex at constant speed to `place` (m) within `seconds` of simulated time, or at once without `seconds`.
   * From then on it is fixed. Many scenes fail if a vertex moves by more than an edge at once.
   */
  moveTo(vertex: number, place: Coordinates, seconds = 0): void {
    this.#vertex(vertex);
    this.#live(Call.MoveTo, [vertex, ...coordinates("the place", place), amount("the time", seconds)]);
  }

  /** Fixes a vertex at its place. */
  pin(vertex: number): void {
    const at = 3 * this.#vertex(vertex);
    this.moveTo(vertex, this.positions().slice(at, at + 3));
  }

  /** Pins a vertex to a collider where it is now: it moves with the collider. */
  attach(vertex: number, collider: number): void {
    this.#vertex(vertex);
    this.#live(Call.Attach, [vertex, whole("the collider", collider)]);
  }

  /** Frees a vertex, also from a pin of the scene. It keeps its velocity. Returns whether it was fixed. */
  release(vertex: number): boolean {
    this.#vertex(vertex);
    return this.#live(Call.Release, [vertex])[0] === 1;
  }

  /** The fixed vertices. */
  pins(): Uint32Array {
    return this.#idle.pins();
  }

  /**
   * Moves a collider evenly to a pose. Then it rests there. Without `seconds` of simulated time it arrives at the end of the
   * next `step`, `awaitStep` or `advance`, so call it before each of them. If `advance` drops time, it is still on its way then:
   * draw it at `colliderPose`. A call replaces the motion before, also that of the scene. Steps find everything in the way of the
   * collider.
   *
   * `position` is its centre: the middle of a sphere, a capsule or a box, the point of a plane, the zero of the coordinates of a
   * mesh. `rotation` counts from the orientation in the scene. If it is absent, the collider has that orientation.
   */
  moveCollider(collider: number, position: Coordinates, rotation: Coordinates = AT_REST, seconds?: number): void {
    whole("the collider", collider);
    const to = pose(position, rotation);
    this.#move(collider, seconds, [Call.MoveCollider, (seconds) => [collider, ...to, seconds]]);
  }

  /** Makes a motion of a collider, which may end with the next steps. */
  #move(collider: number, seconds: number | undefined, motion: Motion) {
    const [call, given] = motion;
    // At once, so that a motion that cannot be is refused here.
    this.#live(call, given(seconds === undefined ? this.stepLength : amount("the time", seconds)));
    if (seconds === undefined) this.#arrivals.set(collider, motion);
    else this.#arrivals.delete(collider);
  }

  /** The present pose of a collider. */
  colliderPose(collider: number): Pose {
    const all = this.#live(Call.ColliderPose, [whole("the collider", collider)]);
    return { position: vector(all), rotation: [...all.subarray(3)] as Quaternion };
  }

  /** Moves every vertex of a mesh evenly to a position (x, y, z of each, m), as `moveCollider` moves a rigid collider. */
  deformCollider(collider: number, positions: ArrayLike<number>, seconds?: number): void {
    whole("the collider", collider);
    const to = list("the positions", positions);
    this.#move(collider, seconds, [Call.DeformCollider, (seconds) => [collider, seconds, ...to]]);
  }

  /** Switches a collider off or on. Nothing touches one that is off. It is not switched on where cloth intersects it. */
  switchCollider(collider: number, isOn: boolean): void {
    whole("the collider", collider);
    this.#live(truth("isOn", isOn) ? Call.SwitchOn : Call.SwitchOff, [collider]);
  }

  /** Measures the impulses on colliders from now on. */
  measureImpulses(): void {
    this.#live(Call.MeasureImpulses);
  }

  /** The impulse that the cloth has given a collider since the last call. A rigid-body engine adds it to its body. */
  takeImpulse(collider: number): Impulse {
    const all = this.#live(Call.TakeImpulse, [whole("the collider", collider)]);
    return { linear: vector(all), angular: vector(all, 3) };
  }

  /** Gives a vertex an impulse, N s: its velocity changes at once. */
  push(vertex: number, impulse: Coordinates): void {
    this.#vertex(vertex);
    this.#live(Call.Push, [vertex, ...coordinates("the impulse", impulse)]);
  }

  /** Sets a force on a vertex, N, until it is set again. */
  setForce(vertex: number, force: Coordinates): void {
    this.#vertex(vertex);
    this.#live(Call.SetForce, [vertex, ...coordinates("the force", force)]);
  }

  /**
   * Moves all cloth, its pins and the named colliders: a rotation about the origin of the world, then a displacement, m.
   * Velocities turn with them, and the cloth feels nothing of it.
   */
  teleport(position: Coordinates, rotation: Coordinates = AT_REST, colliders: ArrayLike<number> = []): void {
    const those = Array.from(list("the colliders", colliders), (collider) => whole("a collider", collider));
    this.#live(Call.Teleport, [...pose(position, rotation), ...those]);
    this.#arrivals.clear();
    this.#forgetGood();
  }

  /** The contacts that push, in the last step, or in its last substep if it was divided. */
  touches(): Touch[] {
    const all = this.#live(Call.Touches);
    return Array.from({ length: all.length / TOUCH }, (_, k) => {
      const own = all.subarray(TOUCH * k, TOUCH * (k + 1));
      return {
        sides: [side(own[0], own[1]), side(own[2], own[3])],
        vertices: [...own.subarray(4, 8)] as Touch["vertices"],
        weights: [...own.subarray(8, 12)] as Touch["weights"],
        position: vector(own, 12),
        normal: vector(own, 15),
        force: vector(own, 18),
      };
    });
  }

  /** The point of a triangle with these barycentric coordinates, for example to hang a button on it. */
  point(triangle: number, weights: Coordinates): SurfacePoint {
    const all = this.#live(Call.Point, [whole("the triangle", triangle), ...coordinates("the weights", weights)]);
    return { position: vector(all), velocity: vector(all, 3), normal: vector(all, 6) };
  }

  /** Where a ray hits the cloth first, from either side. Colliders hide nothing. */
  hit(origin: Coordinates, direction: Coordinates): Hit | undefined {
    const all = this.#live(Call.Hit, [...coordinates("the origin", origin), ...coordinates("the direction", direction)]);
    if (all.length === 0) return undefined;
    return { triangle: all[0] as number, weights: vector(all, 1), distance: all[4] as number };
  }

  /** A copy of all that steps and this program change, for `goBack`. */
  snapshot(): Snapshot {
    return new Snapshot(
      this.#call((own) => own.snapshot()),
      this.scene,
      this.time,
      this.#due,
      new Map(this.#arrivals),
    );
  }

  /**
   * Goes back to a copy of this cloth, or of one of the same scene and meshes. The same steps and calls give the same bits. If
   * keys that need it have changed since, the scene is built anew.
   */
  goBack(snapshot: Snapshot): void {
    if (!(snapshot instanceof Snapshot)) throw new TypeError(`goBack needs a snapshot, not ${snapshot}`);
    this.#goBack(snapshot);
    this.#forgetGood();
    this.#hasDiverged = false;
  }

  #goBack({ saved, scene, due, arrivals }: Snapshot) {
    if (!hasSameBodies(this.#scene, scene)) {
      throw new Error("the snapshot is of another scene: its cloths or colliders have other meshes, places, pins or motions");
    }
    this.#call((own) => {
      const isOther = !isAlike(this.#scene, scene);
      const before = isOther ? own.snapshot() : undefined;
      try {
        if (isOther) own.goOnAs(scene, false);
        own.goBack(saved, scene);
      } catch (error) {
        if (before && !isTrap(error)) {
          own.goOnAs(this.#scene, false);
          own.goBack(before, this.#scene);
        }
        throw error;
      } finally {
        before?.free();
      }
    });
    this.#scene = structuredClone(scene);
    this.#arrivals = new Map(arrivals);
    this.#due = due;
  }

  get vertexCount(): number {
    return this.#idle.vertexCount;
  }

  /** Steps taken. If the step length changes, this number becomes the simulated time divided by the new length. */
  get steps(): number {
    return this.#idle.steps;
  }

  /** Simulated time, s. */
  get time(): number {
    return this.#idle.time;
  }

  /** The step in use, s: the longest step that divides a frame evenly and is at most 0.1 % longer than the scene's. */
  get stepLength(): number {
    return this.#idle.stepLength;
  }

  /** The largest error of a step, m: where the estimate exceeds it, the step is divided. `undefined`: steps are not divided. */
  get stepError(): number | undefined {
    return this.#idle.stepError;
  }

  /** Frames per simulated second. */
  get frameRate(): number {
    return this.#idle.frameRate;
  }

  /** Duration of the scene, s. */
  get duration(): number {
    return this.#idle.duration;
  }

  /** The hash chain over the states of all steps, as `muslin run` prints it. */
  stateHash(): string {
    return this.#idle.stateHash();
  }

  /** Time of each stage since the last call, ms. */
  takeTimes(): Times {
    return named(PARTS, this.#idle.takeTimes()) as unknown as Times;
  }

  /** Diagnostics of the state and of the work. */
  summary(): Summary {
    const all = this.#call((own) => own.numbers());
    return {
      stretch: named(["max", "mean"], all),
      energy: named(ENERGIES, all, 2),
      ...named(COUNTS, all, 2 + ENERGIES.length),
    } as unknown as Summary;
  }

  /** Frees the memory. The cloth cannot be used afterwards. A second call does nothing. */
  free(): void {
    if (this.#busy) throw new Error("a step is under way; await awaitStep() first");
    this.#forgetGood();
    this.#own?.free();
    this.#own = undefined;
  }

  /** `using cloth = new Cloth(..)` frees it at the end of its block. */
  [Symbol.dispose](): void {
    this.free();
  }
}

// Scenes as objects: reads them from TOML, changes values at keys, and compares them.

import { parse } from "smol-toml";
import type { ClothDesc as AnyCloth, ColliderDesc as AnyCollider, Scene as AnyScene, WindDesc } from "./scene_types.js";

export type * from "./scene_types.js";

type MeshKey = "grid" | "tube" | "disc" | "mesh";

type With<K extends MeshKey> = Omit<AnyCloth, MeshKey> & Required<Pick<AnyCloth, K>> & { [Other in Exclude<MeshKey, K>]?: undefined };

// Names for the messages of the compiler.
interface Grid extends With<"grid"> {}
interface Tube extends With<"tube"> {}
interface Disc extends With<"disc"> {}
interface Own extends With<"mesh"> {}

/** One sheet: its mesh, its placement and its material. It has exactly one of `grid`, `tube`, `disc` and `mesh`. */
export type ClothDesc = Grid | Tube | Disc | Own;

type Shaped<S extends AnyCollider["shape"], Needed extends keyof AnyCollider, Free extends keyof AnyCollider = never> = {
  shape: S;
} & Required<Pick<AnyCollider, Needed>> &
  Pick<AnyCollider, Free | "motion" | "friction">;

/** An object that the cloth collides with: its shape, and the keys that the shape needs. */
export type ColliderDesc =
  | Shaped<"plane", "point" | "normal">
  | Shaped<"sphere", "center" | "radius">
  | Shaped<"capsule", "a" | "b" | "radius">
  | Shaped<"box", "center" | "half", "rotation">
  | Shaped<"mesh", "file", "motion_rate">;

/** A whole scene. Steps go on after its duration, 1 s by default: the command line and the warning `motion` use it. */
export type Scene = Omit<AnyScene, "cloth" | "collider" | "duration"> & {
  cloth: ClothDesc[];
  collider?: ColliderDesc[];
  duration?: number;
};

/** A part of a scene as a program may give it: lists may be read-only, and vectors typed arrays. */
export type Given<T> = T extends string | number | boolean | undefined
  ? T
  : T extends [number, ...number[]]
    ? Readonly<T> | Float32Array | Float64Array
    : T extends readonly (infer Item)[]
      ? readonly Given<Item>[]
      : { readonly [K in keyof T]: Given<T[K]> };

type Index = `${number}`;

type KeysOf<T> = T extends string | number | boolean | undefined
  ? never
  : T extends readonly (infer Item)[]
    ? Index | KeysOf<Item> | `${Index}.${KeysOf<Item>}`
    : { [K in keyof T & string]: K | `${K}.${KeysOf<T[K]>}` }[keyof T & string];

/** A key of a scene, such as "integrator.step", "cloth.density" of all cloths, or "cloth.0.density" of the first one. */
export type Key = KeysOf<Scene>;

type ValueAt<T, K extends string> = T extends readonly (infer Item)[]
  ? K extends `${Index}.${infer Rest}`
    ? ValueAt<Item, Rest>
    : K extends Index
      ? Item
      : ValueAt<Item, K>
  : K extends keyof T
    ? T[K]
    : K extends `${infer First}.${infer Rest}`
      ? First extends keyof T
        ? ValueAt<NonNullable<T[First]>, Rest>
        : never
      : never;

/** The value of a key. */
export type Value<K extends Key> = Given<ValueAt<Scene, K>>;

/** New values for keys. If a part of a key is a list, such as `cloth`, every item is changed. `undefined` removes a key. */
export type Changes = { [K in Key]?: Value<K> };

/** A section of a scene, while its keys are changed. */
type Section = { [key: string]: unknown };

/** A copy of a part of a scene, with lists in place of typed arrays. */
export function plain(given: unknown): unknown {
  if (ArrayBuffer.isView(given) && !(given instanceof DataView)) return Array.from(given as Float64Array);
  if (Array.isArray(given)) return given.map(plain);
  if (typeof given !== "object" || given === null) return given;
  return Object.fromEntries(Object.entries(given).map(([key, value]) => [key, plain(value)]));
}

/** Parses the TOML text of a scene. A syntax error names line and column. */
export function read(text: string): Scene {
  return complete(parse(text) as unknown as Scene);
}

/** Parses a value as the command line does: TOML, or a bare word. */
export function value(text: string): unknown {
  try {
    return parse(`value = ${text}`).value;
  } catch {
    return text;
  }
}

/** A scene with the duration of 1 s if it has none: a program goes on as long as it likes. */
export const complete = (scene: Scene): Scene => ({ ...scene, duration: scene.duration ?? 1 });

/** Parts of a key that are refused: the empty one, and names that would change more than the scene. */
const FORBIDDEN = ["", "__proto__", "constructor", "prototype"];

/** Keys of lists whose items a key cannot make. */
const LISTS = ["collider", "pin", "load", "mass", "seam", "start"];

/** A copy of the scene with changed values. */
export function changed(scene: Scene, changes: Changes): Scene {
  const copy = structuredClone(scene);
  for (const [key, value] of Object.entries(changes)) {
    const path = key.split(".");
    if (path.some((part) => FORBIDDEN.includes(part))) throw new Error(`"${key}" is no key; write one such as integrator.step`);
    put(copy as unknown as Section, path, value, key);
  }
  return complete(copy);
}

/**
 * The scene's wind section, with its velocity replaced by this one, m/s. If the scene has no wind, the coefficients
 * are those of light cloth.
 */
export function windy(scene: Scene, velocity: [number, number, number]): WindDesc {
  return { normal: 0.6, tangential: 0.03, ...scene.drag?.wind, velocity };
}

function put(owner: unknown, [first = "", ...rest]: string[], value: unknown, key: string): void {
  let index: string | number = first;
  if (Array.isArray(owner)) {
    if (owner.length === 0) throw new Error(`${key}: no item can have ${first}, because the list is empty`);
    // A key of a list, without an index, applies to each of its items.
    if (!/^\d+$/.test(first)) {
      for (const item of owner) put(item, [first, ...rest], value, key);
      return;
    }
    index = Number(first);
    if (index >= owner.length) throw new Error(`${key}: there is no number ${index}; the last is ${owner.length - 1}`);
  } else if (typeof owner !== "object") {
    throw new Error(`${key}: ${first} is inside a value that is no section`);
  }
  const section = owner as Section;
  if (rest.length > 0) {
    if (section[index] === undefined && value === undefined) return;
    if (section[index] === undefined && (/^\d+$/.test(rest[0] ?? "") || LISTS.includes(first))) {
      throw new Error(`${key}: there is no ${first} yet; set it as a whole`);
    }
    section[index] ??= {};
    put(section[index], rest, value, key);
  } else if (value === undefined) {
    delete section[index];
  } else {
    // Each item of a list gets a copy of its own.
    section[index] = plain(value);
  }
}

/** A scene without the numbers that a running simulation can take over, and without the keys that no step needs. */
function frame({ name, description, duration, until_rest, gravity, drag, cloth, contact, collider, ...rest }: Scene) {
  const switches = contact && (({ thickness, friction, ...rest }) => rest)(contact);
  return { ...rest, sheets: sheets(cloth), switches, colliders: colliders(collider) };
}

const sheets = (all: ClothDesc[]) => all.map(({ density, stretch, shear, bend, seam, load, mass, ...sheet }) => sheet);

const colliders = (all: ColliderDesc[] = []) => all.map(({ friction, ...collider }) => collider);

const same = (a: unknown, b: unknown) => JSON.stringify(a) === JSON.stringify(b);

/** Whether the lists of a scene are lists of sections. The module reports it if they are not. */
function isWellFormed({ cloth, collider = [], contact }: Scene) {
  const isSection = (given: unknown) => typeof given === "object" && given !== null;
  return [cloth, collider].every((list) => Array.isArray(list) && list.every(isSection)) && (contact === undefined || isSection(contact));
}

/** Whether scenes differ only in materials, forces, thickness, friction, names and duration. */
export const isAlike = (a: Scene, b: Scene) => isWellFormed(b) && same(frame(a), frame(b));

/** Whether the colliders of two scenes have the same shapes, places and motions. */
export const hasSameColliders = (a: Scene, b: Scene) => !isWellFormed(b) || same(colliders(a.collider), colliders(b.collider));

/** Whether the cloths of two scenes have the same meshes, places and pins, and their colliders are the same. */
export const hasSameBodies = (a: Scene, b: Scene) => same(sheets(a.cloth), sheets(b.cloth)) && hasSameColliders(a, b);

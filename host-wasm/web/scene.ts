// Scenes as objects: reads them from TOML, changes values at keys, and compares them.

import { parse } from "smol-toml";
import type { ClothDesc, ColliderDesc, Scene, WindDesc } from "./scene_types.js";

export type * from "./scene_types.js";

/** New values for keys such as "integrator.step". If a part of the key is a list, such as `cloth`, every item is changed. `undefined` removes a key. */
export type Changes = { [key: string]: unknown };

/** A section of a scene, while its keys are changed. */
type Section = { [key: string]: unknown };

/** Parses the TOML text of a scene. A syntax error names line and column. */
export function read(text: string): Scene {
  return parse(text) as unknown as Scene;
}

/** Parses a value as the command line does: TOML, or a bare word. */
export function value(text: string): unknown {
  try {
    return parse(`value = ${text}`).value;
  } catch {
    return text;
  }
}

/** Parts of a key that are refused: the empty one, and names that would change more than the scene. */
const FORBIDDEN = ["", "__proto__", "constructor", "prototype"];

/** A copy of the scene with changed values. */
export function changed(scene: Scene, changes: Changes): Scene {
  const copy = structuredClone(scene);
  for (const [key, value] of Object.entries(changes)) {
    const path = key.split(".");
    if (path.some((part) => FORBIDDEN.includes(part))) throw new Error(`"${key}" is no key; write one such as integrator.step`);
    put(copy as unknown as Section, path, value, key);
  }
  return copy;
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
    section[index] ??= {};
    put(section[index], rest, value, key);
  } else if (value === undefined) {
    delete section[index];
  } else {
    // Each item of a list gets a copy of its own.
    section[index] = structuredClone(value);
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

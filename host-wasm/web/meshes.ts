// The meshes that a program gives for a scene.

import { array, keys } from "./checks.js";
import type { Mesh } from "./results.js";
import type { Scene } from "./scene.js";

/** Meshes by name. */
export type Meshes = { [name: string]: Mesh };

/** The meshes that a scene names, after a look at their kinds and sizes. The module checks their numbers. */
export function named(scene: Scene, meshes: Meshes = {}, mostVertices: number): Meshes {
  const files = sections(scene.collider).map((collider) => ("file" in collider ? collider.file : undefined));
  const names = [...sections(scene.cloth).map(({ mesh }) => mesh), ...files];
  const isPlain = typeof meshes === "object" && meshes !== null && !Array.isArray(meshes) && !(meshes instanceof Map);
  if (!isPlain) throw new TypeError(`meshes must be an object with a mesh by name, not ${meshes}`);
  const found: Meshes = {};
  for (const name of names) {
    if (typeof name !== "string" || Object.hasOwn(found, name)) continue;
    if (!Object.hasOwn(meshes, name)) {
      const known = Object.keys(meshes);
      throw new Error(
        `there is no mesh "${name}": ${known.length > 0 ? `meshes has ${known.join(", ")}` : "give it in the option meshes"}`,
      );
    }
    found[name] = checked(`meshes.${name}`, meshes[name] as Mesh, mostVertices);
  }
  return found;
}

/** The sections of a list that may be malformed, which the module reports. */
const sections = <T extends object>(given: T[] | undefined): T[] =>
  Array.isArray(given) ? given.filter((section) => typeof section === "object" && section !== null) : [];

function checked(name: string, given: Mesh, mostVertices: number): Mesh {
  const mesh = keys(name, given, ["positions", "indices", "uvs"]);
  const count = array(`${name}.positions`, mesh.positions).length / 3;
  if (count > mostVertices) {
    throw new Error(
      `${name} has ${count} vertices, more than ${mostVertices}; take a coarser mesh, or allow more by the option mostVertices`,
    );
  }
  array(`${name}.indices`, mesh.indices);
  if (mesh.uvs !== undefined) array(`${name}.uvs`, mesh.uvs);
  return mesh;
}

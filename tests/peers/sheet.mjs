// Parts of all comparisons with peers: the module in Node.js, and the stretch of the edges of a sheet.

import { readFileSync } from "node:fs";
import { join } from "node:path";
import { pathToFileURL } from "node:url";
import { dist } from "../browser/kit.mjs";

export const muslin = await import(pathToFileURL(join(dist, "muslin.js")));
await muslin.load(readFileSync(join(dist, "muslin_wasm_bg.wasm")));

const distance = (x, [a, b]) => Math.hypot(x[3 * a] - x[3 * b], x[3 * a + 1] - x[3 * b + 1], x[3 * a + 2] - x[3 * b + 2]);

/** The largest stretch of an edge as a function of the positions. */
export function stretchOf(rest, triangles) {
  const edges = new Map();
  for (let t = 0; t < triangles.length; t += 3) {
    for (const [a, b] of [
      [0, 1],
      [1, 2],
      [2, 0],
    ]) {
      const edge = [triangles[t + a], triangles[t + b]].sort((a, b) => a - b);
      edges.set(edge.join(), [edge, distance(rest, edge)]);
    }
  }
  const all = [...edges.values()];
  return (x) => all.reduce((most, [edge, length]) => Math.max(most, distance(x, edge) / length - 1), 0);
}

export const middle = (numbers) => numbers.toSorted((a, b) => a - b)[numbers.length >> 1];

export const say = (name, { ms, stretch }) =>
  console.log(`${name.padEnd(36)} ${ms.toFixed(1).padStart(6)} ms for 1/60 s, worst edge +${(100 * stretch).toFixed(1)} %`);

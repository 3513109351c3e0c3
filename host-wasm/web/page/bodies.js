// Colliders as triangles: the position and the normal of each corner. They are computed again when a collider moves.

import { add, cross, sub, unit } from "./vector.js";

const AROUND = 32;
const RINGS = 16;
const FLOOR = 4; // m, half the edge of the square that is drawn of a plane

const across = (n) => unit(cross(n, Math.abs(n[1]) < 0.9 ? [0, 1, 0] : [1, 0, 0]));

const point = (points, k) => Array.from(points.subarray(3 * k, 3 * k + 3));

let last = { bodies: [], corners: new Float32Array() };

/** The corners of the triangles of all bodies: position and normal, six numbers each. */
export function corners(bodies) {
  const rest = (body, k) => body.points.every((x, i) => x === last.bodies[k].points[i]);
  if (bodies.length !== last.bodies.length || !bodies.every(rest)) last = { bodies, corners: made(bodies) };
  return last.corners;
}

function made(bodies) {
  const out = [];
  for (const body of bodies) shapes[body.shape]?.(body, (place, normal) => out.push(...place, ...normal));
  return new Float32Array(out);
}

function quad(put, [a, b, c, d], normals) {
  for (const k of [0, 1, 2, 0, 2, 3]) put([a, b, c, d][k], normals[k] ?? normals[0]);
}

function round({ points, radius }, put) {
  const from = point(points, 0);
  const to = points.length > 3 ? point(points, 1) : from;
  const axis = points.length > 3 ? unit(sub(from, to)) : [0, 1, 0];
  const x = across(axis);
  const z = cross(axis, x);
  const at = (ring, place) => {
    // Two rings lie in the middle: the straight part of a capsule is between them.
    const half = Math.min(ring, RINGS - 1 - ring) / (RINGS / 2 - 1);
    const [polar, turn] = [(half * Math.PI) / 2, (place / AROUND) * 2 * Math.PI];
    const up = Math.cos(polar) * (ring < RINGS / 2 ? 1 : -1);
    const out = add(add([0, 0, 0], x, Math.cos(turn) * Math.sin(polar)), z, Math.sin(turn) * Math.sin(polar));
    const normal = add(out, axis, up);
    return [add(ring < RINGS / 2 ? from : to, normal, radius), normal];
  };
  for (let ring = 1; ring < RINGS; ring++) {
    for (let place = 0; place < AROUND; place++) {
      const four = [at(ring - 1, place), at(ring, place), at(ring, place + 1), at(ring - 1, place + 1)];
      quad(
        put,
        four.map(([place]) => place),
        four.map(([, normal]) => normal),
      );
    }
  }
}

// The corners of each face of a box. Corner k is on the positive side of every axis whose bit is set in k.
const FACES = [
  [0, 2, 6, 4],
  [1, 5, 7, 3],
  [0, 4, 5, 1],
  [2, 3, 7, 6],
  [0, 1, 3, 2],
  [4, 6, 7, 5],
];

const shapes = {
  plane({ points, normal }, put) {
    const x = across(normal);
    const z = cross(normal, x);
    const at = (i, j) => add(add(point(points, 0), x, i * FLOOR), z, j * FLOOR);
    quad(put, [at(-1, -1), at(-1, 1), at(1, 1), at(1, -1)], [normal]);
  },
  sphere: round,
  capsule: round,
  box({ points }, put) {
    for (const face of FACES) {
      const four = face.map((k) => point(points, k));
      quad(put, four, [unit(cross(sub(four[1], four[0]), sub(four[3], four[0])))]);
    }
  },
};

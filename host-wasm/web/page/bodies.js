// Colliders as triangles: the position, the normal and the kind of each corner. They are computed again when a collider
// moves.

import { add, cross, point, sub, unit } from "./vector.js";

const AROUND = 44;
const RINGS = 22;
const FLOOR = 4; // m, half the edge of the square that is drawn of a plane

const across = (n) => unit(cross(n, Math.abs(n[1]) < 0.9 ? [0, 1, 0] : [1, 0, 0]));

/** Numbers of a corner. */
const CORNER = 7;
/** Kinds of corners: solid, floor and glass. */
const [SOLID, GROUND, GLASS] = [0, 1, 2];
/** Boxes from which they are drawn as glass, because they surround the cloth. */
const MANY = 3;

let last = { bodies: [], corners: new Float32Array(), floor: 0, glass: 0 };

/**
 * The corners of the triangles of all bodies: position, normal and kind, seven numbers each. Those of planes come first, then
 * from the corner `floor` on the solid ones, and from `glass` on those of glass.
 */
export function corners(bodies) {
  const isSame = ({ shape, radius, points }, k) => {
    const { [k]: before } = last.bodies;
    return shape === before.shape && radius === before.radius && points.every((x, i) => x === before.points[i]);
  };
  if (bodies.length !== last.bodies.length || !bodies.every(isSame)) last = { bodies, ...made(bodies) };
  return last;
}

/** Corners in a list that grows. */
const out = { numbers: new Float32Array(1 << 12), length: 0, kind: SOLID };

/** Appends a corner. */
function put(place, normal) {
  if (out.length + CORNER > out.numbers.length) {
    const more = new Float32Array(2 * out.numbers.length);
    more.set(out.numbers);
    out.numbers = more;
  }
  const { numbers, length } = out;
  for (let k = 0; k < 3; k++) {
    numbers[length + k] = place[k];
    numbers[length + 3 + k] = normal[k];
  }
  numbers[length + 6] = out.kind;
  out.length += CORNER;
}

function made(bodies) {
  const boxes = bodies.filter(({ shape }) => shape === "box").length;
  const kind = ({ shape }) => (shape === "plane" ? GROUND : shape === "box" && boxes >= MANY ? GLASS : SOLID);
  out.length = 0;
  const ends = [GROUND, SOLID, GLASS].map((own) => {
    out.kind = own;
    for (const body of bodies) if (kind(body) === own) shapes[body.shape]?.(body);
    return out.length / CORNER;
  });
  return { corners: out.numbers.subarray(0, out.length), floor: ends[0], glass: ends[1] };
}

/** A pole for vertices that are pinned in a line upright, as those of a flag: from the ground to a little above them. */
export function pole(positions, pins) {
  const places = Array.from(pins, (pin) => point(positions, pin));
  if (places.length < 3) return [];
  const [low, ...others] = places.sort((a, b) => a[1] - b[1]);
  if (!others.every((place) => Math.hypot(place[0] - low[0], place[2] - low[2]) < 1e-3)) return [];
  const height = others.at(-1)[1] - low[1];
  const ends = [others.at(-1)[1] + 0.05 * height, low[1] - 1.2 * height].map((y) => [low[0], y, low[2]]);
  return [{ shape: "capsule", radius: 0.012 * height, points: new Float32Array(ends.flat()) }];
}

function quad([a, b, c, d], [na, nb = na, nc = na, nd = na]) {
  put(a, na);
  put(b, nb);
  put(c, nc);
  put(a, na);
  put(c, nc);
  put(d, nd);
}

/** Points of a round body: the cosine and sine of the angle around, and for each ring those of the angle from the axis. */
const turns = Array.from({ length: AROUND + 1 }, (_, place) => (place / AROUND) * 2 * Math.PI).map((a) => [Math.cos(a), Math.sin(a)]);
const rings = Array.from({ length: RINGS }, (_, ring) => {
  // Two rings lie in the middle: the straight part of a capsule is between them.
  const half = Math.min(ring, RINGS - 1 - ring) / (RINGS / 2 - 1);
  const polar = (half * Math.PI) / 2;
  return { isUpper: ring < RINGS / 2, up: Math.cos(polar) * (ring < RINGS / 2 ? 1 : -1), out: Math.sin(polar) };
});

function round({ points, radius }) {
  const from = point(points, 0);
  const to = points.length > 3 ? point(points, 1) : from;
  const axis = points.length > 3 ? unit(sub(from, to)) : [0, 1, 0];
  const x = across(axis);
  const z = cross(axis, x);
  // Without a list for each corner, because moving bodies are made anew for every picture.
  const [place, normal] = [
    [0, 0, 0],
    [0, 0, 0],
  ];
  const corner = ({ isUpper, up, out }, [c, s]) => {
    const end = isUpper ? from : to;
    for (let k = 0; k < 3; k++) {
      normal[k] = up * axis[k] + out * (c * x[k] + s * z[k]);
      place[k] = end[k] + radius * normal[k];
    }
    put(place, normal);
  };
  for (let ring = 1; ring < RINGS; ring++) {
    const [above, below] = [rings[ring - 1], rings[ring]];
    for (let turn = 0; turn < AROUND; turn++) {
      const [left, right] = [turns[turn], turns[turn + 1]];
      corner(above, left);
      corner(below, left);
      corner(below, right);
      corner(above, left);
      corner(below, right);
      corner(above, right);
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
  plane({ points, normal }) {
    const x = across(normal);
    const z = cross(normal, x);
    const at = (i, j) => add(add(point(points, 0), x, i * FLOOR), z, j * FLOOR);
    quad([at(-1, -1), at(-1, 1), at(1, 1), at(1, -1)], [normal]);
  },
  sphere: round,
  capsule: round,
  box({ points }) {
    for (const face of FACES) {
      const four = face.map((k) => point(points, k));
      quad(four, [unit(cross(sub(four[1], four[0]), sub(four[3], four[0])))]);
    }
  },
};

// The hand that holds the cloth: a bounded force that draws the vertices around the held one to the hand. Contact stays
// exact, and the cloth stretches no more than the force allows.

import { cross, dot, point, sub } from "./vector.js";

/** Vertices that share the force: this part of all, but at least so many. */
const SHARE = 0.015;
const LEAST = 7;
/** The largest force, as a multiple of the weight of the cloth on Earth. */
const STRONGEST = 3;
const EARTH = 9.81;
/** Share of the distance to the hand that a step covers, if the mass that moves is as estimated. */
const NEARER = 0.25;
/** Growth of the estimate of that mass per step, and the ratio to the mass that moved from which it grows. */
const GROWTH = 1.15;
const MORE = 1.5;

export class Hold {
  #cloth;
  /** Masses of the held vertices and of all cloth, kg. */
  #own;
  #whole;
  /** The mass that the hand moves, as estimated: that of the held vertices, and more if others hang on them. */
  #mass;
  /** The force of the last step, N, and the velocity before it, m/s. */
  #last = { force: [0, 0, 0], velocity: [0, 0, 0] };

  constructor(vertex, to, cloth) {
    if (!(vertex < cloth.vertexCount)) throw new Error(`there is no vertex ${vertex}`);
    const triangles = cloth.triangles();
    /** The held vertex, and the place to which the hand draws it, m. */
    Object.assign(this, { vertex, to });
    this.#cloth = cloth;
    /** The vertices that share the force. */
    this.vertices = around(triangles, vertex, Math.max(LEAST, SHARE * cloth.vertexCount));
    const density = Math.min(...cloth.scene.cloth.map(({ density }) => density));
    this.#whole = density * area(cloth.positions(), triangles);
    this.#own = (this.#whole * this.vertices.length) / cloth.vertexCount;
    this.#mass = this.#own;
  }

  /** The force on each held vertex for the next step, N. */
  force(seconds) {
    const off = sub(this.to, point(this.#cloth.positions(), this.vertex));
    const velocities = this.#cloth.velocities();
    const velocity = [0, 0, 0];
    for (const vertex of this.vertices) for (let k = 0; k < 3; k++) velocity[k] += velocities[3 * vertex + k] / this.vertices.length;
    this.#estimate(velocity, seconds);
    const wanted = off.map((x, k) => this.#mass * ((NEARER * x) / seconds ** 2 - velocity[k] / seconds));
    const force = bounded(wanted, STRONGEST * this.#whole * EARTH);
    this.#last = { force, velocity };
    return force.map((x) => x / this.vertices.length);
  }

  /** Estimates the mass from the change of velocity. It falls at once, because too much force would make the cloth swing. */
  #estimate(velocity, seconds) {
    const { force, velocity: before } = this.#last;
    const gained = dot(force, sub(velocity, before));
    const moved = gained > 0 ? (seconds * dot(force, force)) / gained : this.#whole;
    if (moved > MORE * this.#mass) this.#mass = Math.min(this.#whole, GROWTH * this.#mass);
    else if (moved < this.#mass) this.#mass = Math.max(this.#own, moved);
  }
}

/** A vector that is at most so long. */
function bounded(a, most) {
  const length = Math.hypot(...a);
  return length > most ? a.map((x) => (x * most) / length) : a;
}

/** The vertex and those around it, ring by ring, until there are so many. */
function around(triangles, vertex, count) {
  const found = new Set([vertex]);
  for (let before = 0; before < found.size && found.size < count; ) {
    before = found.size;
    const ring = new Set(found);
    for (let k = 0; k < triangles.length; k += 3) {
      const corners = triangles.subarray(k, k + 3);
      if (corners.some((corner) => ring.has(corner))) for (const corner of corners) found.add(corner);
    }
  }
  return [...found];
}

/** The area of all triangles, m^2. */
function area(positions, triangles) {
  let sum = 0;
  for (let k = 0; k < triangles.length; k += 3) {
    const [a, b, c] = [0, 1, 2].map((i) => point(positions, triangles[k + i]));
    sum += Math.hypot(...cross(sub(b, a), sub(c, a))) / 2;
  }
  return sum;
}

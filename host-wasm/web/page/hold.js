// The vertex that the hand holds. It follows the hand as fast as its speed and the stretch of the cloth allow.

/** Highest speed, m/s. */
const FASTEST = 4;
/** Strain of the edges around the vertex from which it gives way. The force of the hand is bounded by it. */
const STRAINED = 0.08;

export class Hold {
  #at;
  #cloth;
  #around;

  constructor(vertex, to, cloth) {
    Object.assign(this, { vertex, to });
    this.#cloth = cloth;
    this.#at = Array.from(cloth.positions().subarray(3 * vertex, 3 * vertex + 3));
    this.#around = neighbours(cloth.triangles(), vertex);
  }

  /** The place after the next `seconds` of simulated time. */
  next(seconds) {
    const isStrained = this.#cloth.strains()[this.vertex] > STRAINED;
    const to = isStrained ? this.#middle() : this.to;
    const way = Math.hypot(...to.map((x, k) => x - this.#at[k]));
    const part = Math.min(1, (FASTEST * seconds) / (way || 1));
    // A strained vertex goes back a little, not to where the cloth is slack.
    const share = isStrained ? part / 4 : part;
    this.#at = this.#at.map((x, k) => x + share * (to[k] - x));
    return this.#at;
  }

  /** The middle of the vertices around it, m. */
  #middle() {
    const positions = this.#cloth.positions();
    const sum = [0, 0, 0];
    for (const vertex of this.#around) for (let k = 0; k < 3; k++) sum[k] += positions[3 * vertex + k];
    return sum.map((x) => x / this.#around.length);
  }
}

/** The vertices that share a triangle with a vertex. */
function neighbours(triangles, vertex) {
  const found = new Set();
  for (let k = 0; k < triangles.length; k += 3) {
    const corners = triangles.subarray(k, k + 3);
    if (corners.includes(vertex)) for (const corner of corners) found.add(corner);
  }
  found.delete(vertex);
  return [...found];
}

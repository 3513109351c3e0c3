// The camera. It orbits a point; its matrices are stored by columns.

import { SHADOW } from "./look.js";
import { add, cross, dot, sub, unit } from "./vector.js";

const OPENING = 0.7; // rad, field of view of the shorter side
/** The direction from which a cloth is seen at first, rad. */
const FROM = { yaw: 0.6, pitch: 0.25 };
/** The direction to the sun. */
const SUN = unit(SHADOW.sun.split(",").map(Number));
/** Share of the way per picture by which the view follows a cloth that leaves its middle. */
const FOLLOW = 0.05;
/** Part of its first size from which the view goes nearer to a cloth that becomes smaller. */
const SMALL = 0.55;
/** Share of the distance within which the view stays. */
const CLOSE = 0.02;
/** Distance of the middle of the cloth from the middle of the picture up to which it stays, as a share of half the picture. */
const MIDDLE = 0.4;

export class Camera {
  constructor() {
    Object.assign(this, {
      yaw: 0.6,
      pitch: 0.25,
      distance: 3,
      centre: [0, 0.5, 0],
      lit: [0, 0.5, 0],
      reach: 1,
      first: { size: 1, distance: 3 },
      follows: true,
      zooms: true,
      size: [1, 1],
    });
  }

  /** Moves the camera so that all positions are in view, from the first direction if the user asks for it. */
  frame(positions, isAnew = false) {
    if (isAnew) Object.assign(this, FROM);
    const { low, high } = bounds(positions);
    const size = Math.hypot(...sub(high, low));
    // Include the space below, down to the floor or 1 m, because cloth falls.
    low[1] = Math.min(low[1], Math.max(0, low[1] - 1));
    this.centre = low.map((x, k) => (x + high[k]) / 2);
    this.reach = Math.hypot(...sub(high, low)) / 2;
    this.distance = 3 * this.reach + 0.1;
    this.first = { size, distance: this.distance };
    this.follows = this.zooms = true;
  }

  /** Moves the view after a cloth that leaves its middle, and nearer to one that becomes small, unless the user has moved it. */
  follow(positions) {
    const { low, high } = bounds(positions);
    this.lit = low.map((x, k) => (x + high[k]) / 2);
    if (!this.follows) return;
    const at = this.project(this.matrix(true), this.lit).slice(0, 2);
    const off = at.map((pixel, k) => (2 * pixel) / this.size[k] - 1);
    // Seen from nearer, a cloth is kept nearer to the middle.
    const most = (MIDDLE * this.distance) / Math.max(this.distance, this.first.distance);
    if (Math.max(...off.map(Math.abs)) > most) this.centre = add(this.centre, sub(this.lit, this.centre), FOLLOW);
    if (!this.zooms) return;
    const { size, distance } = this.first;
    const near = distance * Math.min(1, Math.hypot(...sub(high, low)) / (SMALL * size));
    if (Math.abs(near / this.distance - 1) > CLOSE) this.distance += FOLLOW * (near - this.distance);
  }

  /** Moves the view parallel to the screen by a number of pixels. */
  pan(x, y) {
    this.follows = false;
    this.centre = this.moved(this.centre, -x, -y);
  }

  turn(x, y) {
    this.yaw -= x;
    this.pitch = Math.max(-1.5, Math.min(1.5, this.pitch + y));
  }

  zoom(factor) {
    this.zooms = false;
    this.distance = Math.max(0.05, Math.min(100, this.distance * factor));
  }

  get axes() {
    const [cy, sy, cp, sp] = [Math.cos(this.yaw), Math.sin(this.yaw), Math.cos(this.pitch), Math.sin(this.pitch)];
    const back = [sy * cp, sp, cy * cp];
    const right = unit(cross([0, 1, 0], back));
    return [right, cross(back, right), back];
  }

  get eye() {
    return this.centre.map((x, k) => x + this.distance * this.axes[2][k]);
  }

  /** The matrix from world to clip space, with depths from 0 to 1 if `fromZero`, otherwise from -1 to 1. */
  matrix(fromZero) {
    const [width, height] = this.size;
    const focus = 1 / Math.tan(OPENING / 2) / Math.max(1, height / width);
    const [near, far] = [this.distance * 0.02, this.distance * 20];
    const [depth, shift] = fromZero
      ? [far / (near - far), (near * far) / (near - far)]
      : [(far + near) / (near - far), (2 * near * far) / (near - far)];
    const [right, up, back] = this.axes;
    const eye = this.eye;
    const rows = [
      [right.map((x) => (x * focus * height) / width), (-dot(right, eye) * focus * height) / width],
      [up.map((x) => x * focus), -dot(up, eye) * focus],
      [back.map((x) => x * depth), -dot(back, eye) * depth + shift],
      [back.map((x) => -x), dot(back, eye)],
    ];
    const out = new Float32Array(16);
    rows.forEach(([axis, last], row) => [...axis, last].forEach((x, column) => (out[4 * column + row] = x)));
    return out;
  }

  /** The matrix from world to the depth map, which the sun sees, around the cloth. Depths as in `matrix`. */
  light(fromZero) {
    const right = unit(cross([0, 1, 0], SUN));
    const up = cross(SUN, right);
    const scale = 1 / (1.5 * this.reach);
    const rows = [right.map((x) => x * scale), up.map((x) => x * scale), SUN.map((x) => (-x * scale) / (fromZero ? 4 : 2))];
    const shift = [0, 0, fromZero ? 0.5 : 0];
    const out = new Float32Array(16);
    rows.forEach((axis, row) => {
      [...axis, shift[row] - dot(axis, this.lit)].forEach((x, column) => (out[4 * column + row] = x));
    });
    out[15] = 1;
    return out;
  }

  /** The position of a point on the screen, in pixels from the left and the top, and its depth in front of the eye. */
  project(matrix, [x, y, z]) {
    const at = (row) => matrix[row] * x + matrix[4 + row] * y + matrix[8 + row] * z + matrix[12 + row];
    const w = at(3);
    return [((at(0) / w + 1) / 2) * this.size[0], ((1 - at(1) / w) / 2) * this.size[1], w];
  }

  /** The visible vertex nearest to a pixel, within a distance in pixels, or undefined. */
  pick(positions, x, y, within) {
    const m = this.matrix(true);
    const [width, height] = this.size;
    let [best, least] = [undefined, within];
    let nearest = Infinity;
    // As `project`, without a list for each vertex.
    for (let v = 0, k = 0; k < positions.length; v++, k += 3) {
      const [a, b, c] = [positions[k], positions[k + 1], positions[k + 2]];
      const depth = m[3] * a + m[7] * b + m[11] * c + m[15];
      if (depth <= 0) continue;
      const px = ((m[0] * a + m[4] * b + m[8] * c + m[12]) / depth + 1) * (width / 2);
      const py = (1 - (m[1] * a + m[5] * b + m[9] * c + m[13]) / depth) * (height / 2);
      const off = Math.hypot(px - x, py - y);
      // Among vertices at about the same distance from the pixel, the one in front is chosen.
      if (off < least - 8 || (off < least + 8 && off < within && depth < nearest)) {
        [best, least, nearest] = [v, Math.min(off, least), depth];
      }
    }
    return best;
  }

  /** A place, m, after a move parallel to the screen by a number of pixels. */
  moved(place, x, y) {
    const [right, up, back] = this.axes;
    const depth = dot(back, sub(this.eye, place));
    const [width, height] = this.size;
    const scale = (2 * depth * Math.tan(OPENING / 2) * Math.max(1, height / width)) / height;
    return place.map((p, k) => p + scale * (x * right[k] - y * up[k]));
  }
}

/** The lowest and the highest coordinates. */
function bounds(positions) {
  const low = [Infinity, Infinity, Infinity];
  const high = low.map((x) => -x);
  for (let k = 0; k < positions.length; k++) {
    low[k % 3] = Math.min(low[k % 3], positions[k]);
    high[k % 3] = Math.max(high[k % 3], positions[k]);
  }
  return { low, high };
}

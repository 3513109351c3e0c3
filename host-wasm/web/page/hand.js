// The user's hand: grabs vertices, moves and pins them, and turns the view.

import { point } from "./vector.js";

/** Distance within which a vertex is grabbed, px. */
const REACH = 40;
const KEY = 0.02; // move per key press, as a fraction of the height of the view
const ARROWS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };

export class Hand {
  #canvas;
  #camera;
  #cloth;
  #pointers = new Map();
  #held;
  /** The vertices that the last two presses grabbed, and whether they were pinned before. */
  #presses = [];
  /** The vertices that the hand pinned or released, and whether they are pinned. The state in view may be older. */
  #known = new Map();

  /** `cloth` provides {positions, pins, lead, drop, pin, release} of the current cloth. */
  constructor(canvas, camera, cloth) {
    this.#canvas = canvas;
    this.#camera = camera;
    this.#cloth = cloth;
    canvas.addEventListener("pointerdown", (event) => this.#down(event));
    canvas.addEventListener("pointermove", (event) => this.#move(event));
    for (const name of ["pointerup", "pointercancel"]) canvas.addEventListener(name, (event) => this.#up(event));
    canvas.addEventListener("dblclick", () => this.#double());
    canvas.addEventListener("contextmenu", (event) => event.preventDefault());
    canvas.addEventListener("wheel", (event) => {
      event.preventDefault();
      camera.zoom(Math.exp(event.deltaY / 500));
    });
  }

  /** Forgets the grabbed vertex, because another cloth is in view. */
  drop() {
    this.#held = undefined;
    this.#presses = [];
    this.#known.clear();
    this.#pointers.clear();
  }

  #at(event) {
    const { left, top } = this.#canvas.getBoundingClientRect();
    return [event.clientX - left, event.clientY - top];
  }

  #take(x, y, within) {
    if (this.#held) this.#let_go();
    const vertex = this.#camera.pick(this.#cloth.positions(), x, y, within);
    if (vertex === undefined) return false;
    this.#held = { vertex, to: this.#place(vertex), pinned: this.#pinned(vertex) };
    // A pin moves with the hand, and is pinned again where it is let go.
    if (this.#held.pinned) this.#release(vertex);
    this.#cloth.lead(vertex, this.#held.to);
    return true;
  }

  /** Moves the target of the held vertex by pixels. */
  #lead(x, y) {
    this.#held.to = this.#camera.moved(this.#held.to, x, y);
    this.#cloth.lead(this.#held.vertex, this.#held.to);
  }

  #pinned(vertex) {
    return this.#known.get(vertex) ?? this.#cloth.pins().includes(vertex);
  }

  #place(vertex) {
    return point(this.#cloth.positions(), vertex);
  }

  #let_go() {
    const { vertex, pinned } = this.#held;
    this.#held = undefined;
    this.#cloth.drop();
    if (pinned) this.#pin(vertex);
  }

  #pin(vertex) {
    this.#known.set(vertex, true);
    this.#cloth.pin(vertex);
  }

  #release(vertex) {
    this.#known.set(vertex, false);
    this.#cloth.release(vertex);
  }

  #down(event) {
    this.#canvas.focus();
    this.#canvas.setPointerCapture(event.pointerId);
    const [x, y] = this.#at(event);
    this.#pointers.set(event.pointerId, [x, y]);
    if (this.#pointers.size === 1 && event.button === 0 && !event.shiftKey) {
      this.#presses = [this.#presses.at(-1), this.#take(x, y, REACH) ? this.#held : undefined];
    } else if (this.#held) this.#let_go();
  }

  /** Pins or releases the vertex of the first of two presses: between them the cloth moves. */
  #double() {
    const pressed = this.#presses.find(Boolean);
    if (pressed) this.#toggle(pressed);
  }

  #toggle({ vertex, pinned }) {
    if (pinned) return this.#release(vertex);
    this.#pin(vertex);
  }

  #move(event) {
    const before = this.#pointers.get(event.pointerId);
    if (!before) return;
    const now = this.#at(event);
    const [x, y] = [now[0] - before[0], now[1] - before[1]];
    if (this.#pointers.size === 2) {
      const [other] = [...this.#pointers].filter(([id]) => id !== event.pointerId).map(([, place]) => place);
      const apart = (place) => Math.hypot(place[0] - other[0], place[1] - other[1]) || 1;
      this.#camera.zoom(apart(before) / apart(now));
      // Each finger moves the middle between them by half its way.
      this.#camera.turn(x / 300, y / 300);
    } else if (event.shiftKey || event.buttons > 1) {
      this.#camera.pan(x, y);
    } else if (this.#held) {
      this.#lead(x, y);
    } else {
      this.#camera.turn(x / 150, y / 150);
    }
    this.#pointers.set(event.pointerId, now);
  }

  #up(event) {
    if (this.#pointers.delete(event.pointerId) && this.#pointers.size === 0 && this.#held) this.#let_go();
  }

  /** Pins the grabbed vertex, or else the vertex in the middle. If it is pinned, its pin is removed. */
  pin() {
    if (this.#held) {
      this.#held.pinned = !this.#held.pinned;
      return;
    }
    const [x, y] = this.#camera.size.map((pixels) => pixels / 2);
    const vertex = this.#camera.pick(this.#cloth.positions(), x, y, Infinity);
    if (vertex !== undefined) this.#toggle({ vertex, pinned: this.#pinned(vertex) });
  }

  /** Handles a key. Returns false if the key is not for the hand. */
  key(key) {
    if (key === "g") {
      if (this.#held) this.#let_go();
      else this.#take(this.#camera.size[0] / 2, this.#camera.size[1] / 2, Infinity);
    } else if (key === "p") this.pin();
    else if (ARROWS[key] && this.#held) {
      this.#lead(...ARROWS[key].map((way) => way * KEY * this.#camera.size[1]));
    } else if (ARROWS[key]) this.#camera.turn(...ARROWS[key].map((way) => way * 0.1));
    else if (key === "+" || key === "-") this.#camera.zoom(key === "+" ? 0.9 : 1.1);
    else return false;
    return true;
  }
}

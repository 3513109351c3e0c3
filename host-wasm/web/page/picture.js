// The canvas, drawn with WebGPU or WebGL2.

import { corners } from "./bodies.js";
import { webgl } from "./draw_webgl.js";
import { webgpu } from "./draw_webgpu.js";

const DARK = matchMedia("(prefers-color-scheme: dark)");
/** Strain at which the colours saturate. */
const STRAINED = 0.05;
/** A strain that marks a pinned vertex. The shaders draw it dark. */
const PINNED = 1e9;

export class Picture {
  #renderer;
  #triangles;
  #only;
  #say;

  /** `only`: "webgl" forces the fallback. `say` shows a message when a renderer is lost. */
  constructor(canvas, camera, only, say) {
    Object.assign(this, { canvas, camera, strain: false });
    this.#only = only;
    this.#say = say;
    this.ready = this.#find();
    new ResizeObserver(() => this.#fit()).observe(canvas.parentElement);
    this.#fit();
  }

  get name() {
    return this.#renderer?.name;
  }

  get renderer() {
    return this.#renderer;
  }

  async #find() {
    const lost = (why) => this.#replace(`the picture was lost (${why}); redrawn`);
    const best = this.#only === "webgl" ? undefined : await webgpu(this.canvas, lost).catch(() => undefined);
    this.#renderer = best ?? webgl(this.canvas, lost);
    if (!this.#renderer) throw new Error("this browser has neither WebGPU nor WebGL2, or they are switched off");
    if (this.#triangles) this.#renderer.triangles(this.#triangles);
  }

  // Makes a new canvas, because a canvas supports only one kind of context and is useless once that is lost.
  async #replace(why) {
    this.#renderer = undefined;
    const fresh = document.createElement("canvas");
    fresh.className = "picture";
    this.canvas.replaceWith(fresh);
    this.canvas = fresh;
    this.#fit();
    await this.#find().then(
      () => this.#say(why),
      (error) => this.#say(error.message, true),
    );
  }

  #fit() {
    const { clientWidth, clientHeight } = this.canvas.parentElement;
    const ratio = Math.min(2, devicePixelRatio);
    this.canvas.width = Math.max(1, Math.round(clientWidth * ratio));
    this.canvas.height = Math.max(1, Math.round(clientHeight * ratio));
    this.camera.size = [Math.max(1, clientWidth), Math.max(1, clientHeight)];
  }

  triangles(list) {
    this.#triangles = list.slice();
    this.#renderer?.triangles(this.#triangles);
  }

  draw({ positions, normals, strains, bodies, pins }) {
    const marked = strains.slice();
    for (const pin of pins) marked[pin] = PINNED;
    this.#renderer?.draw({
      positions,
      normals,
      strains: marked,
      bodies: corners(bodies),
      matrix: this.camera.matrix(this.name === "WebGPU"),
      look: [...this.camera.eye, this.strain ? STRAINED : 0],
      paper: DARK.matches ? [0.115, 0.12, 0.13] : [0.965, 0.957, 0.937],
    });
  }
}

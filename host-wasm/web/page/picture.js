// The canvas, drawn with WebGPU or WebGL2.

import { corners, pole } from "./bodies.js";
import { webgl } from "./draw_webgl.js";
import { webgpu } from "./draw_webgpu.js";
import { STRAINED } from "./look.js";

const DARK = matchMedia("(prefers-color-scheme: dark)");
/** Checks of the cloth per metre. */
const CHECKS = 20;
/** A strain that marks a pinned or held vertex. The shaders draw it dark. */
const MARKED = 1e9;

export class Picture {
  #renderer;
  #mesh;
  /** Columns of the mesh, where its texture has seams: it has more vertices than the cloth. */
  #columns;
  /** A pole that is drawn for the pins. */
  #pole = [];
  /** The state and the settings of the picture that is seen. */
  #last = {};
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
    this.#last = {};
    if (!this.#renderer) throw new Error("this browser has neither WebGPU nor WebGL2, or they are switched off");
    if (this.#mesh) this.#renderer.mesh(this.#mesh);
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

  /** Shows another cloth, with the surface {vertices, uvs, triangles} and its first state. */
  show({ vertices, uvs, triangles }, { positions, pins }) {
    this.#mesh = { vertices, triangles, uvs: uvs.map((x) => CHECKS * x) };
    const hasSeams = vertices.length !== positions.length / 3;
    this.#columns = hasSeams ? [3, 3, 1].map((size) => new Float32Array(size * vertices.length)) : undefined;
    this.#pole = pole(positions, pins);
    this.#renderer?.mesh(this.#mesh);
  }

  /** Columns of the cloth as those of the mesh. */
  #gathered(all) {
    const { vertices } = this.#mesh;
    return this.#columns.map((out, column) => {
      const [own, size] = [all[column], out.length / vertices.length];
      vertices.forEach((vertex, k) => {
        for (let i = 0; i < size; i++) out[size * k + i] = own[size * vertex + i];
      });
      return out;
    });
  }

  /** Draws a state, unless the same picture is seen already. */
  refresh(view) {
    const { camera, canvas, strain, name } = this;
    camera.follow(view.positions);
    const key = JSON.stringify([camera, canvas.width, canvas.height, strain, name, DARK.matches]);
    if (view === this.#last.view && key === this.#last.key) return;
    this.draw(view);
    this.#last = { view, key };
  }

  draw({ positions, normals, strains, bodies, marked }) {
    const shown = strains.slice();
    for (const vertex of marked) shown[vertex] = MARKED;
    const columns = [positions, normals, shown];
    const [places, ways, marks] = this.#columns ? this.#gathered(columns) : columns;
    const fromZero = this.name === "WebGPU";
    this.#renderer?.draw({
      positions: places,
      normals: ways,
      strains: marks,
      bodies: corners(bodies.concat(this.#pole)),
      matrix: this.camera.matrix(fromZero),
      light: this.camera.light(fromZero),
      look: [...this.camera.eye, this.strain ? STRAINED : 0],
      paper: DARK.matches ? [0.115, 0.12, 0.13] : [0.965, 0.957, 0.937],
    });
  }
}

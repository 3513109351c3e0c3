// The cloth in view and its time: who wants something of it waits until no step is under way.

import { Cloth, changed } from "../muslin.js";
import { Reference } from "./reference.js";

/** s of the clock that a picture may stand for: after a stall or behind another tab the cloth goes on, not after. */
const LONGEST = 1 / 15;
/** ms of steps before the next picture. */
const BUDGET = 24;

export class Run {
  #todo = [];
  #due = 0;
  #compare = false;
  paused = false;
  /** Simulated over real time. */
  speed = 1;

  constructor(scene, changes, picture, hand, say) {
    Object.assign(this, { picture, hand, say });
    this.open(scene, changes);
  }

  /** Begins with a scene, another or the same; throws where that is none. */
  open(scene, changes) {
    const cloth = new Cloth(changed(scene, changes));
    this.device = undefined;
    this.cloth?.free();
    this.cloth = cloth;
    this.picture.triangles(cloth.triangles());
    this.#look();
    this.compare(this.#compare);
  }

  /** Does something between steps. */
  ask(what) {
    this.#todo.push(what);
  }

  // What the hand needs.
  positions = () => this.view.positions;
  pins = () => this.view.pins;
  lead = (vertex, place, seconds) =>
    this.ask(() => {
      this.cloth.lead(vertex, place, seconds);
      this.reference?.tell({ ask: "lead", vertex, place, seconds });
    });
  release = (vertex) =>
    this.ask(() => {
      this.cloth.release(vertex);
      this.reference?.tell({ ask: "release", vertex });
    });

  set(changes) {
    this.ask(() => {
      this.cloth.set(changes);
      const { scene, stepLength: step } = this.cloth;
      this.reference?.tell({ ask: "change", changes, step, tolerance: scene.integrator.tolerance });
      this.say("");
    });
  }

  /** Follows the run with a reference from its next start on, or from now where it has not begun. */
  compare(whether) {
    this.#compare = whether;
    this.reference?.end();
    this.reference = whether && this.cloth.steps === 0 ? new Reference(this.cloth.scene, this.cloth.stepLength) : undefined;
  }

  /** Detects on the GPU from now on, or no more. */
  detect(whether) {
    this.ask(async () => {
      this.device = whether ? await this.cloth.openDevice() : undefined;
    });
  }

  #look() {
    const { cloth } = this;
    // With a device a step may be under way while the views are looked at.
    const kept = (view) => (this.device ? view.slice() : view);
    this.view = {
      positions: kept(cloth.positions()),
      normals: kept(cloth.normals()),
      strains: kept(cloth.strains()),
      bodies: cloth.bodies(),
      pins: Array.from(cloth.pins()),
    };
  }

  async #drain() {
    while (this.#todo.length > 0) {
      try {
        await this.#todo.shift()();
      } catch (error) {
        this.say(error.message, true);
      }
    }
  }

  async #step(count) {
    const { cloth } = this;
    this.hand.lead(count * cloth.stepLength);
    await this.#drain();
    const began = performance.now();
    let taken = 0;
    while (taken < count && (taken === 0 || performance.now() - began < BUDGET)) {
      if (this.device) await cloth.awaitStep();
      else cloth.step();
      taken += 1;
    }
    this.reference?.reached(cloth.time, cloth.positions());
    return taken * cloth.stepLength;
  }

  /** Goes on by one step. */
  one() {
    this.ask(() => this.#advance(this.cloth.stepLength));
  }

  async #advance(seconds) {
    const count = Math.floor(seconds / this.cloth.stepLength + 1e-6);
    if (count === 0) return 0;
    try {
      return await this.#step(count);
    } catch (error) {
      this.paused = true;
      this.say(`${error.message}\nA shorter step, softer cloth or an implicit method may hold; Reset begins anew.`, true);
      return 0;
    }
  }

  /** A picture's worth of time. */
  async tick(seconds) {
    await this.#drain();
    if (!this.paused) {
      this.#due = Math.min(this.#due + Math.min(seconds, LONGEST), Math.max(LONGEST, this.cloth.stepLength));
      const passed = await this.#advance(this.#due);
      // What there was no time for is not made up for.
      this.#due = passed > 0 ? Math.max(0, Math.min(this.#due - passed, this.cloth.stepLength)) : this.#due;
      this.speed += 0.05 * (passed / Math.max(seconds, 1e-3) - this.speed);
    }
    const note = this.cloth.takeNote();
    if (note) this.say(note, true);
    this.#look();
    this.picture.draw(this.view);
  }
}

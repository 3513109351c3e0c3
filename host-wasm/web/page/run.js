// The current cloth and its time. Requests wait until no step is running.

import { Cloth, changed } from "../muslin.js";
import { Reference } from "./reference.js";

/** Longest time that one frame may advance, s. After a stall or behind another tab the cloth does not catch up. */
const LONGEST = 1 / 15;
/** Time for steps before the next frame is drawn, ms. */
const BUDGET = 24;

/** What makes a run accurate: step, s, error of a step, m, and tolerance of the solver. */
const accuracy = ({ stepLength: step, stepError: error, scene }) => ({ step, error, tolerance: scene.integrator?.tolerance });

export class Run {
  #todo = [];
  #due = 0;
  #ones = 0;
  /** Whether a reference follows the run from its start on. */
  comparing = false;
  paused = false;
  /** Simulated time over real time. */
  speed = 1;

  constructor(scene, changes, picture, hand, say) {
    Object.assign(this, { picture, hand, say });
    this.open(scene, changes);
  }

  /** Starts a scene, a new one or the same again. Throws if the scene is not valid. */
  open(scene, changes) {
    const cloth = new Cloth(changed(scene, changes));
    const last = this.cloth;
    this.cloth = cloth;
    this.device = undefined;
    try {
      last?.free();
    } catch {
      // A cloth that failed inside the module cannot be freed.
    }
    this.picture.triangles(cloth.triangles());
    this.#look();
    this.compare(this.comparing);
  }

  /** Queues an action that runs between steps. */
  ask(what) {
    this.#todo.push(what);
  }

  // The interface for the hand.
  positions = () => this.view.positions;
  pins = () => this.view.pins;
  moveTo = (...given) => this.ask(() => this.#moveTo(...given));
  release = (vertex) =>
    this.ask(() => {
      this.cloth.release(vertex);
      this.reference?.tell({ ask: "release", vertex, time: this.cloth.time });
    });

  #moveTo = (vertex, place, seconds) => {
    this.cloth.moveTo(vertex, place, seconds);
    this.reference?.tell({ ask: "moveTo", vertex, place, seconds, time: this.cloth.time });
  };

  /** Changes values at keys of the scene. Call it between steps. */
  set(changes) {
    const before = this.cloth.time;
    this.cloth.set(changes);
    this.reference?.tell({ ask: "change", changes, ...accuracy(this.cloth), time: before, after: this.cloth.time });
  }

  /** Switches the reference on or off. It starts now if no step was taken, otherwise at the next start of the run. */
  compare(whether) {
    this.comparing = whether;
    this.reference?.end();
    this.reference = whether && this.cloth.steps === 0 ? new Reference(this.cloth.scene, accuracy(this.cloth)) : undefined;
  }

  /** Switches detection on the GPU on or off. Call it between steps. */
  async detect(whether) {
    this.device = whether ? await this.cloth.openDevice() : undefined;
  }

  #look() {
    const { cloth } = this;
    const view = { bodies: cloth.bodies(), pins: Array.from(cloth.pins()) };
    // Copies, because the module's memory may move, and a step on a device may run while they are used.
    for (const name of ["positions", "normals", "strains"]) view[name] = cloth[name]().slice();
    this.view = view;
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
    const began = performance.now();
    let taken = 0;
    while (taken < count && (taken === 0 || performance.now() - began < BUDGET)) {
      this.hand.moveTo(cloth.stepLength, this.#moveTo);
      if (this.device) await cloth.awaitStep();
      else cloth.step();
      taken += 1;
    }
    this.reference?.reached(cloth.time, cloth.positions());
    return taken * cloth.stepLength;
  }

  /** Takes one step at the next frame, paused or not. */
  one() {
    this.#ones += 1;
  }

  async #advance(seconds) {
    const count = Math.floor(seconds / this.cloth.stepLength + 1e-6);
    if (count === 0) return 0;
    try {
      return await this.#step(count);
    } catch (error) {
      this.paused = true;
      this.say(`${error.message}\nTry a shorter step, softer cloth or an implicit method, then Reset.`, true);
      return 0;
    }
  }

  /** Advances by the time of one frame, s, and draws. */
  async tick(seconds) {
    await this.#drain();
    for (; this.#ones > 0; this.#ones--) await this.#advance(this.cloth.stepLength);
    if (!this.paused) {
      this.#due = Math.min(this.#due + Math.min(seconds, LONGEST), Math.max(LONGEST, this.cloth.stepLength));
      const passed = await this.#advance(this.#due);
      // Time that the budget did not suffice for is dropped, except for at most one step.
      this.#due = passed > 0 ? Math.max(0, Math.min(this.#due - passed, this.cloth.stepLength)) : this.#due;
      this.speed += 0.05 * (passed / Math.max(seconds, 1e-3) - this.speed);
    }
    const note = this.cloth.takeNote();
    if (this.device && !this.cloth.hasDevice) this.device = undefined;
    if (note) this.say(note, true);
    this.#look();
    this.picture.draw(this.view);
  }
}

// Whole steps for the time that passes, within a budget.

import type { Advanced } from "./results.js";

export class Pace {
  /** Time that no step has covered yet, s: at most half a step, more or less. */
  #due = 0;

  /**
   * Takes the steps that are nearest to the time of all calls. After `budget` ms of work it drops the rest.
   * `take` takes one step and returns whether another one may follow.
   */
  advance(seconds: number, step: number, budget: number, take: () => boolean): Advanced {
    const began = performance.now();
    this.#due += seconds;
    let steps = 0;
    // Half a step early or late, so that frames of uneven length take the same number of steps.
    while (this.#due >= 0.5 * step) {
      if (steps > 0 && performance.now() - began >= budget) {
        const dropped = this.#due;
        this.#due = 0;
        return { steps, dropped };
      }
      this.#due -= step;
      if (!take()) {
        this.#due = 0;
        break;
      }
      steps += 1;
    }
    return { steps, dropped: 0 };
  }
}

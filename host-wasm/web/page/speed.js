// The speed of a run: simulated time over real time, over the last two seconds.

/** The time that counts, ms. */
const SPAN = 2000;
/** The speed from which a run keeps up with real time. */
const KEPT = 0.98;

export class Speed {
  /** Times of the clock, ms, and the simulated time of the steps that ended then, s. */
  #steps = [];
  /** The number of steps at the beginning that no longer count, and the simulated time of those after the first that counts. */
  #old = 0;
  #simulated = 0;
  #last = 0;

  /** Starts over, for example after a pause. */
  clear() {
    this.#steps = [];
    this.#old = 0;
    this.#simulated = 0;
  }

  /** A step ended at this time of the clock, ms, or no step was due then. */
  add(now, seconds) {
    this.#last = now;
    const isFirst = this.#steps.length === 0;
    if (!isFirst) this.#simulated += seconds;
    if (isFirst || seconds > 0) this.#steps.push([now, seconds]);
    while (this.#steps.length - this.#old > 2 && now - this.#steps[this.#old + 1][0] > SPAN) {
      this.#old += 1;
      this.#simulated -= this.#steps[this.#old][1];
    }
    if (this.#old > this.#steps.length / 2) {
      this.#steps = this.#steps.slice(this.#old);
      this.#old = 0;
    }
  }

  /** Simulated time over real time; undefined before the second step has ended. */
  get value() {
    const count = this.#steps.length - this.#old - 1;
    if (count < 1) return undefined;
    // Up to the last step: since then, time passes for the next one.
    const until = Math.max(this.#steps.at(-1)[0], this.#last - (1000 * this.#simulated) / count);
    return (1000 * this.#simulated) / (until - this.#steps[this.#old][0]);
  }

  /** Whether the run keeps up with real time. */
  get isKept() {
    return this.value >= KEPT;
  }
}

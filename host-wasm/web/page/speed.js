// The speed of a run: simulated time over real time, over the last two seconds.

/** The time that counts, ms. */
const SPAN = 2000;
/** The speed from which a run keeps up with real time. */
const KEPT = 0.98;

export class Speed {
  /** Times of the clock, ms, and the simulated time of the steps that ended then, s. */
  #steps = [];
  #last = 0;

  /** Starts over, for example after a pause. */
  clear() {
    this.#steps = [];
  }

  /** A step ended at this time of the clock, ms, or no step was due then. */
  add(now, seconds) {
    this.#last = now;
    if (seconds > 0 || this.#steps.length === 0) this.#steps.push([now, seconds]);
    while (this.#steps.length > 2 && now - this.#steps[1][0] > SPAN) this.#steps.shift();
  }

  /** Simulated time over real time; undefined before the second step has ended. */
  get value() {
    const [first, ...rest] = this.#steps;
    if (rest.length === 0) return undefined;
    const simulated = rest.reduce((sum, [, seconds]) => sum + seconds, 0);
    // Up to the last step: since then, time passes for the next one.
    const until = Math.max(rest.at(-1)[0], this.#last - (1000 * simulated) / rest.length);
    return (1000 * simulated) / (until - first[0]);
  }

  /** Whether the run keeps up with real time. */
  get isKept() {
    return this.value >= KEPT;
  }
}

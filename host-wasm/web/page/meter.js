// The numbers of a run, over the steps since they were read last.

const NONE = { predict: 0, broadPhase: 0, narrowPhase: 0, response: 0 };

export class Meter {
  #before = {};
  #last;

  /** Counts and times per step since the last reading. They start over with another cloth or step. */
  read(cloth) {
    const { stretch, energy, proximity, impacts } = cloth.summary();
    const now = { cloth, steps: cloth.steps, step: cloth.stepLength, contacts: proximity + impacts };
    // The number of steps is the simulated time divided by their length.
    const isSame = now.cloth === this.#before.cloth && now.step === this.#before.step;
    const taken = isSame ? now.steps - this.#before.steps : -1;
    if (taken < 0) this.#last = { contacts: 0, times: NONE };
    if (taken !== 0) {
      const times = cloth.takeTimes();
      if (taken > 0) {
        const per = ([part, ms]) => [part, ms / taken];
        this.#last = {
          contacts: (now.contacts - this.#before.contacts) / taken,
          times: Object.fromEntries(Object.entries(times).map(per)),
        };
      }
      this.#before = now;
    }
    const joules = Object.values(energy).reduce((sum, part) => sum + part, 0);
    return { stretch: stretch.max, energy: joules, warnings: cloth.warnings(), ...this.#last };
  }
}

// The current error of the run: a worker simulates the same scene with shorter steps, and repeats every action of
// the user. It runs in the time that is left: on few cores it goes on only while the run keeps up with real time.

import { areFarApart, rms } from "./error.js";

/** Most states that wait for the reference. Further ones are skipped until fewer wait. */
const MOST = 8;
/** Most actions and states that wait. With more the reference would never be reached. */
const FULL = 20_000;
/** Cores from which the reference takes no time from the run: the page, the run and the reference have one each. */
const CORES = 3;

export class Reference {
  #worker;
  /** Actions and states in the order of their times, and the positions of states that were sent. */
  #queue = [];
  #waiting = new Map();
  /** States in the queue or sent. */
  #states = 0;
  /** {time, error, isFar}, s and m, of the last state that the reference has reached. */
  last;
  /** The reason why there is no reference. */
  why;
  /** Whether it waits until the run leaves time for it. */
  waits = false;

  constructor(scene, accuracy) {
    this.#worker = new Worker(new URL("worker.js", import.meta.url), { type: "module" });
    this.#worker.onmessage = ({ data }) => this.#hear(data);
    this.#worker.onerror = ({ message }) => this.#give_up(message ?? "the worker does not start");
    this.tell({ ask: "start", scene, ...accuracy });
  }

  /** Repeats an action of the user at its time. */
  tell(action) {
    if (this.why !== undefined) return;
    this.#queue.push(action);
    if (this.#queue.length > FULL) this.#give_up("the reference is too slow to follow");
  }

  /** Reports that the run has reached this time with these positions. */
  reached(time, positions) {
    if (this.why !== undefined || this.#states >= MOST) return;
    this.#states += 1;
    this.#queue.push({ ask: "until", time, positions: positions.slice() });
  }

  /** Goes on with the queue, up to the next state. `isFree`: the run leaves time for it. */
  goOn(isFree = true) {
    this.waits = !isFree && navigator.hardwareConcurrency < CORES;
    if (this.#waiting.size > 0 || this.waits) return;
    while (this.#queue.length > 0 && this.#waiting.size === 0) {
      const { positions, ...action } = this.#queue.shift();
      if (positions) this.#waiting.set(action.time, positions);
      this.#worker.postMessage(action);
    }
  }

  #hear({ kind, time, positions, why }) {
    if (kind === "failed") return this.#give_up(why);
    const own = this.#waiting.get(time);
    this.#waiting.delete(time);
    this.#states -= 1;
    if (own?.length !== positions.length) return;
    const error = rms(own, positions);
    this.last = { time, error, isFar: areFarApart(error, positions) };
  }

  #give_up(why) {
    this.why = why;
    this.#queue = [];
    this.#waiting.clear();
    this.end();
  }

  end() {
    this.#worker.terminate();
  }
}

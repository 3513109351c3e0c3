// The current error of the run: a worker simulates the same scene with shorter steps, and repeats every action of
// the user.

import { rms } from "./error.js";

/** Most frames that wait for the reference. Further frames are skipped until fewer wait. */
const MOST = 8;

export class Reference {
  #worker;
  #waiting = new Map();
  /** {time, error}, s and m, of the last frame that the reference has reached. */
  last;
  /** The reason why there is no reference. */
  why;

  constructor(scene, accuracy) {
    this.#worker = new Worker(new URL("worker.js", import.meta.url), { type: "module" });
    this.#worker.onmessage = ({ data }) => this.#hear(data);
    this.#worker.onerror = ({ message }) => this.#give_up(message ?? "the worker does not start");
    this.tell({ ask: "start", scene, ...accuracy });
  }

  /** Sends an action to the worker, which advances the reference to the page's time and repeats the action there. */
  tell(what) {
    if (this.why === undefined) this.#worker.postMessage(what);
  }

  /** Reports that the page's run has reached this time with these positions. */
  reached(time, positions) {
    if (this.why !== undefined || this.#waiting.size >= MOST) return;
    this.#waiting.set(time, positions.slice());
    this.tell({ ask: "until", time });
  }

  #hear({ kind, time, positions, why }) {
    if (kind === "failed") return this.#give_up(why);
    const own = this.#waiting.get(time);
    this.#waiting.delete(time);
    if (own?.length === positions.length) this.last = { time, error: rms(own, positions) };
  }

  #give_up(why) {
    this.why = why;
    this.#waiting.clear();
    this.end();
  }

  end() {
    this.#worker.terminate();
  }
}

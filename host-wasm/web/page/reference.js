// The error of the run in view, live: a worker takes the same scene in shorter steps, and is told of every hand.

import { rms } from "./error.js";

/** Pictures that wait for the reference; those after them are passed over until there is room. */
const MOST = 8;

export class Reference {
  #worker;
  #waiting = new Map();
  /** {time, error}, s and m, of the last picture that the reference has reached. */
  last;
  /** The reason why there is no reference. */
  why;

  constructor(scene, step) {
    this.#worker = new Worker(new URL("worker.js", import.meta.url), { type: "module" });
    this.#worker.onmessage = ({ data }) => this.#hear(data);
    this.#worker.onerror = ({ message }) => this.#give_up(message ?? "the worker does not start");
    this.tell({ ask: "start", scene, step });
  }

  /** Lets it go on to the page's time, and do there what the page did. */
  tell(what) {
    if (this.why === undefined) this.#worker.postMessage(what);
  }

  /** The page's run is at this time, with these positions. */
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

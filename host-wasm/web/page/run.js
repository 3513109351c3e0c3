// The page's side of the run: it sends requests to the worker that takes the steps, and keeps the latest states.

/** Longest step whose states are drawn as they come, s. States of longer steps are interpolated. */
const EVEN = 1 / 50;
/** Longest time between two states that are interpolated, ms. */
const LONGEST = 250;
/** Time after which a worker that does not answer is replaced, ms. A step is given up after two seconds, on the device later. */
const PATIENCE = 12_000;

export class Run {
  #worker;
  /** Whether the worker has started. */
  #isReady = false;
  #answers = new Map();
  #last = 0;
  #todo = Promise.resolve();
  #paused = false;
  #comparing = false;
  /** The numbers of the cloth in view and of the latest one. The hand's requests name theirs, and others are ignored. */
  #number = 0;
  #latest = 0;
  /** The state before the latest one, and a state between them. */
  #before;
  #between = {};
  /** The time at which the latest state came, and the time between it and the one before, ms. */
  #came = 0;
  #gap = 0;
  /** Older states that the worker has not got back. */
  #seen = [];
  /** The settings of the cloth: its scene, its step, and the number of its vertices. */
  cloth;
  /** The latest state: the columns that are drawn, pins, colliders, steps taken and simulated time. */
  view;
  /** The latest numbers. */
  numbers;
  /** The name of the device that finds the candidates. */
  device;
  /** Whether the run has stopped by itself, and nobody has continued it. */
  hasStopped = false;

  /** `say(text, bad)` shows a message, `stopped()` is called when the run has stopped by itself. */
  constructor(picture, say, stopped) {
    Object.assign(this, { picture, say, stopped });
    /** Resolves to the texts of the built-in scenes, by name. */
    this.ready = new Promise((resolve, reject) => {
      this.#hear.ready = ({ texts }) => {
        this.#isReady = true;
        resolve(texts);
      };
      this.#hear.failed = ({ why }) => {
        reject(new Error(why));
        // One that does not start would fail again.
        if (this.#isReady) this.#replace(`${why}\nPress Reset.`);
        else this.say(why, true);
      };
    });
    this.#begin();
  }

  #begin() {
    this.#isReady = false;
    this.#worker = new Worker(new URL("simulator.js", import.meta.url), { type: "module" });
    this.#worker.onmessage = ({ data }) => this.#hear[data.kind](data);
    this.#worker.onerror = ({ message }) => this.#hear.failed({ why: message ?? "the worker does not start" });
  }

  /** Starts another worker in place of one that failed. The last state stays in view. */
  #replace(why) {
    this.#worker.terminate();
    this.#seen = [];
    this.#before = undefined;
    if (this.view) this.view = { ...this.view, isKept: true };
    for (const { reject } of this.#answers.values()) reject(new Error(why));
    this.#answers.clear();
    this.#begin();
    // Without a limit: a worker that does not start must not be replaced again and again.
    this.#tell("compare", { whether: this.#comparing });
    this.paused = this.#paused;
    this.say(why, true);
  }

  #hear = {
    state: ({ view }) => this.#look(view),
    numbers: (numbers) => {
      this.numbers = numbers;
    },
    answer: ({ id, told, why }) => {
      const { resolve, reject } = this.#answers.get(id) ?? {};
      this.#answers.delete(id);
      if (why === undefined) resolve?.(told);
      else reject?.(new Error(why));
    },
    note: ({ note, device }) => {
      this.device = device;
      this.say(note, true);
    },
    stopped: ({ why }) => {
      this.#paused = this.hasStopped = true;
      this.stopped();
      this.say(why, true);
    },
  };

  #look(view) {
    if (this.#before) this.#seen.push(this.#before);
    this.#before = this.view;
    this.view = view;
    const now = performance.now();
    this.#gap = Math.min(now - this.#came, LONGEST);
    this.#came = now;
  }

  /** Sends a request. The promise ends when it is done. */
  #request(ask, given = {}) {
    return new Promise((resolve, reject) => {
      this.#last += 1;
      this.#answers.set(this.#last, { resolve, reject });
      this.#worker.postMessage({ id: this.#last, ask, ...given });
    });
  }

  /** Sends a request, and replaces the worker if it does not answer. */
  async #timely(ask, given) {
    const timer = setTimeout(() => this.#replace("a step took too long and was given up: press Reset"), PATIENCE);
    return this.#request(ask, given).finally(() => clearTimeout(timer));
  }

  /** Sends a request that begins with a scene. If the worker does not come to it, another one tries once. */
  #anew(ask, given) {
    const worker = this.#worker;
    return this.#timely(ask, given).catch((error) => {
      if (this.#worker === worker) throw error;
      return this.#timely(ask, given);
    });
  }

  /** Sends a request whose end nothing waits for. Its error is shown. */
  #tell(ask, given) {
    this.#request(ask, given).catch((error) => this.say(error.message, true));
  }

  /** Sends a request of the hand, about the cloth in view. */
  #about(ask, given) {
    this.#tell(ask, { ...given, number: this.#number });
  }

  /** Starts a scene, a new one or the same again. Throws if the scene is not valid. `isFirst`: another follows at once. */
  async open(scene, changes, isFirst = false) {
    this.#latest += 1;
    const number = this.#latest;
    const { surface, view, ...settings } = await this.#anew("open", { scene, changes, isFirst, number });
    this.#number = number;
    this.device = undefined;
    this.numbers = undefined;
    this.hasStopped = false;
    this.cloth = settings;
    this.#look({ ...view, isKept: true });
    // Nothing lies between the states of two cloths.
    if (this.#before) this.#seen.push(this.#before);
    this.#before = undefined;
    this.picture.show(surface, view);
  }

  /** Chooses the detail of a scene that this machine simulates in real time; the changes of the user stay. */
  choose = (scene, changes, isImplicit) => this.#anew("choose", { scene, changes, isImplicit });

  /** Changes values at keys of the scene. */
  async set(changes) {
    this.cloth = await this.#timely("set", { changes });
  }

  /** Switches the reference on or off. It starts with the next scene. */
  compare(whether) {
    this.#comparing = whether;
    return this.#timely("compare", { whether });
  }

  /** Switches detection on the GPU on or off. */
  async detect(whether) {
    ({ device: this.device } = await this.#timely("detect", { whether }));
  }

  /** Queues an action, which begins when those before it have ended. Its error is shown. */
  ask(action) {
    this.#todo = this.#todo.then(action).catch((error) => this.say(error.message, true));
    return this.#todo;
  }

  get paused() {
    return this.#paused;
  }

  set paused(whether) {
    this.#paused = whether;
    if (!whether) this.hasStopped = false;
    this.#tell("pause", { whether });
  }

  /** Takes one step, paused or not. */
  one = () => this.#tell("one");

  // The interface for the hand.
  positions = () => this.view?.positions ?? new Float32Array();
  pins = () => Array.from(this.view.pins);
  lead = (vertex, to) => this.#about("lead", { vertex, to });
  drop = () => this.#about("drop");
  fly = (from, to) => this.#request("fly", { from, to });
  pin = (vertex) => this.#about("pin", { vertex });
  release = (vertex) => this.#about("release", { vertex });

  /** Draws the latest state. The columns of those before go back, so that the worker allocates none. */
  draw() {
    for (const { positions, normals, strains, isKept } of this.#seen.splice(0)) {
      if (isKept) continue;
      const columns = { positions, normals, strains };
      const buffers = Object.values(columns).map(({ buffer }) => buffer);
      this.#worker.postMessage({ ask: "back", view: columns }, buffers);
    }
    if (this.view) this.picture.refresh(this.#now());
  }

  /** The state to draw at this time. */
  #now() {
    const [from, to, { stepLength }] = [this.#before, this.view, this.cloth];
    const part = (performance.now() - this.#came) / this.#gap;
    if (!from || stepLength <= EVEN || part >= 1 || from.steps >= to.steps) return to;
    const mix = (name, from, to) => {
      if (this.#between[name]?.length !== to.length) this.#between[name] = to.slice();
      const out = this.#between[name];
      for (let k = 0; k < out.length; k++) out[k] = from[k] + part * (to[k] - from[k]);
      return out;
    };
    const [positions, normals] = ["positions", "normals"].map((name) => mix(name, from[name], to[name]));
    const bodies = to.bodies.map((body, k) => ({
      ...body,
      points: mix(`body ${k}`, from.bodies[k]?.points ?? body.points, body.points).slice(),
    }));
    return { ...to, positions, normals, bodies };
  }
}

// The page's side of the run: it sends requests to the worker that takes the steps, and keeps the latest states.

/** Longest step whose states are drawn as they come, s. Between those of longer steps the cloth moves evenly, as in the step. */
const EVEN = 1 / 50;

export class Run {
  #worker = new Worker(new URL("simulator.js", import.meta.url), { type: "module" });
  #answers = new Map();
  #last = 0;
  #todo = Promise.resolve();
  #paused = false;
  /** The state before the latest one, the time at which that came, ms, and a state between them. */
  #before;
  #came = 0;
  #between = {};
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

  /** `say(text, bad)` shows a message, `stopped()` is called when the run has stopped by itself. */
  constructor(picture, say, stopped) {
    Object.assign(this, { picture, say, stopped });
    this.#worker.onmessage = ({ data }) => this.#hear[data.kind](data);
    /** Resolves to the texts of the built-in scenes, by name. */
    this.ready = new Promise((resolve, reject) => {
      this.#hear.ready = ({ texts }) => resolve(texts);
      this.#hear.failed = ({ why }) => reject(new Error(why));
      this.#worker.onerror = ({ message }) => reject(new Error(message ?? "the worker does not start"));
    });
  }

  #hear = {
    state: ({ view }) => this.#look(view),
    numbers: (numbers) => {
      this.numbers = numbers;
    },
    answer: ({ id, told, why }) => {
      const { resolve, reject } = this.#answers.get(id);
      this.#answers.delete(id);
      if (why === undefined) resolve(told);
      else reject(new Error(why));
    },
    note: ({ note, device }) => {
      this.device = device;
      this.say(note, true);
    },
    stopped: ({ why }) => {
      this.#paused = true;
      this.stopped();
      this.say(why, true);
    },
  };

  #look(view) {
    if (this.#before) this.#seen.push(this.#before);
    this.#before = this.view;
    this.view = view;
    this.#came = performance.now();
  }

  /** Sends a request. The promise ends when it is done. */
  #request(ask, given = {}) {
    return new Promise((resolve, reject) => {
      this.#last += 1;
      this.#answers.set(this.#last, { resolve, reject });
      this.#worker.postMessage({ id: this.#last, ask, ...given });
    });
  }

  /** Starts a scene, a new one or the same again. Throws if the scene is not valid. */
  async open(scene, changes) {
    const { surface, view, ...settings } = await this.#request("open", { scene, changes });
    this.device = undefined;
    this.cloth = settings;
    this.#look({ ...view, isFirst: true });
    // Nothing lies between the states of two cloths.
    if (this.#before) this.#seen.push(this.#before);
    this.#before = undefined;
    this.picture.show(surface, view);
  }

  /** Chooses the detail of a scene that this machine simulates in real time; the changes of the user stay. */
  choose = (scene, changes, isImplicit) => this.#request("choose", { scene, changes, isImplicit });

  /** Changes values at keys of the scene. */
  async set(changes) {
    this.cloth = await this.#request("set", { changes });
  }

  /** Switches the reference on or off. It starts now if no step was taken, otherwise at the next start of the run. */
  compare = (whether) => this.#request("compare", { whether });

  /** Switches detection on the GPU on or off. */
  async detect(whether) {
    ({ device: this.device } = await this.#request("detect", { whether }));
  }

  /** Queues an action, which begins when those before it have ended. Its error is shown. */
  ask(what) {
    this.#todo = this.#todo.then(what).catch((error) => this.say(error.message, true));
    return this.#todo;
  }

  get paused() {
    return this.#paused;
  }

  set paused(whether) {
    this.#paused = whether;
    this.#request("pause", { whether });
  }

  /** Takes one step, paused or not. */
  one = () => this.#request("one");

  // The interface for the hand.
  positions = () => this.view.positions;
  pins = () => Array.from(this.view.pins);
  lead = (vertex, to) => this.#request("lead", { vertex, to });
  drop = () => this.#request("drop");
  fly = (from, to) => this.#request("fly", { from, to });
  pin = (vertex) => this.#request("pin", { vertex });
  release = (vertex) => this.#request("release", { vertex });

  /** Draws the latest state. The columns of those before go back, so that the worker allocates none. */
  draw() {
    for (const { positions, normals, strains, isFirst } of this.#seen.splice(0)) {
      if (isFirst) continue;
      const columns = { positions, normals, strains };
      const buffers = Object.values(columns).map(({ buffer }) => buffer);
      this.#worker.postMessage({ ask: "back", view: columns }, buffers);
    }
    if (this.view) this.picture.refresh(this.#now());
  }

  /** The state to draw at this time. */
  #now() {
    const [from, to, { stepLength }] = [this.#before, this.view, this.cloth];
    const part = (performance.now() - this.#came) / 1000 / stepLength;
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

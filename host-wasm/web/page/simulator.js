// The worker that takes the steps: it answers the page's requests, and sends states and numbers.

import { Cloth, changed, load, scenes, source } from "../muslin.js";
import { Ball, seen, withBall, withoutBall } from "./ball.js";
import { Hold } from "./hold.js";
import { choose } from "./live.js";
import { Meter } from "./meter.js";
import { Reference } from "./reference.js";
import { Speed } from "./speed.js";
import { point } from "./vector.js";

/** Longest time that the cloth makes up for, s. After a stall or behind another tab it does not catch up. */
const LONGEST = 1 / 8;
/** Time after which the cloth waits for a page that takes no states, ms. */
const PATIENCE = 250;
/** States under way to the page. */
const FRAMES = 3;
/** Time between numbers, ms. */
const BETWEEN = 250;
const COLUMNS = ["positions", "normals", "strains"];

const requests = [];
let cloth;
/** The number of the cloth, which the page gives. */
let number = 0;
let reference;
let hold;
let ball;
let paused = false;
let comparing = false;
/** Steps to take although the run is paused. */
let ones = 0;
/** Time that no step has covered yet, s, and the time of the clock up to which it was counted, ms. */
let due = 0;
let counted = performance.now();
/** Columns that the page gave back. */
let spare = [];
/** Coordinates of a state. */
let coordinates = 0;
/** States that the page has, and the time at which the last one was sent, ms. */
let sent = 0;
let sentAt = 0;
/** Whether the cloth waits because the page takes no states. */
let waits = false;
/** Whether the page has not seen the latest state. */
let isNew = false;
/** Whether the page has drawn since the last step. */
let drew = false;
let numbersAt = 0;
/** The name of the device that finds the candidates. */
let device;
/** Why the last step was taken back. */
let trouble;
const speed = new Speed();
const meter = new Meter();

/** What makes a run accurate: step, s, error of a step, m, and tolerance of the solver. */
const accuracy = () => ({ step: cloth.stepLength, error: cloth.stepError, tolerance: cloth.scene.integrator?.tolerance });

/** The settings of the cloth that the page shows. */
const settings = () => ({
  scene: ball ? withoutBall(cloth.scene) : cloth.scene,
  hasBall: Boolean(ball),
  stepLength: cloth.stepLength,
  stepError: cloth.stepError,
  vertexCount: cloth.vertexCount,
});

/** The present state, in columns that the page gave back. */
function state() {
  const columns = spare.pop() ?? {};
  for (const name of COLUMNS) {
    const own = cloth[name]();
    if (columns[name]?.length === own.length) columns[name].set(own);
    else columns[name] = own.slice();
  }
  const bodies = seen(cloth.bodies(), ball);
  const pins = cloth.pins();
  const marked = hold ? [...pins, hold.vertex] : pins;
  return { ...columns, pins, marked, held: hold?.vertex, bodies, steps: cloth.steps, time: cloth.time, isStill: paused };
}

const buffers = (view) => COLUMNS.map((name) => view[name].buffer);

function send() {
  const view = state();
  postMessage({ kind: "state", view }, buffers(view));
  sent += 1;
  sentAt = performance.now();
  isNew = false;
}

/** Lets the held vertex go. */
function drop() {
  const last = hold;
  hold = undefined;
  if (last) pull(last, [0, 0, 0]);
}

/** Sets the force on each vertex that is held. */
function pull({ vertices }, force) {
  for (const vertex of vertices) cloth.setForce(vertex, force);
  repeat({ ask: "pull", vertices, force });
}

function restart() {
  speed.clear();
  due = 0;
  counted = performance.now();
}

/** Repeats an action in the reference. */
const repeat = (action) => reference?.tell({ ...action, time: cloth.time });

/** The requests of the page. An error is told to the page, and changes nothing. */
const asks = {
  // The changes of the user stay as they are.
  choose: ({ scene, changes, isImplicit }) => choose((live) => new Cloth(changed(scene, { ...live, ...changes })), scene, isImplicit),
  open({ scene, changes, isFirst, number: given }) {
    const next = new Cloth(withBall(changed(scene, changes)));
    let thrown;
    try {
      thrown = next.scene.contact && new Ball(next, repeat);
    } catch (error) {
      next.free();
      throw error;
    }
    cloth?.free();
    reference?.end();
    [cloth, ball, number] = [next, thrown, given];
    cloth.onDiverge = ({ message }) => {
      trouble = message;
    };
    coordinates = cloth.positions().length;
    [hold, device] = [undefined, undefined];
    spare = [];
    [ones, numbersAt] = [0, 0];
    restart();
    // The cloth of the first picture is not compared: the reference would disturb the measurement of the machine.
    reference = comparing && !isFirst ? new Reference(cloth.scene, accuracy()) : undefined;
    if (ball) repeat(ball.state());
    const view = state();
    return { ...settings(), surface: cloth.surface(), view };
  },
  set({ changes }) {
    const before = cloth.time;
    cloth.set(changes);
    reference?.tell({ ask: "change", changes, ...accuracy(), time: before, after: cloth.time });
    isNew = true;
    return settings();
  },
  compare({ whether }) {
    comparing = whether;
    if (whether) return;
    reference?.end();
    reference = undefined;
  },
  pause({ whether }) {
    if (paused !== whether) restart();
    paused = whether;
    isNew = true;
  },
  one() {
    ones += 1;
  },
  lead({ vertex, to }) {
    if (hold?.vertex !== vertex) {
      drop();
      hold = new Hold(vertex, to, cloth);
    }
    hold.to = to;
    isNew = true;
  },
  drop() {
    drop();
    isNew = true;
  },
  fly({ from, to }) {
    if (!ball) throw new Error("nothing touches the cloth of a scene without [contact]");
    ball.fly(from, to);
  },
  pin({ vertex }) {
    cloth.pin(vertex);
    repeat({ ask: "moveTo", vertex, place: point(cloth.positions(), vertex), seconds: 0 });
    isNew = true;
  },
  release({ vertex }) {
    cloth.release(vertex);
    repeat({ ask: "release", vertex });
    isNew = true;
  },
  detect: async ({ whether }) => {
    device = whether ? await cloth.openDevice() : undefined;
    return { device };
  },
};

/** Requests that need no cloth. */
const FREE = ["choose", "open", "compare", "pause"];

async function answer({ id, ask, ...given }) {
  try {
    if (!cloth && !FREE.includes(ask)) throw new Error("there is no cloth: press Reset");
    // Requests of the hand may be about the cloth before.
    const isOld = ask !== "open" && given.number !== undefined && given.number !== number;
    const told = isOld ? undefined : await asks[ask](given);
    postMessage({ kind: "answer", id, told }, told?.view ? buffers(told.view) : []);
  } catch (error) {
    postMessage({ kind: "answer", id, why: error.message });
  }
}

/** Takes a step. One that takes too long, or diverges, is taken back to a good state. */
async function takeStep() {
  if (device) return cloth.awaitStep();
  trouble = undefined;
  cloth.advance(cloth.stepLength);
  if (trouble === undefined) return;
  cloth.resume();
  // The reference is ahead of this state.
  reference?.end();
  reference = undefined;
  throw new Error(trouble);
}

async function step() {
  try {
    if (hold) pull(hold, hold.force(cloth.stepLength));
    ball?.before(cloth.stepLength);
    await takeStep();
    ball?.after();
  } catch (error) {
    // The module failed, and the cloth is lost.
    if (error.cause instanceof WebAssembly.RuntimeError) throw error;
    isNew = true;
    // The cloth may have no room between the ball and a pin, or be where the ball starts.
    if (ball?.isHere) return ball.stop();
    drop();
    paused = true;
    postMessage({ kind: "stopped", why: `${error.message}\nTry a shorter step, softer cloth or an implicit method, then Reset.` });
    return;
  }
  isNew = true;
  reference?.reached(cloth.time, cloth.positions());
}

/** Takes a step if one is due. Returns the time until the next one, ms. */
async function advance() {
  const now = performance.now();
  const did = waits;
  waits = sent >= FRAMES && now - sentAt > PATIENCE;
  if (did && !waits) restart();
  const passed = (now - counted) / 1000;
  counted = now;
  if (ones > 0) {
    ones -= 1;
    await step();
    return 0;
  }
  if (paused || waits) {
    reference?.goOn();
    return BETWEEN;
  }
  const length = cloth.stepLength;
  due = Math.min(due + passed, Math.max(LONGEST, length));
  // Up to half a step early when the page has just drawn, so that every picture has the same number of steps.
  const early = drew ? length / 2 : 1e-6;
  drew = false;
  if (due < length - early) {
    speed.add(now, 0);
    reference?.goOn();
    return 1000 * (length - due);
  }
  due -= length;
  await step();
  speed.add(performance.now(), paused ? 0 : length);
  reference?.goOn(speed.isKept);
  return 0;
}

function tell() {
  const note = cloth.takeNote();
  if (device && !cloth.hasDevice) device = undefined;
  if (note) postMessage({ kind: "note", note, device });
  const now = performance.now();
  if (now - numbersAt < BETWEEN) return;
  numbersAt = now;
  const error = reference && { why: reference.why, waits: reference.waits, ...reference.last };
  postMessage({ kind: "numbers", ...meter.read(cloth), time: cloth.time, speed: speed.value, paused, comparing, error });
}

const channel = new MessageChannel();
let wake = () => {};
channel.port1.onmessage = () => wake();

/** Waits for a time, ms, or for a message. Messages that have come are received even if the time is 0. */
const rest = (ms) =>
  new Promise((resolve) => {
    const timer = ms > 0 && setTimeout(resolve, ms);
    wake = () => {
      clearTimeout(timer);
      resolve();
    };
    if (!(ms > 0)) channel.port2.postMessage(0);
  });

self.onmessage = ({ data }) => {
  if (data.ask === "back") {
    sent -= 1;
    drew = true;
    if (data.view.positions.length === coordinates) spare.push(data.view);
  } else requests.push(data);
  wake();
};

async function start() {
  await load();
  postMessage({ kind: "ready", texts: Object.fromEntries(scenes().map((name) => [name, source(name)])) });
  for (;;) {
    while (requests.length > 0) await answer(requests.shift());
    let pause = BETWEEN;
    if (cloth) {
      pause = await advance();
      if (isNew && sent < FRAMES) send();
      tell();
    }
    await rest(pause);
  }
}

start().catch((error) => postMessage({ kind: "failed", why: error.message }));

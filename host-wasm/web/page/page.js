// The page: its controls change the scene, the run simulates it, and the address stores it.

import { load, scene as read, scenes, source, windy } from "../muslin.js";
import * as address from "./address.js";
import { Camera } from "./camera.js";
import { chart } from "./chart.js";
import { Hand } from "./hand.js";
import { materials } from "./materials.js";
import { IMPLICIT, METHODS } from "./methods.js";
import { Numbers } from "./numbers.js";
import { Picture } from "./picture.js";
import { Run } from "./run.js";

/** The terms by name: the key, and the value to use if the scene does not have the term. */
const TERMS = {
  shear: ["cloth.shear", { stiffness: 200 }],
  bend: ["cloth.bend", { model: "hinge", rigidity: 1e-5, damping: 0.001 }],
  drag: ["drag", { linear: 0.05 }],
  "self-collision": ["contact.self", true],
  friction: ["contact.friction", 0.3],
};
/** Simulated time that the chart measures, s. */
const CHARTED = 0.5;

const el = (id) => document.getElementById(id);
const list = (id, names) => el(id).append(...names.map((name) => new Option(name, name)));

/** The name of a scene that the user typed in. */
const OWN = "own";
const DETAILS = ["quick", "as in the scene"];
/** The largest error of a step of quick scenes, m. */
const QUICK_ERROR = 0.004;

const state = { scene: "ball", changes: {}, shown: {} };
/** The text of the scene that the user typed in last. */
let own;
let base;
let run;
let stop;
let firstFrame;

const pad = el("pad");
const camera = new Camera();

function say(text, bad = false) {
  const detect = run?.device ? `detection: ${run.device}, WebGPU` : "detection: processor";
  const banner = el("banner");
  banner.textContent = text || `${detect} · picture: ${picture.name ?? "…"}`;
  banner.classList.toggle("bad", bad);
}

const picture = new Picture(el("picture"), camera, new URLSearchParams(location.hash.slice(1)).get("draw"), say);
const hand = new Hand(pad, camera, {
  positions: () => run.positions(),
  pins: () => run.pins(),
  moveTo: (...given) => run.moveTo(...given),
  release: (vertex) => run.release(vertex),
});
const numbers = new Numbers(el("numbers"));

/** The value of a key in a scene; for a list, of its first item. */
function valueAt(scene, key) {
  return key.split(".").reduce((owner, part) => (Array.isArray(owner) ? owner[0] : owner)?.[part], scene);
}

const method_of = (scene) => scene.integrator?.method ?? "backward-euler";

/** The largest error of a step, m, for a method: a coarse one if the page is quick. Explicit methods have none. */
function step_error(scene, method) {
  if (!IMPLICIT.includes(method)) return undefined;
  const own = state.changes["integrator.error"] ?? scene.integrator?.error;
  return state.shown.detail ? own : Math.max(QUICK_ERROR, own ?? 0);
}

/** Makes a scene quick: half of the cells in each direction, and a solver that follows the error of a step. */
function quick(scene) {
  const changes = { "integrator.tolerance": undefined };
  const halved = (count) => (count > 5 ? Math.ceil(count / 2) : count);
  scene.cloth?.forEach?.(({ grid, tube, disc }, k) => {
    for (const [kind, of] of Object.entries({ grid, tube })) {
      if (Array.isArray(of?.cells)) changes[`cloth.${k}.${kind}.cells`] = of.cells.map(halved);
    }
    if (disc) changes[`cloth.${k}.disc.rings`] = halved(disc.rings);
  });
  return changes;
}

/** Sets the controls to the values of the scene. */
function show() {
  const { scene } = run.cloth;
  if (state.scene === OWN && !el("scene").querySelector(`[value=${OWN}]`)) list("scene", [OWN]);
  el("scene").value = state.scene;
  el("about").textContent = scene.description ?? "";
  el("detail").value = state.shown.detail ? DETAILS[1] : DETAILS[0];
  el("material").value = state.shown.material ?? "as in the scene";
  el("method").value = method_of(scene);
  el("length").value = +(1000 * run.cloth.stepLength).toPrecision(4);
  const wind = Math.hypot(...(steady(scene) ?? [0]));
  el("wind").value = el("speed").value = wind.toFixed(1);
  for (const [name, [key]] of Object.entries(TERMS)) {
    const box = el(name);
    const value = valueAt(scene, key);
    const assumed = key === "contact.self" && scene.contact !== undefined;
    box.checked = Boolean(value ?? assumed) && value !== 0;
    box.disabled = key.startsWith("contact.") && scene.contact === undefined;
  }
  el("strain").checked = picture.strain;
  address.write(state);
}

/** Stores changes, the latest ones last. A new value for a key removes older values for keys inside it. */
function keep(changes) {
  for (const [key, value] of Object.entries(changes)) {
    for (const old of Object.keys(state.changes)) {
      if (old === key || old.startsWith(`${key}.`)) delete state.changes[old];
    }
    state.changes[key] = value;
  }
}

/** Changes values, and stores those in `kept`. If one is refused, the scene and the controls stay as before. */
function change(changes, kept = changes) {
  attempt(() => {
    run.set(changes);
    keep(kept);
    say("");
    show();
  });
}

/** Starts a built-in scene, or a scene from a text. */
function open(name, text = name) {
  const scene = read(text);
  const changes = { ...(state.shown.detail ? {} : quick(scene)), ...state.changes };
  changes["integrator.error"] = step_error(scene, changes["integrator.method"] ?? method_of(scene));
  if (run) run.open(scene, changes);
  else run = new Run(scene, changes, picture, hand, say);
  base = scene;
  state.scene = name;
  hand.drop();
  camera.frame(run.positions());
  // The text of a scene that the user typed in is part of the address.
  if (name === OWN) state.shown.text = own = text;
  else delete state.shown.text;
  el("text").value = source(text) ?? text;
  say("");
  show();
  if (el("device").checked) device();
}

/** Runs an action between steps. An error is shown, and the state and the cloth stay as before. */
function attempt(what) {
  run.ask(() => {
    const before = { ...state, changes: { ...state.changes }, shown: { ...state.shown } };
    try {
      what();
    } catch (error) {
      Object.assign(state, before);
      show();
      throw error;
    }
  });
}

function reset() {
  run.paused = false;
  pause();
  attempt(() => open(state.scene, state.shown.text));
}

function pause(whether = run.paused) {
  run.paused = whether;
  el("pause").textContent = whether ? "Continue" : "Pause";
}

function strain(whether) {
  picture.strain = whether;
  if (whether) state.shown.strain = "1";
  else delete state.shown.strain;
  show();
}

/** The velocity of a scene's wind, m/s; of one that changes with time, the first. */
function steady(scene) {
  const velocity = scene.drag?.wind?.velocity;
  return velocity?.keys?.[0].slice(1) ?? velocity;
}

function wind(speed) {
  const { scene } = run.cloth;
  const way = [steady(scene), steady(base), [0.3, 0, -1]].find((way) => way && Math.hypot(...way) > 0);
  const size = Math.hypot(...way);
  const velocity = way.map((x) => (x / size) * speed);
  change({ "drag.wind": windy(scene, velocity) });
}

/** From the next step on, detects on the GPU if this is chosen and the scene has contact. */
function device() {
  run.ask(async () => {
    await run.detect(el("device").checked && run.cloth.scene.contact !== undefined).catch((error) => {
      el("device").checked = false;
      throw error;
    });
    say("");
  });
}

const KEYS = {
  " ": () => pause(!run.paused),
  ".": () => {
    pause(true);
    run.one();
  },
  r: reset,
  s: () => strain(!picture.strain),
};

function listen() {
  const anew = (name, text) =>
    attempt(() => {
      state.changes = {};
      delete state.shown.material;
      open(name, text);
    });
  el("scene").onchange = () => anew(el("scene").value, el("scene").value === OWN ? own : undefined);
  el("detail").onchange = () => {
    if (el("detail").value === DETAILS[0]) delete state.shown.detail;
    else state.shown.detail = "scene";
    reset();
  };
  el("pause").onclick = KEYS[" "];
  el("step").onclick = KEYS["."];
  el("reset").onclick = reset;
  el("material").onchange = () => {
    const name = el("material").value;
    attempt(() => {
      const keys = Object.keys(materials.silk);
      const values = materials[name] ?? Object.fromEntries(keys.map((key) => [key, valueAt(base, key)]));
      run.set(values);
      keep(values);
      if (materials[name]) state.shown.material = name;
      else {
        delete state.shown.material;
        keys.forEach((key) => delete state.changes[key]);
      }
      say("");
      show();
    });
  };
  el("method").onchange = () => {
    const method = { "integrator.method": el("method").value };
    change({ ...method, "integrator.error": step_error(base, el("method").value) }, method);
  };
  el("length").onchange = () => {
    const step = el("length").valueAsNumber / 1000;
    // With the error that the run has: a step alone would fix the length of all steps.
    run.ask(() => {
      const { stepError: error } = run.cloth;
      const own = { "integrator.step": step };
      const both = error ? { ...own, "integrator.error": error } : own;
      // The error of a quick scene belongs to its level of detail.
      if (step > 0) change(both, state.shown.detail ? both : own);
      else show();
    });
  };
  el("wind").oninput = () => (el("speed").value = el("wind").value);
  el("wind").onchange = () => wind(el("wind").valueAsNumber);
  el("strain").onchange = () => strain(el("strain").checked);
  el("compare").onchange = () =>
    run.ask(() => {
      run.compare(el("compare").checked);
      if (el("compare").checked) delete state.shown.compare;
      else state.shown.compare = "0";
      show();
    });
  el("device").onchange = device;
  el("chart").onclick = () => {
    if (stop) return stop();
    run.ask(() => {
      stop ??= chart(el("plot"), run.cloth, CHARTED, () => {
        el("chart").textContent = "Speed against accuracy";
        stop = undefined;
      });
      el("chart").textContent = "Stop measuring";
    });
  };
  el("use").onclick = () => anew(OWN, el("text").value);
  addEventListener("keydown", (event) => {
    const key = event.key.length === 1 ? event.key.toLowerCase() : event.key;
    const typing = event.target.closest("select, textarea, input:not([type=checkbox])");
    if (event.ctrlKey || event.metaKey || event.altKey || typing) return;
    if (key === " " && event.target !== pad && event.target !== document.body) return;
    if (KEYS[key]) event.repeat || KEYS[key]();
    else if (!hand.key(key)) return;
    event.preventDefault();
  });
}

/** Creates a checkbox for each term. */
function terms() {
  for (const [name, [key, fallback]] of Object.entries(TERMS)) {
    const label = document.createElement("label");
    const box = Object.assign(document.createElement("input"), { type: "checkbox", id: name });
    box.onchange = () => {
      const off = key === "contact.self" ? false : key === "contact.friction" ? 0 : undefined;
      change({ [key]: box.checked ? valueAt(base, key) || fallback : off });
    };
    label.append(box, ` ${name}`);
    el("terms").append(label);
  }
}

/** Whether there is a GPU, and whether it is worth using: software that emulates one is slower than the processor. */
async function offered() {
  const adapter = await navigator.gpu?.requestAdapter();
  const software =
    adapter?.info?.isFallbackAdapter || /swiftshader|llvmpipe/i.test(`${adapter?.info?.architecture} ${adapter?.info?.description}`);
  return { some: Boolean(adapter), worth: Boolean(adapter) && !software };
}

async function start() {
  await load();
  list("scene", scenes());
  list("detail", DETAILS);
  list("material", ["as in the scene", ...Object.keys(materials)]);
  list("method", METHODS);
  terms();
  const asked = address.read();
  Object.assign(state, { ...asked, scene: asked.scene ?? state.scene });
  picture.strain = asked.shown.strain === "1";
  try {
    open(state.scene, asked.shown.text);
  } catch (error) {
    Object.assign(state, { changes: {}, shown: {} });
    open("ball");
    say(error.message, true);
  }
  listen();
  await picture.ready;
  el("banner").classList.contains("bad") || say("");
  el("compare").checked = state.shown.compare !== "0";
  run.compare(el("compare").checked);
  let before = performance.now();
  const frame = async (now) => {
    try {
      await run.tick((now - before) / 1000);
    } catch (error) {
      pause(true);
      say(error.message, true);
    }
    before = now;
    firstFrame ??= performance.now();
    requestAnimationFrame(frame);
  };
  requestAnimationFrame(frame);
  setInterval(() => {
    // A run that diverges pauses itself; this updates the button.
    pause();
    run.cloth.busy || numbers.show(run);
  }, 250);
  addEventListener("hashchange", () => location.reload());
  const { some, worth } = await offered();
  el("device").disabled = !some;
  if (worth && run.cloth.scene.contact) {
    el("device").checked = true;
    device();
  }
}

// For tests, and for users of the console.
window.muslin = { camera, picture, run: () => run, firstFrame: () => firstFrame };
start().catch((error) => say(error.message, true));

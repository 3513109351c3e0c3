// The page: its controls change the scene, the run simulates it, and the address stores it.

import { stringify } from "smol-toml";
import { changed, scene as read, windy } from "../muslin.js";
import * as address from "./address.js";
import { Camera } from "./camera.js";
import { chart } from "./chart.js";
import { length } from "./error.js";
import { Hand } from "./hand.js";
import { cells } from "./live.js";
import { materials } from "./materials.js";
import { IMPLICIT, METHODS } from "./methods.js";
import { show as showNumbers } from "./numbers.js";
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
const DETAILS = ["live", "as in the scene"];
/** Part of the cells in each direction of the first picture, while the machine is measured. */
const FIRST = 0.35;
const STILL = matchMedia("(prefers-reduced-motion: reduce)");

const state = { scene: "ball", changes: {}, shown: {} };
/** Choices for the detail `live`, {changes, setting}, by scene and changes of the user; and the present one. */
const choices = new Map();
let live;
/** The text of the scene that the user typed in last. */
let own;
/** The scene in view without changes, and its text. */
let base;
let given;
/** The texts of the built-in scenes, by name. */
let texts;
let stop;
let firstFrame;

const pad = el("pad");
const camera = new Camera();

function say(text, bad = false) {
  const detect = run.device ? `detection: ${run.device}, WebGPU` : "detection: processor";
  const banner = el("banner");
  banner.textContent = text || `${detect} · picture: ${picture.name ?? "…"}`;
  banner.classList.toggle("bad", bad);
}

/** Shows the usual line again, unless an error is shown. */
const quiet = () => el("banner").classList.contains("bad") || say("");

const picture = new Picture(el("picture"), camera, new URLSearchParams(location.hash.slice(1)).get("draw"), say);
const run = new Run(picture, say, () => pause());
const hand = new Hand(pad, camera, run);

/** The value of a key in a scene; for a list, of its first item. */
function valueAt(scene, key) {
  return key.split(".").reduce((owner, part) => (Array.isArray(owner) ? owner[0] : owner)?.[part], scene);
}

const method_of = (scene) => scene.integrator?.method ?? "backward-euler";

/** Changes that go with another method: explicit ones have no error of a step, and need the step of the scene. */
function settings_for(method) {
  const isImplicit = IMPLICIT.includes(method);
  const of = (key, mine) => state.changes[`integrator.${key}`] ?? (isImplicit ? mine : undefined) ?? base.integrator?.[key];
  const error = isImplicit ? of("error", live?.setting?.error) : undefined;
  return { "integrator.method": method, "integrator.error": error, "integrator.step": of("step", live?.setting?.step) };
}

/** Chooses the detail that this machine simulates in real time. */
async function choose(scene) {
  // A key that the user removed is part of the name.
  const name = JSON.stringify([scene, state.changes], (_, value) => (value === undefined ? "none" : value));
  if (!choices.has(name)) choices.set(name, await measured(scene));
  return choices.get(name);
}

/** Measures this machine. Scenes that other cells do not suit run as they are: `why` says the reason. */
async function measured(scene) {
  picture.canvas.classList.add("waits");
  try {
    if (!run.view) {
      await run.open(scene, { ...cells(scene, FIRST), ...state.changes }, true);
      camera.frame(run.positions());
    }
    el("about").textContent = scene.description ?? "";
    say("measuring how fast this machine is …");
    const isImplicit = IMPLICIT.includes(state.changes["integrator.method"] ?? method_of(scene));
    return await run.choose(scene, state.changes, isImplicit);
  } catch (error) {
    return { changes: {}, why: error.message };
  } finally {
    picture.canvas.classList.remove("waits");
  }
}

/** The detail in words. */
function detail() {
  const count = run.cloth.vertexCount.toLocaleString("en");
  const { stepLength, stepError } = run.cloth;
  const error = stepError ? `, error of a step up to ${length(stepError)}` : "";
  return `${count} vertices, steps of ${+(1000 * stepLength).toPrecision(3)} ms${error}`;
}

/** Whether the error is shown. */
const compares = () => state.shown.compare !== "0";

/** Sets the controls to the values of the scene; `stays`: for an address that was refused. */
function show(stays = false) {
  const { scene } = run.cloth;
  if (state.scene === OWN && !el("scene").querySelector(`[value=${OWN}]`)) list("scene", [OWN]);
  el("scene").value = state.scene;
  el("about").textContent = scene.description ?? "";
  el("detail").value = state.shown.detail ? DETAILS[1] : DETAILS[0];
  el("cost").textContent = detail();
  el("again").hidden = Boolean(state.shown.detail);
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
  picture.strain = state.shown.strain === "1";
  el("strain").checked = picture.strain;
  el("legend").hidden = !picture.strain;
  el("compare").checked = compares();
  el("throw").disabled = !run.cloth.hasBall;
  address.write(state, stays);
}

/** Writes the scene in view with the changes of the user as text. A text that was refused stays until then. */
function write() {
  const own = Object.keys(state.changes).length > 0;
  el("text").value = own ? stringify(changed(base, state.changes)) : given;
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
  attempt(async () => {
    await apply(changes, kept);
    say("");
    show();
    write();
  });
}

/** Changes values, or starts the scene anew with them if the run has stopped by itself. */
async function apply(changes, kept = changes) {
  if (!run.hasStopped) await run.set(changes);
  keep(kept);
  if (run.hasStopped) await open(state.scene, state.shown.text);
}

/** Starts a built-in scene, or a scene from a text. */
async function open(name, text = Object.hasOwn(texts, name) ? texts[name] : undefined) {
  if (text === undefined) throw new Error(`there is no scene ${name}; there are ${Object.keys(texts).join(", ")}`);
  if (!/[=[]/.test(text))
    throw new Error("a scene has keys and sections, such as duration = 1 and [[cloth]]: see the text of a built-in one");
  const scene = read(text);
  if (scene.cloth?.some?.(({ mesh }) => mesh)) throw new Error("the page reads no files: describe the cloth by a grid, a tube or a disc");
  say("");
  live = state.shown.detail ? undefined : await choose(scene);
  const hadStopped = run.hasStopped;
  await run.open(scene, { ...live?.changes, ...state.changes });
  if (hadStopped) pause(false);
  [base, given] = [scene, text];
  state.scene = name;
  hand.drop();
  camera.frame(run.positions());
  if (live?.why) say(`the scene runs as it is, because live does not suit it: ${live.why}`);
  else quiet();
  // The text of a scene that the user typed in is part of the address.
  if (name === OWN) state.shown.text = own = text;
  else delete state.shown.text;
  show();
  write();
  if (el("device").checked) device();
}

/** Runs an action between steps. An error is shown, and the state and the cloth stay as before. */
function attempt(action) {
  run.ask(async () => {
    const before = { ...state, changes: { ...state.changes }, shown: { ...state.shown } };
    const choice = live;
    try {
      await action();
    } catch (error) {
      Object.assign(state, before);
      live = choice;
      if (base) show(true);
      await run.compare(compares());
      throw error;
    }
  });
}

function reset() {
  attempt(async () => {
    await open(state.scene, state.shown.text);
    pause(false);
  });
}

function pause(whether = run.paused) {
  // Who continues has read why the run stopped.
  if (!whether && run.hasStopped) say("");
  if (whether !== run.paused) run.paused = whether;
  el("pause").textContent = whether ? "Continue" : "Pause";
}

function strain(whether) {
  if (whether) state.shown.strain = "1";
  else delete state.shown.strain;
  show();
}

/** The velocity of a scene's wind, m/s; of one that changes with time, the first. */
function steady(scene) {
  const velocity = scene.drag?.wind?.velocity;
  // A list has a method of that name.
  return Array.isArray(velocity) ? velocity : velocity?.keys[0].slice(1);
}

function wind(speed) {
  const { scene } = run.cloth;
  const way = [steady(scene), steady(base), [0.3, 0, -1]].find((way) => way && Math.hypot(...way) > 0);
  const size = Math.hypot(...way);
  const velocity = way.map((x) => (x / size) * speed);
  change({ "drag.wind": windy(scene, velocity) });
}

/** The keys that materials change. */
const OF_MATERIAL = /^cloth\.(\d+\.)?(density|stretch|shear|bend)\b/;

/** The values of these keys in the scene, for each cloth. */
function ofScene() {
  const of = (cloth, k) => ["density", "stretch", "shear", "bend"].map((key) => [`cloth.${k}.${key}`, cloth[key]]);
  return Object.fromEntries(base.cloth.flatMap(of));
}

/** From the next step on, detects on the GPU if this is chosen and the scene has contact. */
function device() {
  run.ask(async () => {
    await run.detect(el("device").checked && run.cloth.scene.contact !== undefined).catch((error) => {
      el("device").checked = false;
      throw error;
    });
    quiet();
  });
}

/** Throws a ball from the eye, or from near the cloth if the eye is far, to the middle of the picture. */
function fly() {
  const { centre, eye, reach } = camera;
  const way = eye.map((x, k) => x - centre[k]);
  const part = Math.min(1, (1.5 * reach) / Math.hypot(...way));
  const from = centre.map((x, k) => x + part * way[k]);
  run.ask(() => run.fly([from[0], Math.max(from[1], 0.3), from[2]], camera.lit));
}

const KEYS = {
  " ": () => pause(!run.paused),
  ".": () => {
    pause(true);
    run.one();
  },
  r: reset,
  s: () => strain(!el("strain").checked),
  b: fly,
  c: () => camera.frame(run.positions(), true),
};

/** Starts the scene of the address. */
async function visit() {
  const asked = address.read();
  Object.assign(state, { changes: {}, shown: {}, ...asked, scene: asked.scene ?? "ball" });
  await run.compare(compares());
  await open(state.scene, asked.shown.text);
}

function listen() {
  const anew = (name, text) =>
    attempt(async () => {
      state.changes = {};
      delete state.shown.material;
      await open(name, text);
    });
  el("scene").onchange = () => anew(el("scene").value, el("scene").value === OWN ? own : undefined);
  el("detail").onchange = () => {
    const isLive = el("detail").value === DETAILS[0];
    attempt(async () => {
      if (isLive) delete state.shown.detail;
      else state.shown.detail = "scene";
      await open(state.scene, state.shown.text);
    });
  };
  el("pause").onclick = KEYS[" "];
  el("step").onclick = KEYS["."];
  el("reset").onclick = reset;
  el("material").onchange = () => {
    const name = el("material").value;
    attempt(async () => {
      if (materials[name]) state.shown.material = name;
      else delete state.shown.material;
      await apply(materials[name] ?? ofScene());
      if (!materials[name]) for (const key of Object.keys(state.changes)) if (OF_MATERIAL.test(key)) delete state.changes[key];
      say("");
      show();
      write();
    });
  };
  el("method").onchange = () => {
    const method = el("method").value;
    change(settings_for(method), { "integrator.method": method });
  };
  el("length").onchange = () => {
    const step = el("length").valueAsNumber / 1000;
    attempt(async () => {
      if (!(step > 0)) throw new Error("a step is longer than 0 ms");
      // With the error that the run has: a step alone would fix the length of all steps.
      const { stepError: error } = run.cloth;
      const own = { "integrator.step": step };
      const both = error ? { ...own, "integrator.error": error } : own;
      // The error of `live` belongs to this machine.
      await apply(both, state.shown.detail ? both : own);
      const { stepLength } = run.cloth;
      say(Math.abs(stepLength / step - 1) > 2e-3 ? `steps divide a frame evenly: ${+(1000 * stepLength).toPrecision(4)} ms` : "");
      show();
      write();
    });
  };
  el("wind").oninput = () => (el("speed").value = el("wind").value);
  el("wind").onchange = () => wind(el("wind").valueAsNumber);
  el("strain").onchange = () => strain(el("strain").checked);
  el("compare").onchange = () =>
    run.ask(async () => {
      await run.compare(el("compare").checked);
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
  el("again").onclick = () => {
    choices.clear();
    reset();
  };
  el("throw").onclick = fly;
  el("recentre").onclick = KEYS.c;
  // Keys work where the picture has the focus, so that no letter surprises somebody who types or reads aloud.
  pad.addEventListener("keydown", (event) => {
    if (el("controls").inert) return;
    const key = event.key.length === 1 ? event.key.toLowerCase() : event.key;
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    if (KEYS[key]) event.repeat || KEYS[key]();
    else if (!hand.key(key)) return;
    event.preventDefault();
  });
  addEventListener("popstate", () => attempt(visit));
}

/** Creates a checkbox for each term. */
function terms() {
  for (const [name, [key, fallback]] of Object.entries(TERMS)) {
    const label = document.createElement("label");
    const box = Object.assign(document.createElement("input"), { type: "checkbox", id: name });
    box.onchange = () => {
      const off = key === "contact.self" ? false : key === "contact.friction" ? 0 : undefined;
      // With the material that was chosen.
      const scene = changed(base, materials[state.shown.material] ?? {});
      change({ [key]: box.checked ? valueAt(scene, key) || fallback : off });
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
  texts = await run.ready;
  list("scene", Object.keys(texts));
  list("detail", DETAILS);
  list("material", ["as in the scene", ...Object.keys(materials)]);
  list("method", METHODS);
  terms();
  listen();
  // On a phone the numbers would hide the cloth, upright or not.
  el("measured").open = matchMedia("(min-width: 45rem) and (min-height: 36rem)").matches;
  let trouble;
  const opened = visit().catch((error) => {
    trouble = error.message;
    Object.assign(state, { scene: "ball", changes: {}, shown: {} });
    return run.compare(true).then(() => open("ball"));
  });
  const frame = () => {
    try {
      run.draw();
    } catch (error) {
      say(error.message, true);
    }
    if (run.view && picture.name) firstFrame ??= performance.now();
    requestAnimationFrame(frame);
  };
  requestAnimationFrame(frame);
  await opened;
  el("controls").inert = false;
  if (STILL.matches) pause(true);
  await picture.ready;
  if (trouble) say(trouble, true);
  else if (STILL.matches) say("paused, because this system asks for little motion");
  else quiet();
  setInterval(() => run.numbers && showNumbers(el("numbers"), run.numbers, Boolean(live)), 250);
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

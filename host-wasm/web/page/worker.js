// What would make the page stand still: a reference run that follows the page's, and runs for the chart.

import { Cloth, changed, load } from "../muslin.js";
import { rms } from "./error.js";
import { METHODS } from "./methods.js";

/** The reference takes so many steps where the page takes one. */
const FINER = 4;
/** Its solver goes on for so much longer, to what single precision can tell. */
const SHARPER = 0.01;
const SHARPEST = 1e-5;

let reference;
/** The page's time less the reference's, s: another step moves both clocks to whole ones of their own. */
let ahead = 0;

/** What makes a run the reference of one with this step and tolerance. */
const finer = (step, tolerance = 1e-4, by) => ({
  // A hair more, so that single precision makes no further step of it.
  "integrator.step": (step / by) * (1 + 1e-6),
  "integrator.tolerance": Math.min(tolerance, Math.max(SHARPEST, SHARPER * tolerance)),
});
const reference_of = (scene, step, by) => changed(scene, finer(step, scene.integrator.tolerance, by));

const asks = {
  // Its step divides the other's, which is not the scene's own where that divides no picture.
  start({ scene, step }) {
    reference?.free();
    reference = new Cloth(reference_of(scene, step, FINER));
    ahead = 0;
  },
  // All happens at the page's time.
  change({ changes, step, tolerance, time, after }) {
    go_on(time);
    reference.set({ ...changes, ...finer(step, tolerance, FINER) });
    ahead = after - reference.time;
  },
  moveTo({ vertex, place, seconds, time }) {
    go_on(time);
    reference.moveTo(vertex, place, seconds);
  },
  release({ vertex, time }) {
    go_on(time);
    reference.release(vertex);
  },
  until({ time }) {
    go_on(time);
    const positions = reference.positions().slice();
    postMessage({ kind: "reached", time, positions }, [positions.buffer]);
  },
  chart: ({ scene, seconds }) => chart({ frame_rate: 30, ...scene }, seconds),
};

const COARSER = [4, 2, 1, 0.5, 0.25];
const TRUTH = 32;

function go_on(time) {
  reference.step(Math.max(0, Math.round((time - ahead - reference.time) / reference.stepLength)));
}

/** Positions after so many seconds, and what they cost, ms. */
function ran(scene, seconds) {
  const cloth = new Cloth(scene);
  try {
    const count = Math.round(seconds / cloth.stepLength);
    const began = performance.now();
    cloth.step(count);
    const ms = performance.now() - began;
    return { positions: cloth.positions().slice(), ms, step: cloth.stepLength };
  } finally {
    cloth.free();
  }
}

function chart(scene, seconds) {
  const { step } = scene.integrator;
  // Of second order, where contact does not make all methods of first.
  const method = scene.contact ? "backward-euler" : "bdf2";
  const best = changed(scene, { "integrator.method": method });
  // Steps divide a picture's time: all end together after whole ones.
  const until = Math.max(1, Math.round(seconds * scene.frame_rate)) / scene.frame_rate;
  const tell = (what) => postMessage({ kind: "chart", until, ...what });
  tell({ doing: `the reference: ${method} in steps of ${((1000 * step) / TRUTH).toPrecision(3)} ms` });
  const truth = ran(reference_of(best, step, TRUTH), until).positions;
  const own = rms(ran(reference_of(best, step, TRUTH / 2), until).positions, truth);
  tell({ reference: own });
  // Of steps that come to the same number in a picture, one is enough.
  const steps_of = (coarser) => Math.max(1, Math.ceil(1 / (step * coarser * scene.frame_rate) - 1e-9));
  const tried = [...new Set(COARSER.map(steps_of))].map((count) => 1 / scene.frame_rate / count);
  for (const method of METHODS) {
    for (const step of tried) {
      tell({ doing: `${method} in steps of ${(1000 * step).toPrecision(3)} ms` });
      try {
        const run = ran(changed(scene, { "integrator.method": method, "integrator.step": step }), until);
        tell({ point: { method, step: run.step, ms: run.ms / until, error: rms(run.positions, truth) } });
      } catch (error) {
        tell({ point: { method, step, failed: error.message } });
      }
    }
  }
  tell({ done: true });
}

onmessage = async ({ data }) => {
  try {
    await load();
    asks[data.ask](data);
  } catch (error) {
    postMessage({ kind: "failed", why: error.message });
  }
};

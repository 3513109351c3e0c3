// What would make the page stand still: a reference run that follows the page's, and runs for the chart.

import { Cloth, changed, load } from "../muslin.js";
import { rms } from "./error.js";

/** The reference takes so many steps where the page takes one. */
const FINER = 4;
/** Its solver goes on for so much longer, to what single precision can tell. */
const SHARPER = 0.01;
const SHARPEST = 1e-5;

let reference;

/** What makes a run the reference of one with this step and tolerance. */
const finer = (step, tolerance = 1e-4, by) => ({
  "integrator.step": step / by,
  "integrator.tolerance": Math.min(tolerance, Math.max(SHARPEST, SHARPER * tolerance)),
});
const reference_of = (scene, step, by) => changed(scene, finer(step, scene.integrator.tolerance, by));

const asks = {
  // Its step divides the other's, which is not the scene's own where that divides no picture.
  start({ scene, step }) {
    reference?.free();
    reference = new Cloth(reference_of(scene, step, FINER));
  },
  change({ changes, step, tolerance }) {
    reference?.set({ ...changes, ...finer(step, tolerance, FINER) });
  },
  lead: ({ vertex, place, seconds }) => reference?.lead(vertex, place, seconds),
  release: ({ vertex }) => reference?.release(vertex),
  // What was asked before happened before this time.
  until({ time }) {
    if (!reference) return;
    reference.step(Math.max(0, Math.round((time - reference.time) / reference.stepLength)));
    const positions = reference.positions().slice();
    postMessage({ kind: "reached", time, positions }, [positions.buffer]);
  },
  chart: ({ scene, seconds }) => chart({ frame_rate: 30, ...scene }, seconds),
};

const METHODS = ["explicit-euler", "symplectic-euler", "midpoint", "rk4", "backward-euler", "implicit-midpoint", "bdf2"];
const COARSER = [4, 2, 1, 0.5, 0.25];
const TRUTH = 32;

/** Positions after so many seconds, and what they cost, ms. */
function ran(scene, seconds) {
  const cloth = new Cloth(scene);
  try {
    const count = Math.round(seconds / cloth.stepLength);
    const began = performance.now();
    cloth.step(count);
    const ms = performance.now() - began;
    return { positions: cloth.positions().slice(), ms };
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
  for (const other of METHODS) {
    for (const coarser of COARSER) {
      tell({ doing: `${other} in steps of ${(1000 * step * coarser).toPrecision(3)} ms` });
      const point = { method: other, step: step * coarser };
      try {
        const { positions, ms } = ran(changed(scene, { "integrator.method": other, "integrator.step": point.step }), until);
        tell({ point: { ...point, ms: ms / until, error: rms(positions, truth) } });
      } catch (error) {
        tell({ point: { ...point, failed: error.message } });
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

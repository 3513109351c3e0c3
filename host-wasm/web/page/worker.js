// Work that would block the page: a reference that follows the page's run, and the runs for the chart.

import { Cloth, changed, load } from "../muslin.js";
import { rms } from "./error.js";
import { IMPLICIT, METHODS } from "./methods.js";

/** Steps of the reference per step of the page. */
const FINER = 4;
/** Tolerance of the reference's solver: a factor of the page's tolerance, and the limit of single precision. */
const SHARPER = 0.01;
const SHARPEST = 1e-5;

let reference;
/** The page's time minus the reference's, s. A change of the step rounds each clock to whole steps of its own. */
let ahead = 0;

/** Changes that make a run the reference of a run with this step, tolerance and largest error of a step. */
const finer = ({ step, error, tolerance }, by) => ({
  // Slightly longer, so that rounding to single precision does not add a step.
  "integrator.step": (step / by) * (1 + 1e-6),
  // The error of a step of backward Euler falls with the square of the step.
  "integrator.error": error && error / by ** 2,
  // Without a tolerance the solver follows the error.
  "integrator.tolerance": error && !tolerance ? undefined : sharper(tolerance),
});
const sharper = (tolerance = 1e-4) => Math.min(tolerance, Math.max(SHARPEST, SHARPER * tolerance));

const asks = {
  // The reference's step divides the page's step. This is not the scene's step if that does not divide a frame.
  start({ scene, ...accuracy }) {
    reference?.free();
    reference = new Cloth(changed(scene, finer(accuracy, FINER)));
    ahead = 0;
  },
  // These actions happen at the page's time.
  change({ changes, time, after, ...accuracy }) {
    go_on(time);
    reference.set({ ...changes, ...finer(accuracy, FINER) });
    ahead = after - reference.time;
  },
  pull({ vertices, force, time }) {
    go_on(time);
    for (const vertex of vertices) reference.setForce(vertex, force);
  },
  moveTo({ vertex, place, seconds, time }) {
    go_on(time);
    reference.moveTo(vertex, place, seconds);
  },
  moveCollider({ collider, place, seconds, time }) {
    go_on(time);
    reference.moveCollider(collider, place, undefined, seconds);
  },
  switchCollider({ collider, isOn, time }) {
    go_on(time);
    reference.switchCollider(collider, isOn);
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
  chart: ({ scene, step, error, seconds }) => chart({ frame_rate: 30, ...scene }, error ? Math.min(step, LONGEST) : step, seconds),
};

const COARSER = [4, 2, 1, 0.5, 0.25];
/** Longest step around which the chart of a run under error control tries steps, s: explicit methods fail with longer ones. */
const LONGEST = 1 / 180;
const TRUTH = 32;

function go_on(time) {
  reference.step(Math.max(0, Math.round((time - ahead - reference.time) / reference.stepLength)));
}

/** Positions after `seconds`, the time of the computation, ms, and the step, s. */
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

function chart(scene, step, seconds) {
  // A method of second order, unless contact reduces all methods to first order.
  const method = scene.contact ? "backward-euler" : "bdf2";
  const best = changed(scene, { "integrator.method": method });
  // Steps divide the time of a frame: after whole frames all runs end at the same time.
  const until = Math.max(1, Math.round(seconds * scene.frame_rate)) / scene.frame_rate;
  const tell = (message) => postMessage({ kind: "chart", until, ...message });
  const says = (by) => tell({ doing: `the reference: ${method} in steps of ${((1000 * step) / by).toPrecision(3)} ms` });
  says(TRUTH / 2);
  const reached = (by) => ran(changed(best, finer({ step, tolerance: scene.integrator?.tolerance }, by)), until).positions;
  const rough = reached(TRUTH / 2);
  const runs = [];
  // Of step lengths that give the same number of steps per frame, one is tried.
  const steps_of = (coarser) => Math.max(1, Math.ceil(1 / (step * coarser * scene.frame_rate) - 1e-9));
  const tried = [...new Set(COARSER.map(steps_of))].map((count) => 1 / scene.frame_rate / count);
  // First those that are stable.
  for (const method of [...IMPLICIT, ...METHODS.filter((method) => !IMPLICIT.includes(method))]) {
    for (const step of tried) {
      tell({ doing: `${method} in steps of ${(1000 * step).toPrecision(3)} ms` });
      try {
        const fixed = { "integrator.method": method, "integrator.step": step, "integrator.error": undefined };
        const run = ran(changed(scene, fixed), until);
        const point = { method, step: run.step, ms: run.ms / until };
        runs.push({ point, positions: run.positions });
        tell({ point: { ...point, error: rms(run.positions, rough) } });
      } catch (error) {
        tell({ point: { method, step, failed: error.message } });
      }
    }
  }
  // All points again, with a better reference.
  says(TRUTH);
  const truth = reached(TRUTH);
  tell({ reference: rms(rough, truth) });
  for (const { point, positions } of runs) tell({ point: { ...point, error: rms(positions, truth) } });
  tell({ done: true });
}

self.onmessage = async ({ data }) => {
  try {
    await load();
    asks[data.ask](data);
  } catch (error) {
    postMessage({ kind: "failed", why: error.message });
  }
};

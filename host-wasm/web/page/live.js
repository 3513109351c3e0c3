// The detail `live`: the cells, the step and the error of a step with which this machine simulates a scene in real time.
// Runs with few vertices measure the cost of the scene here.

/** Settings, from the fastest to the most accurate: the step, s, and the largest error of a step, m. The last is the scene's own. */
const SETTINGS = [{ step: 1 / 30, error: 0.008 }, { step: 1 / 60, error: 0.004 }, { step: 1 / 60, error: 0.001 }, undefined];
/** The largest number of vertices, unless the machine runs the whole scene: time is better spent on accuracy then. */
const ENOUGH = 1560;
/** Vertices of the runs that measure. */
const FEW = 300;
/**
 * The whole scene must take so much less time than there is. The estimate takes the cost per vertex as that of few vertices; that of
 * many is larger.
 */
const SPARE = 1.3;
/** Stretch from which a more accurate setting is tried, and the share of it that such a setting may leave. */
const STRETCHED = 0.07;
const LESS = 0.7;
/** Simulated time of a run that measures, s. */
const SECONDS = 4;
/** Length of the part of it that costs most, and the time between the beginnings of parts, s. */
const PART = 2;
const BETWEEN = 0.25;
/** Time of the machine for the first run and for each further one, ms, and before them, while the browser compiles the module. */
const FIRST = 1000;
const FURTHER = 500;
const WARM = 150;
/** The part of a run that was not reached may cost so many times as much as the part that was. */
const WORSE = 1.5;

const scaled = (count, factor, least = 1) => Math.max(least, Math.round(factor * count));

/** Scales both counts of cells. The larger one makes up for the rounding of the smaller one, so that their product is as asked. */
function bothScaled([a, b], factor, least) {
  if (a > b) return bothScaled([b, a], factor, least).reverse();
  const few = scaled(a, factor, least);
  return [few, scaled(b, (factor ** 2 * a) / few, least)];
}

/** Changes that scale the cells of all cloths in each direction. Cloths from files keep their meshes. */
export function cells(scene, factor) {
  const changes = {};
  scene.cloth?.forEach?.(({ grid, tube, disc }, k) => {
    if (Array.isArray(grid?.cells)) changes[`cloth.${k}.grid.cells`] = bothScaled(grid.cells, factor);
    if (Array.isArray(tube?.cells)) changes[`cloth.${k}.tube.cells`] = bothScaled(tube.cells, factor, 3);
    if (disc) changes[`cloth.${k}.disc.rings`] = scaled(disc.rings, factor);
  });
  return changes;
}

/** Changes that make a run of an implicit method coarser or finer in time. A step of 1/30 s needs frames as long. */
const timed = (setting) =>
  setting && {
    frame_rate: Math.min(60, Math.round(1 / setting.step)),
    "integrator.step": setting.step,
    "integrator.error": setting.error,
    "integrator.tolerance": undefined,
  };

/**
 * Runs a cloth for at most `longest` ms. Returns the time of the machine over the simulated time of its most expensive part,
 * its stretch, and whether it reached the end.
 */
function measured(cloth, longest, now) {
  const began = now();
  const times = [[0, 0]];
  let stretch = 0;
  let hasDiverged = false;
  cloth.onDiverge = () => {
    hasDiverged = true;
  };
  while (cloth.time < SECONDS && now() - began < longest && !hasDiverged) {
    cloth.advance(cloth.stepLength);
    stretch = Math.max(stretch, cloth.summary().stretch.max - 1);
    if (cloth.time - times.at(-1)[0] >= BETWEEN) times.push([cloth.time, (now() - began) / 1000]);
  }
  if (cloth.time > times.at(-1)[0]) times.push([cloth.time, (now() - began) / 1000]);
  if (hasDiverged) throw new Error("the scene diverges with fewer vertices");
  const parts = Math.max(1, Math.floor(Math.min(PART, cloth.time) / BETWEEN));
  const costs = times.slice(parts).map(([time, spent], k) => (spent - times[k][1]) / (time - times[k][0]));
  return { cost: Math.max(...costs), stretch, isWhole: cloth.time >= SECONDS };
}

/**
 * Chooses changes of a scene. `make(changes)` makes a cloth of it; `isImplicit` says whether its method divides steps by their
 * error. Returns the changes and the setting.
 */
export function choose(make, scene, isImplicit, now = () => performance.now()) {
  const using = (changes, act) => {
    const cloth = make(changes);
    try {
      return act(cloth);
    } finally {
      cloth.free();
    }
  };
  const all = using({}, (cloth) => cloth.vertexCount);
  const coarse = cells(scene, Math.min(1, Math.sqrt(FEW / all)));
  const few = using(coarse, (cloth) => {
    for (const began = now(); now() - began < WARM && !cloth.hasDiverged; ) cloth.advance(cloth.stepLength);
    return cloth.vertexCount;
  });
  const enough = Math.min(all, ENOUGH);
  let best;
  for (const setting of isImplicit ? SETTINGS : [undefined]) {
    const run = using({ ...coarse, ...timed(setting) }, (cloth) => measured(cloth, best ? FURTHER : FIRST, now));
    if (best && !run.isWhole) break;
    const { stretch } = run;
    const cost = run.isWhole ? run.cost : WORSE * run.cost;
    const held = few / cost;
    // All of them only with the settings of the scene.
    const vertices = setting || held < SPARE * all ? Math.min(enough, held) : all;
    // Fewer vertices are right only where the setting before lets the cloth stretch.
    if (best && vertices < enough && !(best.stretch > STRETCHED && stretch < LESS * best.stretch)) break;
    const factor = Math.sqrt(vertices / all);
    const changes = { ...(factor < 1 ? cells(scene, factor) : {}), ...timed(setting) };
    best = { changes, setting, stretch };
  }
  return { changes: best.changes, setting: best.setting };
}

// `hanging` (64x64, two corners) with this module and with the soft bodies of Jolt Physics and of Rapier, one thread each in
// Node.js: cost of a step of 1/60 s, and largest stretch of an edge during the second second.
//     cargo run -p muslin-pack
//     npm install --no-save --prefix host-wasm jolt-physics@1.1.0 @dimforge/rapier3d-compat@0.21.0
//     node tests/peers/hanging.mjs

import { joltSheet } from "./jolt.mjs";
import { rapierSheet } from "./rapier.mjs";
import { middle, muslin, say, stretchOf } from "./sheet.mjs";

const SECOND = 60;
const ITERATIONS = [20, 80, 160, 240, 280, 320];
/** Of Rapier: natural frequency of the springs, Hz, and iterations of the solver. */
const SPRINGS = [
  [200, 4],
  [1000, 16],
  [2000, 64],
];

// Fixed steps to one tolerance: the figures of the manual.
const fixed = { "integrator.step": 1 / 60, "integrator.tolerance": 1e-3 };
const sheet = new muslin.Cloth(muslin.changed(muslin.scene("hanging"), fixed));
const [rest, triangles, pins] = [sheet.positions().slice(), sheet.triangles().slice(), Array.from(sheet.pins())];
const [cloth] = sheet.scene.cloth;
const mass = cloth.density * cloth.grid.size[0] * cloth.grid.size[1];
const worst = stretchOf(rest, triangles);

/** Runs two seconds; returns the median cost of a step, ms, and the largest stretch, both over the second second. */
function measure({ step, positions }) {
  for (let k = 0; k < SECOND; k++) step();
  let stretch = 0;
  const times = Array.from({ length: SECOND }, () => {
    const began = performance.now();
    step();
    const ms = performance.now() - began;
    stretch = Math.max(stretch, worst(positions()));
    return ms;
  });
  return { ms: middle(times), stretch };
}

const ours = measure({ step: () => sheet.step(), positions: () => sheet.positions() });
say("Muslin, backward Euler", ours);
for (const [frequency, iterations] of SPRINGS) {
  const [columns, gravity] = [cloth.grid.cells[0] + 1, sheet.scene.gravity[1]];
  const rapier = rapierSheet({ rest, columns, pins, mass, gravity, frequency, iterations });
  say(`Rapier, ${frequency} Hz, ${iterations} iterations`, measure(rapier));
  rapier.free();
}
const theirs = ITERATIONS.map((iterations) => {
  const jolt = joltSheet({ rest, triangles, pins, mass, stiffness: cloth.stretch.stiffness, iterations });
  const measured = measure(jolt);
  jolt.free();
  say(`Jolt, ${iterations} substeps`, measured);
  return measured;
});
const equal = theirs.filter(({ stretch }) => stretch <= 1.25 * ours.stretch).sort((a, b) => a.ms - b.ms)[0];
console.log(
  equal
    ? `at equal stretch (to a quarter, in its favour) a step of Muslin takes ${((100 * ours.ms) / equal.ms).toFixed(0)} % of the time of Jolt's`
    : "Jolt reached no equal stretch",
);

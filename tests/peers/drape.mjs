// A sheet of 64x64 vertices falls on a sphere and hangs over it (tests/scenes/drape.toml, 2 s), with this module, with the
// soft body of Jolt Physics and with that of Rapier, one thread each in Node.js, in turns. Jolt's cloth does not collide
// with itself. Prints the mean cost of a frame of 1/60 s, the median of the turns, and the largest stretch in any frame.
//     cargo run -p muslin-pack
//     npm install --no-save --prefix host-wasm jolt-physics@1.1.0 @dimforge/rapier3d-compat@0.21.0
//     node tests/peers/drape.mjs

import { readFileSync } from "node:fs";
import { join } from "node:path";
import { root } from "../browser/kit.mjs";
import { joltSheet } from "./jolt.mjs";
import { rapierSheet } from "./rapier.mjs";
import { middle, muslin, say, stretchOf } from "./sheet.mjs";

const TURNS = Number(process.argv[2] ?? 3);
const FRAMES = 120;
const scene = muslin.scene(readFileSync(join(root, "tests/scenes/drape.toml"), "utf8"));
const model = new muslin.Cloth(scene);
const [rest, triangles] = [model.positions().slice(), model.triangles().slice()];
model.free();
const {
  density,
  grid,
  stretch: { stiffness },
} = scene.cloth[0];
const mass = density * grid.size[0] * grid.size[1];
const { radius } = scene.collider[0];
const { thickness, friction } = scene.contact;
const worst = stretchOf(rest, triangles);

function ours(error, self = true) {
  const cloth = new muslin.Cloth(muslin.changed(scene, { "integrator.error": error, "contact.self": self }));
  return { step: () => cloth.step(), positions: () => cloth.positions(), free: () => cloth.free() };
}

const common = { rest, mass, radius, thickness, friction };
const jolt = (iterations) => joltSheet({ ...common, triangles, stiffness, iterations });
const rapier = (frequency, iterations) =>
  rapierSheet({ ...common, columns: grid.cells[0] + 1, gravity: scene.gravity[1], frequency, iterations });

const SHEETS = {
  "Muslin, error 1 mm": () => ours(0.001),
  "Muslin, error 2 mm": () => ours(0.002),
  "Muslin, error 2 mm, no self-contact": () => ours(0.002, false),
  "Jolt, 80 substeps, no self-contact": () => jolt(80),
  "Jolt, 160 substeps, no self-contact": () => jolt(160),
  "Jolt, 280 substeps, no self-contact": () => jolt(280),
  "Rapier, 200 Hz, 4 iterations": () => rapier(200, 4),
  "Rapier, 1000 Hz, 16 iterations": () => rapier(1000, 16),
};

function measure({ step, positions, free }) {
  let [ms, stretch] = [0, 0];
  for (let frame = 0; frame < FRAMES; frame++) {
    const began = performance.now();
    step();
    ms += performance.now() - began;
    stretch = Math.max(stretch, worst(positions()));
  }
  free();
  return { ms: ms / FRAMES, stretch };
}

const measured = Object.fromEntries(Object.keys(SHEETS).map((name) => [name, []]));
for (let turn = 0; turn < TURNS; turn++) {
  for (const [name, sheet] of Object.entries(SHEETS)) measured[name].push(measure(sheet()));
}
for (const [name, turns] of Object.entries(measured)) {
  say(name, { ms: middle(turns.map(({ ms }) => ms)), stretch: Math.max(...turns.map(({ stretch }) => stretch)) });
}

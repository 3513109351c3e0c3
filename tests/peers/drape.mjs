// A sheet of 64x64 vertices falls on a sphere and hangs over it (tests/scenes/drape.toml, 2 s), with this module, with the
// soft body of Jolt Physics and with that of Rapier, one thread each in Node.js, in turns. Jolt's cloth does not collide
// with itself. Prints the mean cost of a frame of 1/60 s, the median of the turns, and the largest stretch in any frame.
//     cargo run -p muslin-pack
//     npm install --no-save --prefix host-wasm jolt-physics@1.1.0 @dimforge/rapier3d-compat@0.21.0
//     node tests/peers/drape.mjs

import { readFileSync } from "node:fs";
import { join } from "node:path";
import { root } from "../browser/kit.mjs";
import { installed, joltSheet } from "./jolt.mjs";
import { middle, muslin, say, stretchOf } from "./sheet.mjs";

const TURNS = Number(process.argv[2] ?? 3);
const FRAMES = 120;
const Rapier = await installed("@dimforge/rapier3d-compat", "0.21.0");
await Rapier.init();

const scene = muslin.scene(readFileSync(join(root, "tests/scenes/drape.toml"), "utf8"));
const model = new muslin.Cloth(scene);
const [rest, triangles] = [model.positions().slice(), model.triangles().slice()];
model.free();
const {
  density,
  grid,
  position,
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

/** Rapier's cloth: springs of this natural frequency, Hz, and so many iterations of its solver a step. */
function rapierSheet(frequency, iterations) {
  const world = new Rapier.World({ x: 0, y: scene.gravity[1], z: 0 });
  world.timestep = 1 / 60;
  world.integrationParameters.numSolverIterations = iterations;
  world.createCollider(Rapier.ColliderDesc.ball(radius).setFriction(friction));
  const [[width, depth], [columns, rows]] = [grid.size, grid.cells];
  const origin = { x: position[0] - width / 2, y: position[1], z: position[2] - depth / 2 };
  const [along, across] = [
    { x: width / columns, y: 0, z: 0 },
    { x: 0, y: 0, z: depth / rows },
  ];
  const cloth = Rapier.SoftBodyDesc.cloth(origin, along, across, columns + 1, rows + 1)
    .setMass(mass)
    .setSoftness(frequency, 1)
    .setSelfContacts(true)
    .setParticleRadius(thickness / 2)
    .setCanSleep(false);
  const body = world.createSoftBody(cloth);
  return { step: () => world.step(), positions: () => body.particlePositions(), free: () => world.free() };
}

const jolt = (iterations) => joltSheet({ rest, triangles, mass, stiffness, iterations, radius, thickness, friction });

const SHEETS = {
  "Muslin, error 1 mm": () => ours(0.001),
  "Muslin, error 2 mm": () => ours(0.002),
  "Muslin, error 2 mm, no self-contact": () => ours(0.002, false),
  "Jolt, 80 substeps, no self-contact": () => jolt(80),
  "Jolt, 160 substeps, no self-contact": () => jolt(160),
  "Jolt, 280 substeps, no self-contact": () => jolt(280),
  "Rapier, 200 Hz, 4 iterations": () => rapierSheet(200, 4),
  "Rapier, 1000 Hz, 16 iterations": () => rapierSheet(1000, 16),
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

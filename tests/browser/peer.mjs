// `hanging` (64x64, two corners) with this module and with the soft body of Jolt Physics (XPBD, npm:
// jolt-physics), one thread each in Node.js: cost of a step of 1/60 s, and largest stretch of an edge during
// the second second.
//     cargo run -p muslin-pack && npm install --no-save --prefix host-wasm jolt-physics@1.1.0 && node tests/browser/peer.mjs

import { readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { join } from "node:path";
import { pathToFileURL } from "node:url";
import { dist, root } from "./kit.mjs";

const SECOND = 60;
const ITERATIONS = [20, 80, 160, 240, 280, 320];

const require = createRequire(join(root, "host-wasm/package.json"));
let peer;
try {
  peer = require.resolve("jolt-physics/wasm-compat");
} catch {
  console.log("the peer is missing: npm install --no-save --prefix host-wasm jolt-physics@1.1.0");
  process.exit(1);
}
const Jolt = await (await import(pathToFileURL(peer))).default();
const muslin = await import(pathToFileURL(join(dist, "muslin.js")));
await muslin.load(readFileSync(join(dist, "muslin_wasm_bg.wasm")));

// Fixed steps to one tolerance: the figures of the manual.
const fixed = { "integrator.step": 1 / 60, "integrator.tolerance": 1e-3 };
const sheet = new muslin.Cloth(muslin.changed(muslin.scene("hanging"), fixed));
const [rest, triangles, pins] = [sheet.positions().slice(), sheet.triangles().slice(), Array.from(sheet.pins())];
const [cloth] = sheet.scene.cloth;
const count = rest.length / 3;
const edges = new Map();
for (let t = 0; t < triangles.length; t += 3) {
  for (const [a, b] of [[0, 1], [1, 2], [2, 0]]) {
    const [low, high] = [triangles[t + a], triangles[t + b]].sort((a, b) => a - b);
    edges.set(low * count + high, [low, high]);
  }
}
const apart = (x, a, b) => Math.hypot(x[3 * a] - x[3 * b], x[3 * a + 1] - x[3 * b + 1], x[3 * a + 2] - x[3 * b + 2]);
const worst = (x) => [...edges.values()].reduce((most, [a, b]) => Math.max(most, apart(x, a, b) / apart(rest, a, b) - 1), 0);
const middle = (numbers) => numbers.sort((a, b) => a - b)[numbers.length >> 1];

/** Runs two seconds; returns the median cost of a step, ms, and the largest stretch, both over the second second. */
function measure(step, positions) {
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

/** The same sheet with compliance 1 / stiffness and without bending. An iteration in Jolt's terms is a substep. */
function jolt(iterations) {
  const settings = new Jolt.JoltSettings();
  const layers = new Jolt.ObjectLayerPairFilterTable(1);
  const broad = new Jolt.BroadPhaseLayerInterfaceTable(1, 1);
  broad.MapObjectToBroadPhaseLayer(0, new Jolt.BroadPhaseLayer(0));
  settings.mObjectLayerPairFilter = layers;
  settings.mBroadPhaseLayerInterface = broad;
  settings.mObjectVsBroadPhaseLayerFilter = new Jolt.ObjectVsBroadPhaseLayerFilterTable(broad, 1, layers, 1);
  const world = new Jolt.JoltInterface(settings);

  const shared = new Jolt.SoftBodySharedSettings();
  const vertex = new Jolt.SoftBodySharedSettingsVertex();
  for (let v = 0; v < count; v++) {
    vertex.mPosition = new Jolt.Float3(rest[3 * v], rest[3 * v + 1], rest[3 * v + 2]);
    vertex.mInvMass = pins.includes(v) ? 0 : count / (cloth.density * cloth.grid.size[0] * cloth.grid.size[1]);
    shared.mVertices.push_back(vertex);
  }
  for (let t = 0; t < triangles.length; t += 3) {
    shared.AddFace(new Jolt.SoftBodySharedSettingsFace(triangles[t], triangles[t + 1], triangles[t + 2], 0));
  }
  const attributes = new Jolt.SoftBodySharedSettingsVertexAttributes();
  attributes.mCompliance = attributes.mShearCompliance = 1 / cloth.stretch.stiffness;
  shared.CreateConstraints(attributes, 1, Jolt.SoftBodySharedSettings_EBendType_None);
  shared.Optimize();

  const creation = new Jolt.SoftBodyCreationSettings(shared, new Jolt.RVec3(0, 0, 0), new Jolt.Quat(0, 0, 0, 1), 0);
  creation.mNumIterations = iterations;
  creation.mUpdatePosition = false;
  creation.mAllowSleeping = false;
  const bodies = world.GetPhysicsSystem().GetBodyInterface();
  const body = bodies.CreateSoftBody(creation);
  bodies.AddBody(body.GetID(), Jolt.EActivation_Activate);
  const own = Jolt.castObject(body.GetMotionProperties(), Jolt.SoftBodyMotionProperties).GetVertices();
  const first = (Jolt.getPointer(own.at(0)) + Jolt.SoftBodyVertexTraits.prototype.mPositionOffset) / 4;
  const stride = (Jolt.getPointer(own.at(1)) - Jolt.getPointer(own.at(0))) / 4;
  const at = (k) => Jolt.HEAPF32[first + Math.floor(k / 3) * stride + (k % 3)];
  const measured = measure(() => world.Step(1 / SECOND, 1), () => rest.map((_, k) => at(k)));
  bodies.RemoveBody(body.GetID());
  bodies.DestroyBody(body.GetID());
  Jolt.destroy(world);
  return measured;
}

const say = (name, { ms, stretch }) => console.log(`${name.padEnd(22)} ${ms.toFixed(1).padStart(6)} ms a step, worst edge +${(100 * stretch).toFixed(2)} %`);
const ours = measure(() => sheet.step(), () => sheet.positions());
say("Muslin, backward Euler", ours);
const theirs = ITERATIONS.map((iterations) => {
  const measured = jolt(iterations);
  say(`Jolt, ${iterations} substeps`, measured);
  return measured;
});
const equal = theirs.filter(({ stretch }) => stretch <= 1.25 * ours.stretch).sort((a, b) => a.ms - b.ms)[0];
console.log(
  equal
    ? `at equal stretch (to a quarter, in its favour) a step of Muslin takes ${(100 * ours.ms / equal.ms).toFixed(0)} % of the time of Jolt's`
    : "Jolt reached no equal stretch",
);

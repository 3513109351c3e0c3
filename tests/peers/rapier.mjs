// The soft body of Rapier (npm: @dimforge/rapier3d-compat).

import { installed } from "./jolt.mjs";

const Rapier = await installed("@dimforge/rapier3d-compat", "0.21.0");
await Rapier.init();

/**
 * A sheet of rows of `columns` vertices, of springs of this natural frequency, Hz, with so many iterations of the solver in a step
 * of 1/60 s; on a sphere with this `radius`, m, around the origin if there is one. Without a `thickness`, m, nothing touches.
 */
export function rapierSheet({ rest, columns, pins = [], mass, gravity, frequency, iterations, radius, thickness, friction }) {
  const world = new Rapier.World({ x: 0, y: gravity, z: 0 });
  world.timestep = 1 / 60;
  world.integrationParameters.numSolverIterations = iterations;
  if (radius) world.createCollider(Rapier.ColliderDesc.ball(radius).setFriction(friction));
  const from = (a, b) => ({ x: rest[3 * b] - rest[3 * a], y: rest[3 * b + 1] - rest[3 * a + 1], z: rest[3 * b + 2] - rest[3 * a + 2] });
  const origin = { x: rest[0], y: rest[1], z: rest[2] };
  const sheet = Rapier.SoftBodyDesc.cloth(origin, from(0, 1), from(0, columns), columns, rest.length / 3 / columns)
    .setMass(mass)
    .setSoftness(frequency, 1)
    .setSelfContacts(Boolean(thickness))
    .setCanSleep(false);
  if (thickness) sheet.setParticleRadius(thickness / 2);
  const body = world.createSoftBody(sheet);
  for (const pin of pins) body.setParticlePinned(pin, true);
  return { step: () => world.step(), positions: () => body.particlePositions(), free: () => world.free() };
}

// The soft body of Jolt Physics (XPBD, npm: jolt-physics).

import { createRequire } from "node:module";
import { join } from "node:path";
import { pathToFileURL } from "node:url";
import { root } from "../browser/kit.mjs";

/** Loads a package that was installed beside the module; ends the program with a hint if it is missing. */
export async function installed(name, version) {
  try {
    return await import(pathToFileURL(createRequire(join(root, "host-wasm/package.json")).resolve(name)));
  } catch {
    const [base] = name.match(/^(@[^/]+\/)?[^/]+/);
    console.log(`a peer is missing: npm install --no-save --prefix host-wasm ${base}@${version}`);
    process.exit(1);
  }
}

const Jolt = await (await installed("jolt-physics/wasm-compat", "1.1.0")).default();

/**
 * A sheet with compliance 1 / `stiffness` and without bending; on a sphere with this `radius`, m, around the origin if
 * there is one. An iteration in Jolt's terms is a substep. Its cloth does not collide with itself.
 */
export function joltSheet({ rest, triangles, pins = [], mass, stiffness, iterations, radius, thickness = 0, friction = 0 }) {
  const settings = new Jolt.JoltSettings();
  const layers = new Jolt.ObjectLayerPairFilterTable(1);
  layers.EnableCollision(0, 0);
  const broad = new Jolt.BroadPhaseLayerInterfaceTable(1, 1);
  broad.MapObjectToBroadPhaseLayer(0, new Jolt.BroadPhaseLayer(0));
  settings.mObjectLayerPairFilter = layers;
  settings.mBroadPhaseLayerInterface = broad;
  settings.mObjectVsBroadPhaseLayerFilter = new Jolt.ObjectVsBroadPhaseLayerFilterTable(broad, 1, layers, 1);
  const world = new Jolt.JoltInterface(settings);
  const bodies = world.GetPhysicsSystem().GetBodyInterface();
  const [origin, upright] = [new Jolt.RVec3(0, 0, 0), new Jolt.Quat(0, 0, 0, 1)];
  if (radius) {
    const sphere = new Jolt.BodyCreationSettings(new Jolt.SphereShape(radius), origin, upright, Jolt.EMotionType_Static, 0);
    sphere.mFriction = friction;
    bodies.AddBody(bodies.CreateBody(sphere).GetID(), Jolt.EActivation_Activate);
  }

  const count = rest.length / 3;
  const shared = new Jolt.SoftBodySharedSettings();
  const vertex = new Jolt.SoftBodySharedSettingsVertex();
  for (let v = 0; v < count; v++) {
    vertex.mPosition = new Jolt.Float3(rest[3 * v], rest[3 * v + 1], rest[3 * v + 2]);
    vertex.mInvMass = pins.includes(v) ? 0 : count / mass;
    shared.mVertices.push_back(vertex);
  }
  for (let t = 0; t < triangles.length; t += 3) {
    shared.AddFace(new Jolt.SoftBodySharedSettingsFace(triangles[t], triangles[t + 1], triangles[t + 2], 0));
  }
  const attributes = new Jolt.SoftBodySharedSettingsVertexAttributes();
  attributes.mCompliance = attributes.mShearCompliance = 1 / stiffness;
  shared.CreateConstraints(attributes, 1, Jolt.SoftBodySharedSettings_EBendType_None);
  shared.Optimize();

  const creation = new Jolt.SoftBodyCreationSettings(shared, origin, upright, 0);
  creation.mNumIterations = iterations;
  creation.mVertexRadius = thickness;
  creation.mFriction = friction;
  creation.mUpdatePosition = false;
  creation.mAllowSleeping = false;
  const body = bodies.CreateSoftBody(creation);
  bodies.AddBody(body.GetID(), Jolt.EActivation_Activate);
  const own = Jolt.castObject(body.GetMotionProperties(), Jolt.SoftBodyMotionProperties).GetVertices();
  const first = (Jolt.getPointer(own.at(0)) + Jolt.SoftBodyVertexTraits.prototype.mPositionOffset) / 4;
  const stride = (Jolt.getPointer(own.at(1)) - Jolt.getPointer(own.at(0))) / 4;
  return {
    step: () => world.Step(1 / 60, 1),
    positions: () => rest.map((_, k) => Jolt.HEAPF32[first + Math.floor(k / 3) * stride + (k % 3)]),
    free: () => {
      bodies.RemoveBody(body.GetID());
      bodies.DestroyBody(body.GetID());
      Jolt.destroy(world);
    },
  };
}

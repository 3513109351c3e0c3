// Makes walker.gltf: a figure of capsules that walks on the spot. cape.html hangs a cape on it.
//     node host-wasm/examples/make_walker.mjs

import { writeFileSync } from "node:fs";
import { CapsuleGeometry } from "three";

/** The bones: parent, joint relative to the parent, tip relative to the joint, radius, m. */
const BONES = {
  hips: [undefined, [0, 0.95, 0], [0, 0.1, 0], 0.11],
  spine: ["hips", [0, 0.12, 0], [0, 0.33, 0], 0.12],
  head: ["spine", [0, 0.5, 0], [0, 0.12, 0], 0.1],
  leftArm: ["spine", [0.2, 0.36, 0], [0.02, -0.27, 0], 0.045],
  leftHand: ["leftArm", [0.02, -0.3, 0], [0, -0.26, 0], 0.038],
  rightArm: ["spine", [-0.2, 0.36, 0], [-0.02, -0.27, 0], 0.045],
  rightHand: ["rightArm", [-0.02, -0.3, 0], [0, -0.26, 0], 0.038],
  leftThigh: ["hips", [0.09, -0.04, 0], [0, -0.42, 0], 0.075],
  leftShin: ["leftThigh", [0, -0.44, 0], [0, -0.42, 0], 0.055],
  rightThigh: ["hips", [-0.09, -0.04, 0], [0, -0.42, 0], 0.075],
  rightShin: ["rightThigh", [0, -0.44, 0], [0, -0.42, 0], 0.055],
};

/** Angles about x over a cycle, rad: mean, swing and phase. */
const SWINGS = {
  spine: [0.05, 0.02, 0.25],
  leftArm: [0, 0.45, 0.5],
  leftHand: [-0.3, 0.1, 0.5],
  rightArm: [0, 0.45, 0],
  rightHand: [-0.3, 0.1, 0],
  leftThigh: [-0.05, 0.45, 0],
  leftShin: [0.35, 0.3, 0.75],
  rightThigh: [-0.05, 0.45, 0.5],
  rightShin: [0.35, 0.3, 0.25],
};
const CYCLE = 1.1; // s
const KEYS = 17;

const bytes = [];
let length = 0;
const gltf = {
  asset: { version: "2.0", generator: "make_walker.mjs" },
  scene: 0,
  scenes: [{ nodes: [0] }],
  nodes: [],
  meshes: [],
  materials: [{ name: "skin", pbrMetallicRoughness: { baseColorFactor: [0.36, 0.48, 0.6, 1], metallicFactor: 0, roughnessFactor: 0.8 } }],
  animations: [{ name: "walk", samplers: [], channels: [] }],
  accessors: [],
  bufferViews: [],
  buffers: [],
};

/** Adds numbers to the buffer and returns the index of their accessor. */
function accessor(numbers, type, componentType, bounds = {}) {
  const view = new Uint8Array(numbers.buffer, numbers.byteOffset, numbers.byteLength);
  const size = { SCALAR: 1, VEC3: 3, VEC4: 4 }[type];
  gltf.bufferViews.push({ buffer: 0, byteOffset: length, byteLength: view.length });
  gltf.accessors.push({ bufferView: gltf.bufferViews.length - 1, componentType, count: numbers.length / size, type, ...bounds });
  // Numbers begin at multiples of four bytes.
  const padding = new Uint8Array(-view.length & 3);
  bytes.push(view, padding);
  length += view.length + padding.length;
  return gltf.accessors.length - 1;
}

const floats = (numbers, type, bounds) => accessor(Float32Array.from(numbers), type, 5126, bounds);
const extremes = (numbers) =>
  Object.fromEntries(["min", "max"].map((which) => [which, [0, 1, 2].map((k) => Math[which](...numbers.filter((_, i) => i % 3 === k)))]));

const names = Object.keys(BONES);
const times = floats(
  Array.from({ length: KEYS }, (_, k) => (CYCLE * k) / (KEYS - 1)),
  "SCALAR",
  { min: [0], max: [CYCLE] },
);
names.forEach((name, k) => {
  const [parent, joint, tip, radius] = BONES[name];
  // The capsule reaches from the joint to the tip.
  const shape = new CapsuleGeometry(radius, Math.hypot(...tip), 4, 12);
  const middle = tip.map((x) => x / 2);
  const up = Math.sign(tip[1]);
  const positions = Array.from(shape.attributes.position.array, (x, i) => x + middle[i % 3]);
  // Tips lie nearly along y: the capsule is sheared by the little that they do not.
  positions.forEach((y, i) => {
    if (i % 3 === 1) positions[i - 1] += (tip[0] * (up * (y - middle[1]))) / Math.hypot(...tip);
  });
  gltf.meshes.push({
    primitives: [
      {
        attributes: {
          POSITION: floats(positions, "VEC3", extremes(positions)),
          NORMAL: floats(shape.attributes.normal.array, "VEC3"),
        },
        indices: accessor(Uint16Array.from(shape.index.array), "SCALAR", 5123),
        material: 0,
      },
    ],
  });
  const children = names.flatMap((child, index) => (BONES[child][0] === name ? [index] : []));
  // The ends of the bone are what a program needs for a collider.
  const extras = { tip, radius };
  gltf.nodes.push({ name, translation: joint, mesh: k, extras, ...(children.length > 0 && { children }) });
  if (parent === undefined || !SWINGS[name]) return;
  const [mean, swing, phase] = SWINGS[name];
  const turns = Array.from({ length: KEYS }, (_, key) => {
    const angle = mean + swing * Math.sin(2 * Math.PI * (key / (KEYS - 1) + phase));
    return [Math.sin(angle / 2), 0, 0, Math.cos(angle / 2)];
  });
  const [{ samplers, channels }] = gltf.animations;
  samplers.push({ input: times, output: floats(turns.flat(), "VEC4"), interpolation: "LINEAR" });
  channels.push({ sampler: samplers.length - 1, target: { node: k, path: "rotation" } });
});

const buffer = Buffer.concat(bytes);
gltf.buffers.push({ byteLength: buffer.length, uri: `data:application/octet-stream;base64,${buffer.toString("base64")}` });
writeFileSync(new URL("walker.gltf", import.meta.url), JSON.stringify(gltf));

// The worker of worker.html: it takes the steps and sends each frame to the page.

// An import map does not reach into a worker. A bundler resolves "muslin" here, too.
import { Cloth, load } from "../dist/muslin.js";

/** Highest speed of the ball, m/s. */
const FASTEST = 1;

await load();
const cloth = new Cloth({
  gravity: [0, -9.81, 0],
  contact: { thickness: 0.005, friction: 0.3 },
  collider: [{ shape: "sphere", center: [0, -0.25, 0], radius: 0.1 }],
  cloth: [
    {
      grid: { size: [0.6, 0.6], cells: [28, 32] },
      density: 0.2,
      stretch: { model: "membrane", stiffness: 500, damping: 0.001 },
      shear: { stiffness: 100 },
      bend: { model: "hinge", rigidity: 1e-5, damping: 0.001 },
      pin: [{ select: { corners: [0, 1, 2, 3] } }],
    },
  ],
  integrator: { error: 0.004 },
});
postMessage({ triangles: cloth.triangles().slice() });

let to = cloth.colliderPose(0).position;
/** Buffers that the page has given back. */
let spare = [];

self.onmessage = ({ data }) => {
  to = data.to ?? to;
  if (data.back) spare = data.back;
};

cloth.onDiverge = ({ message }) => postMessage({ message });
let before = performance.now();
setInterval(() => {
  const now = performance.now();
  const seconds = Math.min(0.1, (now - before) / 1000);
  before = now;
  // The ball goes towards the pointer.
  const { position } = cloth.colliderPose(0);
  const way = Math.hypot(...to.map((x, k) => x - position[k]));
  const part = Math.min(1, (FASTEST * seconds) / (way || 1));
  const place = position.map((x, k) => x + part * (to[k] - x));
  cloth.moveCollider(0, place);
  const { steps } = cloth.advance(seconds, { budget: 30 });
  if (steps === 0) return;
  const [positions, normals] = [cloth.positions(), cloth.normals()].map((view, k) => {
    const own = spare[k] ?? new Float32Array(view.length);
    own.set(view);
    return own;
  });
  spare = [];
  const ball = cloth.colliderPose(0).position;
  postMessage({ positions, normals, ball, time: cloth.time }, [positions.buffer, normals.buffer]);
}, 1000 / 120);

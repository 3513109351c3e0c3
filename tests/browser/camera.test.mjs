// The page's camera: it keeps a cloth that falls or becomes small in view, until the user moves the view.

import assert from "node:assert/strict";
import { test } from "node:test";
import { Camera } from "../../host-wasm/web/page/camera.js";

/** A square sheet of this size, m, around a point. */
const sheet = (size, [x, y, z]) =>
  Float32Array.of(...[-1, 1].flatMap((a) => [-1, 1].flatMap((b) => [x + (a * size) / 2, y, z + (b * size) / 2])));

function seen(act = () => {}) {
  const camera = new Camera();
  camera.size = [800, 600];
  camera.frame(sheet(1, [0, 1, 0]));
  const before = camera.distance;
  act(camera);
  for (let picture = 0; picture < 400; picture++) camera.follow(sheet(0.2, [0, 0.01, 0]));
  const [x, y] = camera.project(camera.matrix(true), [0, 0.01, 0]);
  return { nearer: before / camera.distance, off: Math.max(Math.abs(x / 400 - 1), Math.abs(y / 300 - 1)) };
}

test("it goes nearer to a cloth that became small, and keeps it near the middle", () => {
  const { nearer, off } = seen();
  // A fifth of the size, and the view goes nearer from 0.55 of it on.
  assert.ok(Math.abs((nearer * 0.2) / 0.55 - 1) < 0.03, `${nearer} times nearer`);
  assert.ok(off < 0.2, `${off} of half the picture off the middle`);
});

test("a user's distance stays", () => assert.ok(Math.abs(seen((camera) => camera.zoom(0.5)).nearer - 2) < 1e-9));

test("a user's place stays", () => assert.equal(seen((camera) => camera.pan(10, 0)).nearer, 1));

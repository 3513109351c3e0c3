// The golden table in WebAssembly: the same bits after every step, in Node.js and in Chromium.

import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { browser, dist, root, skip, withModule } from "./kit.mjs";

let chromium;
let page;

before(async () => {
  if (skip) return;
  chromium = await browser({ webgpu: false });
  page = await withModule(chromium);
});
after(() => chromium?.close());

/** Scenes that are not built in. */
const OWN = { "cortex-m": readFileSync(join(root, "core/examples/cortex-m/scene.toml"), "utf8") };

const lines = readFileSync(join(root, "tests/goldens.txt"), "utf8").trim().split("\n");
const goldens = lines.map((line) => line.split(" ")).filter(([, precision]) => precision === "f32");

/** Hashes of the start and of `count - 1` steps. */
function hashes(m, scene, count) {
  const cloth = new m.Cloth(scene);
  const all = Array.from({ length: count }, (_, step) => {
    if (step > 0) cloth.step();
    return cloth.stateHash().replace("fnv1a:", "");
  });
  cloth.free();
  return all;
}

/** Compares all lines; `run` takes a scene and a number of hashes. */
async function compare(run) {
  assert.ok(goldens.length > 13, "goldens.txt has lines in single precision");
  for (const [scene, , ...expected] of goldens) {
    const got = await run(OWN[scene] ?? scene, expected.length);
    const first = got.findIndex((hash, step) => hash !== expected[step]);
    assert.equal(first, -1, `${scene} differs first after step ${first}`);
  }
}

test("Node.js: every step has its golden hash", async () => {
  const m = await import(join(dist, "muslin.js"));
  await m.load(readFileSync(join(dist, "muslin_wasm_bg.wasm")));
  await compare((scene, count) => hashes(m, scene, count));
});

test("Chromium: every step has its golden hash", { skip }, async () => {
  await compare((scene, count) => page.evaluate(`(${hashes})(m, ${JSON.stringify(scene)}, ${count})`));
});

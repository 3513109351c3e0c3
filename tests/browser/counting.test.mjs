// The module built to count calls to its allocator: 1,000 steps make none, and the memory does not grow.

import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { pathToFileURL } from "node:url";
import { pack } from "./kit.mjs";

let folder;
let muslin;

before(async () => {
  folder = mkdtempSync(join(tmpdir(), "muslin-counting-"));
  execFileSync("cargo", ["run", "--quiet", "--package", "muslin-pack", "--", "--count", folder], pack);
  muslin = await import(pathToFileURL(join(folder, "muslin.js")));
  await muslin.load(readFileSync(join(folder, "muslin_wasm_bg.wasm")));
});
after(() => folder && rmSync(folder, { recursive: true, force: true }));

for (const [scene, changes] of [
  ["cantilever", {}],
  ["fold", { "cloth.grid.cells": [5, 26], "integrator.step": 1 / 240 }],
]) {
  test(`${scene}: 1,000 steps ask for no memory`, () => {
    const cloth = new muslin.Cloth(muslin.changed(muslin.scene(scene), changes));
    cloth.step(10);
    const [asked, bytes] = [muslin.allocations(), cloth.positions().buffer.byteLength];
    cloth.step(1000);
    assert.equal(muslin.allocations() - asked, 0);
    assert.equal(cloth.positions().buffer.byteLength, bytes);
    assert.ok(cloth.steps === 1010 && muslin.allocations() > 0);
    cloth.free();
  });
}

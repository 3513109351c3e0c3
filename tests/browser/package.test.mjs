// The npm package as users get it: installed from its tarball, and typed.

import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { existsSync, mkdtempSync, readdirSync, readFileSync, rmSync, symlinkSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { test } from "node:test";
import { dist, root } from "./kit.mjs";

const USE = `
import { Cloth, load, scenes } from "muslin";
import { readFileSync } from "node:fs";
await load(readFileSync(new URL(import.meta.resolve("muslin/muslin_wasm_bg.wasm"))));
const cloth = new Cloth("cantilever");
cloth.step(10);
console.log(scenes().length, cloth.positions().length, cloth.steps);
console.log(await cloth.openDevice().catch(({ message }) => message));
`;
const TYPED = `
import { Cloth, type ColliderDesc, type Given, load, type Scene, type Summary, type Warning } from "muslin";
import { load as loadInline } from "muslin/inline";
const sheet: Scene = { cloth: [{ mesh: "sheet", density: 0.2 }], gravity: [0, -9.81, 0] };
const ball: ColliderDesc = { shape: "sphere", center: [0, 0, 0], radius: 0.2 };
// @ts-expect-error: a sphere has a radius
const point: ColliderDesc = { shape: "sphere", center: [0, 0, 0] };
// @ts-expect-error: a sphere has no half size
const half: ColliderDesc = { ...ball, half: [1, 1, 1] };
// @ts-expect-error: a cloth has a mesh
const bare: Scene = { cloth: [{ density: 0.2 }] };
// @ts-expect-error: a cloth has one mesh
const double: Scene = { cloth: [{ mesh: "sheet", grid: { size: [1, 1], cells: [4, 4] }, density: 0.2 }] };
// @ts-expect-error: a list of sheets is no word
const word: Scene = { duration: 1, cloth: "x" };
// @ts-expect-error: density is misspelt
const misspelt: Scene = { duration: 1, cloth: [{ densty: 0.2 }] };
// @ts-expect-error: there is no such method
const method: Scene = { ...sheet, integrator: { method: "rk5" } };
// @ts-expect-error: gravity has three coordinates
const flat: Scene = { ...sheet, gravity: [0, -9.81] };
// Read-only lists and typed arrays are scenes, too.
const fixed = { cloth: [{ mesh: "sheet", density: 0.2 }], collider: [{ shape: "sphere", center: [0, 0, 0], radius: 1 }] } as const;
const given: Given<Scene> = { ...fixed, gravity: new Float32Array(3), duration: undefined };
console.log(given, word, misspelt, method, flat, point, half, bare, double);
export async function run(): Promise<Summary> {
  await load();
  await loadInline();
  using own = new Cloth(sheet, { meshes: { sheet: { positions: new Float32Array(9), indices: [0, 1, 2] } } });
  own.onDiverge = ({ message, time }) => console.log(message.length, time.toFixed());
  own.moveCollider(0, [0, 1, 0]);
  const { steps, dropped }: { steps: number; dropped: number } = own.advance(1 / 60, { budget: 8 });
  console.log(steps, dropped, own.hit([0, 1, 0], [0, -1, 0])?.weights[2]);
  const cloth = new Cloth("flag");
  cloth.set({ "integrator.step": 0.005, "cloth.density": 0.3, "cloth.0.grid.cells": [8, 8] });
  const k: number = cloth.steps;
  cloth.set(\`cloth.\${k}.bend.rigidity\`, 1e-5);
  // @ts-expect-error: the key is misspelt
  cloth.set("integrator.stp", 0.005);
  // @ts-expect-error: the key is misspelt
  cloth.set({ "cloth.0.densty": 0.3 });
  cloth.set("gravity", new Float32Array([0, -9.81, 0]));
  // @ts-expect-error: a density is a number
  cloth.set("cloth.density", "heavy");
  cloth.wind([1, 0, 0]);
  const x: Float32Array = cloth.positions();
  cloth.moveTo(0, x.subarray(0, 3), 0.1);
  // @ts-expect-error: a step is no word
  cloth.step("one");
  const codes: Warning["code"][] = cloth.warnings().map(({ code }) => code);
  console.log(codes);
  return cloth.summary();
}
`;

/**
 * The snippets of a manual, as Node.js runs them: the module is read from its file, `draw` prints the views' lengths, and the
 * last line prints the frames of 1/60 s that were simulated.
 */
function snippets(manual) {
  const text = readFileSync(join(root, manual), "utf8");
  const blocks = [...text.matchAll(/```js\n(.*?)```/gs)].map(([, block]) => block);
  const draw = "const draw = (...views) => console.log(...views.map(({ length }) => length));\n";
  const bytes = 'readFileSync(new URL(import.meta.resolve("muslin/muslin_wasm_bg.wasm")))';
  const frames = "console.log(Math.round(1e4 * 60 * cloth.time) / 1e4);\n";
  // A slow machine must not drop time.
  const inNode = (block) => block.replace("load()", `load(${bytes})`).replace("budget: 8", "budget: 1e9");
  return blocks.map((block) => `import { readFileSync } from "node:fs";\n${draw}${inNode(block)}${frames}`);
}

/** Every scene of the project as an object with the type of a scene. */
async function typedScenes() {
  const m = await import(join(dist, "muslin.js"));
  await m.load(readFileSync(join(dist, "muslin_wasm_bg.wasm")));
  const folder = join(root, "tests/scenes");
  const files = readdirSync(folder).filter((file) => file.endsWith(".toml"));
  const texts = files.map((file) => readFileSync(join(folder, file), "utf8"));
  const all = [...m.scenes(), ...texts].map((given) => m.scene(given));
  assert.ok(all.length > 13, `${all.length} scenes`);
  return `import type { Scene } from "muslin";\nexport const all: Scene[] = [\n${all.map((scene) => JSON.stringify(scene)).join(",\n")}\n];\n`;
}

/** Checks that all files which the examples name are there, once the packages of others lie beside this one. */
function checkExamples(modules) {
  for (const name of ["three", "playcanvas"]) symlinkSync(join(root, "host-wasm/node_modules", name), join(modules, name));
  const folder = join(modules, "muslin/examples");
  const shownIn = (folder) => readdirSync(folder).filter((file) => /\.(html|js)$/.test(file));
  const files = shownIn(folder);
  assert.deepEqual(files, shownIn(join(root, "host-wasm/examples")), "name a new example in host-wasm/pack");
  for (const file of files) {
    const text = readFileSync(join(folder, file), "utf8");
    const named = [...text.matchAll(/"(\.\.\/[^"]*)"|src="([^"]*)"|Worker\("([^"]*)"|load(?:Async)?\("([^"]*)"/g)];
    assert.ok(named.length > 0, `${file} names no file`);
    for (const path of named.map((found) => found.slice(1).find(Boolean))) {
      assert.ok(existsSync(join(folder, path)), `${file} names ${path}, which is not in the package`);
    }
  }
}

test("it is installed from its tarball, runs in Node.js and has types", async () => {
  const folder = mkdtempSync(join(tmpdir(), "muslin-package-"));
  try {
    const tarball = execFileSync("npm", ["pack", "--silent", "--pack-destination", folder], { cwd: dist, encoding: "utf8" }).trim();
    writeFileSync(join(folder, "package.json"), '{ "type": "module", "private": true }');
    execFileSync("npm", ["install", "--no-audit", "--no-fund", "--offline", join(folder, tarball)], { cwd: folder });
    writeFileSync(join(folder, "use.mjs"), USE);
    assert.equal(execFileSync("node", ["use.mjs"], { cwd: folder, encoding: "utf8" }), "13 423 10\nthere is no WebGPU here\n");
    const manuals = ["README.md", "host-wasm/README.md"].flatMap(snippets);
    assert.ok(manuals.length >= 2, "the manuals have no snippets in JavaScript");
    const printed = manuals.map((snippet) => {
      writeFileSync(join(folder, "manual.mjs"), snippet);
      return execFileSync("node", ["manual.mjs"], { cwd: folder, encoding: "utf8" });
    });
    // A flag after a frame, twice, and a cloak after a second.
    assert.deepEqual(printed, ["5643 5643 10767\n1\n", "5643 5643 10767\n1\n", "867 867 1536\n60\n"]);
    assert.match(readFileSync(join(folder, "node_modules/muslin/README.md"), "utf8"), /^# muslin in the browser/);
    checkExamples(join(folder, "node_modules"));
    writeFileSync(join(folder, "typed.ts"), TYPED);
    writeFileSync(join(folder, "scenes.ts"), await typedScenes());
    const tsc = join(root, "host-wasm/node_modules/.bin/tsc");
    const options = ["--noEmit", "--strict", "--target", "es2022", "--module", "nodenext", "--lib", "es2022,dom,esnext.disposable"];
    execFileSync(tsc, [...options, "--types", "", "typed.ts", "scenes.ts"], { cwd: folder, stdio: "inherit" });
  } finally {
    rmSync(folder, { recursive: true, force: true });
  }
});

// The examples that people copy, opened in Chromium.

import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { browser, root, shot, skip } from "./kit.mjs";

const host = join(root, "host-wasm");

let chromium;
before(async () => {
  if (skip) return;
  // The command that the example itself names, with the package of this folder.
  const [, command] = readFileSync(join(host, "examples/react/flag.jsx"), "utf8").match(/npx esbuild (.*?) && /);
  const options = [...command.split(" "), "--alias:muslin/inline=../../dist/inline.js", "--log-level=warning"];
  execFileSync(join(host, "node_modules/.bin/esbuild"), options, { cwd: join(host, "examples/react"), stdio: "inherit" });
  chromium = await browser({ webgpu: false });
});
after(() => chromium?.close());

for (const name of ["three.html", "cape.html", "playcanvas.html", "worker.html", "react/index.html"]) {
  test(`${name} draws cloth that moves`, { skip }, async () => {
    const { page, errors } = await chromium.open(`examples/${name}`, { width: 640, height: 400 });
    await page.waitForFunction(() => (window.cloth?.time ?? window.time) >= 0.5);
    await shot(page, name.replace(/\W/g, "-"));
    const stretch = await page.evaluate(() => window.cloth?.summary().stretch.max);
    assert.ok(stretch === undefined || stretch < 1.2, `an edge is ${stretch} times its length`);
    assert.deepEqual(errors, []);
    await page.close();
  });
}

test("the ball of the worker follows the pointer", { skip }, async () => {
  const { page, errors } = await chromium.open("examples/worker.html", { width: 640, height: 400 });
  await page.waitForFunction(() => window.ball?.[1] < -0.2);
  await page.mouse.move(320, 200);
  await page.waitForFunction(() => window.ball[1] > -0.15);
  assert.deepEqual(errors, []);
  await page.close();
});

test("the cape does not pass into the figure", { skip }, async () => {
  const { page } = await chromium.open("examples/cape.html", { width: 640, height: 400 });
  await page.waitForFunction(() => window.cloth?.time >= 1.5);
  // Distance of the vertices from the axes of the capsules, less their radii, m.
  const deepest = await page.evaluate(() => {
    const [positions, bodies] = [cloth.positions(), cloth.bodies()];
    const pinned = new Set(cloth.pins());
    let least = Infinity;
    for (const { points, radius } of bodies) {
      const [a, b] = [points.subarray(0, 3), points.subarray(3, 6)];
      const along = b.map((x, k) => x - a[k]);
      const length = along.reduce((sum, x) => sum + x * x, 0);
      for (let k = 0; k < positions.length; k += 3) {
        if (pinned.has(k / 3)) continue;
        const arm = [0, 1, 2].map((axis) => positions[k + axis] - a[axis]);
        const part = Math.min(1, Math.max(0, arm.reduce((sum, x, axis) => sum + x * along[axis], 0) / length));
        least = Math.min(least, Math.hypot(...arm.map((x, axis) => x - part * along[axis])) - radius);
      }
    }
    return least;
  });
  assert.ok(deepest > 0, `a vertex is ${-1000 * deepest} mm inside`);
  await page.close();
});

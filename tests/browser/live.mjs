// The detail `live` without the page: for each built-in scene the vertices, the step and the error that this machine gets, and
// what a run with them does over six seconds: simulated time over real time, the same in the most expensive two seconds, and the
// largest stretch. The steps run alone, on one thread of Node.js. The scenes are left in target/live, where `muslin run --audit
// FILE` counts crossings in the same states.
//     cargo run -p muslin-pack && node tests/browser/live.mjs [SCENE...]

import { mkdirSync, readFileSync, writeFileSync } from "node:fs";
import { createRequire } from "node:module";
import { join } from "node:path";
import { choose } from "../../host-wasm/web/page/live.js";
import { dist, root } from "./kit.mjs";

const { stringify } = createRequire(join(root, "host-wasm/package.json"))("smol-toml");
const SECONDS = 6;
const PART = 2;
const folder = join(root, "target/live");
mkdirSync(folder, { recursive: true });
const m = await import(join(dist, "muslin.js"));
await m.load(readFileSync(join(dist, "muslin_wasm_bg.wasm")));

/** Runs a cloth and returns its speed, that of its most expensive part, and its largest stretch. */
function ran(cloth) {
  const began = performance.now();
  let [worst, stretch] = [0, 0];
  let [time, at] = [0, began];
  while (cloth.time < SECONDS) {
    cloth.step();
    stretch = Math.max(stretch, cloth.summary().stretch.max - 1);
    if (cloth.time - time < PART) continue;
    worst = Math.max(worst, (performance.now() - at) / 1000 / (cloth.time - time));
    [time, at] = [cloth.time, performance.now()];
  }
  return { speed: (1000 * cloth.time) / (performance.now() - began), worst: 1 / worst, stretch };
}

console.log("scene       vertices  step, ms  error, mm  speed  in its worst 2 s  stretch  chosen in, s");
for (const name of process.argv.length > 2 ? process.argv.slice(2) : m.scenes()) {
  const scene = m.scene(name);
  const make = (changes) => new m.Cloth(m.changed(scene, changes));
  const began = performance.now();
  const { changes } = choose(make, scene, true);
  const chosen = (performance.now() - began) / 1000;
  writeFileSync(join(folder, `${name}.toml`), stringify({ ...m.changed(scene, changes), duration: SECONDS }));
  const cloth = make(changes);
  const { vertexCount, stepLength, stepError } = cloth;
  const { speed, worst, stretch } = ran(cloth);
  cloth.free();
  const columns = [
    [vertexCount, 8],
    [(1000 * stepLength).toPrecision(3), 8],
    [stepError ? 1000 * stepError : "default", 9],
    [speed.toFixed(2), 5],
    [worst.toFixed(2), 16],
    [`${(100 * stretch).toFixed(1)} %`, 7],
    [chosen.toFixed(1), 12],
  ];
  console.log(`${name.padEnd(10)}  ${columns.map(([text, width]) => String(text).padStart(width)).join("  ")}`);
}

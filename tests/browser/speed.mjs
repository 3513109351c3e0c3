// Steps per second of `hanging` (64x64) in a browser and native, one thread each, in alternating turns:
//     cargo run -p muslin-pack && cargo build --release -p muslin-cli && node tests/browser/speed.mjs

import { execFileSync } from "node:child_process";
import { mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { browser, root } from "./kit.mjs";

const SECONDS = 2;
const TURNS = 15;
// Fixed steps, so that both take the same number.
const [STEP, TOLERANCE] = [1 / 60, 1e-3];
const muslin = join(process.env.CARGO_TARGET_DIR ?? join(root, "target"), "release/muslin");

function native() {
  const out = mkdtempSync(join(tmpdir(), "muslin-speed-"));
  try {
    const run = [
      "run",
      "hanging",
      "--set",
      `integrator.step=${STEP}`,
      "--set",
      `integrator.tolerance=${TOLERANCE}`,
      "--threads",
      "1",
      "--duration",
      SECONDS,
      "--preview",
      "none",
      "--json",
      "--quiet",
      "--out",
      out,
    ];
    const { steps, state_hash: hash, stage_ms: stages } = JSON.parse(execFileSync(muslin, run.map(String), { encoding: "utf8" }));
    return { steps, hash, ms: stages.predict + stages.broad_phase + stages.narrow_phase + stages.response };
  } finally {
    rmSync(out, { recursive: true, force: true });
  }
}

const chromium = await browser({ webgpu: false });
const { page } = await chromium.open("blank.html");
const inBrowser = () =>
  page.evaluate(
    async ([seconds, step, tolerance]) => {
      const m = await import("/dist/muslin.js");
      await m.load();
      const cloth = new m.Cloth(m.changed(m.scene("hanging"), { "integrator.step": step, "integrator.tolerance": tolerance }));
      const steps = Math.round(seconds / cloth.stepLength);
      cloth.takeTimes();
      cloth.step(steps);
      const ms = Object.values(cloth.takeTimes()).reduce((sum, ms) => sum + ms) / steps;
      const hash = cloth.stateHash();
      cloth.free();
      return { steps, hash, ms };
    },
    [SECONDS, STEP, TOLERANCE],
  );

const ratios = [];
await inBrowser();
for (let turn = 0; turn < TURNS; turn++) {
  const [ours, theirs] = [await inBrowser(), native()];
  if (ours.hash !== theirs.hash || ours.steps !== theirs.steps) throw new Error("not the same run");
  ratios.push(theirs.ms / ours.ms);
  console.log(`browser ${ours.ms.toFixed(2)} ms a step, native ${theirs.ms.toFixed(2)}: ${(100 * ratios.at(-1)).toFixed(0)} % of native`);
}
ratios.sort((a, b) => a - b);
console.log(`median of ${TURNS} turns: ${(100 * ratios[TURNS >> 1]).toFixed(0)} % of native, the same ${SECONDS} s to the last bit`);
await chromium.close();

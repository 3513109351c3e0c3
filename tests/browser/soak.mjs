// Ten minutes of use: scenes, drags, balls, resets, methods and texts, one after the other. Prints the memory of the browser's
// renderer processes, MB, after each round of all scenes. It must not grow from round to round.
//     cargo run -p muslin-pack && node tests/browser/soak.mjs [MINUTES]

import { execFileSync } from "node:child_process";
import { browser } from "./kit.mjs";

const minutes = Number(process.argv[2] ?? 10);
const chromium = await browser({ webgpu: false });
const { page, errors } = await chromium.open("dist/page/index.html#scene=cantilever");
await page.waitForFunction(() => document.getElementById("cost").textContent);
const scenes = await page.locator("#scene option").allTextContents();

/** Memory of the renderers, MB. */
function memory() {
  const rows = execFileSync("ps", ["-eo", "rss,args"], { encoding: "utf8" }).split("\n");
  const renderers = rows.filter((row) => row.includes("--type=renderer") && !row.includes("grep"));
  return renderers.reduce((sum, row) => sum + Number.parseInt(row, 10), 0) / 1024;
}

async function use(scene) {
  await page.selectOption("#scene", scene);
  await page.waitForFunction((scene) => muslin.run().cloth.scene.name === scene && muslin.run().view.steps > 1, scene);
  const { width, height } = await page.locator("#pad").boundingBox();
  await page.mouse.move(width / 2, height / 2);
  await page.mouse.down();
  for (let k = 0; k < 10; k++) {
    await page.mouse.move(width / 2 + 60 * Math.sin(k), height / 2 - 8 * k);
    await page.waitForTimeout(60);
  }
  await page.mouse.up();
  await page.focus("#pad");
  await page.keyboard.press("b");
  await page.waitForTimeout(500);
  await page.selectOption("#material", "denim");
  await page.waitForTimeout(300);
  await page.keyboard.press("r");
}

const began = performance.now();
for (let round = 1; performance.now() - began < 60_000 * minutes; round++) {
  for (const scene of scenes) await use(scene);
  console.log(`round ${round}, ${((performance.now() - began) / 60_000).toFixed(1)} min: ${memory().toFixed(0)} MB`);
}
console.log(errors.length ? errors : "no errors on the console");
await chromium.close();

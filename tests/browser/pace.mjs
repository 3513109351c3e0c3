// How fast the page is, for each built-in scene at the detail `live`, with the live reference, drawn by WebGL2: vertices, steps,
// simulated time over real time over ten seconds, and the same for the steps alone, as the worker measures them; the largest
// stretch; and the time of the page's own thread per picture, the median, the 99th of 100 and the largest. In the second
// half a hand drags the cloth.
//     cargo run -p muslin-pack && node tests/browser/pace.mjs [SCENE...]

import { browser } from "./kit.mjs";

const SECONDS = 10;
const chromium = await browser({ webgpu: false });

/** Records the time of each frame on the page's thread, ms. */
function record() {
  window.frames = [];
  const request = window.requestAnimationFrame;
  window.requestAnimationFrame = (what) =>
    request((now) => {
      const began = performance.now();
      what(now);
      window.frames.push(performance.now() - began);
    });
}

async function open(scene) {
  const { page } = await chromium.open("blank.html");
  await page.addInitScript(record);
  await page.goto(new URL(`dist/page/index.html${scene ? `#scene=${scene}` : ""}`, page.url()).href);
  await page.waitForFunction(() => document.getElementById("cost")?.textContent && muslin.run().numbers);
  return page;
}

const state = (page) =>
  page.evaluate(() => {
    const { numbers, view, cloth } = muslin.run();
    const ms = Object.values(numbers.times).reduce((sum, part) => sum + part, 0);
    return { time: view.time, at: performance.now(), stretch: numbers.stretch - 1, alone: (1000 * cloth.stepLength) / ms };
  });

/** Drags the vertex nearest to the middle of the picture to and fro for some seconds, and collects states meanwhile. */
async function drag(page, seconds, states) {
  const [x, y] = await page.evaluate(() => {
    const { camera, run } = muslin;
    const [width, height] = camera.size;
    const vertex = camera.pick(run().positions(), width / 2, height / 2, Infinity);
    const places = run().positions();
    return camera.project(camera.matrix(true), places.slice(3 * vertex, 3 * vertex + 3));
  });
  await page.mouse.move(x, y);
  await page.mouse.down();
  for (let k = 1; k <= 5 * seconds; k++) {
    await page.mouse.move(x + 60 * Math.sin(k / 3), y - 40 * Math.sin(k / 5));
    await page.waitForTimeout(200);
    states.push(await state(page));
  }
  await page.mouse.up();
}

const first = await open();
const all = await first.locator("#scene option").allTextContents();
await first.close();
const named = process.argv.slice(2);
console.log("scene       times real time, steps alone (least), stretch, ms per picture (median, 99 %, largest), detail");
for (const scene of named.length ? named : all) {
  const page = await open(scene);
  await page.evaluate(() => (window.frames = []));
  const states = [await state(page)];
  for (let k = 0; k < 2.5 * SECONDS; k++) {
    await page.waitForTimeout(200);
    states.push(await state(page));
  }
  await drag(page, SECONDS / 2, states);
  const [from, to] = [states[0], states.at(-1)];
  const times = (await page.evaluate(() => window.frames)).sort((a, b) => a - b);
  const least = Math.min(...states.map(({ alone }) => alone));
  const stretch = Math.max(...states.map(({ stretch }) => stretch));
  const speed = (1000 * (to.time - from.time)) / (to.at - from.at);
  const half = states[Math.floor(2.5 * SECONDS)];
  console.log(
    "before the drag",
    ((1000 * (half.time - from.time)) / (half.at - from.at)).toFixed(2),
    Math.min(...states.slice(0, 25).map(({ alone }) => alone)).toFixed(2),
    Math.max(...states.slice(0, 25).map(({ stretch }) => stretch)).toFixed(3),
  );
  const row = [speed.toFixed(2), least.toFixed(2), `${(100 * stretch).toFixed(1)} %`];
  console.log(
    scene.padEnd(11),
    row.join("  "),
    ` ${[0.5, 0.99, 1].map((part) => times[Math.min(times.length - 1, Math.floor(part * times.length))].toFixed(1)).join(" ")}  ${await page.locator("#cost").textContent()}`,
  );
  await page.close();
}
await chromium.close();

// How fast the page is, for each built-in scene at the detail `live`, with the live reference, drawn by WebGL2: simulated time
// over real time; simulated time over the time of the steps alone, as the worker measures it; the largest stretch; and the time
// of the page's own thread per picture without the calls of WebGL, which software makes slow: the median, the 99th of 100 and
// the largest. Over five seconds, and over five more while a hand drags the cloth.
//     cargo run -p muslin-pack && node tests/browser/pace.mjs [SCENE...]

import { browser } from "./kit.mjs";

const SECONDS = 5;
const chromium = await browser({ webgpu: false });

/** Records the time of each frame on the page's thread without that of the renderer, ms. */
function record() {
  window.frames = [];
  const request = window.requestAnimationFrame;
  const wrapped = new WeakSet();
  let drawing = 0;
  const wrap = (renderer) => {
    const { draw } = renderer;
    renderer.draw = (...given) => {
      const began = performance.now();
      draw(...given);
      drawing += performance.now() - began;
    };
    wrapped.add(renderer);
  };
  window.requestAnimationFrame = (what) =>
    request((now) => {
      const renderer = window.muslin?.picture.renderer;
      if (renderer && !wrapped.has(renderer)) wrap(renderer);
      drawing = 0;
      const began = performance.now();
      what(now);
      window.frames.push(performance.now() - began - drawing);
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
    return { time: view.time, at: performance.now(), stretch: numbers.stretch - 1, cost: ms / 1000 / cloth.stepLength };
  });

/** Speed, speed of the steps alone, and largest stretch, as text. */
function summed(states) {
  const [from, to] = [states[0], states.at(-1)];
  const simulated = to.time - from.time;
  const spent = states.slice(1).reduce((sum, { time, cost }, k) => sum + (time - states[k].time) * cost, 0);
  const stretch = Math.max(...states.map(({ stretch }) => stretch));
  return `${((1000 * simulated) / (to.at - from.at)).toFixed(2)} ${(simulated / spent).toFixed(2)} ${(100 * stretch).toFixed(1)} %`;
}

/** The median, the 99th of 100 and the largest, as text. */
function spread(times) {
  const sorted = times.sort((a, b) => a - b);
  return [0.5, 0.99, 1].map((part) => sorted[Math.min(sorted.length - 1, Math.floor(part * sorted.length))].toFixed(1)).join(" ");
}

/** Drags the vertex nearest to the middle of the picture to and fro, and collects states meanwhile. */
async function drag(page, states) {
  const [x, y] = await page.evaluate(() => {
    const { camera, run } = muslin;
    const [width, height] = camera.size;
    const vertex = camera.pick(run().positions(), width / 2, height / 2, Infinity);
    const places = run().positions();
    return camera.project(camera.matrix(true), places.slice(3 * vertex, 3 * vertex + 3));
  });
  await page.mouse.move(x, y);
  await page.mouse.down();
  for (let k = 1; k <= 5 * SECONDS; k++) {
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
console.log("scene       alone: speed, steps, stretch, ms per picture | dragged: speed, steps, stretch, ms per picture | detail");
for (const scene of named.length ? named : all) {
  const page = await open(scene);
  const frames = () => page.evaluate(() => window.frames.splice(0));
  await frames();
  const states = [await state(page)];
  for (let k = 0; k < 5 * SECONDS; k++) {
    await page.waitForTimeout(200);
    states.push(await state(page));
  }
  const alone = `${summed(states)}  ${spread(await frames())}`;
  const dragged = [states.at(-1)];
  await drag(page, dragged);
  const cost = await page.locator("#cost").textContent();
  console.log(`${scene.padEnd(11)} ${alone} | ${summed(dragged)}  ${spread(await frames())} | ${cost}`);
  await page.close();
}
await chromium.close();

// How fast the page is: simulated time over real time for each built-in scene in `quick`, over its first seconds, with the live
// reference, drawn by WebGL2. A scene that keeps up has 1.
//     cargo run -p muslin-pack && node tests/browser/pace.mjs [SCENE...]

import { browser } from "./kit.mjs";

const SECONDS = 10;
const chromium = await browser({ webgpu: false });
const { page } = await chromium.open("dist/page/index.html");
await page.waitForFunction(() => window.muslin?.run().view?.steps > 0);
const named = process.argv.slice(2);
const scenes = named.length ? named : await page.evaluate(() => import("/dist/muslin.js").then((m) => m.load().then(() => m.scenes())));
await page.close();
for (const scene of scenes) {
  const { page } = await chromium.open(`dist/page/index.html#scene=${scene}`);
  await page.waitForFunction(() => window.muslin?.run().view?.steps > 0);
  const [from, began] = [await page.evaluate(() => muslin.run().view.time), performance.now()];
  await page.waitForTimeout(1000 * SECONDS);
  const [to, ended] = [await page.evaluate(() => muslin.run().view.time), performance.now()];
  console.log(`${scene.padEnd(11)} ${((1000 * (to - from)) / (ended - began)).toFixed(2)}`);
  await page.close();
}
await chromium.close();

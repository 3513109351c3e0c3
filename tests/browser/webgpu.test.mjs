// The page with WebGPU: it draws with WebGPU, and detection on the device finds the same contacts as the
// processor.

import assert from "node:assert/strict";
import { readFile } from "node:fs/promises";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { browser, dark, dist, drawn, free, held, more, shot, skip, spot, steps, still } from "./kit.mjs";

let chromium;
before(async () => {
  if (skip) return;
  chromium = await browser({ webgpu: true });
});
after(() => chromium?.close());

test("it draws with WebGPU, and again when the device is lost", { skip }, async () => {
  const { page, errors } = await chromium.open("dist/page/index.html#scene=poncho");
  await steps(page, 3);
  assert.equal(await page.locator("#banner").textContent(), "detection: processor · picture: WebGPU");
  assert.ok((await drawn(page)) > 1000, "cloth and figure are seen");
  await shot(page, "webgpu");
  await page.evaluate(() => {
    muslin.picture.renderer.lose();
  });
  await page.waitForFunction(() => /the picture was lost .*redrawn/.test(document.getElementById("banner").textContent));
  assert.ok((await drawn(page)) > 1000, "drawn anew");
  await more(page, 2);
  assert.deepEqual(errors, []);
  await page.close();
});

test("it draws pins dark, and them alone", { skip }, async () => {
  const { page, errors } = await chromium.open("dist/page/index.html#scene=cantilever&compare=0");
  await steps(page, 1);
  await page.evaluate(() => (muslin.run().paused = true));
  await still(page);
  const [pin] = await page.evaluate(() => muslin.run().pins());
  assert.deepEqual([await dark(page, pin), await dark(page, -1)], [true, false]);
  assert.deepEqual(errors, []);
  await page.close();
});

test("the page detects on the device while a hand drags, and here again", { skip }, async () => {
  const { page, errors } = await chromium.open("dist/page/index.html#scene=ball&compare=0&cloth.0.grid.cells=[12,14]");
  await steps(page, 2);
  const banner = () => page.locator("#banner").textContent();
  // A software device is slower than the processor: the page does not use it unless the box is checked.
  assert.equal(await page.isChecked("#device"), false);
  await page.check("#device");
  await page.waitForFunction(() => /detection: .+, WebGPU · picture: WebGPU/.test(document.getElementById("banner").textContent));
  const [x, y] = await spot(page, 0);
  await page.mouse.move(x, y);
  await page.mouse.down();
  await page.mouse.move(x, y - 150, { steps: 5 });
  await more(page, 20);
  await held(page);
  await page.mouse.up();
  await page.uncheck("#device");
  await page.waitForFunction(() => /detection: processor/.test(document.getElementById("banner").textContent));
  await more(page, 2);
  await free(page);
  assert.equal(await banner(), "detection: processor · picture: WebGPU");
  assert.deepEqual(errors, []);
  await page.close();
});

/** Added to the page's worker: `lose` in its channel destroys every device that the worker has, as a driver that stops does. */
const LOSABLE = `{
  const ask = GPUAdapter.prototype.requestDevice;
  const devices = [];
  GPUAdapter.prototype.requestDevice = async function (...given) {
    devices.push(await ask.apply(this, given));
    return devices.at(-1);
  };
  new BroadcastChannel("lose").onmessage = () => devices.splice(0).forEach((device) => device.destroy());
}
`;

test("a device that is lost while it detects is opened again, and the run goes on", { skip }, async () => {
  const { page, errors } = await chromium.open("blank.html");
  const source = await readFile(join(dist, "page/simulator.js"), "utf8");
  await page.route("**/page/simulator.js", (route) => route.fulfill({ contentType: "text/javascript", body: LOSABLE + source }));
  await page.goto(page.url().replace("blank.html", "dist/page/index.html#scene=ball&compare=0&cloth.0.grid.cells=[12,14]"));
  await steps(page, 2);
  await page.check("#device");
  await page.waitForFunction(() => /detection: .+, WebGPU/.test(document.getElementById("banner").textContent));
  const device = await page.evaluate(() => muslin.run().device);
  await more(page, 3);
  await page.evaluate(() => new BroadcastChannel("lose").postMessage(""));
  await page.waitForFunction(() => /opened it again/.test(document.getElementById("banner").textContent));
  await more(page, 10);
  assert.equal(await page.isChecked("#device"), true);
  assert.equal(await page.evaluate(() => muslin.run().device), device, "it detects on the device again");
  assert.equal(await page.evaluate(() => muslin.run().hasStopped), false);
  assert.deepEqual(errors, []);
  await page.close();
});

test("from one state the device finds the contacts that the processor finds", { skip }, async () => {
  const { page, errors } = await chromium.open("blank.html");
  const told = await page.evaluate(async () => {
    const m = await import("/dist/muslin.js");
    await m.load();
    const scene = m.changed(m.scene("fold"), { "cloth.grid.cells": [4, 20], "cloth.position": [0, 0.5, 0] });
    const counts = ({ candidates, proximity, impacts }) => [candidates, proximity, impacts];
    const rows = [];
    // At these times the cloth falls on the plane and on itself.
    for (const before of [60, 90, 120]) {
      const [ours, theirs] = [new m.Cloth(scene), new m.Cloth(scene)];
      ours.step(before);
      theirs.step(before);
      const from = counts(ours.summary());
      const device = await theirs.openDevice();
      ours.step();
      await theirs.awaitStep();
      // Then changes the scene: the device must not keep the old one.
      if (before === 120) {
        for (const cloth of [ours, theirs]) cloth.set("contact.self", false);
        ours.step();
        await theirs.awaitStep();
      }
      const [own, others] = [ours, theirs].map((cloth) => counts(cloth.summary()).map((count, k) => count - from[k]));
      const [here, there] = [ours, theirs].map((cloth) => Array.from(cloth.positions()));
      const same = here.every((coordinate, k) => coordinate === there[k]);
      rows.push({ device, own, others, same, kept: theirs.hasDevice, note: theirs.takeNote() });
      [ours, theirs].forEach((cloth) => cloth.free());
    }
    return rows;
  });
  for (const { device, own, others, same, kept, note } of told) {
    assert.ok(device.length > 0 && kept, `the device was asked, and answered: ${note}`);
    // The device does not leave out pairs that move together.
    assert.ok(others[0] >= own[0], `${others[0]} candidates on the device, ${own[0]} on the processor`);
    assert.deepEqual(others.slice(1), own.slice(1), "near pairs, impacts");
    assert.ok(same, "positions are the same, bit for bit");
  }
  assert.ok(
    told.some(({ own }) => own[1] > 20),
    "there is contact",
  );
  assert.deepEqual(errors, []);
  await page.close();
});

test("with a step under way nothing else is asked of the module", { skip }, async () => {
  const { page } = await chromium.open("blank.html");
  const why = await page.evaluate(async () => {
    const m = await import("/dist/muslin.js");
    await m.load();
    const cloth = new m.Cloth("cantilever");
    await cloth.openDevice();
    const step = cloth.awaitStep();
    let why = "nothing";
    try {
      cloth.positions();
    } catch (error) {
      why = error.message;
    }
    await step;
    return `${why}; then ${cloth.steps}`;
  });
  assert.equal(why, "a step is under way; await awaitStep() first; then 1");
  await page.close();
});

// The page on its fallback path: without WebGPU, the processor detects and WebGL2 draws.

import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import { browser, dark, drawn, free, held, more, pinned, shot, skip, spot, steps, still } from "./kit.mjs";

const PAGE = "dist/page/index.html";

let chromium;
before(async () => {
  if (skip) return;
  chromium = await browser({ webgpu: false });
});
after(() => chromium?.close());

/** Opens the page and waits until it has taken two steps. */
async function open(hash = "", viewport) {
  const { page, errors } = await chromium.open(`${PAGE}${hash}`, viewport);
  await steps(page, 2);
  return { page, errors };
}

const inPage = (page, what, given) => page.evaluate(what, given);

test("it opens without an error, draws, and the cloth falls on the ball", { skip }, async () => {
  const { page, errors } = await open();
  const height = () => inPage(page, () => muslin.run().positions()[1]);
  const first = await height();
  await steps(page, 10);
  assert.ok((await height()) < first, "a corner falls");
  assert.ok((await drawn(page)) > 2000, "the picture shows cloth and ball");
  assert.equal(await page.locator("#banner").textContent(), "detection: processor · picture: WebGL2");
  await page.waitForFunction(() => /\d (µm|mm|m) at/.test(document.getElementById("numbers").textContent));
  for (const name of ["largest stretch", "energy", "contacts per step", "ms per step", "error (RMS"]) {
    assert.ok((await page.locator("#numbers").textContent()).includes(name), name);
  }
  const ms = await inPage(page, () => muslin.firstFrame());
  console.log(`first picture ${ms.toFixed(0)} ms after the page was asked for`);
  await shot(page, "ball");
  assert.deepEqual(errors, []);
  await page.close();
});

test("warnings stand among the numbers, and go with their reason", { skip }, async () => {
  const { page, errors } = await open("#scene=flag&compare=0");
  const shows = (whether) =>
    page.waitForFunction(
      (whether) => document.getElementById("numbers").textContent.includes("does not divide a frame") === whether,
      whether,
    );
  const set = (step) => inPage(page, (step) => muslin.run().ask(() => muslin.run().set({ "integrator.step": step })), step);
  await shows(false);
  await set(1);
  await shows(true);
  await set(undefined);
  await shows(false);
  assert.deepEqual(errors, []);
  await page.close();
});

test("a hand drags the cloth, pins it and lets it go", { skip }, async () => {
  const { page, errors } = await open("#scene=flag&compare=0");
  const seen = () =>
    inPage(page, () => {
      const { camera, run } = muslin;
      const vertex = run().cloth.vertexCount - 1;
      const place = Array.from(
        run()
          .positions()
          .subarray(3 * vertex, 3 * vertex + 3),
      );
      return { place, at: camera.project(camera.matrix(true), place), pins: Array.from(run().pins()), vertex };
    });
  // The cloth stands still until it is grabbed.
  await page.click("#pause");
  await still(page);
  const before = await seen();
  await page.mouse.move(before.at[0], before.at[1]);
  await page.mouse.down();
  await inPage(page, () => (muslin.run().paused = false));
  for (let k = 1; k <= 10; k++) {
    await page.mouse.move(before.at[0] + 10 * k, before.at[1] - 12 * k);
    await page.waitForTimeout(50);
  }
  await inPage(page, () => (window.from = muslin.run().view.steps));
  await page.waitForFunction(() => muslin.run().view.steps > window.from + 20);
  const led = await seen();
  assert.deepEqual(led.pins, before.pins, "it is drawn by a force");
  const pin = await held(page);
  assert.ok(Math.abs(pin - before.vertex) < 60, "the vertex under the pointer, or a neighbour, is taken");
  assert.ok(led.place[1] - before.place[1] > 0.1, `dragging up moves it up: ${before.place[1]} to ${led.place[1]}`);
  await page.keyboard.press("p");
  await page.mouse.up();
  // Pinned, it stays.
  await pinned(page, before.pins.length + 1);
  await free(page);
  await inPage(page, (pin) => muslin.run().release(pin), pin);
  await pinned(page, before.pins.length);
  assert.deepEqual(errors, []);
  await page.close();
});

test("a finger drags the cloth, two come nearer, and the page stays where it is", { skip }, async () => {
  const { page, errors } = await open("#scene=flag&compare=0", { width: 390, height: 844 });
  const touches = await page.context().newCDPSession(page);
  await touches.send("Emulation.setTouchEmulationEnabled", { enabled: true });
  const touch = (type, ...points) =>
    touches.send("Input.dispatchTouchEvent", { type, touchPoints: points.map(([x, y], id) => ({ x, y, id })) });
  const seen = () =>
    inPage(page, () => {
      const { camera, run } = muslin;
      const vertex = run().cloth.vertexCount - 1;
      const place = Array.from(
        run()
          .positions()
          .subarray(3 * vertex, 3 * vertex + 3),
      );
      return { at: camera.project(camera.matrix(true), place), pins: run().pins().length, distance: camera.distance };
    });
  await page.click("#pause");
  await still(page);
  const before = await seen();
  const [x, y] = before.at;
  await touch("touchStart", [x, y]);
  await inPage(page, () => (muslin.run().paused = false));
  for (let k = 1; k <= 10; k++) await touch("touchMove", [x - 6 * k, y - 8 * k]);
  // The vertex under the finger is held, and then let go.
  await held(page);
  await touch("touchEnd");
  await free(page);
  await touch("touchStart", [150, 200], [250, 300]);
  await touch("touchMove", [100, 150], [300, 350]);
  await touch("touchEnd");
  await free(page);
  const after = await seen();
  assert.ok(after.distance < 0.9 * before.distance, `nearer: ${before.distance} m, then ${after.distance} m`);
  assert.equal(await inPage(page, () => scrollY), 0);
  assert.deepEqual(errors, []);
  await page.close();
});

test("one hand holds one vertex, and its pins are seen", { skip }, async () => {
  const { page } = await open("#scene=cantilever&compare=0&detail=scene");
  const pins = () => inPage(page, () => Array.from(muslin.run().pins()));
  const before = await pins();
  assert.deepEqual([await dark(page, before[0]), await dark(page, -1)], [true, false], "pins are dark, and they alone");
  await page.focus("#pad");
  await page.keyboard.press("g");
  const byKey = await held(page);
  assert.ok(await dark(page, byKey), "what is held is dark");
  await inPage(page, () => (muslin.run().paused = true));
  await still(page);
  await page.mouse.move(...(await spot(page, -1)));
  await page.mouse.down();
  await inPage(page, () => (muslin.run().paused = false));
  await held(page, byKey);
  await page.mouse.up();
  await free(page);
  assert.deepEqual(await pins(), before);
  await page.close();
});

test("a double click pins, and another lets go", { skip }, async () => {
  const { page } = await open("#scene=cantilever&detail=scene");
  const pins = () => inPage(page, () => Array.from(muslin.run().pins()));
  const press = async (vertex, count) => {
    // The run is paused while the pointer aims; a grabbed vertex follows the pointer only if the run continues.
    await inPage(page, () => (muslin.run().paused = true));
    await still(page);
    await page.mouse.move(...(await spot(page, vertex)));
    await page.mouse.down();
    await inPage(page, () => (muslin.run().paused = false));
    await more(page, 2);
    await page.mouse.up();
    await page.mouse.down({ clickCount: 2 });
    await more(page, 2);
    await page.mouse.up({ clickCount: 2 });
    await pinned(page, count);
    return pins();
  };
  const before = await pins();
  const after = await press(-1, before.length + 1);
  assert.equal(after.length, before.length + 1);
  assert.deepEqual(
    await press(
      after.find((pin) => !before.includes(pin)),
      before.length,
    ),
    before,
  );
  await page.close();
});

test("a link to other changes, in whatever order they were made, gives what was in view", { skip }, async () => {
  const { page } = await open("#scene=cantilever&detail=scene");
  await page.selectOption("#material", "leather");
  for (const box of ["shear", "drag"]) await page.uncheck(`#${box}`);
  await page.check("#shear");
  await page.selectOption("#material", "silk");
  await more(page, 2);
  const scene = await inPage(page, () => muslin.run().cloth.scene);
  assert.equal(scene.drag, undefined);
  const address = page.url();
  await page.goto("about:blank");
  await page.goto(address);
  await steps(page, 2);
  assert.deepEqual(await inPage(page, () => muslin.run().cloth.scene), scene);
  await page.close();
});

test("what is chosen is done, kept in the address, and found there again", { skip }, async () => {
  const { page, errors } = await open("#scene=cantilever&detail=scene");
  await page.selectOption("#material", "leather");
  await page.selectOption("#method", "bdf2");
  await page.fill("#length", "2");
  await page.locator("#length").blur();
  await page.check("#strain");
  await page.uncheck("#shear");
  await page.waitForFunction(() => muslin.run().cloth.scene.cloth[0].shear === undefined);
  const scene = await inPage(page, () => muslin.run().cloth.scene);
  assert.equal(scene.integrator.method, "bdf2");
  assert.equal(scene.integrator.step, 0.002);
  assert.equal(scene.cloth[0].density, 0.9);
  const address = page.url();
  await page.close();
  const { page: again } = await open(address.slice(address.indexOf("#")));
  const found = await inPage(again, () => muslin.run().cloth.scene);
  assert.deepEqual(found, scene);
  assert.ok(await again.isChecked("#strain"));
  assert.equal(await again.inputValue("#material"), "leather");
  await again.close();
  assert.deepEqual(errors, []);
});

test("a scene that was typed in is in the address, and so may be words", { skip }, async () => {
  const { page } = await open("#scene=cantilever&integrator.method=bdf2");
  assert.equal(await inPage(page, () => muslin.run().cloth.scene.integrator.method), "bdf2");
  const text = `name = "mine"
duration = 1
[[cloth]]
grid = { size = [1, 1], cells = [4, 4] }
density = 0.3
[cloth.stretch]
model = "membrane"
stiffness = 100
[integrator]
method = "rk4"
step = 0.002
`;
  await page.locator("summary", { hasText: "Scene as text" }).click();
  await page.fill("#text", text);
  await page.click("#use");
  await page.waitForFunction(() => muslin.run().cloth.scene.name === "mine");
  await page.click("#reset");
  const address = page.url();
  await page.close();
  const { page: again } = await open(address.slice(address.indexOf("#")));
  assert.equal(await inPage(again, () => muslin.run().cloth.scene.cloth[0].density), 0.3);
  assert.equal(await again.inputValue("#text"), text);
  // The scene stays in the list, once, after another scene was viewed.
  for (const [name, density] of [
    ["cantilever", 0.2],
    ["own", 0.3],
  ]) {
    await again.selectOption("#scene", name);
    await again.click("#strain");
    await again.waitForFunction((density) => muslin.run().cloth.scene.cloth[0].density === density, density);
  }
  assert.equal(await again.locator("#scene option", { hasText: "own" }).count(), 1);
  await again.close();
});

test("a value that is refused changes neither controls nor address", { skip }, async () => {
  const { page } = await open("#scene=cantilever&detail=scene");
  const address = page.url();
  const length = await page.inputValue("#length");
  await page.fill("#length", "1e300");
  await page.locator("#length").blur();
  await page.waitForFunction(() => document.getElementById("banner").className === "bad");
  assert.equal(page.url(), address);
  assert.equal(await page.inputValue("#length"), length);
  await page.close();
});

test("what is wrong with a scene that was typed in is said by the core", { skip }, async () => {
  const { page } = await open("#scene=cantilever&detail=scene");
  await page.locator("summary", { hasText: "Scene as text" }).click();
  await page.fill("#text", "[[cloth]]\ngrid = { size = [1, 1], cells = 5 }\n");
  await page.click("#use");
  await page.locator("#banner.bad", { hasText: "cloth.0.grid.cells: invalid type" }).waitFor();
  await page.close();
});

test("two choices at once are both done", { skip }, async () => {
  const { page } = await open("#scene=cantilever&detail=scene");
  await inPage(page, () => {
    for (const [id, value] of [
      ["length", "2"],
      ["material", "leather"],
    ]) {
      const control = document.getElementById(id);
      control.value = value;
      control.dispatchEvent(new Event("change"));
    }
  });
  await more(page, 2);
  const { integrator, cloth } = await inPage(page, () => muslin.run().cloth.scene);
  assert.equal(integrator.step, 0.002);
  const leather = await page.inputValue("#material");
  assert.ok(leather === "leather" && cloth[0].density > 0.3, `${leather}, ${cloth[0].density} kg/m^2`);
  await page.close();
});

test("a run that stops by itself can be gone on with", { skip }, async () => {
  const { page } = await open("#scene=hanging&compare=0&detail=scene");
  await page.selectOption("#method", "explicit-euler");
  await page.locator("#pause", { hasText: "Continue" }).waitFor();
  assert.match(await page.locator("#banner").textContent(), /then Reset/);
  await page.close();
});

test("a mistake is told and the cloth in view goes on", { skip }, async () => {
  const { page } = await open("#scene=cantilever&detail=scene");
  await page.locator("summary", { hasText: "Scene as text" }).click();
  await page.fill("#text", 'name = "x"\nduration = 1\n[[clot]]\n');
  await page.click("#use");
  await page.waitForFunction(() => document.getElementById("banner").className === "bad");
  assert.match(await page.locator("#banner").textContent(), /unknown field `clot`.*did you mean `cloth`\?/s);
  const at = await inPage(page, () => muslin.run().view.steps);
  await steps(page, at + 3);
  // A run that diverges pauses, reports it, and starts again on reset.
  await page.selectOption("#method", "explicit-euler");
  await page.waitForFunction(() => /diverged/.test(document.getElementById("banner").textContent));
  await page.selectOption("#method", "backward-euler");
  await page.click("#reset");
  await page.waitForFunction(() => !muslin.run().paused && document.getElementById("banner").className === "");
  await more(page, 2);
  await page.close();
});

test("keys do what buttons do", { skip }, async () => {
  const { page, errors } = await open("#scene=cantilever&detail=scene");
  await page.locator("#pad").focus();
  await page.keyboard.press(" ");
  await still(page);
  const at = () => inPage(page, () => muslin.run().view.steps);
  const paused = await at();
  await page.waitForTimeout(300);
  assert.equal(await at(), paused, "paused");
  await page.keyboard.press(".");
  await page.waitForFunction((paused) => muslin.run().view.steps === paused + 1, paused);
  const yaw = await inPage(page, () => muslin.camera.yaw);
  await page.keyboard.press("ArrowLeft");
  assert.notEqual(await inPage(page, () => muslin.camera.yaw), yaw);
  await page.keyboard.press("g");
  await page.keyboard.press("ArrowUp");
  await page.keyboard.press(".");
  await page.waitForFunction((paused) => muslin.run().view.steps === paused + 2, paused);
  await page.keyboard.press("s");
  assert.ok(await page.isChecked("#strain"));
  await page.keyboard.press("r");
  await page.waitForFunction((paused) => muslin.run().view.steps <= paused && !muslin.run().paused, paused);
  assert.deepEqual(errors, []);
  await page.close();
});

test("the chart measures in a worker while the page goes on", { skip }, async () => {
  const { page, errors } = await open("#scene=cantilever&detail=scene");
  await page.click("#chart");
  const before = await inPage(page, () => muslin.run().view.steps);
  await page.waitForFunction(() => document.querySelectorAll("#plot .point").length >= 8);
  assert.ok((await inPage(page, () => muslin.run().view.steps)) > before + 5, "the cloth moves meanwhile");
  await page.waitForFunction(() => document.getElementById("chart").textContent === "Speed against accuracy");
  assert.match(await page.locator("#plot figcaption").textContent(), /failed with.*RMS error after 0\.500 s/s);
  await shot(page, "chart");
  assert.deepEqual(errors, []);
  await page.close();
});

test("it fits a phone", { skip }, async () => {
  const { page, errors } = await open("#scene=poncho", { width: 390, height: 844 });
  const wide = await inPage(page, () => document.documentElement.scrollWidth);
  assert.ok(wide <= 390, `nothing is wider than the screen: ${wide} px`);
  await page.setViewportSize({ width: 844, height: 390 });
  await page.waitForFunction(() => muslin.camera.size[0] > 400);
  assert.ok((await drawn(page)) > 500, "after turning the phone the picture is still there");
  await page.setViewportSize({ width: 390, height: 844 });
  await page.waitForTimeout(300);
  await shot(page, "phone");
  assert.deepEqual(errors, []);
  await page.close();
});

test("a stall is not caught up; a lost context is drawn anew", { skip }, async () => {
  const { page } = await open("#scene=cantilever&detail=scene");
  // Blocks frames for a while, as in a background tab.
  const [before, after] = await inPage(page, async () => {
    const before = muslin.run().view.time;
    const until = performance.now() + 2000;
    while (performance.now() < until);
    await new Promise((next) => requestAnimationFrame(() => requestAnimationFrame(next)));
    return [before, muslin.run().view.time];
  });
  assert.ok(after - before < 0.5, `two seconds of stall are not caught up: ${before} to ${after} s`);
  await inPage(page, () => muslin.picture.canvas.getContext("webgl2").getExtension("WEBGL_lose_context").loseContext());
  await page.waitForFunction(() => /redrawn/.test(document.getElementById("banner").textContent));
  assert.ok((await drawn(page)) > 200, "drawn again on a fresh canvas");
  const at = await inPage(page, () => muslin.run().view.steps);
  await steps(page, at + 3);
  await page.close();
});

test("the detail live goes with the method, and the user's own step stays", { skip }, async () => {
  const { page, errors } = await open("#scene=curtain&compare=0");
  const settings = () => inPage(page, () => ({ ...muslin.run().cloth.scene.integrator, divided: muslin.run().cloth.stepError }));
  const method = async (name) => {
    await page.selectOption("#method", name);
    await page.waitForFunction((name) => muslin.run().cloth.scene.integrator.method === name, name);
    return settings();
  };
  await page.click("#pause");
  const live = await settings();
  const cost = await page.locator("#cost").textContent();
  assert.match(cost, /^[\d,]+ vertices, steps of [\d.]+ ms/);
  assert.equal(
    await inPage(page, () => `${muslin.run().cloth.vertexCount.toLocaleString("en")} vertices`),
    cost.split(",").slice(0, -1).join(",").split(", steps")[0],
  );
  // An explicit method has no error of a step, and the step of the scene.
  const { method: explicit, step, divided } = await method("rk4");
  assert.deepEqual([explicit, step, divided], ["rk4", undefined, undefined]);
  assert.deepEqual({ ...(await method("bdf2")), method: live.method }, live, "as chosen for this machine");
  await page.fill("#length", "8");
  await page.locator("#length").blur();
  await page.waitForFunction(() => muslin.run().cloth.scene.integrator.step === 0.008);
  assert.equal((await settings()).divided, live.divided, "a step is the longest one, and is divided as before");
  await page.selectOption("#detail", "as in the scene");
  await page.waitForFunction(() => muslin.run().cloth.stepError === undefined);
  assert.deepEqual(await settings(), { method: "bdf2", step: 0.008, divided: undefined });
  assert.equal(await page.locator("#banner.bad").count(), 0);
  assert.deepEqual(errors, []);
  await page.close();
});

test("every built-in scene opens without a message", { skip }, async () => {
  const { page, errors } = await open("#scene=cantilever&compare=0&detail=scene");
  for (const scene of await page.locator("#scene option").allTextContents()) {
    await page.selectOption("#scene", scene);
    await page.waitForFunction((scene) => muslin.run().cloth.scene.name === scene && muslin.run().view.steps > 1, scene);
    assert.equal(await page.locator("#banner.bad").count(), 0, `${scene}: ${await page.locator("#banner").textContent()}`);
  }
  // Each scene is an entry of the history.
  await page.goBack();
  await page.waitForFunction(() => muslin.run().cloth.scene.name === "tablecloth");
  assert.equal(await page.inputValue("#scene"), "tablecloth");
  assert.deepEqual(errors, []);
  await page.close();
});

test("a ball that is thrown pushes the cloth and is slowed down", { skip }, async () => {
  const { page, errors } = await open("#scene=curtain&compare=0&detail=scene&cloth.0.grid.cells=[12,16]");
  await page.focus("#pad");
  await page.keyboard.press("b");
  const ball = () => inPage(page, () => muslin.run().view.bodies.map(({ points }) => Array.from(points)));
  await page.waitForFunction(() => muslin.run().view.bodies.length === 1);
  const [from] = await ball();
  await more(page, 30);
  const [to] = await ball();
  assert.ok(Math.hypot(...to.map((x, k) => x - from[k])) > 0.2, `it flies: ${from} to ${to}`);
  // No vertex is inside the ball.
  const least = await inPage(page, () => {
    const { positions, bodies } = muslin.run().view;
    const [{ points, radius }] = bodies;
    let least = Infinity;
    for (let k = 0; k < positions.length; k += 3) {
      least = Math.min(least, Math.hypot(positions[k] - points[0], positions[k + 1] - points[1], positions[k + 2] - points[2]) - radius);
    }
    return least;
  });
  assert.ok(least > 0, `${least} m`);
  await page.waitForFunction(() => muslin.run().view.bodies.length === 0);
  await page.selectOption("#scene", "cantilever");
  await page.waitForFunction(() => document.getElementById("throw").disabled);
  assert.deepEqual(errors, []);
  await page.close();
});

test("the text has the material and the wind that were chosen", { skip }, async () => {
  const { page } = await open("#scene=flag&compare=0");
  await page.selectOption("#material", "silk");
  await page.locator("#wind").fill("3");
  await page.waitForFunction(
    () => /density = 0.06/.test(document.getElementById("text").value) && muslin.run().cloth.scene.drag.wind.velocity.length,
  );
  await page.waitForFunction(() => Math.abs(Math.hypot(...muslin.run().cloth.scene.drag.wind.velocity) - 3) < 1e-6);
  const { drag } = await inPage(page, () => muslin.run().cloth.scene);
  await page.locator("summary", { hasText: "Scene as text" }).click();
  await page.click("#use");
  await page.waitForFunction(() => document.getElementById("scene").value === "own");
  const scene = await inPage(page, () => muslin.run().cloth.scene);
  assert.deepEqual(scene.drag, drag);
  assert.equal(scene.cloth[0].density, 0.06);
  await page.close();
});

test("it opens at an address without a slash, and stands still for who asks for little motion", { skip }, async () => {
  const { page, errors } = await chromium.open("dist/page", undefined, { reducedMotion: "reduce" });
  await still(page);
  assert.match(await page.locator("#banner").textContent(), /little motion/);
  const at = await inPage(page, () => muslin.run().view.steps);
  await page.waitForTimeout(300);
  assert.equal(await inPage(page, () => muslin.run().view.steps), at);
  await page.click("#pause");
  await more(page, 2);
  assert.deepEqual(errors, []);
  await page.close();
});

test("a worker that fails is replaced, and so is one that does not answer", { skip }, async () => {
  const { page } = await open("#scene=cantilever&compare=0&detail=scene");
  // An answer that the page cannot have asked for stands for a failure inside the worker.
  await inPage(page, () => {
    const { prototype } = Worker;
    window.post = prototype.postMessage;
    prototype.postMessage = function (what, ...given) {
      window.post.call(this, what.ask === "lead" ? { ask: "back" } : what, ...given);
    };
    muslin.run().lead(0, [0, 0, 0]);
  });
  await page.locator("#banner.bad", { hasText: "Press Reset" }).waitFor();
  await page.click("#reset");
  await page.waitForFunction(() => document.getElementById("banner").className === "");
  await more(page, 2);
  await page.close();
  // A worker that does not hear any more stands for one whose step does not end.
  const { page: other } = await open("#scene=cantilever&compare=0&detail=scene");
  await inPage(other, () => {
    const { prototype } = Worker;
    const post = prototype.postMessage;
    let deaf;
    prototype.postMessage = function (what, ...given) {
      deaf ??= this;
      if (this !== deaf) post.call(this, what, ...given);
    };
  });
  // The wind waits, too, and does not keep the scene waiting for ever.
  await other.locator("#wind").fill("3");
  await other.selectOption("#scene", "swing");
  await other.waitForFunction(() => muslin.run().cloth.scene.name === "swing");
  await more(other, 2);
  await other.close();
});

test("what the hand asks of a cloth before does not reach the next one", { skip }, async () => {
  const { page, errors } = await open("#scene=cantilever&compare=0&detail=scene");
  await page.focus("#pad");
  await page.keyboard.press("g");
  await held(page);
  // Requests that are sent while a scene opens are about the cloth before.
  await inPage(page, () => {
    document.getElementById("reset").click();
    for (let k = 0; k < 20; k++) setTimeout(() => muslin.run().view.steps && muslin.run().lead(3, [0, 0, 0]), k);
  });
  await page.waitForTimeout(200);
  await inPage(page, () => muslin.run().drop());
  await more(page, 2);
  await free(page);
  assert.deepEqual(errors, []);
  await page.close();
});

test("a text that is refused stays, and a smaller sphere is drawn smaller", { skip }, async () => {
  const { page } = await open("#scene=ball&compare=0");
  await page.locator("summary", { hasText: "Scene as text" }).click();
  const text = await page.inputValue("#text");
  await page.fill("#text", "hello");
  await page.click("#use");
  await page.locator("#banner.bad", { hasText: "a scene has keys and sections" }).waitFor();
  assert.equal(await page.inputValue("#text"), "hello");
  await page.fill("#text", text.replace("radius = 0.3", "radius = 0.1"));
  await page.click("#use");
  await page.waitForFunction(() => document.getElementById("scene").value === "own");
  await inPage(page, () => (muslin.run().paused = true));
  await still(page);
  const radii = await inPage(page, () => muslin.run().view.bodies.map(({ radius }) => +radius.toFixed(2)));
  assert.deepEqual(radii, [0.1, 0]);
  const small = await drawn(page);
  await inPage(page, () => {
    const { view } = muslin.run();
    muslin.run().view = { ...view, bodies: view.bodies.map((body) => ({ ...body, radius: 3 * body.radius })) };
  });
  assert.ok((await drawn(page)) > small, "a larger one covers more of the picture");
  await page.close();
});

test("settings that are changed after a run has stopped start it anew", { skip }, async () => {
  const { page } = await open("#scene=hanging&compare=0&detail=scene");
  await page.selectOption("#method", "explicit-euler");
  await page.locator("#pause", { hasText: "Continue" }).waitFor();
  await page.selectOption("#method", "backward-euler");
  await page.locator("#pause", { hasText: "Pause" }).waitFor();
  await page.waitForFunction(() => muslin.run().numbers?.stretch < 1.1 && document.getElementById("banner").className === "");
  await page.close();
});

test("a page whose module does not come says so, and does not try for ever", { skip }, async () => {
  const { page } = await chromium.open("blank.html");
  await page.addInitScript(() => {
    window.begun = 0;
    const Own = Worker;
    window.Worker = class extends Own {
      constructor(...given) {
        super(...given);
        window.begun += 1;
      }
    };
  });
  await page.context().route("**/muslin_wasm_bg.wasm", (route) => route.abort());
  await page.goto(new URL(PAGE, page.url()).href);
  await page.locator("#banner.bad").waitFor();
  await page.waitForTimeout(500);
  assert.equal(await inPage(page, () => window.begun), 1);
  await page.context().unroute("**/muslin_wasm_bg.wasm");
  await page.close();
});

test("a pause while a scene opens is a pause of the scene that opens", { skip }, async () => {
  const { page } = await open("#scene=cantilever&compare=0&detail=scene");
  await page.selectOption("#scene", "hanging");
  await page.click("#pause");
  await page.waitForFunction(() => muslin.run().cloth.scene.name === "hanging");
  await still(page);
  const at = await inPage(page, () => muslin.run().view.steps);
  await page.waitForTimeout(300);
  assert.equal(await inPage(page, () => muslin.run().view.steps), at);
  await page.close();
});

test("a method that cannot take the steps stops, and everything still answers", { skip }, async () => {
  const { page, errors } = await open("#scene=flag&compare=0&detail=scene&cloth.0.grid.cells=[24,18]");
  await page.selectOption("#method", "explicit-euler");
  await page.locator("#pause", { hasText: "Continue" }).waitFor();
  assert.match(await page.locator("#banner").textContent(), /then Reset/);
  // The last good state is in view.
  const { stretch } = await inPage(page, () => ({ stretch: muslin.run().numbers.stretch }));
  assert.ok(stretch < 4, `stretch ${stretch}`);
  await page.selectOption("#method", "backward-euler");
  await more(page, 2);
  await page.selectOption("#scene", "swing");
  await page.waitForFunction(() => muslin.run().cloth.scene.name === "swing" && muslin.run().view.steps > 2);
  assert.deepEqual(errors, []);
  await page.close();
});

test("a run that was continued takes changes and does not start anew", { skip }, async () => {
  const { page } = await open("#scene=cantilever&compare=0&detail=scene");
  // What the worker says when a step fails.
  await inPage(page, () => {
    const { prototype } = Worker;
    const post = prototype.postMessage;
    prototype.postMessage = function (...given) {
      prototype.postMessage = post;
      post.apply(this, given);
      this.onmessage({ data: { kind: "stopped", why: "for the test" } });
    };
    muslin.run().one();
  });
  await page.locator("#pause", { hasText: "Continue" }).waitFor();
  await more(page, 20);
  await page.click("#pause");
  assert.equal(await page.locator("#banner.bad").count(), 0, "who continues has read why");
  const time = await inPage(page, () => muslin.run().view.time);
  await page.selectOption("#material", "silk");
  await page.waitForFunction(() => muslin.run().cloth.scene.cloth[0].density === 0.06);
  assert.ok((await inPage(page, () => muslin.run().view.time)) >= time, "it goes on");
  await page.close();
});

test("a ball that starts in the cloth is taken away, and the run goes on", { skip }, async () => {
  const { page, errors } = await open("#scene=curtain&compare=0&detail=scene&cloth.0.grid.cells=[12,16]");
  await inPage(page, () => {
    const x = muslin.run().positions();
    const k = 3 * Math.floor(x.length / 6);
    return muslin.run().fly([x[k], x[k + 1], x[k + 2]], [x[k], x[k + 1], x[k + 2] - 1]);
  });
  await more(page, 10);
  assert.equal(await inPage(page, () => muslin.run().hasStopped), false);
  assert.equal(await page.locator("#banner.bad").count(), 0);
  assert.deepEqual(errors, []);
  await page.close();
});

test("a bad address in the history leaves the entries before it", { skip }, async () => {
  const { page } = await open("#scene=swing&compare=0&detail=scene");
  await page.selectOption("#scene", "cantilever");
  await page.waitForFunction(() => muslin.run().cloth.scene.name === "cantilever");
  await inPage(page, () => {
    location.hash = "#scene=nope&compare=1";
  });
  await page.locator("#banner.bad", { hasText: "there is no scene nope" }).waitFor();
  assert.equal(await page.inputValue("#scene"), "cantilever");
  assert.equal(await page.isChecked("#compare"), false, "the choice of the scene in view");
  assert.match(page.url(), /scene=cantilever/);
  await page.goBack();
  await page.waitForFunction(() => /scene=cantilever/.test(location.hash));
  await page.goBack();
  await page.waitForFunction(() => muslin.run().cloth.scene.name === "swing");
  await inPage(page, () => {
    location.hash = "#scene=constructor";
  });
  await page.locator("#banner.bad", { hasText: "there is no scene constructor" }).waitFor();
  await page.close();
});

test("every pin is drawn dark", { skip }, async () => {
  const { page } = await open("#scene=hanging&compare=0&detail=scene&cloth.0.grid.cells=[12,12]");
  await page.click("#pause");
  await still(page);
  const pins = await inPage(page, () => muslin.run().pins());
  assert.equal(pins.length, 2);
  for (const pin of pins) assert.ok(await dark(page, pin), `pin ${pin}`);
  await page.close();
});

test("keys before the first scene do nothing", { skip }, async () => {
  const { page, errors } = await chromium.open(`${PAGE}#scene=cantilever`);
  await inPage(page, () => {
    const pad = document.getElementById("pad");
    for (const key of "srbcgp .") pad.dispatchEvent(new KeyboardEvent("keydown", { key }));
  });
  await steps(page, 2);
  assert.ok(await inPage(page, () => muslin.run().positions().every(Number.isFinite) && muslin.camera.centre.every(Number.isFinite)));
  assert.deepEqual(errors, []);
  await page.close();
});

/** Applies a scene as text. */
async function type(page, text) {
  if (!(await page.isVisible("#text"))) await page.locator("summary", { hasText: "Scene as text" }).click();
  await page.fill("#text", text);
  await page.click("#use");
}

test("the material of the scene comes back, for each cloth; terms keep the material", { skip }, async () => {
  const { page } = await open("#scene=cantilever&compare=0&detail=scene");
  const sheet = (z, density, rest) =>
    `[[cloth]]\nposition = [0, 1, ${z}]\ngrid = { size = [1, 1], cells = [4, 4] }\ndensity = ${density}\nstretch = { model = "membrane", stiffness = 3000 }\n${rest}`;
  await type(page, `duration = 1\n${sheet(0, 0.3, "")}${sheet(2, 0.5, "shear = { stiffness = 50 }\n")}`);
  await page.waitForFunction(() => muslin.run().cloth.scene.cloth.length === 2);
  const cloths = () => inPage(page, () => muslin.run().cloth.scene.cloth.map(({ density, shear, bend }) => ({ density, shear, bend })));
  const before = await cloths();
  await page.selectOption("#material", "denim");
  await page.waitForFunction(() => muslin.run().cloth.scene.cloth.every(({ density }) => density === 0.4));
  await page.uncheck("#bend");
  await page.waitForFunction(() => muslin.run().cloth.scene.cloth.every(({ bend }) => !bend));
  await page.check("#bend");
  await page.waitForFunction(() => muslin.run().cloth.scene.cloth.every(({ bend }) => bend?.rigidity === 1e-4));
  await page.selectOption("#material", "as in the scene");
  await page.waitForFunction(() => muslin.run().cloth.scene.cloth[0].density === 0.3);
  assert.deepEqual(await cloths(), before);
  assert.equal(await page.locator("#banner.bad").count(), 0);
  await page.close();
});

test("a scene that other cells do not suit runs as it is, and the page says why", { skip }, async () => {
  const { page } = await open("#scene=cantilever&compare=0");
  await type(
    page,
    'duration = 1\n[[cloth]]\nposition = [0, 1, 0]\ngrid = { size = [1, 1], cells = [30, 30] }\ndensity = 0.2\nstretch = { model = "membrane", stiffness = 1000 }\n[[cloth.pin]]\nselect = { vertices = [0, 860] }\n',
  );
  await page.locator("#banner", { hasText: "live does not suit it: " }).waitFor();
  assert.ok((await inPage(page, () => muslin.run().cloth.vertexCount)) > 860, "all cells");
  await type(page, 'duration = 1\n[[cloth]]\nmesh = "sheet.obj"\ndensity = 0.2\nstretch = { model = "membrane", stiffness = 1000 }\n');
  await page.locator("#banner.bad", { hasText: "the page reads no files" }).waitFor();
  await page.close();
});

test("numbers are folded on a phone that lies on its side", { skip }, async () => {
  const { page } = await open("#scene=cantilever&compare=0&detail=scene", { width: 844, height: 390 });
  assert.equal(await inPage(page, () => document.getElementById("measured").open), false);
  await page.close();
});

test("the machine is measured again when asked", { skip }, async () => {
  const { page, errors } = await open("#scene=cantilever&compare=0");
  await inPage(page, () => {
    window.choices = 0;
    const choose = muslin.run().choose;
    muslin.run().choose = (...given) => {
      window.choices += 1;
      return choose(...given);
    };
  });
  await page.click("#reset");
  await more(page, 2);
  assert.equal(await inPage(page, () => window.choices), 0, "a reset keeps the choice");
  await page.click("#again");
  await page.waitForFunction(() => window.choices === 1);
  await more(page, 2);
  assert.deepEqual(errors, []);
  await page.close();
});

// The module in a browser: the same bits as the command line, steps that allocate no memory, errors that say
// how to fix them.

import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { existsSync, mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { browser, root, skip, withModule } from "./kit.mjs";

let chromium;
let page;

before(async () => {
  if (skip) return;
  chromium = await browser({ webgpu: false });
  page = await withModule(chromium);
});
after(() => chromium?.close());

const STEPS = { flag: 60, fold: 200, cantilever: 200 };

/** Built by the tests of the command line. */
const muslin = join(process.env.CARGO_TARGET_DIR ?? join(root, "target"), "debug/muslin");

/** The command line's JSON report of the same run. */
function native(scene, seconds) {
  assert.ok(existsSync(muslin), `no ${muslin}: cargo build -p muslin-cli`);
  const out = mkdtempSync(join(tmpdir(), "muslin-native-"));
  try {
    const run = ["run", scene, "--duration", String(seconds * (1 - 1e-6)), "--preview", "none", "--json", "--quiet", "--out", out];
    // The duration is slightly shorter, so that the run stops at the picture of that time, not at the next one.
    return JSON.parse(execFileSync(muslin, run, { encoding: "utf8", stdio: ["ignore", "pipe", "ignore"] }));
  } finally {
    rmSync(out, { recursive: true, force: true });
  }
}

// Wind and two-step memory (flag), self-contact and contact with a plane (fold), a stiff strip (cantilever).
for (const [scene, count] of Object.entries(STEPS)) {
  test(`${scene}: the state hash after ${count} steps is the native one`, { skip }, async () => {
    const own = await page.evaluate(
      ([scene, steps]) => {
        const cloth = new m.Cloth(scene);
        cloth.step(steps);
        const told = { hash: cloth.stateHash(), seconds: steps * cloth.stepLength };
        cloth.free();
        return told;
      },
      [scene, count],
    );
    const { state_hash: hash, steps } = native(scene, own.seconds);
    assert.equal(steps, count);
    assert.equal(own.hash, hash, "the browser and the command line differ: compare step by step");
  });
}

test("what is wrong with a scene is said with its place and what to do", { skip }, async () => {
  const said = (what) =>
    page.evaluate((what) => {
      try {
        new m.Cloth(what);
        return "nothing";
      } catch (error) {
        return error instanceof Error ? error.message : `no Error: ${error}`;
      }
    }, what);
  assert.match(await said("flagg"), /there is no scene flagg; there are ball, /);
  assert.match(await said("a = [1"), /1:\d|line 1|\^/);
  const rest = { name: "test", duration: 1 };
  const cloth = { grid: { size: [1, 1], cells: [4, 4] }, density: 0.2 };
  const integrator = { method: "rk4", step: 0.001 };
  assert.match(
    await said({ ...rest, cloth: [{ ...cloth, densty: 1 }], integrator }),
    /^cloth\.0: unknown field `densty`.*\ndid you mean `density`\?$/s,
  );
  assert.match(
    await said({ ...rest, cloth: [{ ...cloth, density: "heavy" }], integrator }),
    /^cloth\.0\.density: invalid type: string "heavy", expected a number/,
  );
  assert.match(
    await said({ ...rest, cloth: [{ ...cloth, grid: { size: [1], cells: [4, 4] } }], integrator }),
    /^cloth\.0\.grid\.size: invalid length 1/,
  );
  const pin = [{ select: { corners: [-1] } }];
  assert.match(await said({ ...rest, cloth: [{ ...cloth, pin }], integrator }), /corners\.0: invalid value: integer `-1`/);
  assert.match(await said({ ...rest, cloth: [{ ...cloth, density: -1 }], integrator }), /density/);
  assert.match(
    await said({ ...rest, cloth: [{ ...cloth, grid: undefined, mesh: "dress.obj" }], integrator }),
    /^there is no mesh "dress\.obj": give it in the option meshes$/,
  );
});

test("keys are set as on the command line; what is refused changes nothing", { skip }, async () => {
  const told = await page.evaluate(() => {
    const cloth = new m.Cloth("cantilever");
    cloth.step(3);
    const place = cloth.positions()[5];
    const why = (key, value) => {
      try {
        cloth.set(key, value);
        return "nothing";
      } catch (error) {
        return error.message;
      }
    };
    const refused = [
      why("integrator.method", "rk5"),
      why("cloth.7.density", 1),
      why("integrator.step", -1),
      why("a..b", 1),
      why("__proto__.x", 1),
    ];
    const before = JSON.stringify(cloth.scene);
    cloth.set("integrator.step", 0.002);
    cloth.set({ "cloth.density": 0.3, "cloth.bend": undefined });
    const kept = cloth.positions()[5] === place;
    const { scene, stepLength, time } = cloth;
    const value = [m.value("0.5"), m.value("rk4"), m.value("[1, 2]")];
    cloth.free();
    return { refused, before, kept, scene, stepLength, time, value };
  });
  assert.match(told.refused[0], /unknown variant `rk5`/);
  assert.match(told.refused[1], /there is no number 7; the last is 0/);
  assert.match(told.refused[2], /step/);
  assert.match(told.refused[3], /is no key/);
  assert.match(told.refused[4], /is no key/);
  assert.equal(JSON.parse(told.before).integrator.method, "backward-euler");
  assert.ok(told.kept, "the cloth stays where it was");
  assert.equal(told.scene.cloth[0].density, 0.3);
  assert.equal(told.scene.cloth[0].bend, undefined);
  // The longest step that is not above the requested one and divides a picture evenly.
  assert.ok(Math.abs(told.stepLength - 1 / 30 / 17) < 1e-9, `steps of ${told.stepLength} s`);
  assert.ok(Math.abs(told.time - 3 / 60) <= 0.001, `time went from ${3 / 60} to ${told.time}`);
  assert.deepEqual(told.value, [0.5, "rk4", [1, 2]]);
});

test("a vertex is led, pinned and let go", { skip }, async () => {
  const told = await page.evaluate(() => {
    const cloth = new m.Cloth("cantilever");
    const vertex = cloth.vertexCount - 1;
    const place = Array.from(cloth.positions().subarray(3 * vertex, 3 * vertex + 3));
    const to = [place[0], place[1] + 0.05, place[2]];
    cloth.moveTo(vertex, to, 10 * cloth.stepLength);
    cloth.step(20);
    const led = Array.from(cloth.positions().subarray(3 * vertex, 3 * vertex + 3));
    cloth.set("cloth.density", 0.4);
    const pinned = cloth.pins().includes(vertex);
    const released = [cloth.release(vertex), cloth.release(vertex)];
    cloth.step(20);
    const fell = cloth.positions()[3 * vertex + 1];
    const why = [() => cloth.moveTo(99999, to), () => cloth.pin(-1), () => cloth.release(2.5), () => cloth.pin()].map((what) => {
      try {
        return String(what());
      } catch (error) {
        return error.message;
      }
    });
    cloth.free();
    return { to, led, pinned, released, fell, why };
  });
  told.to.forEach((x, k) => assert.ok(Math.abs(x - told.led[k]) < 1e-6));
  assert.ok(told.pinned, "a hand's pins stay when the scene is changed");
  assert.deepEqual(told.released, [true, false]);
  assert.ok(told.fell < told.to[1] - 1e-3, "what is let go falls");
  ["99999", "-1", "2.5", "undefined"].forEach((vertex, k) =>
    assert.match(told.why[k], new RegExp(`there is no vertex ${vertex}; there are \\d+, from 0`)),
  );
});

test("views are of the columns themselves, also after memory has grown", { skip }, async () => {
  const told = await page.evaluate(() => {
    const cloth = new m.Cloth("cantilever");
    const before = cloth.positions();
    const same = cloth.positions() === before;
    const copied = before.buffer !== cloth.velocities().buffer;
    const others = [];
    while (before.length > 0 && others.length < 40) others.push(new m.Cloth("ball"));
    const gone = before.length === 0;
    const again = cloth.positions();
    const lengths = [again.length, cloth.normals().length, cloth.strains().length, cloth.velocities().length];
    const normal = Math.hypot(...cloth.normals().subarray(0, 3));
    others.concat(cloth).forEach((cloth) => cloth.free());
    return { same, copied, gone, lengths, normal, count: again.length / 3 };
  });
  assert.deepEqual([told.same, told.copied, told.gone], [true, false, true]);
  assert.deepEqual(
    told.lengths,
    [3, 3, 1, 3].map((each) => each * told.count),
  );
  assert.ok(Math.abs(told.normal - 1) < 1e-5);
});

test("a run that blows up says so and leaves a cloth that can be asked", { skip }, async () => {
  const told = await page.evaluate(() => {
    const cloth = new m.Cloth("hanging");
    cloth.set("integrator.method", "explicit-euler");
    try {
      cloth.step(200);
      return { why: "nothing" };
    } catch (error) {
      return { why: error.message, finite: cloth.positions().every(Number.isFinite), steps: cloth.steps };
    }
  });
  assert.match(told.why, /diverged in step \d+/);
  assert.ok(told.finite, "the state is the last that could be taken");
});

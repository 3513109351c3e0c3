// The choice of the detail `live`, and the speed that the page shows, on a clock of the test. Needs no browser.

import assert from "node:assert/strict";
import { test } from "node:test";
import { choose } from "../../host-wasm/web/page/live.js";
import { Speed } from "../../host-wasm/web/page/speed.js";

const SCENE = { cloth: [{ grid: { cells: [60, 60] } }] };

/** A machine on which a step takes so many ms per vertex, and the choice that is made on it. */
function chosen(ms, stretch = 1) {
  let clock = 0;
  const make = (changes) => {
    const [across, along] = changes["cloth.0.grid.cells"] ?? [60, 60];
    const vertexCount = (across + 1) * (along + 1);
    const step = changes["integrator.step"] ?? 1 / 60;
    const cloth = { vertexCount, time: 0, stepLength: step, summary: () => ({ stretch: { max: stretch } }), free() {} };
    cloth.advance = () => {
      clock += ms * vertexCount;
      cloth.time += step;
    };
    return cloth;
  };
  const { changes, setting } = choose(make, SCENE, true, () => clock);
  const cloth = make(changes);
  return { vertices: cloth.vertexCount, step: changes["integrator.step"] ?? 1 / 60, setting };
}

test("a fast machine takes the scene as it is", () => {
  assert.deepEqual(chosen(1e-4), { vertices: 61 * 61, step: 1 / 60, setting: undefined });
});

test("a slower machine takes fewer vertices, in steps that it can take in their time", () => {
  for (const ms of [0.015, 0.02, 0.03, 0.05, 0.1]) {
    const { vertices, step, setting } = chosen(ms);
    assert.ok(setting && vertices <= 1700 && vertices > 4, `${ms}: ${vertices}`);
    assert.ok(ms * vertices <= 1000 * step * 1.05, `${ms} ms a vertex: ${ms * vertices} ms for a step of ${1000 * step} ms`);
  }
});

test("a machine on which a step takes longer than a part of the measurement takes few vertices", () => {
  for (let ms = 0.3; ms < 0.6; ms += 0.01) {
    const { vertices } = chosen(ms);
    assert.ok(vertices >= 4 && vertices < 400, `${ms} ms a vertex: ${vertices}`);
  }
});

test("the speed is that of the last two seconds", () => {
  const speed = new Speed();
  assert.equal(speed.value, undefined);
  for (let k = 0; k < 300; k++) speed.add(k * 20, 0.01);
  assert.ok(Math.abs(speed.value - 0.5) < 1e-6 && !speed.isKept, `${speed.value}`);
  for (let k = 300; k < 600; k++) speed.add(k * 20, 0.02);
  assert.ok(Math.abs(speed.value - 1) < 1e-6 && speed.isKept, `${speed.value}`);
  // A step that does not end shows when it ends.
  speed.add(599 * 20 + 10_000, 0.02);
  assert.ok(speed.value < 0.01, `${speed.value}`);
  speed.clear();
  assert.equal(speed.value, undefined);
});

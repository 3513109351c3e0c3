// The page's error: the distance of two runs, also beside the cloth's size.

import assert from "node:assert/strict";
import { test } from "node:test";
import { areFarApart, length, rms } from "../../host-wasm/web/page/error.js";
import { show } from "../../host-wasm/web/page/numbers.js";

// A sheet of 1 m, 5 m from the origin: the RMS distance of its vertices from its middle is 0.45 m.
const side = 9;
const sheet = Float32Array.from({ length: 3 * side ** 2 }, (_, k) => {
  const [vertex, axis] = [Math.floor(k / 3), k % 3];
  return [5 + (vertex % side) / (side - 1), 0, Math.floor(vertex / side) / (side - 1)][axis];
});
const moved = (by) => sheet.map((x, k) => (k % 3 === 1 ? x + by : x));

test("it is the root mean square distance of the vertices", () => {
  for (const by of [0.001, 0.5]) assert.ok(Math.abs(rms(moved(by), sheet) / by - 1) < 1e-6);
});

test("runs are far apart from a tenth of the cloth's size on, wherever the cloth is", () => {
  for (const [by, whether] of [
    [0.04, false],
    [0.05, true],
  ]) {
    assert.equal(areFarApart(rms(moved(by), sheet), sheet), whether, `${by} m`);
  }
});

test("lengths are read in µm, mm or m", () => {
  assert.deepEqual([1.234e-5, 0.00123, 0.5].map(length), ["12.3 µm", "1.23 mm", "0.5 m"]);
});

test("the page says where runs are far apart", () => {
  globalThis.document = { createElement: (tag) => ({ tag }) };
  const times = { predict: 1, broadPhase: 0, narrowPhase: 0, response: 0 };
  const numbers = { time: 1, paused: false, speed: 1, stretch: 1, energy: 1, contacts: 0, times, warnings: [] };
  const told = (isFar) => {
    let text;
    const list = { replaceChildren: (...items) => (text = items[3].textContent) };
    show(list, { ...numbers, error: { time: 0.5, error: 0.06, isFar } }, false);
    return text;
  };
  assert.equal(told(false), "60 mm at 0.50 s");
  assert.equal(told(true), "60 mm at 0.50 s, over a tenth of the cloth's size");
});

// The page's chart as markup: needs no browser.

import assert from "node:assert/strict";
import { test } from "node:test";
import { drawn } from "../../host-wasm/web/page/chart.js";

const point = (ms, error) => ({ method: "rk4", ms, error, step: 0.001 });
const state = { name: "flag", failed: [], until: 0.5, reference: 1e-6, doing: "rk4 in steps of 1 ms" };
const marks = (points) => drawn({ ...state, points }).match(/class="point"/g)?.length ?? 0;

test("what took a browser's clock no time is left out", () => {
  assert.equal(marks([point(0, 1e-3), point(20, 1e-4), point(200, 1e-5)]), 2);
  assert.equal(marks([point(0, 1e-3)]), 0);
});

test("it says how it ended", () => {
  assert.match(drawn({ ...state, points: [] }), /rk4 in steps of 1 ms …/);
  assert.match(drawn({ ...state, points: [], done: true }), /no measurements/);
  assert.match(drawn({ ...state, points: [], done: true, why: "a < b" }), /a &lt; b/);
  assert.doesNotMatch(drawn({ ...state, points: [point(20, 1e-4)], done: true }), /…/);
});

test("a scene without a name is charted all the same", () => {
  assert.match(drawn({ ...state, name: undefined, points: [point(20, 1e-4)] }), /untitled: RMS error/);
});

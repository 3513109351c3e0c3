// The hand that holds the cloth, and the ball that is thrown, step by step. Needs the package, but no browser.

import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { test } from "node:test";
import { Ball, withBall } from "../../host-wasm/web/page/ball.js";
import { Hold } from "../../host-wasm/web/page/hold.js";
import { dist } from "./kit.mjs";

const m = await import(join(dist, "muslin.js"));
await m.load(readFileSync(join(dist, "muslin_wasm_bg.wasm")));

const EARTH = 9.81;
const place = (x, vertex) => Array.from(x.subarray(3 * vertex, 3 * vertex + 3));
const distance = (a, b) => Math.hypot(...a.map((x, k) => x - b[k]));

/** A sheet of 13x13 vertices without contact, hung by two corners, and its weight, N. */
function hung() {
  const changes = { "cloth.0.grid.cells": [12, 12], "integrator.error": 0.002 };
  const cloth = new m.Cloth(m.changed(m.scene("hanging"), changes));
  return { cloth, weight: 0.2 * EARTH };
}

/** Holds a vertex for some steps. Returns the largest force of the hand, N, and the largest stretch. */
function pulled(cloth, hold, steps) {
  let [force, stretch] = [0, 0];
  for (let k = 0; k < steps; k++) {
    const each = hold.force(cloth.stepLength);
    for (const vertex of hold.vertices) cloth.setForce(vertex, each);
    cloth.step();
    force = Math.max(force, hold.vertices.length * Math.hypot(...each));
    stretch = Math.max(stretch, cloth.summary().stretch.max - 1);
  }
  return { force, stretch };
}

test("the hand brings a vertex to its place, and holds it there", () => {
  const { cloth, weight } = hung();
  const vertex = cloth.vertexCount - 7;
  const start = place(cloth.positions(), vertex);
  const to = [start[0], start[1] + 0.15, start[2] + 0.3];
  const hold = new Hold(vertex, to, cloth);
  const { force, stretch } = pulled(cloth, hold, 120);
  assert.ok(force <= 3.001 * weight, `${force} N for a cloth of ${weight} N`);
  assert.ok(stretch < 0.1, `stretch ${stretch}`);
  assert.ok(distance(place(cloth.positions(), vertex), to) < 0.03, "after two seconds it is there");
  const { force: holding } = pulled(cloth, hold, 60);
  assert.ok(holding < 1.5 * weight, `${holding} N hold it`);
  const left = distance(place(cloth.positions(), vertex), to);
  assert.ok(left < 0.03, `${left} m from the hand a second later`);
  cloth.free();
});

test("a hand that is out of reach pulls with three weights of the cloth, and no more", () => {
  const { cloth, weight } = hung();
  const hold = new Hold(cloth.vertexCount - 7, [0, 0, 50], cloth);
  const { force, stretch } = pulled(cloth, hold, 120);
  assert.ok(Math.abs(force - 3 * weight) < 0.001 * weight, `${force} N for a cloth of ${weight} N`);
  assert.ok(stretch < 0.1, `stretch ${stretch}`);
  cloth.free();
});

/** A scene whose cloth lies aside, so that the ball meets only the floor; and the ball. */
function thrown(changes = {}) {
  const scene = { ...m.changed(m.scene("ball"), { "cloth.0.grid.cells": [4, 4], ...changes }) };
  scene.collider = [{ shape: "plane", point: [0, 0, 0], normal: [0, 1, 0], friction: 0.5 }];
  const cloth = new m.Cloth(withBall(scene));
  const acts = [];
  const ball = new Ball(cloth, (act) => acts.push(act.ask));
  const where = () => Array.from(cloth.bodies().at(-1).points).slice(0, 3);
  const step = () => {
    ball.before(cloth.stepLength);
    cloth.step();
    ball.after();
    return where();
  };
  return { cloth, ball, step, acts };
}

test("the ball bounces off the floor, each time lower, and is gone after three seconds", () => {
  const { cloth, ball, step, acts } = thrown({ "cloth.0.position": [20, 0.5, 0] });
  ball.fly([0, 1.5, 0], [0, 1.5, 1]);
  const heights = [];
  let seconds = 0;
  for (; seconds < 5 && ball.isHere; seconds += cloth.stepLength) heights.push(step()[1]);
  assert.ok(Math.abs(seconds - 3) < 0.1, `gone after ${seconds} s`);
  const flight = heights.slice(1);
  assert.ok(Math.min(...flight) > 0.09, `it never enters the floor: ${Math.min(...flight)} m`);
  const tops = flight.filter((y, k) => k > 0 && k < flight.length - 1 && y > flight[k - 1] && y >= flight[k + 1]);
  assert.ok(tops.length >= 2 && tops[0] < 0.6 && tops[1] < tops[0], `tops of the bounces: ${tops.slice(0, 3)} m`);
  assert.deepEqual([acts[0], acts.at(-1)], ["moveCollider", "switchCollider"], "the reference sees the same");
  cloth.free();
});

test("cloth slows the ball down", () => {
  const speed = (changes) => {
    const { cloth, ball, step } = thrown({ gravity: [0, 0, 0], ...changes });
    ball.fly([0, 1.5, -0.5], [0, 1.5, 0]);
    let [before, now] = [step(), step()];
    for (let k = 0; k < 30; k++) [before, now] = [now, step()];
    const speed = distance(before, now) / cloth.stepLength;
    cloth.free();
    return speed;
  };
  const upright = { "cloth.0.rotation": [90, 0, 0], "cloth.0.position": [0, 1.5, 0] };
  const [free, slowed] = [speed({ "cloth.0.position": [20, 0.5, 0] }), speed(upright)];
  assert.ok(Math.abs(free - 4) < 0.01, `${free} m/s without cloth in the way`);
  assert.ok(slowed < 3.9 && slowed > 0.5, `${slowed} m/s after the cloth`);
});

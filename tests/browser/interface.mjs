// What a program can do with a cloth: each case runs in Node.js, on a page and in a worker. `run` gets the module and
// returns plain data; it is sent as text, so it uses nothing from outside. `check` judges the data.

import assert from "node:assert/strict";

const near = (a, b, within) => assert.ok(Math.abs(a - b) <= within, `${a} is not within ${within} of ${b}`);

/** Functions that cases may use. */
export const helpers = {
  /** The message of the error that a call throws. */
  why: (call) => {
    try {
      return `nothing, but ${call()}`;
    } catch (error) {
      return error instanceof Error ? error.message : `no Error: ${error}`;
    }
  },
  /** A sheet of 0.5 m, 2 cm above a ball of 10 cm. */
  ball: (more = {}) => ({
    duration: 1,
    gravity: [0, -9.81, 0],
    integrator: { step: 1 / 120, tolerance: 1e-8 },
    contact: { thickness: 0.004, friction: 0.3 },
    collider: [{ shape: "sphere", center: [0, -0.12, 0], radius: 0.1 }],
    cloth: [
      {
        grid: { size: [0.5, 0.5], cells: [12, 12] },
        density: 0.2,
        stretch: { model: "membrane", stiffness: 500, damping: 0.001 },
        shear: { stiffness: 200 },
        bend: { model: "hinge", rigidity: 1e-5, damping: 0.001 },
      },
    ],
    ...more,
  }),
  /** A sheet of two triangles per cell, as typed arrays. */
  sheet: (cells, size) => {
    const side = cells + 1;
    const mesh = { positions: new Float32Array(3 * side ** 2), uvs: new Float32Array(2 * side ** 2), indices: [] };
    for (let k = 0; k < side ** 2; k++) {
      const [u, v] = [(k % side) / cells, Math.floor(k / side) / cells];
      mesh.positions.set([(u - 0.5) * size, 0, (v - 0.5) * size], 3 * k);
      mesh.uvs.set([u, v], 2 * k);
      if (u < 1 && v < 1) mesh.indices.push(k, k + side, k + 1, k + 1, k + side, k + side + 1);
    }
    return { ...mesh, indices: Uint32Array.from(mesh.indices) };
  },
  /** Least distance of the vertices from a point. */
  nearest: (cloth, [x, y, z]) => {
    const all = cloth.positions();
    let least = Infinity;
    for (let k = 0; k < all.length; k += 3) least = Math.min(least, Math.hypot(all[k] - x, all[k + 1] - y, all[k + 2] - z));
    return least;
  },
};

export const cases = {
  "numbers are checked": {
    run(m, { why, ball }) {
      const cloth = new m.Cloth(ball());
      const before = cloth.stateHash();
      const told = [
        why(() => cloth.step(NaN)),
        why(() => cloth.step(1.5)),
        why(() => cloth.step(-1)),
        why(() => cloth.moveTo(3)),
        why(() => cloth.moveTo(3, [0, 1])),
        why(() => cloth.moveTo(3, [0, 1, NaN])),
        why(() => cloth.moveTo(3, [0, 1, 0], NaN)),
        why(() => cloth.moveCollider(0, [0, 0])),
        why(() => cloth.moveCollider(1, [0, 0, 0])),
        why(() => cloth.moveCollider(0.5, [0, 0, 0])),
        why(() => cloth.moveCollider(0, [0, 0, 0], [0, 0, 0, 0])),
        why(() => cloth.moveCollider(0, [0, 0, 0], [0, 0, 0, 1], 0)),
        why(() => cloth.wind([1, "strong", 0])),
        why(() => cloth.gravity()),
        why(() => cloth.advance(-1)),
        why(() => cloth.advance(NaN)),
        why(() => cloth.push(1000, [0, 0, 0])),
        why(() => cloth.setForce(0, [1e300, 0, 0])),
        why(() => cloth.point(1e6, [1, 0, 0])),
        why(() => cloth.hit([0, 0, 0], [NaN, 0, 0])),
        why(() => cloth.attach(0, 7)),
        why(() => cloth.takeImpulse(0)),
        why(() => cloth.deformCollider(0, [0, 0, 0])),
        why(() => cloth.teleport([0, 0, 0], undefined, [-1])),
        why(() => cloth.teleport([0, 0, 0], undefined, 5)),
        why(() => cloth.wind(5)),
        why(() => cloth.wind("123")),
        why(() => cloth.wind({ x: 1, y: 2 })),
        why(() => cloth.moveTo(0, [0, 0, 0], "1")),
        why(() => cloth.moveCollider(0, [0, 0, 0], undefined, true)),
        why(() => cloth.switchCollider(0, 1)),
        why(() => cloth.deformCollider(0)),
        why(() => cloth.goBack({})),
        why(() => cloth.goBack()),
        why(() => cloth.set(5)),
        why(() => cloth.set("cloth", 5)),
        why(() => cloth.set("cloth", [null])),
        why(() => cloth.set("collider", 5)),
        why(() => cloth.set("contact", null)),
        why(() => new m.Cloth(ball(), { mostVertices: NaN })),
        why(() => new m.Cloth(ball(), { mostVertices: "x" })),
        why(() => new m.Cloth(ball(), { mostvertices: 5 })),
        why(() => new m.Cloth(ball(), 5)),
        why(() => cloth.advance(1, { budgt: 5 })),
        why(() => cloth.advance(1, null)),
        why(() => new m.Cloth()),
        why(() => new m.Cloth(null)),
        why(() => cloth.set("cloth.0.pin.0.select", "left")),
        why(() => cloth.set("cloth.pin.from", 1)),
        why(() => cloth.set([])),
        why(() => cloth.moveTo(0, ["0", 0, 0])),
        why(() => cloth.moveCollider(0, [0, 0, 0], { x: 0, y: 0, z: 0 })),
        why(() => cloth.moveTo("0", [0, 0, 0])),
        why(() => cloth.teleport([0, 0, 0], undefined, [null])),
      ];
      const same = cloth.stateHash() === before && cloth.steps === 0;
      cloth.free();
      return { told, same };
    },
    check({ told, same }) {
      const expected = [
        /^the number of steps must be a whole number, 0 or more, not NaN$/,
        /not 1\.5$/,
        /not -1$/,
        /^the place must be 3 finite numbers, not undefined$/,
        /^the place must be 3 finite numbers, not \[0, 1\]$/,
        /not \[0, 1, NaN\]$/,
        /./,
        /^the position must be 3 finite numbers, not \[0, 0\]$/,
        /^there is no collider 1: the last one is 0$/,
        /^the collider must be a whole number, 0 or more, not 0\.5$/,
        /^the rotation must be a quaternion x, y, z, w, not zeros$/,
        /./,
        /^the wind must be 3 finite numbers/,
        /^gravity must be 3 finite numbers, not undefined$/,
        /^the time must be a finite number, 0 or more, not -1$/,
        /not NaN$/,
        /^there is no vertex 1000; there are 175, from 0$/,
        /./,
        /triangle/,
        /^the direction must be 3 finite numbers/,
        /collider 7/,
        /measure/,
        /./,
        /^a collider must be a whole number/,
        /^the colliders must be a list of finite numbers, not 5$/,
        /^the wind must be 3 finite numbers, not 5$/,
        /^the wind must be 3 finite numbers, not "123"$/,
        /^the wind must be 3 finite numbers, not \[1, 2, undefined\]$/,
        /^the time must be a finite number, 0 or more, not "1"$/,
        /^the time must be a finite number, 0 or more, not true$/,
        /^isOn must be true or false, not 1$/,
        /^the positions must be a list of finite numbers, not undefined$/,
        /^goBack needs a snapshot/,
        /^goBack needs a snapshot, not undefined$/,
        /^the key must be a word/,
        /^cloth: invalid type: floating point `5.*`, expected a sequence/,
        /^cloth\.0: invalid type/,
        /^collider: invalid type/,
        /^contact: invalid type/,
        /^mostVertices must be a whole number/,
        /^mostVertices must be a whole number/,
        /^the options has no mostvertices; it has meshes, mostVertices$/,
        /^the options must be an object with meshes, mostVertices, not 5$/,
        /^the options of advance has no budgt; it has budget$/,
        /^the options of advance must be an object with budget, not null$/,
        /^a scene is a text, the name of a built-in one, or an object, not undefined$/,
        /^a scene is a text, the name of a built-in one, or an object, not null$/,
        /^cloth\.0\.pin\.0\.select: there is no pin yet; set it as a whole$/,
        /^cloth\.pin\.from: there is no pin yet; set it as a whole$/,
        /^the key must be a word such as "integrator\.step", not \[\]$/,
        /^the place must be 3 finite numbers, not \["0", 0, 0\]$/,
        /^the rotation must be 4 finite numbers, not \[0, 0, 0, undefined\]$/,
        /^there is no vertex "0"; there are 175, from 0$/,
        /^the colliders must be a list of finite numbers, not \[null\]$/,
      ];
      assert.equal(told.length, expected.length);
      told.forEach((text, k) => {
        assert.doesNotMatch(text, /^(nothing|no Error)/, `call ${k} was not refused`);
        assert.match(text, expected[k], `call ${k}`);
      });
      assert.ok(same, "a refused call changes nothing");
    },
  },

  "vectors of a scene are lists or typed arrays, and a duration is not needed": {
    run(m, { ball }) {
      const hash = (change) => {
        const { duration, ...scene } = ball();
        const cloth = new m.Cloth(change(scene));
        cloth.step(3);
        cloth.set({ gravity: new Float32Array([0, -5, 0]), duration: undefined });
        cloth.step();
        const told = { hash: cloth.stateHash(), gravity: cloth.scene.gravity, duration: cloth.duration };
        cloth.free();
        return told;
      };
      const arrays = (scene) => ({ ...scene, gravity: new Float64Array(scene.gravity), duration: undefined });
      return [hash((scene) => scene), hash(arrays)];
    },
    check([lists, arrays]) {
      assert.deepEqual(arrays, lists);
      assert.deepEqual(lists.gravity, [0, -5, 0]);
      assert.equal(lists.duration, 1);
    },
  },

  "a program gives its own meshes, also for colliders": {
    run(m, { why, ball, sheet }) {
      const mesh = sheet(10, 0.4);
      const table = sheet(1, 2);
      table.positions = Array.from(table.positions, (x, k) => (k % 3 === 1 ? -0.05 : x));
      const scene = ball({ collider: [{ shape: "mesh", file: "table" }] });
      scene.cloth[0] = { ...scene.cloth[0], grid: undefined, mesh: "sheet" };
      const refused = [
        why(() => new m.Cloth(scene)),
        why(() => new m.Cloth(scene, { meshes: { sheet: mesh } })),
        why(() => new m.Cloth(scene, { meshes: { sheet: mesh, table: { ...table, indices: [0, 1, 9] } } })),
        why(() => new m.Cloth(scene, { meshes: { sheet: { ...mesh, positions: [0, 1] }, table } })),
        why(() => new m.Cloth(scene, { meshes: { sheet: { ...mesh, indices: [0, 1, 1.5] }, table } })),
        why(() => new m.Cloth(scene, { meshes: 5 })),
      ];
      const cloth = new m.Cloth(scene, { meshes: { sheet: mesh, table } });
      const { vertices, uvs, triangles } = cloth.surface();
      const same = [
        [...cloth.triangles()].join() === [...mesh.indices].join(),
        [...vertices].every((vertex, k) => vertex === k),
        [...uvs].join() === [...mesh.uvs].join(),
        [...triangles].join() === [...mesh.indices].join(),
      ];
      cloth.step(120);
      const lowest = Math.min(...cloth.positions().filter((_, k) => k % 3 === 1));
      const bodies = cloth.bodies().map(({ shape, points }) => [shape, points.length]);
      cloth.free();
      return { refused, same, lowest, bodies };
    },
    check({ refused, same, lowest, bodies }) {
      const expected = [
        /mesh/,
        /table|collider/,
        /9/,
        /^meshes\.sheet\.positions: expected groups of 3 numbers/,
        /^meshes\.sheet\.indices: 1\.5/,
        /^meshes/,
      ];
      refused.forEach((text, k) => assert.match(text, expected[k]));
      assert.deepEqual(same, [true, true, true, true]);
      near(lowest, -0.05 + 0.004, 0.004);
      assert.deepEqual(bodies, [["mesh", 12]]);
    },
  },

  "nothing sinks into a collider that the program moves, at 0.1 to 5 m/s": {
    run(m, { ball, nearest }) {
      return [0.1, 0.3, 1, 2, 5].map((speed) => {
        const cloth = new m.Cloth(ball());
        let least = Infinity;
        const y = (time) => -0.12 + Math.min(0.4, speed * time);
        for (let k = 1; k <= 60; k++) {
          const height = y(k * cloth.stepLength);
          cloth.moveCollider(0, [0, height, 0]);
          cloth.step();
          least = Math.min(least, nearest(cloth, [0, height, 0]));
        }
        const { position, rotation } = cloth.colliderPose(0);
        const reached = position[1] - y(60 * cloth.stepLength);
        cloth.free();
        return { speed, least, reached, rotation };
      });
    },
    check(all) {
      for (const { speed, least, reached, rotation } of all) {
        assert.ok(least > 0.1, `at ${speed} m/s a vertex is ${1000 * (0.1 - least)} mm inside`);
        near(reached, 0, 1e-9);
        assert.deepEqual(rotation, [0, 0, 0, 1]);
      }
    },
  },

  "wind, gravity and materials change in place": {
    run(m, { ball }) {
      const scene = ball({ gravity: [0, 0, 0], drag: { wind: { velocity: [0, 0, 0], normal: 1, tangential: 1 } } });
      const cloth = new m.Cloth(scene);
      const speed = () => {
        const all = cloth.velocities();
        const sum = [0, 0, 0];
        for (let k = 0; k < all.length; k++) sum[k % 3] += (3 * all[k]) / all.length;
        return sum;
      };
      cloth.step(5);
      const still = speed();
      cloth.gravity([1, 0, 0]);
      cloth.step(12);
      const fallen = speed();
      cloth.gravity([0, 0, 0]);
      cloth.wind([0, 0, 3]);
      cloth.step(12);
      const blown = speed();
      // A force of the program stays, which shows that nothing was built anew.
      cloth.setForce(0, [0, 1, 0]);
      cloth.set({ "cloth.density": 0.4, "cloth.bend.rigidity": 2e-5, "contact.friction": 0.5 });
      const before = cloth.velocities()[1];
      cloth.step(1);
      const lifted = cloth.velocities()[1] - before;
      const { gravity, drag, cloth: sheets } = cloth.scene;
      const { steps } = cloth;
      cloth.free();
      return { still, fallen, blown, lifted, steps, gravity, wind: drag.wind.velocity, density: sheets[0].density };
    },
    check({ still, fallen, blown, lifted, steps, gravity, wind, density }) {
      near(Math.hypot(...still), 0, 1e-6);
      // The air at rest takes some of it.
      assert.ok(fallen[0] > 0.07 && fallen[0] < 12 / 120, `gravity gives ${fallen[0]} m/s`);
      assert.ok(blown[2] > 0.05, `the wind gives ${blown[2]} m/s`);
      assert.ok(lifted > 0.1, `the force gives ${lifted} m/s`);
      assert.deepEqual([steps, gravity, wind, density], [30, [0, 0, 0], [0, 0, 3], 0.4]);
    },
  },

  "impulses, forces and what the cloth does to a collider": {
    run(m, { ball }) {
      const cloth = new m.Cloth(ball({ gravity: undefined }));
      cloth.push(0, [0, 0, 1e-3]);
      const [, , pushed] = cloth.velocities();
      cloth.gravity([0, -9.81, 0]);
      cloth.measureImpulses();
      cloth.step(240);
      cloth.takeImpulse(0);
      const times = 120;
      let sum = 0;
      for (let k = 0; k < times; k++) {
        cloth.step();
        sum += cloth.takeImpulse(0).linear[1];
      }
      const force = sum / (times * cloth.stepLength);
      const touches = cloth.touches();
      const pressed = touches.reduce((sum, { sides, force }) => sum + (sides[0].kind === "cloth" ? force[1] : -force[1]), 0);
      const one = touches[0];
      cloth.free();
      return { pushed, force, pressed, one };
    },
    check({ pushed, force, pressed, one }) {
      assert.ok(pushed > 0.5, `the impulse gives ${pushed} m/s`);
      // The weight of 0.05 kg.
      const weight = 0.2 * 0.25 * 9.81;
      near(force, -weight, 0.1 * weight);
      near(pressed, weight, 0.2 * weight);
      assert.deepEqual(one.sides.map(({ kind }) => kind).sort(), ["cloth", "collider"]);
      near(Math.hypot(...one.normal), 1, 1e-5);
      near(Math.hypot(one.position[0], one.position[1] + 0.12, one.position[2]), 0.1, 0.01);
    },
  },

  "a vertex is pinned to a collider and let go": {
    run(m, { ball }) {
      const cloth = new m.Cloth(ball({ gravity: undefined }));
      const place = () => [...cloth.positions().subarray(0, 3)];
      const from = place();
      cloth.attach(0, 0);
      for (let k = 1; k <= 12; k++) {
        cloth.moveCollider(0, [0.01 * k, -0.12, 0]);
        cloth.step();
      }
      const to = place();
      const pins = [...cloth.pins()];
      const released = [cloth.release(0), cloth.release(0)];
      cloth.step();
      const on = place();
      cloth.free();
      return { from, to, on, pins, released };
    },
    check({ from, to, on, pins, released }) {
      near(to[0] - from[0], 0.12, 1e-5);
      assert.deepEqual([pins, released], [[0], [true, false]]);
      assert.ok(on[0] > to[0], "it keeps its velocity");
    },
  },

  "colliders are switched and deformed": {
    run(m, { why, ball, sheet }) {
      const table = sheet(1, 2);
      table.positions = Array.from(table.positions, (x, k) => (k % 3 === 1 ? -0.1 : x));
      const collider = [...ball().collider, { shape: "mesh", file: "table" }];
      const cloth = new m.Cloth(ball({ collider }), { meshes: { table } });
      const lowest = () => Math.min(...cloth.positions().filter((_, k) => k % 3 === 1));
      cloth.switchCollider(0, false);
      cloth.step(40);
      const through = lowest();
      const refused = why(() => cloth.switchCollider(0, true));
      const up = table.positions.map((y, k) => (k % 3 === 1 ? y + 0.05 : y));
      cloth.deformCollider(1, up, 0.5);
      cloth.step(90);
      const carried = lowest();
      cloth.switchCollider(1, false);
      cloth.step(30);
      const fallen = lowest();
      cloth.free();
      return { through, refused, carried, fallen };
    },
    check({ through, refused, carried, fallen }) {
      assert.ok(through < -0.05 && through > -0.1, `it falls through the ball and not through the table: ${through}`);
      assert.match(refused, /collider 0/);
      near(carried, -0.05 + 0.004, 0.004);
      assert.ok(fallen < -0.1, `it falls through the table: ${fallen}`);
    },
  },

  "a ray finds the point of the cloth that a hand points at": {
    run(m, { ball }) {
      const cloth = new m.Cloth(ball());
      cloth.step(60);
      const [origin, direction] = [
        [0.05, 1, 0.03],
        [0, -2, 0],
      ];
      const hit = cloth.hit(origin, direction);
      const point = cloth.point(hit.triangle, hit.weights);
      const beside = cloth.hit([2, 1, 0], direction);
      cloth.free();
      return { hit, point, missed: beside === undefined };
    },
    check({ hit, point, missed }) {
      assert.ok(missed);
      [0.05, 1 - hit.distance, 0.03].forEach((x, k) => near(point.position[k], x, 1e-6));
      near(Math.hypot(...point.normal), 1, 1e-6);
      assert.ok(Math.hypot(...point.velocity) > 0);
    },
  },

  "a cloth is carried elsewhere without a velocity": {
    run(m, { ball }) {
      const cloths = [0, 1].map(() => new m.Cloth(ball()));
      for (const cloth of cloths) cloth.step(30);
      const [stays, goes] = cloths;
      goes.teleport([3, 0, 0], [0, Math.SQRT1_2, 0, Math.SQRT1_2], [0]);
      for (const cloth of cloths) cloth.step(30);
      const place = (cloth) => [...cloth.positions().subarray(0, 3)];
      const told = { here: place(stays), there: place(goes), pose: goes.colliderPose(0) };
      for (const cloth of cloths) cloth.free();
      return told;
    },
    check({ here, there, pose }) {
      // A quarter turn about y: x becomes -z, and z becomes x.
      [here[2] + 3, here[1], -here[0]].forEach((x, k) => near(there[k], x, 2e-3));
      [3, -0.12, 0].forEach((x, k) => near(pose.position[k], x, 1e-6));
    },
  },

  "a motion without a time ends with the next steps, evenly": {
    run(m, { ball }) {
      // Four steps per frame.
      const cloth = new m.Cloth(ball({ gravity: undefined, integrator: { step: 1 / 240, tolerance: 1e-6 } }));
      const told = [];
      const frames = { advance: () => cloth.advance(1 / 60, { budget: 1e9 }), step: () => cloth.step(4) };
      let x = 0;
      for (const take of Object.values(frames)) {
        cloth.attach(0, 0);
        for (let k = 0; k < 5; k++) {
          x += 0.01;
          cloth.moveCollider(0, { x, y: -0.12, z: 0 });
          take();
        }
        // A vertex that is let go keeps the velocity of the collider, which would be zero if the motion had ended before.
        cloth.release(0);
        told.push([cloth.velocities()[0], cloth.colliderPose(0).position[0] - x]);
      }
      // With a time it goes its own way.
      cloth.moveCollider(0, [x + 0.04, -0.12, 0], undefined, 4 / 60);
      cloth.advance(1 / 60, { budget: 1e9 });
      const part = cloth.colliderPose(0).position[0] - x;
      cloth.free();
      return { told, part };
    },
    check({ told, part }) {
      for (const [speed, off] of told) {
        near(speed, 0.6, 1e-3);
        near(off, 0, 1e-9);
      }
      near(part, 0.01, 1e-9);
    },
  },

  "a vertex that a collider carries stays with it, whatever changes": {
    run(m, { ball }) {
      const cloth = new m.Cloth(ball({ gravity: undefined }));
      cloth.attach(0, 0);
      const from = cloth.positions()[0];
      cloth.set("cloth.density", 0.3);
      cloth.set("integrator.method", "bdf2");
      cloth.wind([0, 0, 1]);
      cloth.set({ "integrator.step": undefined, "integrator.error": 0.001 });
      const codes = cloth.warnings().map(({ code }) => code);
      cloth.moveCollider(0, [0.02, -0.12, 0]);
      cloth.step();
      const way = cloth.positions()[0] - from;
      const pins = [...cloth.pins()];
      cloth.free();
      return { way, pins, codes };
    },
    check({ way, pins, codes }) {
      near(way, 0.02, 1e-6);
      assert.deepEqual(pins, [0]);
      assert.ok(Array.isArray(codes));
    },
  },

  "going back goes back to the method, too": {
    run(m, { ball }) {
      const play = (cloth) => {
        cloth.push(0, [0, 0, 1e-4]);
        cloth.step(20);
        return [...cloth.positions()].join();
      };
      const cloth = new m.Cloth(ball());
      cloth.step(10);
      const snapshot = cloth.snapshot();
      const first = [play(cloth), cloth.stateHash()];
      cloth.set({ "integrator.method": "implicit-midpoint", "integrator.tolerance": 0.5, duration: 9, "contact.self": false });
      cloth.step(5);
      cloth.goBack(snapshot);
      const { scene, duration } = cloth;
      const second = [play(cloth), cloth.stateHash()];
      cloth.free();
      return { same: first.join() === second.join(), integrator: scene.integrator, own: scene.contact.self, duration };
    },
    check({ same, integrator, own, duration }) {
      assert.ok(same, "the same steps do not give the same bits");
      assert.deepEqual([integrator, own, duration], [{ step: 1 / 120, tolerance: 1e-8 }, undefined, 1]);
    },
  },

  "going back to a snapshot and on gives the same bits": {
    run(m, { why, ball }) {
      const cloth = new m.Cloth(ball());
      const play = () => {
        for (let k = 0; k < 30; k++) {
          cloth.moveCollider(0, [0, cloth.colliderPose(0).position[1] + 0.001, 0]);
          cloth.step();
        }
        return [...cloth.positions(), ...cloth.velocities()].join();
      };
      cloth.step(30);
      const snapshot = cloth.snapshot();
      const first = play();
      cloth.gravity([0, 5, 0]);
      cloth.step(3);
      cloth.goBack(snapshot);
      const { gravity } = cloth.scene;
      const second = play();
      const other = new m.Cloth("flag");
      const refused = why(() => other.goBack(snapshot));
      snapshot.free();
      cloth.free();
      other.free();
      return { same: first === second, steps: gravity, refused };
    },
    check({ same, steps, refused }) {
      assert.ok(same);
      assert.deepEqual(steps, [0, -9.81, 0]);
      assert.match(refused, /^the snapshot is of another scene/);
    },
  },

  "a snapshot keeps the motions that end with the next steps": {
    run(m, { ball }) {
      const cloth = new m.Cloth(ball());
      cloth.step(5);
      cloth.moveCollider(0, [0, 0.01, 0]);
      const snapshot = cloth.snapshot();
      const play = (cloth) => {
        cloth.step(4);
        return [...cloth.positions(), ...cloth.colliderPose(0).position].join();
      };
      const first = play(cloth);
      cloth.moveCollider(0, [0, -1, 0]);
      cloth.goBack(snapshot);
      const second = play(cloth);
      // In another cloth it moves that one's collider.
      const [other, at] = [new m.Cloth(ball()), cloth.colliderPose(0).position];
      other.goBack(snapshot);
      const third = play(other);
      const after = cloth.colliderPose(0).position;
      [snapshot, cloth, other].forEach((it) => it.free());
      return { same: first === second && first === third, stays: at.join() === after.join() };
    },
    check({ same, stays }) {
      assert.ok(same, "other bits after going back");
      assert.ok(stays, "the collider of the first cloth moved");
    },
  },

  "a snapshot that does not fit changes nothing": {
    run(m, { why, sheet }) {
      const scene = { duration: 1, cloth: [{ mesh: "s", density: 0.2, stretch: { model: "membrane", stiffness: 1000 } }] };
      const other = { ...scene, integrator: { step: 1 / 120, error: 0.003 }, cloth: [{ ...scene.cloth[0], density: 0.7 }] };
      const [cloth, finer] = [new m.Cloth(scene, { meshes: { s: sheet(5, 1) } }), new m.Cloth(other, { meshes: { s: sheet(6, 1) } })];
      cloth.step(3);
      const told = () => JSON.stringify([cloth.scene, cloth.stepLength, cloth.stepError, cloth.stateHash(), cloth.time]);
      const before = told();
      const refused = why(() => cloth.goBack(finer.snapshot()));
      const after = told();
      cloth.step();
      [cloth, finer].forEach((it) => it.free());
      return { refused, same: before === after };
    },
    check({ refused, same }) {
      assert.match(refused, /the snapshot is damaged, or the scene has other meshes/);
      assert.ok(same, "the cloth has changed");
    },
  },

  "another method goes on with pins, forces and colliders; colliders do not jump": {
    run(m, { why, ball }) {
      const cloth = new m.Cloth(ball());
      cloth.set("collider.0.center", [0, -0.13, 0]);
      const early = cloth.colliderPose(0).position[1];
      cloth.step(30);
      cloth.moveTo(90, [0.1, 0.1, 0.1], 0.1);
      cloth.moveCollider(0, [0, -0.1, 0], undefined, 0.1);
      cloth.step(20);
      const state = () => [...cloth.positions()].join();
      const before = state();
      const refused = why(() => cloth.set("collider.0.center", [0, 0, 0]));
      cloth.set({ "integrator.method": "bdf2" });
      const kept = state() === before;
      const pose = cloth.colliderPose(0).position[1];
      const pins = [...cloth.pins()];
      cloth.set("collider.0.friction", 0.9);
      cloth.step(10);
      const { method } = cloth.scene.integrator;
      cloth.free();
      return { early, refused, kept, pose, pins, method };
    },
    check({ early, refused, kept, pose, pins, method }) {
      near(early, -0.13, 1e-7);
      assert.match(refused, /use moveCollider/);
      assert.ok(kept);
      near(pose, -0.1, 1e-7);
      assert.deepEqual([pins, method], [[90], "bdf2"]);
    },
  },

  "time that passes unevenly gives the right number of steps; a budget drops what is too much": {
    run(m, { ball }) {
      const cloth = new m.Cloth(ball({ integrator: { step: 1 / 60, tolerance: 1e-4 } }));
      let [steps, worst] = [0, 0];
      for (let k = 0; k < 60; k++) {
        const { steps: own } = cloth.advance(1 / 60 + (k % 2 === 0 ? 0.003 : -0.003), { budget: 1e9 });
        steps += own;
        worst = Math.max(worst, Math.abs(own - 1));
      }
      const late = cloth.advance(10, { budget: 0 });
      const { time } = cloth;
      cloth.free();
      return { steps, worst, late, time };
    },
    check({ steps, worst, late, time }) {
      assert.deepEqual([steps, worst, late.steps], [60, 0, 1]);
      near(late.dropped, 10 - 1 / 60, 0.01);
      near(time, 61 / 60, 1e-6);
    },
  },

  "a run that diverges is told, and the last good state stays": {
    run(m, { ball }) {
      const cloth = new m.Cloth(ball({ contact: undefined, collider: undefined }));
      cloth.pin(0);
      const events = [];
      cloth.onDiverge = (event) => events.push(event);
      for (let k = 0; k < 30; k++) cloth.advance(1 / 60, { budget: 1e9 });
      const calm = events.length;
      cloth.set("integrator", { method: "explicit-euler", step: 1 / 120 });
      cloth.advance(1e-9);
      cloth.gravity([0, -9, 0]);
      for (let k = 0; k < 60; k++) cloth.advance(1 / 60, { budget: 1e9 });
      const { stretch } = cloth.summary();
      const { hasDiverged, time } = cloth;
      const stands = cloth.advance(1 / 60).steps;
      const { gravity } = cloth.scene;
      cloth.resume();
      const resumed = cloth.hasDiverged;
      cloth.set("integrator", { method: "backward-euler", step: 1 / 120 });
      const goesOn = cloth.advance(1 / 60, { budget: 1e9 }).steps;
      cloth.restart();
      const again = [cloth.time, cloth.hasDiverged];
      cloth.free();
      return { calm, events, stretch: stretch.max, hasDiverged, time, stands, goesOn, again, gravity, resumed };
    },
    check({ calm, events, stretch, hasDiverged, time, stands, goesOn, again, gravity, resumed }) {
      assert.deepEqual([calm, events.length, hasDiverged, stands, goesOn], [0, 1, true, 0, 2]);
      assert.match(events[0].message, /diverged|stretched to/);
      assert.ok(stretch < 4 && time >= 0.49, `${stretch} times its length, at ${time} s`);
      assert.deepEqual(again, [0, false]);
      // The state is from before gravity changed, and the scene says so.
      assert.deepEqual([gravity, events[0].back, resumed], [[0, -9.81, 0], time, false]);
    },
  },

  "a scene that is too large is refused before it takes memory": {
    run(m, { why, ball }) {
      const scene = ball();
      scene.cloth[0].grid.cells = [2400, 2400];
      const refused = [why(() => new m.Cloth(scene)), why(() => new m.Cloth(ball(), { mostVertices: 100 }))];
      const cloth = new m.Cloth(ball());
      refused.push(why(() => cloth.set("cloth.grid.cells", [2400, 2400])));
      const file = ball({ collider: [{ shape: "mesh", file: "big" }] });
      const big = { positions: new Float32Array(600_000), indices: [0, 1, 2] };
      refused.push(why(() => new m.Cloth(file, { meshes: { big } })));
      refused.push(
        why(() => new m.Cloth(file, { meshes: { big: { ...big, positions: big.positions.subarray(0, 600) } }, mostVertices: 300 })),
      );
      const { vertexCount } = cloth;
      cloth.free();
      return { refused, vertexCount };
    },
    check({ refused, vertexCount }) {
      assert.match(
        refused[0],
        /^the scene has 57\d{5} vertices, more than 100000; take fewer cells, or allow more by the option mostVertices$/,
      );
      assert.match(refused[1], /^the scene has 175 vertices, more than 100;/);
      assert.match(refused[2], /more than 100000/);
      assert.match(refused[3], /^meshes\.big has 200000 vertices, more than 100000; take a coarser mesh/);
      assert.match(refused[4], /^the scene has 375 vertices, more than 300;/);
      assert.equal(vertexCount, 175);
    },
  },

  "a cloth is freed once, also at the end of a block": {
    run(m, { why, ball }) {
      const cloth = new m.Cloth(ball());
      if (Symbol.dispose) cloth[Symbol.dispose]();
      cloth.free();
      cloth.free();
      const snapshot = why(() => cloth.snapshot());
      return [why(() => cloth.step()), snapshot, why(() => cloth.positions())];
    },
    check(told) {
      told.forEach((text) => assert.match(text, /given back by free/));
    },
  },

  "a texture has coordinates where it has a seam, too": {
    run(m) {
      const cloth = new m.Cloth("skirt");
      const { vertices, uvs, triangles } = cloth.surface();
      const own = cloth.triangles();
      const fits = triangles.every((vertex, k) => vertices[vertex] === own[k]);
      // Each triangle is as large in the texture as at rest, to the stretch of the start.
      const at = (k) => [uvs[2 * k], uvs[2 * k + 1]];
      const widest = Math.max(
        ...Array.from({ length: triangles.length / 3 }, (_, k) => {
          const [a, b, c] = [...triangles.subarray(3 * k, 3 * k + 3)].map(at);
          return Math.max(Math.abs(a[0] - b[0]), Math.abs(b[0] - c[0]), Math.abs(c[0] - a[0]));
        }),
      );
      const counts = [vertices.length > cloth.vertexCount, uvs.length === 2 * vertices.length];
      cloth.free();
      return { fits, widest, counts };
    },
    check({ fits, widest, counts }) {
      assert.ok(fits);
      assert.deepEqual(counts, [true, true]);
      assert.ok(widest < 0.1, `a triangle is ${widest} m wide in the texture`);
    },
  },
};

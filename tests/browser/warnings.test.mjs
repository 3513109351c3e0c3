// The package warns of the same things as the command line, with the same codes and in the same order.

import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import { existsSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { before, test } from "node:test";
import { dist, root } from "./kit.mjs";

/** Built by the tests of the command line. */
const muslin = join(process.env.CARGO_TARGET_DIR ?? join(root, "target"), "debug/muslin");

let m;

before(async () => {
  m = await import(join(dist, "muslin.js"));
  await m.load(readFileSync(join(dist, "muslin_wasm_bg.wasm")));
});

/** The codes in the summary of a run, also of one that ends as doubtful. */
function native(text) {
  assert.ok(existsSync(muslin), `no ${muslin}: cargo build -p muslin-cli`);
  const out = mkdtempSync(join(tmpdir(), "muslin-warnings-"));
  try {
    writeFileSync(join(out, "scene.toml"), text);
    const words = ["run", join(out, "scene.toml"), "--preview", "none", "--export", "none", "--json", "--quiet", "--out", join(out, "out")];
    const { stdout, stderr } = spawnSync(muslin, words, { encoding: "utf8" });
    assert.ok(stdout, stderr);
    const { warnings, steps, verdict } = JSON.parse(stdout);
    return { codes: warnings.map(({ code }) => code), steps, verdict };
  } finally {
    rmSync(out, { recursive: true, force: true });
  }
}

const SHEET = `frame_rate = 20
[[cloth]]
grid = { size = [0.3, 0.3], cells = [4, 4] }
density = 0.2
stretch = { model = "membrane", stiffness = STIFF, damping = DAMPING }
shear = { stiffness = STIFF }
pin = [{ select = { corners = [0, 1] } }]
`;
const sheet = (stiffness, damping) => `gravity = [0.0, -9.81, 0.0]\n${SHEET.replaceAll("STIFF", stiffness).replace("DAMPING", damping)}`;

/** Scenes, and the codes that they are made for. */
const SCENES = {
  "settings that do not divide time": [`duration = 0.12\n${sheet("50.0", "0.0")}[integrator]\nstep = 0.03\n`, ["step", "duration"]],
  "an explicit step that is too long": [
    `duration = 0.05\n${sheet("100.0", "0.0")}[integrator]\nmethod = "symplectic-euler"\nstep = 0.025\n`,
    ["unstable"],
  ],
  "cloth that its weight stretches": [`duration = 1.0\n${sheet("0.25", "0.2")}[integrator]\nstep = 0.01\n`, ["stretch"]],
  "a thick layer": [`duration = 0.05\n${sheet("100.0", "0.0")}[contact]\nthickness = 0.2\nself = false\n`, ["thickness"]],
  "masses that single precision loses": [`duration = 0.5\n${sheet("1e7", "0.0")}[integrator]\nstep = 0.025\n`, ["masses"]],
  "a pendulum that backward Euler damps": [
    `duration = 6.0
gravity = [0.0, -9.81, 0.0]
frame_rate = 20
[[cloth]]
grid = { size = [0.5, 0.5], cells = [1, 1], pattern = "diagonal" }
density = 0.1
stretch = { model = "membrane", stiffness = 1e4 }
shear = { stiffness = 1e4 }
pin = [{ select = { edge = "back" } }]
`,
    ["method"],
  ],
  "a rotation that backward Euler slows down": [
    `duration = 0.5
frame_rate = 60
[[cloth]]
grid = { size = [1.0, 1.0], cells = [6, 6] }
density = 0.2
stretch = { model = "membrane", stiffness = 1000.0 }
spin = { axis = [0, 1, 0], rate = 6.0 }
[contact]
thickness = 0.005
`,
    ["method"],
  ],
  "a strip that one solve in each step does not follow": [
    `duration = 1.0
frame_rate = 20
[[cloth]]
grid = { size = [0.0462, 0.2], cells = [8, 40] }
density = 0.02
stretch = { model = "membrane", stiffness = 5000.0 }
shear = { stiffness = 2000.0 }
bend = { model = "hinge", rigidity = 1e-3 }
pin = [{ select = { box = [[-1, -1, -0.101], [1, 1, -0.0949]] } }]
load = [{ select = { edge = "front" }, force = [0.0, -0.01, 0.0], share = "length" }]
[drag]
linear = 0.4
[integrator]
step = 0.01
error = 0
`,
    ["energy"],
  ],
  "no reason to warn": [`duration = 0.2\n${sheet("100.0", "0.0")}[integrator]\nstep = 0.01\n`, []],
};

for (const [name, [text, made]] of Object.entries(SCENES)) {
  test(`${name}: the warnings of the command line`, () => {
    const { codes, steps, verdict } = native(text);
    const cloth = new m.Cloth(text);
    cloth.step(steps);
    const own = cloth.warnings();
    cloth.free();
    console.log(name, verdict, codes, own);
    assert.deepEqual(
      own.map(({ code }) => code),
      codes,
      "the package and the command line differ",
    );
    for (const code of made) assert.ok(codes.includes(code), `${code} is not among ${codes}`);
    assert.equal(
      own.some(({ doubtful }) => doubtful),
      verdict === "doubtful",
      "the verdict",
    );
    assert.ok(made.length > 0 || codes.length === 0, `${codes}`);
  });
}

test("a change of the scene begins anew", () => {
  const cloth = new m.Cloth(SCENES["cloth that its weight stretches"][0]);
  cloth.step(100);
  assert.deepEqual(
    cloth.warnings().map(({ code }) => code),
    ["stretch"],
  );
  cloth.set({ "cloth.stretch.stiffness": 100, "integrator.step": 0.5 });
  assert.ok(
    cloth.warnings().some(({ code }) => code === "step"),
    "a warning of the new settings",
  );
  cloth.free();
});

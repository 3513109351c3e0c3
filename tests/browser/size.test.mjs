// Size of the files that a visitor's browser fetches: the page and the module, gzipped.

import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { readdirSync, statSync } from "node:fs";
import { join } from "node:path";
import { test } from "node:test";
import { dist } from "./kit.mjs";

const MOST = 338_000;

test(`page and module are less than ${MOST / 1000} kB`, () => {
  // A page fetches the module itself, not the bundle that has it inside, and no examples.
  const isFetched = (file) => /\.(html|css|js|wasm)$/.test(file) && file !== "inline.js" && !file.startsWith("examples");
  const files = readdirSync(dist, { recursive: true }).filter(isFetched);
  const sizes = files.map((file) => [file, execFileSync("gzip", ["-9", "--stdout", "--no-name", join(dist, file)]).length]);
  const sum = sizes.reduce((sum, [, size]) => sum + size, 0);
  console.log(`${sizes.map(([file, size]) => `${file} ${size}`).join(", ")}; together ${sum} bytes gzipped`);
  assert.ok(statSync(join(dist, "muslin_wasm_bg.wasm")).size > 100_000, "the module is there");
  assert.ok(sum < MOST, `${sum} bytes: look at what grew with twiggy or by halves`);
});

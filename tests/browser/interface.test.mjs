// The interface of the package, in Node.js, on a page and in a worker.

import { readFileSync } from "node:fs";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { cases, helpers } from "./interface.mjs";
import { browser, dist, skip, withModule } from "./kit.mjs";

/** The helpers as text, for the other side. */
const tools = `({ ${Object.entries(helpers).map(([name, helper]) => `${name}: ${helper}`)} })`;

let chromium;
let page;

before(async () => {
  if (skip) return;
  chromium = await browser({ webgpu: false });
  page = await withModule(chromium);
  await page.evaluate((tools) => {
    const worker = new Worker(
      URL.createObjectURL(
        new Blob(
          [
            `
      const ready = import("${location.origin}/dist/inline.js").then(async (m) => (await m.load(), m));
      onmessage = async ({ data }) => {
        const m = await ready;
        try {
          postMessage({ told: Function("m", "tools", "return " + data)(m, ${tools}) });
        } catch (error) {
          postMessage({ failed: String(error.stack ?? error) });
        }
      };`,
          ],
          { type: "text/javascript" },
        ),
      ),
    );
    window.tools = Function(`return ${tools}`)();
    window.inWorker = (code) =>
      new Promise((resolve, reject) => {
        worker.onmessage = ({ data }) => (data.failed ? reject(new Error(data.failed)) : resolve(data.told));
        worker.onerror = (event) => reject(new Error(event.message));
        worker.postMessage(code);
      });
  }, tools);
});
after(() => chromium?.close());

const node = import(join(dist, "muslin.js")).then(async (m) => {
  await m.load(readFileSync(join(dist, "muslin_wasm_bg.wasm")));
  return m;
});

for (const [name, { run, check }] of Object.entries(cases)) {
  // A method of an object is a function once `function` stands before it.
  const code = `(function ${run})(m, tools)`;
  test(`${name}, in Node.js`, async () => check(run(await node, helpers)));
  test(`${name}, on a page`, { skip }, async () =>
    check(await page.evaluate((code) => Function("m", "tools", `return ${code}`)(m, tools), code)),
  );
  test(`${name}, in a worker with the module inside`, { skip }, async () => check(await page.evaluate((code) => inWorker(code), code)));
}

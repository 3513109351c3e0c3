// A browser and a server for tests: Debian's Chromium, headless, with a software implementation of WebGPU.

import { existsSync } from "node:fs";
import { mkdtemp, readFile, rm } from "node:fs/promises";
import { createServer } from "node:http";
import { createRequire } from "node:module";
import { tmpdir } from "node:os";
import { extname, join, normalize } from "node:path";
import { fileURLToPath } from "node:url";

export const root = fileURLToPath(new URL("../..", import.meta.url));
export const dist = join(root, "host-wasm/dist");
const require = createRequire(join(root, "host-wasm/package.json"));

const CHROMIUM = ["/usr/bin/chromium", "/usr/bin/chromium-browser", "/usr/bin/google-chrome"];
const executablePath = process.env.CHROMIUM ?? CHROMIUM.find((path) => existsSync(path));

/** The reason why tests that need a browser are skipped; false if they run. */
export const skip =
  executablePath || process.env.MUSLIN_REQUIRE_BROWSER ? false : "no Chromium: apt-get install chromium, or name one in CHROMIUM";

const FLAGS = ["--no-sandbox", "--disable-quic", "--no-first-run", "--disable-background-networking"].concat([
  "--disable-component-update",
  "--disable-sync",
  "--enable-unsafe-swiftshader",
]);
// Without software Vulkan and ANGLE as well, WebGPU canvases stay blank.
const WEBGPU = ["--enable-unsafe-webgpu", "--use-webgpu-adapter=swiftshader", "--enable-features=Vulkan"].concat([
  "--use-vulkan=swiftshader",
  "--use-angle=swiftshader",
]);

const TYPES = {
  ".html": "text/html",
  ".js": "text/javascript",
  ".mjs": "text/javascript",
  ".gltf": "model/gltf+json",
  ".css": "text/css",
  ".wasm": "application/wasm",
};

/** Options for running commands of the project; their error output is shown. */
export const pack = { cwd: root, stdio: ["ignore", "ignore", "inherit"] };

/** Saves a screenshot of a page in target/browser. */
export const shot = (page, name) => page.screenshot({ path: join(root, "target/browser", `${name}.png`) });

/** A blank page with the module, loaded, as `m`. */
export async function withModule(chromium) {
  const { page } = await chromium.open("blank.html");
  await page.evaluate(async () => {
    window.m = await import("/dist/muslin.js");
    await m.load();
  });
  return page;
}

/** ms after which a page counts as hung: long, because machines may be slow and busy. */
const PATIENCE = 600_000;

/** Waits until the page's run has taken `count` steps. */
export const steps = (page, count) => page.waitForFunction((count) => window.muslin?.run().view?.steps >= count, count);

/** Waits until a paused run has stopped and its last state is drawn. */
export async function still(page) {
  await page.waitForFunction(() => muslin.run().paused && muslin.run().view.isStill);
  await page.evaluate(() => new Promise((drawn) => requestAnimationFrame(() => requestAnimationFrame(drawn))));
}

/** Waits for `count` further steps. */
export async function more(page, count) {
  const now = await page.waitForFunction(() => String(muslin.run().view.steps));
  await steps(page, Number(await now.jsonValue()) + count);
}

/** Waits until the cloth in view has this number of pins. The state in view may be a few steps old. */
export const pinned = (page, count) => page.waitForFunction((count) => muslin.run().pins().length === count, count);

/** Waits until the hand holds a vertex, and returns it; `not` is the one that it held before. */
export async function held(page, not = -1) {
  const found = await page.waitForFunction(
    (not) => ![undefined, not].includes(muslin.run().view.held) && String(muslin.run().view.held),
    not,
  );
  return Number(await found.jsonValue());
}

/** Waits until the hand holds nothing. */
export const free = (page) => page.waitForFunction(() => muslin.run().view.held === undefined);

/** Position of a vertex in the page's picture, px; -1 is the last vertex. */
export const spot = (page, vertex) =>
  page.evaluate((vertex) => {
    const { camera, run } = muslin;
    const from = 3 * (vertex < 0 ? run().positions().length / 3 + vertex : vertex);
    return camera.project(
      camera.matrix(true),
      run()
        .positions()
        .slice(from, from + 3),
    );
  }, vertex);

/** Whether a vertex is drawn darker than without marks; -1 is the last vertex. */
export const dark = (page, vertex) =>
  page.evaluate(async (vertex) => {
    const { camera, picture, run } = muslin;
    // The view must not move between two pictures.
    camera.follows = false;
    // A copy, because the columns go back to the worker.
    const view = structuredClone(run().view);
    const from = 3 * (vertex < 0 ? view.positions.length / 3 + vertex : vertex);
    const [x, y] = camera.project(camera.matrix(true), view.positions.slice(from, from + 3));
    const scale = picture.canvas.width / camera.size[0];
    // A WebGPU canvas shows one picture per frame.
    const around = async (marked) => {
      await new Promise(requestAnimationFrame);
      picture.draw({ ...view, marked });
      const context = Object.assign(document.createElement("canvas"), { width: 9, height: 9 }).getContext("2d");
      context.drawImage(picture.canvas, x * scale - 4, y * scale - 4, 9, 9, 0, 0, 9, 9);
      return context.getImageData(0, 0, 9, 9).data;
    };
    const [marked, unmarked] = [await around(view.marked), await around([])];
    // A vertex's colour blends into its neighbours' colours, which may be only a few pixels away.
    return marked.some((value, k) => k % 4 === 0 && unmarked[k] - value > 40);
  }, vertex);

/** Number of points, out of 30,000 in the page's picture, that are darker than the background. */
export const drawn = (page) =>
  page.evaluate(() => {
    const { picture, run } = muslin;
    picture.draw(run().view);
    const copy = Object.assign(document.createElement("canvas"), { width: 200, height: 150 });
    const context = copy.getContext("2d");
    context.drawImage(picture.canvas, 0, 0, 200, 150);
    const { data } = context.getImageData(0, 0, 200, 150);
    return data.filter((value, k) => k % 4 === 0 && value < 230 && data[k + 3] > 0).length;
  });

/** Serves `host-wasm` and a blank page on localhost only; returns the address and a function that stops the server. */
async function serve() {
  const server = createServer(async (request, response) => {
    let path = normalize(decodeURIComponent(new URL(request.url, "http://x").pathname));
    // As other servers do: the page of a folder, also without a slash behind its name.
    if (/\/page\/?$/.test(path)) path = join(path, "index.html");
    try {
      const body = ["/blank.html", "/favicon.ico"].includes(path) ? "" : await readFile(join(root, "host-wasm", path));
      response.writeHead(200, { "content-type": TYPES[extname(path)] ?? "text/plain" }).end(body);
    } catch {
      response.writeHead(404).end();
    }
  });
  await new Promise((ready) => server.listen(0, "127.0.0.1", ready));
  return { address: `http://127.0.0.1:${server.address().port}`, end: () => server.close() };
}

/** A browser, with or without WebGPU, that records the errors of pages. */
export async function browser({ webgpu }) {
  const folder = await mkdtemp(join(tmpdir(), "muslin-browser-"));
  const args = webgpu ? [...FLAGS, ...WEBGPU] : [...FLAGS, "--disable-features=WebGPU"];
  const context = await require("playwright-core").chromium.launchPersistentContext(folder, { executablePath, args, headless: true });
  context.setDefaultTimeout(PATIENCE);
  const server = await serve();
  return {
    /** Opens a page at an address below `host-wasm`; `errors` collects its exceptions and console errors. */
    async open(path, viewport = { width: 1200, height: 800 }, media = {}) {
      const page = await context.newPage();
      await page.emulateMedia(media);
      await page.setViewportSize(viewport);
      const errors = [];
      page.on("console", (message) => message.type() === "error" && errors.push(message.text()));
      page.on("pageerror", (error) => errors.push(String(error)));
      await page.goto(`${server.address}/${path}`);
      return { page, errors };
    },
    async close() {
      await context.close();
      server.end();
      await rm(folder, { recursive: true, force: true });
    },
  };
}

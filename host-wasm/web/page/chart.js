// The chart of speed against accuracy for the current scene. It is drawn while a worker measures.

import { length } from "./error.js";

/** Colours that differ for all kinds of colour vision (M. Okabe, K. Ito), and a shape for each, in a square from -4 to 4. */
const COLOURS = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#444"];
const SHAPES = ["M-4 -4H4V4H-4Z", "M0 -5L5 0L0 5L-5 0Z", "M0 -5L5 4H-5Z", "M0 5L5 -4H-5Z", "M-4 -1H-1V-4H1V-1H4V1H1V4H-1V1H-4Z"].concat([
  "M-5 0A5 5 0 0 1 5 0A5 5 0 0 1 -5 0Z",
  "M-4 -2L-2 -4L0 -2L2 -4L4 -2L2 0L4 2L2 4L0 2L-2 4L-4 2L-2 0Z",
]);
/** The mark of a method, by its number, at a place. */
const mark = (k, x, y, title = "") =>
  `<path class="point" d="${SHAPES[k]}" transform="translate(${x} ${y})" fill="${COLOURS[k]}">${title}</path>`;
const [WIDTH, HEIGHT, LEFT, BOTTOM, TOP] = [360, 300, 56, 38, 10];

/** Measures a cloth's scene in a worker and draws into a figure. Returns a function that ends it. */
export function chart(figure, { scene, stepLength: step, stepError: error }, seconds, over) {
  const state = { name: scene.name, points: [], doing: "", failed: [] };
  const worker = new Worker(new URL("worker.js", import.meta.url), { type: "module" });
  const end = () => {
    worker.terminate();
    state.done = true;
    figure.innerHTML = drawn(state);
    over();
  };
  worker.onmessage = ({ data }) => {
    state.why = data.why;
    state.doing = data.doing ?? state.doing;
    state.until = data.until ?? state.until;
    state.reference = data.reference ?? state.reference;
    if (data.point) put(data.point.failed || !(data.point.error < 1e3) ? state.failed : state.points, data.point);
    if (data.done || data.kind === "failed") end();
    else figure.innerHTML = drawn(state);
  };
  worker.onerror = ({ message }) => worker.onmessage({ data: { kind: "failed", why: message ?? "the worker does not start" } });
  worker.postMessage({ ask: "chart", scene, step, error, seconds });
  figure.hidden = false;
  figure.innerHTML = drawn(state);
  return end;
}

/** Adds a point, or replaces the one of the same method and step. */
function put(points, point) {
  const at = points.findIndex(({ method, step }) => method === point.method && step === point.step);
  if (at < 0) points.push(point);
  else points[at] = point;
}

const escaped = (text) => text.replace(/[<&]/g, (letter) => (letter === "<" ? "&lt;" : "&amp;"));
const powers = (values) => [Math.floor(Math.log10(Math.min(...values))), Math.ceil(Math.log10(Math.max(...values)))];

/** The results up to now, as markup. `why` is the reason for which the measurement failed. */
export function drawn({ name = "untitled", points, doing, failed, until, reference, done, why }) {
  // The clocks of browsers are coarse: a run that took 0 ms cannot be drawn on a logarithmic axis.
  const seen = points.filter(({ error, ms }) => error > 0 && ms > 0);
  const now = done
    ? escaped(why ?? "")
    : `The error of every method, and its time, in seconds to minutes. Now: ${escaped(doing || "start")} …`;
  if (seen.length === 0) return `<figcaption>${now || "There are no measurements to draw."}</figcaption>`;
  const [x0, x1] = powers(seen.map(({ ms }) => ms));
  const [y0, y1] = powers([...seen.map(({ error }) => error), reference || Infinity].filter(Number.isFinite));
  const x = (ms) => LEFT + ((Math.log10(ms) - x0) / (x1 - x0 || 1)) * (WIDTH - LEFT - 16);
  const y = (m) => HEIGHT - BOTTOM - ((Math.log10(m) - y0) / (y1 - y0 || 1)) * (HEIGHT - BOTTOM - TOP);
  const parts = [];
  for (let k = x0; k <= x1; k++) {
    parts.push(`<path d="M${x(10 ** k)} ${TOP}V${HEIGHT - BOTTOM}" stroke="#ddd"/>`);
    parts.push(`<text x="${x(10 ** k)}" y="${HEIGHT - 22}" text-anchor="middle">${10 ** k}</text>`);
  }
  for (let k = y0; k <= y1; k++) {
    parts.push(`<path d="M${LEFT} ${y(10 ** k)}H${WIDTH - 16}" stroke="#ddd"/>`);
    parts.push(`<text x="${LEFT - 4}" y="${y(10 ** k) + 4}" text-anchor="end">${length(10 ** k)}</text>`);
  }
  const methods = [...new Set(points.concat(failed).map(({ method }) => method))];
  methods.forEach((method, k) => {
    const own = seen.filter((point) => point.method === method).sort((a, b) => a.ms - b.ms);
    const line = own.map(({ ms, error }, k) => `${k ? "L" : "M"}${x(ms)} ${y(error)}`).join("");
    parts.push(`<path d="${line}" fill="none" stroke="${COLOURS[k]}" stroke-width="1.5"/>`);
    for (const { ms, error, step } of own) {
      const title = `${method}, ${(1000 * step).toPrecision(3)} ms steps: error ${length(error)}, computing time ${ms.toPrecision(3)} ms per simulated second`;
      parts.push(mark(k, x(ms), y(error), `<title>${title}</title>`));
    }
  });
  if (reference > 0) {
    parts.push(`<path d="M${LEFT} ${y(reference)}H${WIDTH - 16}" stroke="#000" stroke-dasharray="4 3"/>`);
  }
  const legend = methods.map((method, k) => {
    const lost = failed.filter((point) => point.method === method).length;
    return `<svg viewBox="-5 -5 10 10" aria-hidden="true">${mark(k, 0, 0).replace(' class="point"', "")}</svg> ${method}${lost ? ` (failed with ${lost} step${lost > 1 ? "s" : ""})` : ""}`;
  });
  return `<svg viewBox="0 0 ${WIDTH} ${HEIGHT}" role="img" aria-label="Error against time for each method" font-size="11" font-family="system-ui">
    ${parts.join("")}<text x="${WIDTH / 2}" y="${HEIGHT - 5}" text-anchor="middle">computing time, ms per simulated second</text></svg>
    <figcaption>${legend.join(", ")}. ${escaped(name)}: RMS error after ${until.toPrecision(3)} s; dashed: estimated error of the reference.
    <br>${now}</figcaption>`;
}

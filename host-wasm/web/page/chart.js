// The chart of speed against accuracy for the current scene. It is drawn while a worker measures.

import { length } from "./error.js";

const COLOURS = ["#c33", "#e80", "#a70", "#380", "#07a", "#44c", "#a3a"];
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
    if (data.point) (data.point.failed || !(data.point.error < 1e3) ? state.failed : state.points).push(data.point);
    if (data.done || data.kind === "failed") end();
    else figure.innerHTML = drawn(state);
  };
  worker.onerror = ({ message }) => worker.onmessage({ data: { kind: "failed", why: message ?? "the worker does not start" } });
  worker.postMessage({ ask: "chart", scene, step, error, seconds });
  figure.hidden = false;
  figure.innerHTML = drawn(state);
  return end;
}

const escaped = (text) => text.replace(/[<&]/g, (letter) => (letter === "<" ? "&lt;" : "&amp;"));
const powers = (values) => [Math.floor(Math.log10(Math.min(...values))), Math.ceil(Math.log10(Math.max(...values)))];

/** The results up to now, as markup. `why` is the reason for which the measurement failed. */
export function drawn({ name = "untitled", points, doing, failed, until, reference, done, why }) {
  // The clocks of browsers are coarse: a run that took 0 ms cannot be drawn on a logarithmic axis.
  const seen = points.filter(({ error, ms }) => error > 0 && ms > 0);
  const now = done ? escaped(why ?? "") : `${escaped(doing || "Measuring")} …`;
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
      parts.push(`<circle cx="${x(ms)}" cy="${y(error)}" r="4" fill="${COLOURS[k]}"><title>${title}</title></circle>`);
    }
  });
  if (reference > 0) {
    parts.push(`<path d="M${LEFT} ${y(reference)}H${WIDTH - 16}" stroke="#000" stroke-dasharray="4 3"/>`);
  }
  const legend = methods.map((method, k) => {
    const lost = failed.filter((point) => point.method === method).length;
    return `<span style="color:${COLOURS[k]}">● ${method}</span>${lost ? ` (failed with ${lost} step${lost > 1 ? "s" : ""})` : ""}`;
  });
  return `<svg viewBox="0 0 ${WIDTH} ${HEIGHT}" role="img" aria-label="Error against time for each method" font-size="11" font-family="system-ui">
    ${parts.join("")}<text x="${WIDTH / 2}" y="${HEIGHT - 5}" text-anchor="middle">computing time, ms per simulated second</text></svg>
    <figcaption>${legend.join(", ")}. ${escaped(name)}: RMS error after ${until.toPrecision(3)} s; dashed: estimated error of the reference.
    <br>${now}</figcaption>`;
}

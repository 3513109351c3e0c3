// What is measured of the run in view, as a list.

import { length } from "./error.js";

const PARTS = [["predict", "forces, solver"], ["broadPhase", "broad phase"], ["narrowPhase", "narrow phase"], ["response", "response"]];

export class Numbers {
  #list;
  #before = { steps: 0, contacts: 0 };

  constructor(list) {
    this.#list = list;
  }

  show({ cloth, reference, speed, paused }) {
    const { stretch, energy, proximity, impacts } = cloth.summary();
    const before = this.#before;
    this.#before = { steps: cloth.steps, contacts: proximity + impacts };
    const steps = Math.max(1, cloth.steps - before.steps);
    const times = cloth.takeTimes();
    const error = reference && (reference.why ?? (reference.last ? `${length(reference.last.error)} at ${reference.last.time.toFixed(2)} s` : "…"));
    const joules = Object.values(energy).reduce((sum, part) => sum + part, 0);
    const rows = [
      ["time", `${cloth.time.toFixed(2)} s, ${paused ? "paused" : `${speed.toFixed(2)} × real`}`],
      ["error (RMS, against 1/4 of the step)", error ?? "from the next reset on"],
      ["largest stretch", `${(100 * (stretch.max - 1)).toFixed(2)} %`],
      ["energy", `${joules.toPrecision(4)} J`],
      ["contacts a step", (Math.max(0, proximity + impacts - before.contacts) / steps).toFixed(0)],
      ...PARTS.filter(([part]) => part === "predict" || times[part] > 0).map(([part, name]) => [name, `${(times[part] / steps).toFixed(2)} ms a step`]),
    ];
    this.#list.replaceChildren(
      ...rows.flatMap(([name, text]) => [["dt", name], ["dd", text]].map(([tag, text]) => {
        const item = document.createElement(tag);
        item.textContent = text;
        return item;
      })),
    );
  }
}

// The list of measurements of the current run.

import { length } from "./error.js";

/** The warnings in words, by their code. */
const WARNINGS = {
  step: "the step does not divide a frame",
  duration: "the duration is no whole number of frames",
  thickness: "the contact thickness does not suit the edges",
  rigidity: "the shape of the triangles makes the cloth bend too stiffly",
  motion: "pins or colliders curve within a step",
  error: "the allowed error is large for this cloth",
  masses: "the step is too long for single precision",
  unstable: "the step is too long for the method",
  energy: "energy appeared from nowhere",
  stretch: "an edge was stretched by more than 30 %",
  unconverged: "solves ended above their tolerance",
  rounding: "the cloth is too far away for single precision",
  overlap: "energy came from overlapping surfaces",
  method: "the method took most of the energy",
  exceeding: "the error of a step was too large",
  newton: "Newton's method leaves contacts out",
};
const PARTS = [
  ["predict", "forces, solver"],
  ["broadPhase", "broad phase"],
  ["narrowPhase", "narrow phase"],
  ["response", "response"],
];

export class Numbers {
  #list;
  #before = {};
  #last;
  #times;

  constructor(list) {
    this.#list = list;
  }

  /** Steps and contacts between the last two shown states. They start over with another cloth or a longer step. */
  #since(cloth, contacts) {
    const before = this.#before;
    if (before.cloth !== cloth || cloth.steps < before.steps) {
      this.#before = { cloth, steps: cloth.steps, contacts };
      this.#last = { steps: 1, contacts: 0 };
      cloth.takeTimes();
      this.#times = { predict: 0 };
    } else if (cloth.steps > before.steps) {
      this.#last = { steps: cloth.steps - before.steps, contacts: contacts - before.contacts };
      this.#before = { cloth, steps: cloth.steps, contacts };
      this.#times = cloth.takeTimes();
    }
    return this.#last;
  }

  show({ cloth, reference, comparing, speed, paused }) {
    const { stretch, energy, proximity, impacts } = cloth.summary();
    const { steps, contacts } = this.#since(cloth, proximity + impacts);
    const times = this.#times;
    const error =
      reference && (reference.why ?? (reference.last ? `${length(reference.last.error)} at ${reference.last.time.toFixed(2)} s` : "…"));
    const joules = Object.values(energy).reduce((sum, part) => sum + part, 0);
    const rows = [
      ["time", `${cloth.time.toFixed(2)} s, ${paused ? "paused" : `${speed.toFixed(2)} × real time`}`],
      ["error (RMS distance to a run with step / 4)", error ?? (comparing ? "shown after the next reset" : "off")],
      ["largest stretch", `${(100 * (stretch.max - 1)).toFixed(2)} %`],
      ["energy", `${joules.toPrecision(4)} J`],
      ["contacts per step", (contacts / steps).toFixed(0)],
      ...PARTS.filter(([part]) => part === "predict" || times[part] > 0).map(([part, name]) => [
        name,
        `${(times[part] / steps).toFixed(2)} ms per step`,
      ]),
      ...cloth.warnings().map(({ code, doubtful }) => [doubtful ? "doubtful" : "warning", WARNINGS[code]]),
    ];
    this.#list.replaceChildren(
      ...rows.flatMap(([name, text]) =>
        [
          ["dt", name],
          ["dd", text],
        ].map(([tag, text]) => {
          const item = document.createElement(tag);
          item.textContent = text;
          return item;
        }),
      ),
    );
  }
}

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
/** The warning of an error that the page chose. */
const LIVE = "live allows large errors here; “as in the scene” has smaller ones, and is slower";
const PARTS = [
  ["predict", "forces, solver"],
  ["broadPhase", "broad phase"],
  ["narrowPhase", "narrow phase"],
  ["response", "response"],
];

/** The state of the error, as text. */
function compared({ error, comparing }) {
  if (!error) return comparing ? "shown after the next reset" : "off";
  if (error.why) return error.why;
  const far = error.isFar ? ", over a tenth of the cloth's size" : "";
  if (error.time !== undefined) return `${length(error.error)} at ${error.time.toFixed(2)} s${far}`;
  return error.waits ? "waits: the run is slower than real time" : "…";
}

function rows(numbers, isLive) {
  const { time, paused, speed, stretch, energy, contacts, times, warnings } = numbers;
  return [
    ["time", `${time.toFixed(2)} s, ${paused ? "paused" : speed === undefined ? "…" : `${speed.toFixed(2)} × real time`}`],
    ["error (RMS distance to a run with step / 4)", compared(numbers)],
    ["largest stretch", `${(100 * (stretch - 1)).toFixed(2)} %`],
    ["energy", `${energy.toPrecision(4)} J`],
    ["contacts per step", contacts.toFixed(0)],
    ...PARTS.filter(([part]) => part === "predict" || times[part] > 0).map(([part, name]) => [
      name,
      `${times[part].toFixed(2)} ms per step`,
    ]),
    ...warnings.map(({ code, doubtful }) => [doubtful ? "doubtful" : "warning", isLive && code === "error" ? LIVE : WARNINGS[code]]),
  ];
}

/** Shows the numbers in a list. `isLive`: the page chose the allowed error. */
export function show(list, numbers, isLive) {
  const item = (tag, text) => Object.assign(document.createElement(tag), { textContent: text });
  list.replaceChildren(...rows(numbers, isLive).flatMap(([name, text]) => [item("dt", name), item("dd", text)]));
}

// How far apart two states of a cloth are, m.

/** The root mean square distance of the vertices. */
export function rms(a, b) {
  let sum = 0;
  for (let k = 0; k < a.length; k++) sum += (a[k] - b[k]) ** 2;
  return Math.sqrt((3 * sum) / a.length);
}

/** Share of a cloth's size from which two runs are far apart. */
const FAR = 0.1;

/** Whether an error is large beside the cloth: its steps are too long, or small differences have grown in folds or in wind. */
export const areFarApart = (error, positions) => error > FAR * size(positions);

/** The root mean square distance of the vertices from their middle. */
function size(positions) {
  const [count, middle] = [positions.length / 3, [0, 0, 0]];
  for (let k = 0; k < positions.length; k++) middle[k % 3] += positions[k] / count;
  let sum = 0;
  for (let k = 0; k < positions.length; k++) sum += (positions[k] - middle[k % 3]) ** 2;
  return Math.sqrt(sum / count);
}

/** A length as text, in µm, mm or m. */
export function length(metres) {
  const [factor, unit] = metres < 1e-4 ? [1e6, "µm"] : metres < 0.1 ? [1e3, "mm"] : [1, "m"];
  return `${+(factor * metres).toPrecision(3)} ${unit}`;
}

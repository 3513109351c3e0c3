// How far apart two states of a cloth are, m.

/** The root mean square distance of the vertices. */
export function rms(a, b) {
  let sum = 0;
  for (let k = 0; k < a.length; k++) sum += (a[k] - b[k]) ** 2;
  return Math.sqrt((3 * sum) / a.length);
}

/** A length as text, in µm, mm or m. */
export function length(metres) {
  const [factor, unit] = metres < 1e-4 ? [1e6, "µm"] : metres < 0.1 ? [1e3, "mm"] : [1, "m"];
  return `${+(factor * metres).toPrecision(3)} ${unit}`;
}

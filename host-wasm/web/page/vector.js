// Vectors of three numbers.

/** The vector of a vertex in a column. */
export const point = (column, vertex) => Array.from(column.subarray(3 * vertex, 3 * vertex + 3));
export const sub = (a, b) => a.map((x, k) => x - b[k]);
export const add = (a, b, f) => a.map((x, k) => x + f * b[k]);
export const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
export const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
export const unit = (a) => a.map((x) => x / (Math.hypot(...a) || 1));

// Checks of the numbers that a program gives.

/** A whole number that is not negative: a count, or the number of a vertex, a collider or a triangle. */
export function whole(name: string, number: number): number {
  if (Number.isInteger(number) && number >= 0 && number < 2 ** 32) return number;
  throw new TypeError(`${name} must be a whole number, 0 or more, not ${number}`);
}

/** A list of `count` finite numbers. */
export function numbers(name: string, given: ArrayLike<number>, count: number): Float64Array {
  const all = Float64Array.from(given ?? []);
  if (all.length === count && all.every(Number.isFinite)) return all;
  throw new TypeError(`${name} must be ${count} finite numbers, not ${given && `[${Array.from(given).join(", ")}]`}`);
}

/** A finite number that is not negative. */
export function duration(name: string, seconds: number): number {
  if (Number.isFinite(seconds) && seconds >= 0) return seconds;
  throw new TypeError(`${name} must be a finite number, 0 or more, not ${seconds}`);
}

// Checks of the values that a program gives.

/** Coordinates: a list, or an object with x, y, z, and w for a rotation, as those of three.js. */
export type Coordinates = ArrayLike<number> | { x: number; y: number; z: number; w?: number };

/** How a value reads in an error message: texts in quotes. */
export function shown(given: unknown): string {
  if (isList(given)) return `[${Array.from(given, shown).join(", ")}]`;
  return typeof given === "string" ? JSON.stringify(given) : String(given);
}

function isList(given: unknown): given is ArrayLike<number> {
  return Array.isArray(given) || (ArrayBuffer.isView(given) && !(given instanceof DataView));
}

/** A whole number that is not negative: a count, or the number of a vertex, a collider or a triangle. */
export function whole(name: string, number: number): number {
  if (Number.isInteger(number) && number >= 0 && number < 2 ** 32) return number;
  throw new TypeError(`${name} must be a whole number, 0 or more, not ${shown(number)}`);
}

/** A finite number that is not negative. */
export function amount(name: string, number: number): number {
  if (Number.isFinite(number) && number >= 0) return number;
  throw new TypeError(`${name} must be a finite number, 0 or more, not ${shown(number)}`);
}

/** A truth value. */
export function truth(name: string, whether: boolean): boolean {
  if (typeof whether === "boolean") return whether;
  throw new TypeError(`${name} must be true or false, not ${shown(whether)}`);
}

/** A list or a typed array, whose numbers the module checks. */
export function array(name: string, given: ArrayLike<number>): ArrayLike<number> {
  if (isList(given)) return given;
  throw new TypeError(`${name} must be a list of numbers, not ${shown(given)}`);
}

/** A list of finite numbers. */
export function list(name: string, given: ArrayLike<number>): Float64Array {
  const all = isList(given) ? Float64Array.from(given) : undefined;
  // The conversion makes numbers of texts and of null.
  const isNumber = (x: unknown) => typeof x === "number";
  if (all?.every(Number.isFinite) && Array.prototype.every.call(given, isNumber)) return all;
  throw new TypeError(`${name} must be a list of finite numbers, not ${shown(given)}`);
}

/** Three coordinates, or the four of a rotation. */
export function coordinates(name: string, given: Coordinates, count: 3 | 4 = 3): Float64Array {
  const all = isList(given) ? given : object(given, count);
  const numbers = Float64Array.from(all ?? []);
  if (numbers.length === count && Array.from(all ?? []).every(Number.isFinite)) return numbers;
  throw new TypeError(`${name} must be ${count} finite numbers, not ${shown(all ?? given)}`);
}

function object(given: Exclude<Coordinates, ArrayLike<number>>, count: 3 | 4) {
  if (typeof given !== "object" || given === null || !("x" in given)) return undefined;
  const { x, y, z, w } = given;
  return count === 3 ? [x, y, z] : [x, y, z, w as number];
}

/** The keys of an object, if it has no others. */
export function keys<T extends object>(name: string, given: T, known: readonly (keyof T & string)[]): T {
  if (typeof given !== "object" || given === null || isList(given)) {
    throw new TypeError(`${name} must be an object with ${known.join(", ")}, not ${shown(given)}`);
  }
  const unknown = Object.keys(given).find((key) => !(known as readonly string[]).includes(key));
  if (unknown === undefined) return given;
  throw new TypeError(`${name} has no ${unknown}; it has ${known.join(", ")}`);
}

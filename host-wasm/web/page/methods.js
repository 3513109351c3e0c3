// The integrators.

/** The methods that can control the error of their steps. */
export const IMPLICIT = ["backward-euler", "implicit-midpoint", "bdf2"];
export const METHODS = ["explicit-euler", "symplectic-euler", "midpoint", "rk4", ...IMPLICIT];

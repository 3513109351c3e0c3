// The integrators, explicit ones first.

export const METHODS = ["explicit-euler", "symplectic-euler", "midpoint", "rk4", "backward-euler", "implicit-midpoint", "bdf2"];

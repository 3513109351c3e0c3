//! Bisection for the number at which a condition begins to hold.

use super::lab::Miss;

/// Bisects between two ends, down to rounding.
pub fn bisect([mut low, mut high]: [f64; 2], holds: impl Fn(f64) -> bool) -> f64 {
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if holds(middle) { high = middle } else { low = middle }
    }
    0.5 * (low + high)
}

/// Bisects a condition that must be measured, until the interval is at most `within` wide. It is an error if the
/// condition does not begin to hold between the two ends.
pub fn threshold(
    [mut low, mut high]: [f64; 2],
    within: f64,
    holds: impl Fn(f64) -> Result<bool, Miss>,
) -> Result<f64, Miss> {
    if holds(low)? || !holds(high)? {
        return Err(Miss::Why(format!("the limit is not between {low} and {high}")));
    }
    while high - low > within {
        let middle = 0.5 * (low + high);
        if holds(middle)? { high = middle } else { low = middle }
    }
    Ok(0.5 * (low + high))
}

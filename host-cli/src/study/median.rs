//! Medians, for times that are measured several times.

/// Sorts numbers in ascending order.
pub fn sorted(mut numbers: Vec<f64>) -> Vec<f64> {
    numbers.sort_by(f64::total_cmp);
    numbers
}

/// Median of at least one number.
pub fn median(numbers: Vec<f64>) -> f64 {
    let numbers = sorted(numbers);
    0.5 * (numbers[(numbers.len() - 1) / 2] + numbers[numbers.len() / 2])
}

//! What counts of times that were taken several times.

/// Numbers from the least.
pub fn sorted(mut numbers: Vec<f64>) -> Vec<f64> {
    numbers.sort_by(f64::total_cmp);
    numbers
}

/// Of numbers, at least one.
pub fn median(numbers: Vec<f64>) -> f64 {
    let numbers = sorted(numbers);
    0.5 * (numbers[(numbers.len() - 1) / 2] + numbers[numbers.len() / 2])
}

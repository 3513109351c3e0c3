//! The worst of many comparisons, and where it occurred: the first thing that a failed test prints.

use glam::DVec3;

/// Collects relative errors; [`check`](Worst::check) fails if the worst is above the bound.
#[derive(Debug)]
pub struct Worst {
    what: String,
    bound: f64,
    error: f64,
    detail: String,
    count: u64,
}

impl Worst {
    /// An empty collection. `what` names the tested claim, `bound` the largest permitted error.
    pub fn new(what: impl Into<String>, bound: f64) -> Self {
        Self { what: what.into(), bound, error: 0.0, detail: String::new(), count: 0 }
    }

    /// Adds an error; NaN counts as infinite.
    pub fn see(&mut self, error: f64, detail: impl FnOnce() -> String) {
        let error = if error.is_nan() { f64::INFINITY } else { error };
        self.count += 1;
        if error > self.error {
            self.error = error;
            self.detail = detail();
        }
    }

    /// Compares component by component, relative to `scale`. `place` names the element.
    pub fn compare(&mut self, scale: f64, got: &[f64], want: &[f64], place: impl Fn() -> String) {
        assert_eq!(got.len(), want.len(), "{}: {}", self.what, place());
        for (i, (&got, &want)) in got.iter().zip(want).enumerate() {
            // Equal values agree, whatever the scale, also zero and zero.
            let error = if got == want { 0.0 } else { (got - want).abs() / scale };
            self.see(error, || format!("{}, component {i}: {got:e}, expected {want:e}, scale {scale:e}", place()));
        }
    }

    /// [`compare`](Self::compare) of vectors; component 4 is y of vector 1.
    pub fn vectors(&mut self, scale: f64, got: &[DVec3], want: &[DVec3], place: impl Fn() -> String) {
        self.compare(scale, &scalars(got), &scalars(want), place);
    }

    /// Prints the worst error (shown with `--nocapture`) and fails if it is above the bound.
    pub fn check(self) {
        let Self { what, bound, error, detail, count } = self;
        assert!(count > 0, "{what}: nothing was compared");
        println!("{what}: worst {error:.2e} of {count}, bound {bound:.0e}");
        assert!(error <= bound, "{what}: worst error {error:.3e} is above {bound:e}\n  {detail}");
    }
}

/// The components of all vectors, concatenated.
pub fn scalars(v: &[DVec3]) -> Vec<f64> {
    v.iter().flat_map(|v| v.to_array()).collect()
}

/// The Euclidean norm over all vectors.
pub fn norm(v: &[DVec3]) -> f64 {
    v.iter().map(|v| v.length_squared()).sum::<f64>().sqrt()
}

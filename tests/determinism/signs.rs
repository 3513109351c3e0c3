//! The state hash depends on every bit, also on two signs that are flipped together.

use glam::DVec3;
use muslin_core_f64::diagnostics::StateHash;

#[test]
fn two_flipped_signs_change_the_hash() {
    let column: Vec<_> = (0..8).map(|i| DVec3::new(1.0, 2.0, 3.0) * f64::from(i + 1)).collect();
    let hash = |flipped: [usize; 2]| {
        let mut x = column.clone();
        for scalar in flipped {
            x[scalar / 3][scalar % 3] *= -1.0;
        }
        let mut hash = StateHash::default();
        hash.add(&x, &column);
        hash
    };
    let mut hashes: Vec<_> = (0..24).flat_map(|a| (0..a).map(move |b| [a, b])).map(|pair| hash(pair).0).collect();
    let count = hashes.len();
    hashes.sort_unstable();
    hashes.dedup();
    assert_eq!(hashes.len(), count, "different states have the same hash");
}

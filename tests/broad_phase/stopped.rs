//! A search ends where the host stops it, without candidates.

use harness::case::{Case, random};
use harness::rng::Rng;

harness::both_precisions! {
    use super::{Case, Rng, random};
    use std::sync::atomic::{AtomicU32, Ordering};

    use muslin::broad_phase::{self, Candidates, GridColumns};
    use muslin::geometry::aabb::Aabb;
    use muslin::mesh::SurfaceColumns;
    use muslin::dispatch::{Dispatch, Serial, Split};

    /// Stops when it is asked for the so manieth time.
    struct Impatient { at: u32, asked: AtomicU32 }

    impl Dispatch for Impatient {
        fn run<S: Split, K: Fn(usize, S) + Sync>(&self, out: S, kernel: K) {
            Serial.run(out, kernel);
        }
        fn stopped(&self) -> bool {
            self.asked.fetch_add(1, Ordering::Relaxed) + 1 == self.at
        }
    }

    #[test]
    fn a_search_ends_where_the_host_stops_it() {
        let case = Case::soup("1,000 triangles", &random(&mut Rng::new(1), 1000, 3.0, |rng| rng.between(0.3, 1.0)), 0.0);
        let narrow = |corners| {
            let [min, max] = kit::narrow(corners);
            Aabb { min, max }
        };
        let boxes: Vec<_> = case.boxes.iter().map(narrow).collect();
        let surface = SurfaceColumns::build(boxes.len(), &case.triangles, &[]);
        for at in [1, 2, 5] {
            let host = Impatient { at, asked: AtomicU32::new(0) };
            let mut work = GridColumns::build(boxes.len(), surface.triangles.len());
            let out = &mut Candidates::default();
            let found = broad_phase::candidates(&boxes, &surface.view(), &mut work.view(), None, out, &host);
            assert_eq!((found, host.asked.into_inner()), (None, at));
        }
    }
}

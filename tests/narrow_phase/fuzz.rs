//! Exact contacts, scaled by any factor from 1e-3 to 1e3 and thereby rounded: all are found, none late.

use std::thread;

use crate::lattice;
use harness::query::PAIRS;
use harness::rng::Rng;

/// Statistics of many contacts.
#[derive(Clone, Copy, Debug, Default)]
struct Took {
    contacts: u64,
    at_start: u64,
    distances: u64,
    capped: u64,
    missed: u64,
    late: u64,
}

impl Took {
    fn plus(self, other: Self) -> Self {
        Self {
            contacts: self.contacts + other.contacts,
            at_start: self.at_start + other.at_start,
            distances: self.distances + other.distances,
            capped: self.capped + other.capped,
            missed: self.missed + other.missed,
            late: self.late + other.late,
        }
    }
}

/// Number of contacts for each precision in CI.
const COUNT: u64 = 20_000;

/// Number of contacts for each precision in the long form.
const LONG: u64 = 10_000_000;

fn report(name: &str, took: Took) {
    println!(
        "{name}: {took:?}, {:.2} distances each where the start is apart",
        (took.distances - took.at_start) as f64 / (took.contacts - took.at_start) as f64
    );
    assert_eq!((took.missed, took.late), (0, 0), "missed and late contacts are printed above");
}

/// Distributes the contacts over the threads of this machine; each thread has its own seed.
fn in_threads(count: u64, part: impl Fn(u64, u64) -> Took + Sync) -> Took {
    let threads = thread::available_parallelism().map_or(1, |n| n.get() as u64);
    thread::scope(|scope| {
        let part = &part;
        let started: Vec<_> = (0..threads).map(|i| scope.spawn(move || part(1000 + i, count / threads))).collect();
        started.into_iter().map(|thread| thread.join().expect("no panic")).fold(Took::default(), Took::plus)
    })
}

harness::both_precisions! {
    use super::{COUNT, LONG, PAIRS, Rng, Took, in_threads, lattice, report};
    use muslin::narrow_phase::advance::MOST_ADVANCES;

    fn fuzz(seed: u64, count: u64) -> Took {
        fuzz_scaled(seed, count, 1e-3)
    }

    /// Relative to the first vertex, rounding moves a contact by at most a tenth of the reserve.
    fn fuzz_scaled(seed: u64, count: u64, least: f64) -> Took {
        let (rng, mut took) = (&mut Rng::new(seed), Took::default());
        for i in 0..count {
            let lattice::Contact { query, time: contact } = lattice::contact(rng, PAIRS[i as usize % 2]);
            let scale = rng.magnitude(least, 1e3);
            let query = kit::rounded(&query.local().map(|x| x * scale));
            let time = kit::time_of_impact(&query, 0.0, 1e-6 * scale);
            let distances = u64::from(kit::distances(&query, 0.0, 1e-6 * scale));
            let late = time.is_some_and(|time| time > contact);
            if late || time.is_none() {
                eprintln!("time {time:?} instead of {contact}: {query}");
            }
            took = took.plus(Took {
                contacts: 1,
                at_start: u64::from(distances == 1),
                distances,
                capped: u64::from(distances == u64::from(MOST_ADVANCES)),
                missed: u64::from(time.is_none()),
                late: u64::from(late),
            });
        }
        took
    }

    #[test]
    fn contacts_at_every_scale() {
        report("fuzz", fuzz(401, COUNT));
    }

    /// Scales down to where squares of areas underflow and squares of distances do not.
    #[test]
    fn contacts_however_small() {
        report("small", fuzz_scaled(402, COUNT, kit::bound(1e-13, 1e-140)));
    }

    #[test]
    #[ignore = "a command of its own"]
    fn long_form_contacts_at_every_scale() {
        report("long fuzz", in_threads(LONG, fuzz));
    }
}

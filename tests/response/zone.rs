//! Impact zones: columns of light plates and points, pressed together by so much that rounds of
//! single impacts cannot part them. The end is held against the projection that a zone stands for,
//!
//! `min |d' - d|^2_M / 2  so that  G d' >= g`
//!
//! of all contacts that were found, iterated in double until it stands [Harmon 2008].
//!
//! Run: `cargo test -p muslin-tests --test response zone`; with `-- --nocapture` it prints
//! every measured value beside its bound.

use glam::DVec3;
use harness::both_precisions;
use harness::pieces::{Kept, Piece, Response};
use harness::rng::Rng;
use harness::worst::{Worst, norm};

/// m.
const THICKNESS: f64 = 1e-3;
/// From layer to layer at the start, m.
const SPACING: f64 = 4.0 * THICKNESS;
/// Surfaces nearer than this meet, m.
const SEPARATION: f64 = 0.1 * THICKNESS;
/// kg of each light vertex.
const LIGHT: f64 = 1e-3;

/// What presses a column.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Press {
    /// A wall from above against a wall below.
    Walls,
    /// A heavy plate from above against a wall below.
    Falling,
    /// Two heavy plates from both sides.
    Heavy,
}

/// And how many points are in the column: rounds of single impacts part the lowest.
const COLUMNS: [(Press, usize); 7] = [
    (Press::Walls, 5),
    (Press::Walls, 8),
    (Press::Falling, 5),
    (Press::Falling, 8),
    (Press::Heavy, 3),
    (Press::Heavy, 5),
    (Press::Heavy, 8),
];

impl Press {
    /// kg of each vertex of the plates above and below.
    fn masses(self) -> [f64; 2] {
        let heavy = 5.0 * LIGHT;
        match self {
            Self::Walls => [f64::INFINITY; 2],
            Self::Falling => [heavy, f64::INFINITY],
            Self::Heavy => [heavy; 2],
        }
    }

    /// How far the plates above and below come, for a column of so many gaps, m.
    fn moves(self, gaps: usize) -> [DVec3; 2] {
        // Walls leave each gap little more than the thickness.
        let room = gaps as f64 * (SPACING - 1.1 * THICKNESS);
        match self {
            Self::Walls => [-DVec3::Y * room, DVec3::ZERO],
            Self::Falling => [-DVec3::Y * 1.5 * room, DVec3::ZERO],
            Self::Heavy => [-DVec3::Y * 0.8 * room, DVec3::Y * 0.8 * room],
        }
    }
}

/// Plates and points between them, in turn, each thrown aside at random by as much as is said, m.
/// Plates grow upwards so that no edges cross.
fn column(press: Press, height: usize, radius: f64, aside: f64, rng: &mut Rng) -> Vec<Piece> {
    let layers = 2 * height + 1;
    let ([top, bottom], [down, up]) = (press.masses(), press.moves(layers - 1));
    let level = DVec3::new(1.0, 0.0, 1.0);
    let layer = |k: usize| {
        let (mass, moves) = match k {
            0 => (bottom, up),
            k if k + 1 == layers => (top, down),
            _ => (LIGHT, DVec3::ZERO),
        };
        let middle = DVec3::Y * SPACING * k as f64;
        let corner = |c: usize| {
            let (sine, cosine) = (std::f64::consts::TAU / 3.0 * c as f64).sin_cos();
            middle + DVec3::new(cosine, 0.0, sine) * radius * (1.0 + 0.1 * k as f64)
        };
        let start = if k.is_multiple_of(2) { (0..3).map(corner).collect() } else { vec![middle] };
        let moves = moves + rng.cube(aside) * level;
        Piece { moves: vec![moves; start.len()], masses: vec![mass; start.len()], start }
    };
    (0..layers).map(layer).collect()
}

/// Displacements of the projection by Hildreth's method: contact after contact in double, until
/// nothing changes.
fn project(response: &Response) -> Vec<DVec3> {
    let (kept, mut moves) = (&response.kept, response.before());
    let gives = |contact: &Kept| -> f64 {
        contact.vertices.iter().zip(contact.weights).map(|(&v, w)| w * w / response.masses[v]).sum()
    };
    let mut impulses = vec![0.0; kept.len()];
    for sweep in 0.. {
        let mut change: f64 = 0.0;
        for (contact, impulse) in kept.iter().zip(&mut impulses) {
            let gives = gives(contact);
            let next = (*impulse + contact.missing(&moves) / gives).max(0.0);
            change = change.max((next - *impulse) * gives).max((*impulse - next) * gives);
            for (&v, weight) in contact.vertices.iter().zip(contact.weights) {
                moves[v] += contact.normal * ((next - *impulse) * weight / response.masses[v]);
            }
            *impulse = next;
        }
        if change <= 1e-4 * THICKNESS {
            break;
        }
        assert!(sweep < 200_000, "the projection does not converge: changes by {change:e} m");
    }
    moves
}

/// A column weighed by the roots of the masses; what is held weighs nothing.
fn weighed(response: &Response, column: &[DVec3]) -> Vec<DVec3> {
    let root = |mass: f64| if mass.is_finite() { mass.sqrt() } else { 0.0 };
    column.iter().zip(&response.masses).map(|(&d, &mass)| d * root(mass)).collect()
}

fn less(a: &[DVec3], b: &[DVec3]) -> Vec<DVec3> {
    a.iter().zip(b).map(|(a, b)| *a - *b).collect()
}

both_precisions! {
    use super::*;

    /// Every column and what the response makes of it, where it needs a zone.
    pub fn columns(radius: f64, aside: f64) -> impl Iterator<Item = (String, Vec<Piece>, Response)> {
        COLUMNS.into_iter().enumerate().map(move |(seed, (press, height))| {
            let what = format!("{} {press:?}, {height} points", muslin::real::NAME);
            let pieces = column(press, height, radius, aside, &mut Rng::new(seed as u64));
            let response = kit::respond(&pieces, THICKNESS, 0.0);
            let [proximity, _, zones] = response.counts;
            assert_eq!(response.outcome, "Free", "{what}: not resolved, counts {:?}", response.counts);
            assert_eq!(proximity, 0, "{what}: {proximity} contacts near at the start");
            assert!(zones > 0, "{what}: no zone was needed, counts {:?}", response.counts);
            (what, pieces, response)
        })
    }

    /// What a zone leaves of a contact may still be as near as what meets.
    #[test]
    fn a_zone_parts_a_column() {
        for (what, pieces, response) in columns(0.05, 1e-3) {
            let closest = response.closest(&pieces, 200);
            let moves = response.moves();
            let missing = response.kept.iter().map(|contact| contact.missing(&moves)).fold(0.0, f64::max);
            println!("{what}: {closest:.2e} m apart, bound {SEPARATION:.0e}; {:.2} thicknesses missing, bound 0.9", missing / THICKNESS);
            assert!(closest >= 0.99 * SEPARATION, "{what}: {closest:e} m apart, at least {SEPARATION:e} asked");
            assert!(missing <= 0.9 * THICKNESS, "{what}: a contact misses {missing:e} m of {THICKNESS:e}");
        }
    }

    /// Each contact pushes along its normal by the impulse that it remembers, and nothing else moves
    /// anything.
    #[test]
    fn displacements_in_a_zone_are_those_of_its_impulses() {
        let mut worst = Worst::new(format!("{}: displacements, of the push", muslin::real::NAME), kit::bound(1e-4, 1e-12));
        for (what, _, response) in columns(0.05, 1e-3) {
            let mut want = response.before();
            for contact in &response.kept {
                assert!(contact.impulse >= 0.0, "{what}: a contact pulls by {} kg m", contact.impulse);
                for (&v, weight) in contact.vertices.iter().zip(contact.weights) {
                    want[v] += contact.normal * (contact.impulse * weight / response.masses[v]);
                }
            }
            let pushed = less(&want, &response.before()).iter().map(|d| d.length()).fold(0.0, f64::max);
            worst.vectors(pushed, &response.moves(), &want, || what.clone());
        }
        worst.check();
    }

    #[test]
    fn a_zone_keeps_momentum_and_adds_no_energy() {
        let mut worst = Worst::new(format!("{}: momentum", muslin::real::NAME), kit::bound(1e-5, 1e-12));
        let free = |response: &Response| response.masses.iter().all(|mass| mass.is_finite());
        for (what, _, response) in columns(0.05, 1e-3).filter(|(_, _, response)| free(response)) {
            let [before, after] = response.energy();
            println!("{what}: {:.3} of the energy is left", after / before);
            assert!(after < before, "{what}: {after} J of {before} J after an inelastic impact");
            worst.see(response.drift(), || what.clone());
        }
        worst.check();
    }

    /// Plates so large that what slides on them stays in their middles and does not tip them. A rigid
    /// zone would make all of a column slide alike.
    #[test]
    fn what_slides_in_a_zone_slides_on() {
        const ASIDE: f64 = 1e-3;
        let mut worst = Worst::new(format!("{}: sliding lost or gained", muslin::real::NAME), 0.2);
        for (what, _, response) in columns(0.2, ASIDE) {
            for (v, change) in less(&response.moves(), &response.before()).into_iter().enumerate() {
                let across = DVec3::new(change.x, 0.0, change.z).length();
                worst.see(across / ASIDE, || format!("{what}: vertex {v} changes its slide by {across:e} m"));
            }
        }
        worst.check();
    }
}

/// Relative to what the projection changes, in the norm of the masses. The sweeps over a zone end
/// before it is reached; this says how far from it.
#[test]
fn a_zone_is_near_the_inelastic_projection() {
    let mut worst = Worst::new("beside the projection", 0.2);
    for (what, _, response) in double::columns(1.0, 1e-3) {
        let (before, want) = (response.before(), project(&response));
        let apart = norm(&weighed(&response, &less(&response.moves(), &want)));
        let changed = norm(&weighed(&response, &less(&want, &before)));
        println!("{what}: {:.4} of the change beside the projection", apart / changed);
        worst.see(apart / changed, || what.clone());
    }
    worst.check();
}

//! Start states in which cloth passes through cloth or colliders, made free of crossings: continuous
//! detection keeps apart what is apart, and so keeps tangled what is tangled.
//!
//! In rounds, until the exact [`audit`] finds no crossing:
//!
//! 1. [`solids`]: what lies within spheres, capsules, boxes and below planes is moved out of them.
//! 2. The crossings are joined to [`contour`]s. Where these cut a [`flap`] off a sheet, it goes
//!    back through what cut it off [after Baraff 2003].
//! 3. Where they cut nothing off, or that does not help, edges and triangles [`slide`] so that the
//!    contour gets shorter until it vanishes [Volino 2006].
//!
//! Every vertex moves by the mean of what is asked of it; a held axis does not move. The state with
//! the fewest crossings counts. Of 200 sheets folded through themselves (`tests/untangle`) 200 come
//! free in f64 and 197 in f32: by flaps alone 183, by slides alone 126, and 51 where every crossing
//! slides for itself.

pub mod contour;
pub mod flap;
pub mod slide;
pub mod solids;
pub mod topology;

use alloc::vec;
use alloc::vec::Vec;

use crate::audit;
use crate::contact::ContactModel;
use crate::dispatch::Dispatch;
use crate::real::{Real, Vec3, sqrt};
use contour::Crossing;
use topology::Topology;

/// Most rounds.
const MOST_ROUNDS: u32 = 200;
/// Rounds without progress after which it is given up.
const PATIENCE: u32 = 64;
/// Rounds without progress after which another way is tried.
const TRIES: u32 = 8;

/// Length of an edge over what it was, or is in its mesh, beyond which a state does not count: cloth
/// that is held is not drawn out around what it passes through.
const MOST_STRETCH: Real = 2.0;

/// What untangling came to.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Untangled {
    /// Crossings at first, of what can touch.
    pub before: usize,
    /// Crossings left.
    pub after: usize,
    /// Vertices inside colliders, before and after.
    pub inside: [usize; 2],
    /// Rounds taken.
    pub rounds: u32,
    /// The farthest that a vertex was moved, m.
    pub moved: Real,
}

/// What all parts need to know.
#[derive(Clone, Copy, Debug)]
pub struct Scene<'a> {
    /// What can touch.
    pub model: &'a ContactModel<'a>,
    /// How far apart surfaces are put, m.
    pub gap: Real,
}

/// What is asked of each vertex in a round: a weighted sum of displacements, m, and of weights.
#[derive(Clone, Debug)]
pub struct Moves {
    sums: Vec<Vec3>,
    weights: Vec<Real>,
}

impl Moves {
    fn new(vertices: usize) -> Self {
        Self { sums: vec![Vec3::ZERO; vertices], weights: vec![0.0; vertices] }
    }

    /// Asks a vertex to move.
    pub fn add(&mut self, vertex: u32, by: Vec3, weight: Real) {
        self.sums[vertex as usize] += by * weight;
        self.weights[vertex as usize] += weight;
    }

    fn is_empty(&self) -> bool {
        self.weights.iter().all(|&weight| weight == 0.0)
    }

    /// Moves all that may.
    fn apply(&self, mobility: &[Vec3], places: &mut [Vec3]) {
        for (v, x) in places.iter_mut().enumerate() {
            if self.weights[v] > 0.0 {
                let by = self.sums[v] / self.weights[v];
                *x += Vec3::select(mobility[v].cmpgt(Vec3::ZERO), by, Vec3::ZERO);
            }
        }
    }
}

/// Parts what passes through one another; `places` has the vertices of the cloth and then of the
/// colliders, m, of which only those move that can.
pub fn untangle(model: &ContactModel<'_>, places: &mut [Vec3], dispatch: &impl Dispatch) -> Untangled {
    if !places.iter().all(|x| x.is_finite()) {
        return Untangled::default();
    }
    let mut crossings = find(model, places, dispatch);
    let inside = solids::inside(model, places);
    let before = [crossings.len(), inside];
    let mut result = Untangled { before: before[0], after: before[0], inside: [inside; 2], ..Untangled::default() };
    if before == [0; 2] {
        return result;
    }
    let scene = Scene { model, gap: 0.5 * model.thickness };
    let topology = Topology::build(&model.surface, places.len());
    let start = places.to_vec();
    let (mut best, mut best_places, mut waited) = (before, start.clone(), 0);
    for round in 1..=MOST_ROUNDS {
        let mut moves = Moves::new(places.len());
        let attempt = waited / TRIES;
        if attempt.is_multiple_of(2) {
            solids::leave(&scene, &topology, places, &mut moves);
        }
        if moves.is_empty() {
            part(&scene, &topology, &crossings, places, &mut moves, attempt);
        }
        moves.apply(model.mobility, places);
        crossings = find(model, places, dispatch);
        let now = [crossings.len(), solids::inside(model, places)];
        if now < best && !is_torn(model, &start, places) {
            (best, waited) = (now, 0);
            best_places.copy_from_slice(places);
            result.rounds = round;
        } else {
            waited += 1;
            if waited % TRIES == 0 {
                places.copy_from_slice(&best_places);
                crossings = find(model, places, dispatch);
            }
        }
        if best == [0; 2] || waited > PATIENCE {
            break;
        }
    }
    places.copy_from_slice(&best_places);
    result.after = best[0];
    result.inside[1] = best[1];
    let moved = places.iter().zip(&start).map(|(now, before)| (*now - *before).length_squared());
    result.moved = sqrt(moved.fold(0.0, Real::max));
    result
}

/// Whether an edge of the cloth is far longer than before and in its mesh.
fn is_torn(model: &ContactModel<'_>, start: &[Vec3], places: &[Vec3]) -> bool {
    let cloth = model.surface.edges.iter().map(|edge| edge.map(|v| v as usize));
    let squared = |column: &[Vec3], [a, b]: [usize; 2]| (column[b] - column[a]).length_squared();
    cloth.filter(|&[a, _]| a < model.cloth()).any(|edge| {
        let before = squared(start, edge).max(squared(model.material, edge));
        squared(places, edge) > MOST_STRETCH * MOST_STRETCH * before
    })
}

/// Crossings of what can touch.
fn find(model: &ContactModel<'_>, places: &[Vec3], dispatch: &impl Dispatch) -> Vec<Crossing> {
    let surface = &model.surface;
    let crossing = |features: [u32; 2]| {
        let [edge, triangle] = features;
        Crossing::new(features, surface.edges[edge as usize], surface.triangles[triangle as usize], places)
    };
    audit::crossings(surface, places, dispatch).into_iter().map(crossing).collect()
}

/// Asks for what parts the contours. Each `attempt` goes about it in another way, in turn: flaps as
/// they are best moved, slides, flaps moved the other way, the second best flaps.
fn part(
    scene: &Scene<'_>,
    topology: &Topology,
    crossings: &[Crossing],
    places: &[Vec3],
    moves: &mut Moves,
    attempt: u32,
) {
    let [slides, otherwise, second] = [1, 2, 3].map(|way| attempt % 4 == way);
    let mut cut: Vec<u32> = crossings.iter().map(|crossing| crossing.features[0]).collect();
    cut.dedup();
    for contour in contour::trace(topology, crossings) {
        let mut flaps = Vec::new();
        for strand in contour.chunk_by(|a, b| a.0 == b.0).filter(|_| !slides) {
            let strand: Vec<&Crossing> = strand.iter().map(|&(_, k)| &crossings[k as usize]).collect();
            flap::beside(scene, topology, &strand, &cut, places, &mut flaps);
        }
        flaps.sort_by(|a, b| a.held.cmp(&b.held).then(a.length.total_cmp(&b.length)));
        match flaps.get(usize::from(second)).or(flaps.first()) {
            Some(flap) => flap.back(scene, topology, flap.is_shallow() == otherwise, places, moves),
            None => slide::slide(scene, topology, crossings, &contour, places, moves),
        }
    }
}

//! Removes crossings from start states in which cloth passes through itself or through colliders. Continuous
//! collision detection cannot do this: it keeps separate parts separate, and tangled parts tangled.
//!
//! The method works in rounds until the exact [`audit`] finds no crossing:
//!
//! 1. [`solids`]: cloth inside spheres, capsules and boxes and below planes is moved out of them.
//! 2. The crossings are joined to [`contour`]s. If a contour cuts a [`flap`] off a sheet, the flap moves back
//!    through the surface that cuts it off [after Baraff 2003].
//! 3. If a contour cuts no flap off, or if moving the flap does not help, edges and triangles [`slide`] so that the
//!    contour becomes shorter until it vanishes [Volino 2006].
//!
//! Every vertex moves by the weighted mean of its requested displacements; a pinned axis does not move. The result is
//! the state with the fewest crossings. Of 200 sheets folded through themselves (`tests/untangle`), 200 are freed
//! of all crossings in f64 and 197 in f32. Flaps alone free 183, slides alone 126, and slides in which every
//! crossing follows its own gradient 51.

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
use crate::inverse_masses::InverseMasses;
use crate::real::{Real, Vec3, sqrt};
use contour::Crossing;
use topology::Topology;

/// The greatest number of rounds.
const MOST_ROUNDS: u32 = 200;
/// Number of rounds without progress after which the method stops.
const PATIENCE: u32 = 64;
/// Number of rounds without progress after which the next way is tried.
const TRIES: u32 = 8;

/// A state is rejected if an edge is longer than this multiple of both its initial and its material length, so that
/// cloth with pinned vertices is not stretched around the surface that it passes through.
const MOST_STRETCH: Real = 2.0;

/// The result of untangling.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Untangled {
    /// Number of crossings at the start, among the features that can touch.
    pub before: usize,
    /// Number of crossings that are left.
    pub after: usize,
    /// Number of movable cloth vertices inside colliders, before and after.
    pub inside: [usize; 2],
    /// The round that reached the returned state; 0 if no round improved the start.
    pub rounds: u32,
    /// The greatest distance that a vertex was moved, m.
    pub moved: Real,
}

/// The data that all parts of the method share.
#[derive(Clone, Copy, Debug)]
pub struct Scene<'a> {
    /// The surface that can touch, the colliders, the thickness and the mobilities.
    pub model: &'a ContactModel<'a>,
    /// Distance at which surfaces are placed apart, m.
    pub gap: Real,
}

/// The displacements requested of each vertex in a round: the weighted sum of displacements, m, and the sum of
/// weights.
#[derive(Clone, Debug)]
pub struct Displacements {
    sums: Vec<Vec3>,
    weights: Vec<Real>,
}

impl Displacements {
    fn new(vertices: usize) -> Self {
        Self { sums: vec![Vec3::ZERO; vertices], weights: vec![0.0; vertices] }
    }

    /// Requests a displacement of a vertex.
    pub fn add(&mut self, vertex: u32, by: Vec3, weight: Real) {
        self.sums[vertex as usize] += by * weight;
        self.weights[vertex as usize] += weight;
    }

    fn is_empty(&self) -> bool {
        self.weights.iter().all(|&weight| weight == 0.0)
    }

    /// Moves all vertices along their free axes.
    fn apply(&self, inverse_masses: &InverseMasses<'_>, places: &mut [Vec3]) {
        for (v, x) in places.iter_mut().enumerate() {
            if self.weights[v] > 0.0 {
                let by = self.sums[v] / self.weights[v];
                *x += Vec3::select(inverse_masses.at(v).cmpgt(Vec3::ZERO), by, Vec3::ZERO);
            }
        }
    }
}

/// Separates surfaces that pass through one another. `places` has the vertices of the cloth and then of the colliders,
/// m; only vertices with an inverse mass are moved. Positions that are not finite are left unchanged. If the dispatch
/// [stops](Dispatch::stopped), nothing is moved and all counts are 0.
pub fn untangle(model: &ContactModel<'_>, places: &mut [Vec3], dispatch: &impl Dispatch) -> Untangled {
    if !places.iter().all(|x| x.is_finite()) {
        return Untangled::default();
    }
    let mut crossings = find(model, places, dispatch);
    if dispatch.stopped() {
        return Untangled::default();
    }
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
        let mut displacements = Displacements::new(places.len());
        let attempt = waited / TRIES;
        if attempt.is_multiple_of(2) {
            solids::leave(&scene, &topology, places, &mut displacements);
        }
        if displacements.is_empty() {
            separate(&scene, &topology, &crossings, places, &mut displacements, attempt, dispatch);
        }
        displacements.apply(&model.inverse_masses, places);
        crossings = find(model, places, dispatch);
        if dispatch.stopped() {
            places.copy_from_slice(&start);
            return Untangled::default();
        }
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

/// Whether an edge of the cloth is far longer than it was at the start and far longer than it is in the material.
fn is_torn(model: &ContactModel<'_>, start: &[Vec3], places: &[Vec3]) -> bool {
    let cloth = model.surface.edges.iter().map(|edge| edge.map(|v| v as usize));
    let squared = |column: &[Vec3], [a, b]: [usize; 2]| (column[b] - column[a]).length_squared();
    cloth.filter(|&[a, _]| a < model.cloth()).any(|edge| {
        let before = squared(start, edge).max(squared(model.material, edge));
        squared(places, edge) > MOST_STRETCH * MOST_STRETCH * before
    })
}

/// The crossings among the features that can touch.
fn find(model: &ContactModel<'_>, places: &[Vec3], dispatch: &impl Dispatch) -> Vec<Crossing> {
    let surface = &model.surface;
    let crossing = |features: [u32; 2]| {
        let [edge, triangle] = features;
        Crossing::new(features, surface.edges[edge as usize], surface.triangles[triangle as usize], places)
    };
    audit::crossings(surface, places, dispatch).into_iter().map(crossing).collect()
}

/// Requests the displacements that separate the contours. Successive values of `attempt` try four ways in turn: the
/// best flaps, slides, the best flaps moved the other way (as a whole or by depth), and the second best flaps. Requests
/// fewer if the dispatch stops.
fn separate(
    scene: &Scene<'_>,
    topology: &Topology,
    crossings: &[Crossing],
    places: &[Vec3],
    displacements: &mut Displacements,
    attempt: u32,
    dispatch: &impl Dispatch,
) {
    let [slides, otherwise, second] = [1, 2, 3].map(|way| attempt % 4 == way);
    let mut cut: Vec<u32> = crossings.iter().map(|crossing| crossing.features[0]).collect();
    cut.dedup();
    for contour in contour::trace(topology, crossings) {
        if dispatch.stopped() {
            return;
        }
        let mut flaps = Vec::new();
        for strand in contour.chunk_by(|a, b| a.0 == b.0).filter(|_| !slides) {
            let strand: Vec<&Crossing> = strand.iter().map(|&(_, k)| &crossings[k as usize]).collect();
            flap::beside(scene, topology, &strand, &cut, places, &mut flaps);
        }
        flaps.sort_by(|a, b| a.held.cmp(&b.held).then(a.length.total_cmp(&b.length)));
        match flaps.get(usize::from(second)).or(flaps.first()) {
            Some(flap) => flap.back(scene, topology, flap.is_shallow() == otherwise, places, displacements),
            None => slide::slide(scene, topology, crossings, &contour, places, displacements),
        }
    }
}

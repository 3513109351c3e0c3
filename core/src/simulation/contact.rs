//! The phases of a step between prediction and commit, over owned columns that grow where a step
//! needs more room, and the untangling of a start.

use super::{Cause, Simulation, Substep};
use crate::audit;
use crate::broad_phase::Counts;
use crate::contact::{ContactModel, ContactScratch, ContactScratchColumns};
use crate::dispatch::{Dispatch, Here, block_on};
use crate::real::{Real, Vec3, sqrt};
use crate::response::impact::SEPARATION;
use crate::response::{Outcome, Settings, Tally};
use crate::stage::Stage;
use crate::step;
use crate::untangle::{self, Untangled};

/// How often the boxes around the motion are widened before the step is halved.
const MOST_WIDENINGS: u32 = 6;

/// How often, where it cannot be halved any more.
const LAST_WIDENINGS: u32 = 20;

/// Candidates of each kind that are looked at in any scene.
const MOST_PAIRS: usize = 1 << 17;

/// And so many for each vertex: sheets lying flat on themselves have a tenth of it.
const MOST_PAIRS_PER_VERTEX: usize = 1 << 10;

/// Room for the search of a quiet step, relative to that.
const QUIET_ROOM: usize = 4;

/// How often as many candidates may be looked at in one step, over all its halves and widenings: what
/// still boils then does not settle.
const MOST_LOOKS: u64 = 1 << 7;

/// How often what is near is parted after untangling.
const PARTINGS: u32 = 10;

/// How much farther apart than the thickness a pair at rest may be that is solved with the step, relative to the
/// thickness: the response keeps the thickness only within a tolerance.
const REST: Real = 0.2;

/// Why a part of a step cannot be taken, and where.
pub(super) struct Obstacle {
    pub cause: Cause,
    pub particle: u32,
}

impl Simulation {
    /// The phases between prediction and commit.
    pub(super) async fn resolve<D: Dispatch>(
        &mut self,
        part: Substep,
        hold: bool,
        dispatch: &D,
    ) -> Result<(), Obstacle> {
        let most = if hold { LAST_WIDENINGS } else { MOST_WIDENINGS };
        let mut widened = 0;
        loop {
            dispatch.enter(Stage::BroadPhase);
            self.sweep(part, widened);
            if !self.detect(dispatch).await {
                return Err(Obstacle { cause: Cause::TooMuch, particle: self.farthest() });
            }
            if dispatch.stopped() {
                return Err(Obstacle { cause: Cause::Stopped, particle: 0 });
            }
            if widened == 0 {
                self.couple(part, dispatch);
            }
            match self.respond(part, hold, dispatch) {
                Outcome::Free => return Ok(()),
                Outcome::Touches => return self.test_exactly(),
                Outcome::Left if widened < most => widened += 1,
                Outcome::Left | Outcome::Short { .. } => {
                    return Err(Obstacle { cause: Cause::TooMuch, particle: self.farthest() });
                }
                Outcome::Meets(vertices) => return Err(self.obstacle(vertices)),
                Outcome::Stopped => return Err(Obstacle { cause: Cause::Stopped, particle: 0 }),
            }
        }
    }

    /// Contact: writes the boxes around the motion, wider where that was too little.
    pub fn sweep(&mut self, part: Substep, widened: u32) {
        let (time, step) = (self.time_at(part.from), self.step * part.length as Real);
        let (Some(model), Some(contact)) = (&self.built.contact, &mut self.contact) else { return };
        let (model, contact) = (&model.view(), &mut contact.view());
        if widened == 0 {
            let (positions, next_positions) = (&self.built.particles.positions, &self.scratch.next_positions);
            step::place(model, [time, step.into()], positions, next_positions, contact);
        }
        sweep(model, widened, contact);
    }

    /// Contact: finds candidates, with more room where there was too little; false where there are too
    /// many to be looked at.
    pub async fn detect<D: Dispatch>(&mut self, dispatch: &D) -> bool {
        let (Some(model), Some(contact)) = (&self.built.contact, &mut self.contact) else { return true };
        let Some(counts) = detect(&model.view(), contact, dispatch).await else { return false };
        let found = (counts.vertex_triangle + counts.edge_edge) as u64;
        self.tally.candidates += found;
        self.looked_at += found;
        self.looked_at <= MOST_LOOKS * most_pairs(&model.view()) as u64
    }

    /// Contact: corrects the candidate state, with more room where there was too little for what
    /// touches.
    pub fn respond(&mut self, part: Substep, hold: bool, dispatch: &impl Dispatch) -> Outcome {
        let step = self.step * part.length as Real;
        let (Some(model), Some(contact)) = (&self.built.contact, &mut self.contact) else { return Outcome::Free };
        dispatch.enter(Stage::Response);
        let outcome = respond(&model.view(), contact, Settings { step, hold }, &mut self.tally, dispatch);
        if matches!(outcome, Outcome::Free | Outcome::Touches) {
            self.touched = step::settle(step, &contact.view(), &mut self.scratch.view());
        }
        outcome
    }

    /// Contact: solves an implicit step together with its contacts, with more room where there was too little for them.
    pub fn couple(&mut self, part: Substep, dispatch: &impl Dispatch) {
        if !self.scheme.method.is_implicit() {
            return;
        }
        dispatch.enter(Stage::Response);
        self.with_input(part, dispatch, |input, particles, scratch, statistics, contact| {
            let Some((model, contact)) = contact else { return };
            // Backward Euler predicts without gravity, which closes a gap by half of this in a step.
            let gravity = input.model.gravity.unwrap_or(Vec3::ZERO);
            let fall = 2.0 * sqrt(gravity.length_squared()) * input.step * input.step;
            let margin = fall + REST * model.thickness;
            while let Err(outcome) = step::find_contacts(model, &mut contact.view(), input.step, margin) {
                let Outcome::Short { needed } = outcome else { return };
                contact.grow_constraints(needed);
            }
            let target = step::couple(input, particles, &mut contact.view(), scratch, statistics);
            let known = loop {
                match step::find_impacts(model, &mut contact.view(), input.step, dispatch) {
                    Ok(known) => break known,
                    Err(Outcome::Short { needed }) => contact.grow_constraints(needed),
                    Err(_) => return,
                }
            };
            step::couple_again(input, (known, target), &mut contact.view(), scratch, statistics);
        });
    }

    /// Whether nothing passes through at the end of the step that did not at its start.
    fn test_exactly(&mut self) -> Result<(), Obstacle> {
        let (Some(model), Some(contact)) = (&self.built.contact, &mut self.contact) else { return Ok(()) };
        let Some([edge, triangle]) = step::new_crossing(&model.view(), &mut contact.view()) else { return Ok(()) };
        let ([a, b], [c, d, _]) = (model.surface.edges[edge as usize], model.surface.triangles[triangle as usize]);
        Err(self.obstacle([a, b, c, d]))
    }

    /// Who of two features that meet is to be named: the first particle of the cloth, or one that is
    /// pinned.
    fn obstacle(&self, vertices: [u32; 4]) -> Obstacle {
        let cloth = self.built.particles.positions.len();
        let contact = self.built.contact.as_ref();
        let (mobility, bodies) = contact.map_or_else(Default::default, |c| (&c.mobility[..], &c.colliders.bodies[..]));
        let mut particles = vertices.into_iter().filter(|&v| (v as usize) < cloth);
        let pinned = particles.clone().find(|&v| mobility[v as usize].min_element() == 0.0);
        let body = |v: usize| bodies.iter().position(|body| body.range().contains(&v)).map(|body| body as u32);
        let collider = vertices.into_iter().find_map(|v| body((v as usize).checked_sub(cloth)?));
        let cause = Cause::Contact { collider, pinned: pinned.is_some() };
        Obstacle { cause, particle: pinned.or_else(|| particles.next()).unwrap_or_default() }
    }

    /// The particle whose candidate is farthest from where it is.
    fn farthest(&self) -> u32 {
        let (x, next) = (&self.built.particles.positions, &self.scratch.next_positions);
        let moved = |v: usize| (next[v] - x[v]).length_squared();
        (0..x.len()).max_by(|&a, &b| moved(a).total_cmp(&moved(b))).unwrap_or_default() as u32
    }

    /// [Parts](untangle::untangle) what passes through one another now, where pins let it, and then
    /// what is too near for the response to tell apart. Only positions change, and none in a scene
    /// without contact or in which nothing passes through anything.
    pub fn untangle(&mut self, dispatch: &impl Dispatch) -> Untangled {
        let mut places = self.places();
        let Some(model) = &self.built.contact else { return Untangled::default() };
        let mut untangled = untangle::untangle(&model.view(), &mut places, dispatch);
        if untangled.rounds == 0 {
            return untangled;
        }
        let positions = &mut self.built.particles.positions;
        places.truncate(positions.len());
        let start = core::mem::replace(positions, places);
        self.forget_the_past();
        for _ in 0..PARTINGS {
            let kept = self.positions().to_vec();
            if !self.part_near(dispatch) {
                break;
            }
            let places = self.places();
            let contact = self.built.contact.as_ref();
            let left = contact.map_or(0, |model| audit::count(&model.surface.view(), &places, dispatch));
            if left > untangled.after {
                self.built.particles.positions = kept;
                break;
            }
            untangled.after = left;
        }
        let moved = self.positions().iter().zip(&start).map(|(now, before)| (*now - *before).length_squared());
        untangled.moved = sqrt(moved.fold(0.0, Real::max));
        untangled
    }

    /// Lets the response separate pairs at rest that are nearer than the distance of an impact. Returns
    /// false if there are no such pairs, or if it cannot.
    fn part_near(&mut self, dispatch: &impl Dispatch) -> bool {
        let (time, step) = (self.time(), self.step);
        let Self { built, contact, .. } = self;
        let (Some(model), Some(contact)) = (&built.contact, contact) else { return false };
        let (model, positions) = (&model.view(), &mut built.particles.positions);
        for widened in 0..MOST_WIDENINGS {
            if widened == 0 {
                step::place(model, [time, 0.0], positions, positions, &mut contact.view());
            }
            sweep(model, widened, &mut contact.view());
            let Some(counts) = block_on(detect(model, contact, &Here(dispatch))) else { return false };
            let view = contact.view();
            let pairs = [(&view.vertex_triangle, counts.vertex_triangle), (&view.edge_edge, counts.edge_edge)];
            let apart = |&distance: &Real| distance >= SEPARATION * model.thickness;
            if pairs.iter().all(|(pairs, count)| pairs.distances[..*count].iter().all(apart)) {
                return false;
            }
            let settings = Settings { step, hold: false };
            match respond(model, contact, settings, &mut Tally::default(), dispatch) {
                // Counted anew once all are apart.
                Outcome::Free | Outcome::Touches => {
                    positions.copy_from_slice(&contact.view().end[..model.cloth()]);
                    return true;
                }
                Outcome::Left => {}
                _ => return false,
            }
        }
        false
    }
}

/// Writes the boxes around the motion, or widens them.
fn sweep(model: &ContactModel<'_>, widened: u32, contact: &mut ContactScratch<'_>) {
    if widened == 0 && step::is_quiet(model, contact) {
        step::surround_start(model, contact);
    } else {
        step::sweep(model, 0.5 * model.thickness * (1 << widened) as Real, contact);
    }
}

/// Candidates of each kind that are looked at.
fn most_pairs(model: &ContactModel<'_>) -> usize {
    MOST_PAIRS.max(MOST_PAIRS_PER_VERTEX * model.radii.len())
}

async fn detect<D: Dispatch>(
    model: &ContactModel<'_>,
    contact: &mut ContactScratchColumns,
    dispatch: &D,
) -> Option<Counts> {
    let counts = step::await_candidates(model, &mut contact.view(), dispatch).await;
    // A quiet step needs room for more pairs than it keeps.
    let room = if contact.view().lengths.is_quiet { QUIET_ROOM } else { 1 };
    if counts.vertex_triangle.max(counts.edge_edge) > room * most_pairs(model) {
        return None;
    }
    contact.grow_kept();
    if contact.grow_pairs(counts) {
        return Some(step::await_candidates(model, &mut contact.view(), dispatch).await);
    }
    Some(counts)
}

fn respond(
    model: &ContactModel<'_>,
    contact: &mut ContactScratchColumns,
    settings: Settings,
    tally: &mut Tally,
    dispatch: &impl Dispatch,
) -> Outcome {
    loop {
        match step::respond(model, &mut contact.view(), settings, tally, dispatch) {
            Outcome::Short { needed } => contact.grow_constraints(needed),
            outcome => return outcome,
        }
    }
}

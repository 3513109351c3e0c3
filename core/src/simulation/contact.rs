//! The phases of a step between prediction and commit, over owned columns that grow where a step
//! needs more room, and the untangling of a start.

use super::{Part, Simulation};
use crate::audit;
use crate::broad_phase::Counts;
use crate::contact::{ContactModel, ContactScratchColumns};
use crate::dispatch::Dispatch;
use crate::integrate::Context;
use crate::real::{Real, sqrt};
use crate::response::impact::SEPARATION;
use crate::response::{Outcome, Settings, Tally};
use crate::scene::BuiltScene;
use crate::stage::Stage;
use crate::step::{self, Sweep};
use crate::untangle::{self, Untangled};

/// How often the boxes around the motion are widened before the step is halved.
const MOST_WIDENINGS: u32 = 6;

/// How often, where it cannot be halved any more.
const LAST_WIDENINGS: u32 = 20;

/// How often what is near is parted after untangling.
const PARTINGS: u32 = 10;

impl Simulation {
    /// The phases between prediction and commit; false where surfaces would still meet.
    pub(super) fn resolve(&mut self, part: Part, hold: bool, dispatch: &impl Dispatch) -> bool {
        let most = if hold { LAST_WIDENINGS } else { MOST_WIDENINGS };
        let touching = self.tally.touching;
        let mut widened = 0;
        loop {
            dispatch.enter(Stage::BroadPhase);
            self.sweep(part, widened);
            self.detect(dispatch);
            if widened == 0 {
                self.press(part, dispatch);
            }
            match self.respond(part, hold, dispatch) {
                // The exact test decides on what was too near for a time of impact.
                Outcome::Free => return self.tally.touching == touching || !self.crosses(),
                Outcome::Left if widened < most => widened += 1,
                Outcome::Left | Outcome::Short { .. } | Outcome::Meets(_) => return false,
            }
        }
    }

    /// Contact: writes the boxes around the motion, wider where that was too little.
    pub fn sweep(&mut self, part: Part, widened: u32) {
        let (time, step) = (self.time_at(part.from), self.step * part.length as Real);
        let (Some(model), Some(contact)) = (&self.built.contact, &mut self.contact) else { return };
        let margin = 0.5 * model.thickness * (1 << widened) as Real;
        let sweep = Sweep { time, step, margin, widen: widened > 0 };
        let positions = &self.built.particles.positions;
        step::sweep(&model.view(), sweep, positions, &self.scratch.next_positions, &mut contact.view());
    }

    /// Contact: finds candidates, with more room where there was too little.
    pub fn detect(&mut self, dispatch: &impl Dispatch) {
        let (Some(model), Some(contact)) = (&self.built.contact, &mut self.contact) else { return };
        let counts = detect(&model.view(), contact, dispatch);
        self.tally.candidates += (counts.vertex_triangle + counts.edge_edge) as u64;
    }

    /// Contact: corrects the candidate state, with more room where there was too little for what
    /// touches.
    pub fn respond(&mut self, part: Part, hold: bool, dispatch: &impl Dispatch) -> Outcome {
        let step = self.step * part.length as Real;
        let (Some(model), Some(contact)) = (&self.built.contact, &mut self.contact) else { return Outcome::Free };
        dispatch.enter(Stage::Response);
        let outcome = respond(&model.view(), contact, Settings { step, hold }, &mut self.tally, dispatch);
        if outcome == Outcome::Free {
            self.touched = step::settle(step, &contact.view(), &mut self.scratch.view());
        }
        outcome
    }

    /// Contact: solves what touches together with the cloth. Where there is too little room for what
    /// touches, it is grown.
    pub fn press(&mut self, part: Part, dispatch: &impl Dispatch) {
        let (time, step) = (self.time_at(part.from), self.step * part.length as Real);
        let Self { built, scratch, contact, scheme, work, .. } = self;
        let (Some(touching), Some(contact)) = (&built.contact, contact) else { return };
        if !scheme.method.is_implicit() {
            return;
        }
        dispatch.enter(Stage::Response);
        let holds = loop {
            let settings = Settings { step, hold: false };
            match step::press(&touching.view(), &mut contact.view(), settings, scratch.view().inverse_diagonal) {
                Ok(holds) => break holds,
                Err(Outcome::Short { needed }) => contact.grow_constraints(needed),
                Err(_) => return,
            }
        };
        let BuiltScene { particles, model, pins, .. } = built;
        let (model, pins) = (&model.view(), &pins.view());
        let (masses, inverse_masses) = (&particles.masses, &particles.inverse_masses);
        let context = Context { model, pins, masses, inverse_masses, time, step, scheme, dispatch };
        step::couple(&touching.view(), &context, &mut contact.view(), holds, &mut scratch.view(), work);
    }

    /// Whether more passes through at the end of the step than at its start.
    fn crosses(&mut self) -> bool {
        let (Some(model), Some(contact)) = (&self.built.contact, &mut self.contact) else { return false };
        let (surface, view) = (model.surface.view(), contact.view());
        audit::count(&surface, view.end) > audit::count(&surface, view.start)
    }

    /// The particle whose candidate is farthest from where it is.
    pub(super) fn fastest(&self) -> u32 {
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
        let mut untangled = untangle::untangle(&model.view(), &mut places);
        if untangled.rounds == 0 {
            return untangled;
        }
        let positions = &mut self.built.particles.positions;
        places.truncate(positions.len());
        let start = core::mem::replace(positions, places);
        self.scratch.has_history = false;
        for _ in 0..PARTINGS {
            let kept = self.positions().to_vec();
            if !self.part_near(dispatch) {
                break;
            }
            let places = self.places();
            let left = self.built.contact.as_ref().map_or(0, |model| untangle::count(&model.view(), &places));
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

    /// Lets the response part, standing still, what is nearer than what it counts as met; false
    /// where there is no such thing or it cannot.
    fn part_near(&mut self, dispatch: &impl Dispatch) -> bool {
        let (time, step) = (self.time(), self.step);
        let Self { built, contact, .. } = self;
        let (Some(model), Some(contact)) = (&built.contact, contact) else { return false };
        let (model, positions) = (&model.view(), &mut built.particles.positions);
        for widened in 0..MOST_WIDENINGS {
            let margin = 0.5 * model.thickness * (1 << widened) as Real;
            let sweep = Sweep { time, step: 0.0, margin, widen: widened > 0 };
            step::sweep(model, sweep, positions, positions, &mut contact.view());
            let counts = detect(model, contact, dispatch);
            let view = contact.view();
            let pairs = [(&view.vertex_triangle, counts.vertex_triangle), (&view.edge_edge, counts.edge_edge)];
            let apart = |&distance: &Real| distance >= SEPARATION * model.thickness;
            if pairs.iter().all(|(pairs, count)| pairs.distances[..*count].iter().all(apart)) {
                return false;
            }
            let settings = Settings { step, hold: false };
            match respond(model, contact, settings, &mut Tally::default(), dispatch) {
                Outcome::Free => {
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

fn detect(model: &ContactModel<'_>, contact: &mut ContactScratchColumns, dispatch: &impl Dispatch) -> Counts {
    let counts = step::detect(model, &mut contact.view(), dispatch);
    if contact.grow_pairs(counts) {
        return step::detect(model, &mut contact.view(), dispatch);
    }
    counts
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

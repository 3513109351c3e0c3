//! Removes the intersections of a start state.

use alloc::vec;

use super::Simulation;
use crate::audit;
use crate::contact::{ContactScratch, Prediction};
use crate::detection::{self, Purpose};
use crate::dispatch::Dispatch;
use crate::real::{Real, Vec3, sqrt};
use crate::response::impact::SEPARATION;
use crate::response::{self, ContactStatistics, Outcome, Settings};
use crate::step;
use crate::untangle::{self, Untangled};

/// How often the boxes around the corrections are widened.
const MOST_WIDENINGS: u32 = 6;

/// How often near pairs are separated after untangling.
const SEPARATIONS: u32 = 10;

impl Simulation {
    /// [Removes](untangle::untangle) the present intersections as far as pins allow it. Then separates pairs that are
    /// too near for the response. Only positions change. Nothing changes in a scene without contact or without
    /// intersections. If the dispatch [stops](Dispatch::stopped), the counts say nothing.
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
        for _ in 0..SEPARATIONS {
            let kept = self.positions().to_vec();
            if !self.separate_near(dispatch) {
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

    /// Lets the response separate pairs at rest that are nearer than the distance of an impact. Returns false if no
    /// pair is so near, or if it cannot.
    fn separate_near(&mut self, dispatch: &impl Dispatch) -> bool {
        let (time, step) = (self.time(), self.step);
        let Self { built, contact, .. } = self;
        let (Some(model), Some(contact)) = (&built.contact, contact) else { return false };
        let (model, positions) = (&model.view(), &mut built.particles.positions);
        detection::place(model, [time, 0.0], positions, positions, &mut contact.view());
        let still = vec![Vec3::ZERO; positions.len()];
        for widened in 0..MOST_WIDENINGS {
            let searched = detection::search(model, Purpose::Response { widened }, contact, dispatch);
            let Ok(counts) = searched else { return false };
            let view = contact.view();
            let pairs = [(&view.vertex_triangle, counts.vertex_triangle), (&view.edge_edge, counts.edge_edge)];
            let apart = |&distance: &Real| distance >= SEPARATION * model.thickness;
            if pairs.iter().all(|(pairs, count)| pairs.distances[..*count].iter().all(apart)) {
                return false;
            }
            let settings = Settings { step, hold: false };
            let prediction = Prediction { positions, displacements: &still, low: &[] };
            let respond = |contact: &mut ContactScratch<'_>| {
                response::respond(model, &prediction, contact, settings, &mut ContactStatistics::default(), dispatch)
            };
            match step::with_room(contact, respond) {
                // The next call counts the pairs again.
                Ok(Outcome::Free | Outcome::Touches) => {
                    positions.copy_from_slice(&contact.view().end[..model.cloth()]);
                    return true;
                }
                Ok(Outcome::LeavesBoxes) => {}
                _ => return false,
            }
        }
        false
    }
}

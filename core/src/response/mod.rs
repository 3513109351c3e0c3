//! Corrects the motion of a step by its contacts [Bridson 2002], in the passes of the list `PASSES`.
//!
//! An implicit step is first [solved together with its contacts](crate::implicit_contact), so that the cloth gives way
//! elastically. Then:
//!
//! 1. [`repulsion`]: pairs that are near at the start of the step must not come nearer than the thickness, with
//!    [`friction`]. All contacts are [`constraint`]s on the displacements of the step.
//! 2. Pairs that overlap are separated a little. This changes positions, not velocities.
//! 3. [`impact`]: each pair that collides during the step gives one more constraint, in rounds.
//! 4. [`impact_zone`]: pairs that still collide are solved together with all constraints that they are connected to.
//!    Unlike in rigid zones, sliding stays free [Harmon 2008].
//! 5. [`hold`]: as a last resort, vertices of pairs that still collide do not move.
//!
//! If a pair still collides, the step is rejected and taken in halves. Some pairs are so near that rounding hides
//! whether they collide. Then the end of the step is [tested exactly](crate::audit::new_crossing).

pub mod constraint;
pub mod friction;
pub mod hold;
pub mod impact;
pub mod impact_zone;
pub mod repulsion;
pub mod roll;
mod work;

use core::ops::Range;

use crate::column::Column;
use crate::contact::{ContactModel, ContactScratch, Prediction, ResponseColumns};
use crate::dispatch::Dispatch;
use crate::real::{Real, Vec3};
use crate::stage::Stage;
use work::{List, Motion, Work};

/// A pass changes displacements and marks the vertices that it moves.
type Pass = fn(&mut Work<'_>);

/// The passes in their order, each with the rounds in which it runs. After each round, a search finds the impacts that
/// are left.
const PASSES: [(Range<u32>, Pass); 6] = [
    (1..2, repulsion::repel),
    (1..2, repulsion::separate),
    (2..6, impact::resolve),
    (6..32, impact_zone::resolve),
    (32..100, hold::hold),
    (100..101, hold::freeze),
];

/// Rounds after which a step is rejected.
const MOST_ROUNDS: u32 = 30;
/// The same with the last resort: the last round of the list.
const HOLD_ROUNDS: u32 = {
    let [.., (last, _)] = &PASSES;
    last.end - 1
};

/// The result of a response.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// No pair collides.
    Free,
    /// No pair collides within rounding errors. Some pairs touch: only [an exact test](crate::audit::new_crossing) of
    /// the end tells whether they pass through one another.
    Touches,
    /// A vertex was moved out of the box for which its candidates were found. The search must be repeated with wider
    /// boxes.
    LeavesBoxes,
    /// The vertices of two features that still collide: of features that nothing can move, if there are any.
    Collides([u32; 4]),
    /// The host cancelled the step.
    Stopped,
}

/// Counts of contact, over all steps.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct ContactStatistics {
    /// Candidates that the response had to test.
    pub candidates: u64,
    /// Contacts within the thickness.
    pub proximity: u64,
    /// Impacts that were resolved.
    pub impacts: u64,
    /// Impact zones solved.
    pub zones: u64,
    /// Pairs that touched at the start of a step. Only an exact test of its end tells whether they pass through one
    /// another.
    pub touching: u64,
    /// Steps that needed the last resort.
    pub failsafe: u64,
    /// Steps rejected and taken in halves.
    pub rejected: u64,
}

/// How a response is run.
#[derive(Clone, Copy, Debug)]
pub struct Settings {
    /// Length of the step, s.
    pub step: Real,
    /// Whether vertices that still collide may be held back.
    pub hold: bool,
}

/// Finds the pairs that are near at the start of the step and may push, for the solve of an implicit step. Pairs that
/// the predicted motion leaves up to `margin` apart may push, m.
pub fn find_contacts(
    model: &ContactModel<'_>,
    prediction: &Prediction<'_>,
    scratch: &mut ContactScratch<'_>,
    step: Real,
    margin: Real,
) -> Result<(), usize> {
    let count = find_near(model, prediction, scratch, step, 0, margin)?;
    scratch.lengths.constraints = count;
    Ok(())
}

/// Adds the pairs that the motion of the solve brings nearer than the thickness, and those that collide on the way, the
/// latter at the place and along the direction of their impact [Otaduy 2009].
pub fn find_impacts<D: Dispatch>(
    model: &ContactModel<'_>,
    prediction: &Prediction<'_>,
    scratch: &mut ContactScratch<'_>,
    step: Real,
    dispatch: &D,
) -> Result<(), usize> {
    dispatch.enter(Stage::Response);
    let near = find_near(model, prediction, scratch, step, scratch.lengths.constraints, 0.0)?;
    let ContactScratch { start, end, displacements, turns, boxes, counts, constraints, .. } = scratch;
    let rounds = ResponseColumns::within(boxes).rounds;
    let mut pairs = [&mut scratch.vertex_triangle, &mut scratch.edge_edge];
    let motion = Motion { start, end, displacements, turns, rounds, round: 0, step };
    let mut list = List { all: constraints, count: near, touching: 0 };
    scratch.lengths.constraints = impact::find(model, &mut pairs, counts, &motion, &mut list, dispatch)?;
    Ok(())
}

/// Adds the near pairs behind the first `before` constraints. Returns the number of constraints.
fn find_near(
    model: &ContactModel<'_>,
    prediction: &Prediction<'_>,
    scratch: &mut ContactScratch<'_>,
    step: Real,
    before: usize,
    margin: Real,
) -> Result<usize, usize> {
    scratch.set_motion(prediction);
    let ContactScratch { start, end, displacements, turns, boxes, open, constraints, order, .. } = scratch;
    let ResponseColumns { corrections, rounds, .. } = ResponseColumns::within(boxes);
    corrections.fill(Vec3::ZERO);
    rounds.fill(0);
    let mut list = List { all: constraints, count: before, touching: 0 };
    let known = repulsion::Known::sort(list.all.part(..list.count), order);
    let pairs = [&mut scratch.vertex_triangle, &mut scratch.edge_edge];
    let motion = Motion { start, end, displacements, turns, rounds, round: 0, step };
    repulsion::find(model, pairs, open, &motion, &known, margin, &mut list);
    list.count()
}

/// Corrects the predicted motion from `scratch.start` until no features collide, and writes its end to `scratch.end`.
/// Without room for all constraints, returns the number that needs room as an error.
pub fn respond<D: Dispatch>(
    model: &ContactModel<'_>,
    prediction: &Prediction<'_>,
    scratch: &mut ContactScratch<'_>,
    settings: Settings,
    contact_statistics: &mut ContactStatistics,
    dispatch: &D,
) -> Result<Outcome, usize> {
    let near = find_near(model, prediction, scratch, settings.step, scratch.lengths.constraints, 0.0)?;
    let ContactScratch { start, end, displacements, turns, boxes, ends, counts, constraints, order, .. } = scratch;
    let ResponseColumns { corrections, rounds, zones, wanted } = ResponseColumns::within(boxes);
    let mut pairs = [&mut scratch.vertex_triangle, &mut scratch.edge_edge];
    let mut work = Work {
        model,
        list: List { all: constraints, count: near, touching: 0 },
        near,
        first: near,
        motion: Motion { start, end, displacements, turns, rounds, round: 0, step: settings.step },
        corrections,
        zones,
        wanted,
        order,
        statistics: ContactStatistics { proximity: near as u64, ..ContactStatistics::default() },
    };
    let most = if settings.hold { HOLD_ROUNDS } else { MOST_ROUNDS };
    loop {
        work.run_passes();
        work.motion.round_ends();
        if work.motion.leaves_boxes(ends, model) {
            return Ok(Outcome::LeavesBoxes);
        }
        work.first = work.list.count;
        impact::find(model, &mut pairs, counts, &work.motion, &mut work.list, dispatch)?;
        let impacts = work.list.all.part(work.first..work.list.count);
        let Some(last) = impacts.last() else {
            scratch.lengths.constraints = work.list.count;
            work.statistics.touching = work.list.touching;
            contact_statistics.add(&work.statistics);
            return Ok(if work.list.touching > 0 { Outcome::Touches } else { Outcome::Free });
        };
        let stuck = impacts.iter().find(|impact| impact.inverse_mass <= 0.0);
        if stuck.is_some() || work.motion.round == most {
            return Ok(Outcome::Collides(stuck.unwrap_or(last).contact.vertices));
        }
        dispatch.spend(1, 0);
        if dispatch.stopped() {
            return Ok(Outcome::Stopped);
        }
    }
}

impl ContactStatistics {
    fn add(&mut self, other: &Self) {
        self.proximity += other.proximity;
        self.impacts += other.impacts;
        self.zones += other.zones;
        self.touching += other.touching;
        self.failsafe += other.failsafe;
    }
}

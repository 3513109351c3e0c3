//! Corrects the motion of a step by its contacts [Bridson 2002], in passes:
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
//! If a pair still collides, the step is rejected and taken in halves. Some pairs are so near that rounding hides whether
//! they collide. Then the end of the step is [tested exactly](crate::audit::new_crossing).

pub mod constraint;
pub mod friction;
pub mod hold;
pub mod impact;
pub mod impact_zone;
pub mod repulsion;

use crate::contact::{ContactModel, ContactScratch};
use crate::dispatch::Dispatch;
use crate::real::{Real, Vec3};
use crate::stage::Stage;
use constraint::Constraint;

/// Rounds in which only the impacts are solved.
const IMPACT_ROUNDS: u32 = 4;
/// Rounds after which a step is rejected.
const MOST_ROUNDS: u32 = 30;
/// Rounds of the last resort.
const HOLD_ROUNDS: u32 = 100;

/// The result of a response.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// No pair collides.
    Free,
    /// No pair collides within rounding errors. Some pairs touch: only [an exact test](crate::audit::new_crossing) of the end
    /// tells whether they pass through one another.
    Touches,
    /// A vertex was moved out of the box for which its candidates were found. The search must be repeated with wider boxes.
    LeavesBoxes,
    /// The vertices of two features that still collide: of features that nothing can move, if there are any.
    Collides([u32; 4]),
    /// The host cancelled the step.
    Stopped,
}

/// Counts of contact, over all steps.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ContactStatistics {
    /// Candidates found.
    pub candidates: u64,
    /// Contacts within the thickness.
    pub proximity: u64,
    /// Impacts that were resolved.
    pub impacts: u64,
    /// Impact zones solved.
    pub zones: u64,
    /// Pairs that touched at the start of a step. Only an exact test of its end tells whether they pass through one another.
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

/// The constraints so far.
pub(crate) struct List<'a> {
    pub all: &'a mut [Constraint],
    pub count: usize,
    /// Number of pairs that touch and have no time of impact.
    pub touching: u64,
}

impl List<'_> {
    /// Adds a constraint. Without room it is only counted.
    pub fn push(&mut self, constraint: Constraint) {
        if let Some(slot) = self.all.get_mut(self.count) {
            *slot = constraint;
        }
        self.count += 1;
    }

    /// Sorts those from `first` on by their vertices: bits must not depend on the order of the candidates.
    pub fn sort_from(&mut self, first: usize) {
        if let Some(added) = self.all.get_mut(first..self.count) {
            added.sort_unstable_by_key(|constraint| constraint.contact.vertices);
        }
    }

    /// The number of constraints; if there is no room for them, as an error.
    pub fn count(&self) -> Result<usize, usize> {
        if self.count > self.all.len() { Err(self.count) } else { Ok(self.count) }
    }
}

/// Finds the pairs that are near at the start of the step and may push, for the solve of an implicit step. Pairs that the
/// predicted motion leaves up to `margin` apart may push, m.
pub fn find_contacts(
    model: &ContactModel<'_>,
    scratch: &mut ContactScratch<'_>,
    step: Real,
    margin: Real,
) -> Result<(), usize> {
    let count = find_near(model, scratch, step, 0, margin)?;
    scratch.lengths.constraints = count;
    Ok(())
}

/// Adds the pairs that the motion of the solve brings nearer than the thickness, and those that collide on the way, the
/// latter at the place and along the direction of their impact [Otaduy 2009].
pub fn find_impacts<D: Dispatch>(
    model: &ContactModel<'_>,
    scratch: &mut ContactScratch<'_>,
    step: Real,
    dispatch: &D,
) -> Result<(), usize> {
    dispatch.enter(Stage::Response);
    let near = find_near(model, scratch, step, scratch.lengths.constraints, 0.0)?;
    let ContactScratch { start, end, displacements, rounds, counts, constraints, .. } = scratch;
    let pairs = [counts.vertex_triangle, counts.edge_edge];
    let motion = Motion { start, end, displacements, rounds, step };
    let mut list = List { all: constraints, count: near, touching: 0 };
    if model.continuous {
        let [vertex_triangle, edge_edge] = [&mut scratch.vertex_triangle, &mut scratch.edge_edge];
        impact::find(model, vertex_triangle, edge_edge, pairs, &motion, 0, &mut list, dispatch);
    }
    impact::find_planes(model, &motion, 0, &mut list);
    scratch.lengths.constraints = list.count()?;
    Ok(())
}

/// Adds the near pairs behind the first `before` constraints. Returns the number of constraints.
fn find_near(
    model: &ContactModel<'_>,
    scratch: &mut ContactScratch<'_>,
    step: Real,
    before: usize,
    margin: Real,
) -> Result<usize, usize> {
    let ContactScratch {
        start, predicted, end, displacements, corrections, rounds, counts, constraints, order, ..
    } = scratch;
    end.copy_from_slice(predicted);
    for ((displacements, start), end) in displacements.iter_mut().zip(&**start).zip(&**end) {
        *displacements = *end - *start;
    }
    corrections.fill(Vec3::ZERO);
    rounds.fill(0);
    let mut list = List { all: constraints, count: before, touching: 0 };
    let known = repulsion::Known::sort(&list.all[..list.count], order);
    let pairs = [counts.vertex_triangle, counts.edge_edge];
    let motion = Motion { start, end, displacements, rounds, step };
    repulsion::find(model, &scratch.vertex_triangle, &scratch.edge_edge, pairs, &motion, &known, margin, &mut list);
    list.count()
}

/// Corrects the motion from `scratch.start` to `scratch.predicted` until no features collide, and writes its end to
/// `scratch.end`. Without room for all constraints, returns the number that needs room as an error.
pub fn respond<D: Dispatch>(
    model: &ContactModel<'_>,
    scratch: &mut ContactScratch<'_>,
    settings: Settings,
    contact_statistics: &mut ContactStatistics,
    dispatch: &D,
) -> Result<Outcome, usize> {
    let near = find_near(model, scratch, settings.step, scratch.lengths.constraints, 0.0)?;
    let ContactScratch {
        start, end, displacements, corrections, rounds, zones, boxes, counts, constraints, order, ..
    } = scratch;
    let mut list = List { all: constraints, count: near, touching: 0 };
    let pairs = [counts.vertex_triangle, counts.edge_edge];
    let mut motion = Motion { start, end, displacements, rounds, step: settings.step };
    let mut now = ContactStatistics { proximity: near as u64, ..ContactStatistics::default() };
    let context = Context { model, round: 1 };
    repulsion::repel(&context, &mut list.all[..near], &mut motion);
    repulsion::separate(&context, &mut list.all[..near], corrections, &mut motion);
    let most = if settings.hold { HOLD_ROUNDS } else { MOST_ROUNDS };
    for round in 1..=most {
        let context = Context { round: round + 1, ..context };
        motion.round_ends(round, corrections);
        if motion.leaves_boxes(boxes, model, round) {
            return Ok(Outcome::LeavesBoxes);
        }
        let first = list.count;
        let tested = if round == 1 { 0 } else { round };
        if model.continuous {
            let [vertex_triangle, edge_edge] = [&mut scratch.vertex_triangle, &mut scratch.edge_edge];
            impact::find(model, vertex_triangle, edge_edge, pairs, &motion, tested, &mut list, dispatch);
        }
        impact::find_planes(model, &motion, tested, &mut list);
        list.count()?;
        let impacts = &list.all[first..list.count];
        let Some(last) = impacts.last() else {
            now.touching = list.touching;
            scratch.lengths.constraints = list.count;
            contact_statistics.add(&now);
            return Ok(if list.touching > 0 { Outcome::Touches } else { Outcome::Free });
        };
        let stuck = impacts.iter().find(|impact| impact.inverse_mass <= 0.0);
        if stuck.is_some() || round == most {
            return Ok(Outcome::Collides(stuck.unwrap_or(last).contact.vertices));
        }
        if dispatch.stopped() {
            return Ok(Outcome::Stopped);
        }
        now.impacts += impacts.len() as u64;
        // Pairs that collided are tested again, whether or not a vertex moved.
        impacts.iter().for_each(|impact| mark(impact, motion.rounds, context.round));
        if settings.hold && round > MOST_ROUNDS {
            now.failsafe = 1;
            if round + 1 == most {
                hold::freeze(model, &mut motion, context.round);
                continue;
            }
            hold::hold(&list.all[first..list.count], model, &mut motion, context.round);
        } else if round <= IMPACT_ROUNDS {
            impact::resolve(&context, &mut list.all[near..list.count], &mut motion);
        } else {
            now.zones += impact_zone::resolve(&context, &mut list.all[..list.count], first, zones, order, &mut motion);
        }
    }
    Ok(Outcome::Collides([0; 4]))
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

/// Input of every pass.
#[derive(Clone, Copy)]
pub(crate) struct Context<'a> {
    pub model: &'a ContactModel<'a>,
    /// The number with which moved vertices are marked.
    pub round: u32,
}

/// The motion that passes correct.
pub(crate) struct Motion<'a> {
    pub start: &'a mut [Vec3],
    pub end: &'a mut [Vec3],
    pub displacements: &'a mut [Vec3],
    pub rounds: &'a mut [u32],
    pub step: Real,
}

impl Motion<'_> {
    /// Rounds the end positions of the vertices moved in a round. Their rounding errors are no velocity: in f32, with short
    /// steps, they are as large as the effect of friction.
    fn round_ends(&mut self, round: u32, corrections: &mut [Vec3]) {
        for (v, end) in self.end.iter_mut().enumerate() {
            if self.rounds[v] == round {
                *end = self.start[v] + self.displacements[v];
                let rounded = *end - self.start[v];
                corrections[v] += rounded - self.displacements[v];
                self.displacements[v] = rounded;
            }
        }
    }

    /// Whether a vertex moved in a round has left its box, less the margin of the box. In the first round the implicit
    /// solve may have moved any vertex.
    fn leaves_boxes(&self, boxes: &[crate::geometry::aabb::Aabb], model: &ContactModel<'_>, round: u32) -> bool {
        self.end.iter().enumerate().any(|(v, &end)| {
            let around = Vec3::splat(0.5 * model.thickness + model.radii[v]);
            (round == 1 || self.rounds[v] == round)
                && !((end - around).cmpge(boxes[v].min).all() && (end + around).cmple(boxes[v].max).all())
        })
    }
}

/// Solves constraints in their order until no constraint is violated by more than `tolerance`, m, or until the limit of
/// sweeps.
pub(crate) fn relax(
    context: &Context<'_>,
    constraints: &mut [Constraint],
    chosen: Option<&[u32]>,
    motion: &mut Motion<'_>,
    sweeps: u32,
    tolerance: Real,
) {
    let count = chosen.map_or(constraints.len(), <[u32]>::len);
    for _ in 0..sweeps {
        let mut worst: Real = 0.0;
        for k in 0..count {
            let constraint = &mut constraints[chosen.map_or(k, |chosen| chosen[k] as usize)];
            let (violation, moved) = constraint::solve(constraint, context.model.inverse_masses, motion.displacements);
            worst = worst.max(violation.abs());
            if moved {
                mark(constraint, motion.rounds, context.round);
            }
        }
        if worst <= tolerance {
            break;
        }
    }
}

/// Marks the vertices of a constraint as moved.
pub(crate) fn mark(constraint: &Constraint, rounds: &mut [u32], round: u32) {
    for v in constraint.contact.vertices {
        rounds[v as usize] = round;
    }
}

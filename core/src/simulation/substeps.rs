//! The [division](crate::halving) of the steps of a simulation.

use alloc::vec::Vec;

use super::{Simulation, State};
use crate::contact::ContactScratchColumns;
use crate::dispatch::Dispatch;
use crate::halving::{Divided, Progress, Substep, most_halvings};
use crate::implicit_contact::multiplier::Multiplier;
use crate::integrate::StepInput;
use crate::live::Owner as _;
use crate::particles::ParticleColumns;
use crate::reactions::ReactionColumns;
use crate::real::{Real, Vec3};
use crate::refusal::Obstacle;
use crate::step::{self, History, StepContact, Work};
use crate::work_done::{Ledger, WorkDone};

/// Copy of the [`State`] before a step that is divided. The columns are allocated once.
#[derive(Clone, Debug, Default)]
pub(super) struct Kept {
    columns: [Vec<Vec3>; 6],
    multipliers: Vec<Multiplier>,
    history: History,
    work_done: WorkDone,
    pub(super) reactions: ReactionColumns,
}

impl Kept {
    /// Allocates columns with the lengths of the given ones and room for so many multipliers.
    pub fn build(positions: &[Vec3], previous: &[Vec3], multipliers: usize) -> Self {
        let multipliers = Vec::with_capacity(multipliers);
        Self {
            multipliers,
            columns: [positions, positions, positions, positions, previous, previous].map(<[Vec3]>::to_vec),
            ..Self::default()
        }
    }

    /// Size of the columns, bytes.
    pub fn bytes(&self) -> usize {
        let multipliers = self.multipliers.capacity() * size_of::<Multiplier>();
        let columns = self.columns.iter().map(|column| size_of_val(&column[..])).sum::<usize>();
        columns + multipliers + self.reactions.bytes()
    }
}

impl Divided for Simulation {
    fn progress(&mut self) -> Progress<'_> {
        Progress {
            halvings: &mut self.halvings,
            most: most_halvings(self.built.divides(self.scheme.error)),
            estimate: &mut self.estimate,
            limit: self.scheme.error,
            statistics: &mut self.statistics,
            contact_statistics: &mut self.contact_statistics,
        }
    }

    fn keep(&mut self) {
        let Self { built, scratch, contact, kept, reactions, .. } = self;
        let ParticleColumns { positions, velocities, low_positions, low_velocities, .. } = &built.particles;
        let previous = [&scratch.previous_displacements, &scratch.previous_velocity_changes];
        let own = [positions, velocities, low_positions, low_velocities, previous[0], previous[1]];
        for (kept, own) in kept.columns.iter_mut().zip(own) {
            kept.copy_from_slice(own);
        }
        kept.multipliers.clear();
        kept.multipliers.extend_from_slice(contact.as_ref().map_or(&[], ContactScratchColumns::multipliers));
        (kept.history, kept.work_done) = (self.history, self.work_done);
        if let Some(reactions) = reactions {
            kept.reactions.copy_from(reactions);
        }
    }

    #[cfg_attr(small, optimize(size))]
    fn put_back(&mut self) {
        let kept = core::mem::take(&mut self.kept);
        let [positions, velocities, low_positions, low_velocities, previous @ ..] =
            kept.columns.each_ref().map(|column| &column[..]);
        let (multipliers, low) = (&kept.multipliers[..], [low_positions, low_velocities]);
        let state = State { positions, velocities, low, previous, multipliers, anchors: &[], ..self.state() };
        self.restore(&state, self.statistics, self.contact_statistics);
        (self.history, self.work_done) = (kept.history, kept.work_done);
        if let Some(reactions) = &mut self.reactions {
            reactions.copy_from(&kept.reactions);
        }
        self.kept = kept;
        // Those that began at the start of this step.
        self.parts_mut().change_pins();
    }
}

impl Simulation {
    /// Takes a substep. Returns its estimated error, m, if there is a largest one.
    pub(super) async fn try_substep<D: Dispatch>(
        &mut self,
        substep: Substep,
        dispatch: &D,
    ) -> Result<Option<Real>, Obstacle> {
        let time = self.time_at(substep.from);
        let Self {
            built,
            scratch,
            contact,
            history,
            scheme,
            step,
            statistics,
            contact_statistics,
            searched,
            measures_work,
            work_done,
            reactions,
            host,
            forces,
            ..
        } = self;
        let colliders = built.contact.as_ref().map(|contact| contact.colliders.view()).unwrap_or_default();
        let mut particles = built.particles.view();
        let mut model = built.model.view();
        host.add_to(&mut model, forces);
        let input = StepInput {
            model,
            pins: &built.pins.carried_by(colliders),
            masses: particles.masses,
            inverse_masses: particles.inverse_masses,
            time,
            step: *step * substep.length as Real,
            scheme,
            follows_contact: false,
            limit: scheme.error.map(|error| if substep.is_last_resort { Real::INFINITY } else { error }),
            has_contact: contact.is_some(),
            dispatch,
        };
        let model = built.contact.as_ref().map(|model| model.view());
        let columns = model.as_ref().zip(contact.as_mut());
        let contact = columns.map(|(model, columns)| StepContact { model, columns, hold: substep.is_last_resort });
        let reactions = reactions.as_mut().map(|columns| columns.view(&built.pin_groups));
        let done = measures_work.then_some(Ledger { done: work_done, reactions });
        let work = Work { integrator: statistics, contact: contact_statistics, searched, done };
        let taken = step::await_take(&input, &mut particles, &mut scratch.view(), contact, history, work).await;
        if taken.is_ok() {
            self.substep = input.step.into();
        }
        taken
    }
}

//! A cloth that lies in a cooked scene and in memory of its host. It takes the same steps as a
//! [`Simulation`](crate::simulation::Simulation), bit for bit, without a heap. Columns of contact do not grow: a step that
//! lacks room fails, says how much it lacks, and leaves the state as it was.

use glam::DVec3;

use super::source::{Columns, Source};
use super::stored::{Kept, NO_FRAMES, Stored, StoredContact};
use super::{ALIGNMENT, CookedError, HEADER, check, header, is_whole, snapshot};
use crate::broad_phase::Counts;
use crate::colliders::Colliders;
use crate::column::Column;
use crate::contact::{ContactRoom, ContactScratch};
use crate::diagnostics;
use crate::dispatch::Dispatch;
use crate::error::LiveError;
use crate::halving::{Divided, Division, Progress, Substep, most_halvings};
use crate::integrate::pins::Pins;
use crate::integrate::{IntegratorStatistics, Scheme, StepInput};
use crate::live::{HostForces, Owner, Parts, PartsMut, Slot};
use crate::real::{Real, Sum, Vec3};
use crate::refusal::{Cause, Obstacle, StepError};
use crate::response::ContactStatistics;
use crate::step::{self, History, StepContact, Work};
use crate::work_done::{Ledger, WorkDone};

/// A cloth in borrowed memory.
pub struct Cloth<'a> {
    pub(super) stored: Stored<'a>,
    pub(super) scheme: Scheme,
    pub(super) step: Real,
    pub(super) history: History,
    pub(super) kept_history: History,
    pub(super) kept_multipliers: usize,
    pub(super) halvings: u32,
    pub(super) estimate: Option<Real>,
    pub(super) searched: u64,
    pub(super) steps: u64,
    pub(super) substep: Sum,
    pub(super) host: HostForces,
    pub(super) work_done: WorkDone,
    pub(super) kept_work: WorkDone,
    pub(super) statistics: IntegratorStatistics,
    pub(super) contact_statistics: ContactStatistics,
    pub(super) snapshot_bytes: usize,
}

/// Columns of contact that cannot grow.
struct Fixed<'b, 'a>(&'b mut ContactScratch<'a>);

impl ContactRoom for Fixed<'_, '_> {
    fn columns(&mut self) -> ContactScratch<'_> {
        self.0.reborrow()
    }

    fn grow_pairs(&mut self, _: Counts) -> bool {
        false
    }

    fn grow_constraints(&mut self, _: usize) -> bool {
        false
    }
}

impl<'a> Cloth<'a> {
    /// Opens a cooked scene where it lies. `memory` needs [`required_bytes`](super::required_bytes) bytes. Both must begin
    /// at a multiple of [`ALIGNMENT`].
    // Not inlined: the stack that it needs is free again in a step.
    #[inline(never)]
    pub fn open(block: &'a [u8], memory: &'a mut [u8]) -> Result<Self, CookedError> {
        let header = header(block)?;
        if !(block.as_ptr() as usize).is_multiple_of(ALIGNMENT) || !(memory.as_ptr() as usize).is_multiple_of(ALIGNMENT)
        {
            return Err(CookedError::Alignment);
        }
        is_whole(block)?;
        let mut source =
            Source { block: block.get(HEADER..).unwrap_or_default(), memory, needed: header.memory as usize };
        let mut stored = Stored::open(&mut source)?;
        let scheme = stored.settings.scheme()?;
        check::all(&stored, &scheme)?;
        if header.vertices != stored.particles.positions.len() as u64 {
            return Err(CookedError::Malformed);
        }
        if let Some(contact) = &mut stored.contact {
            contact.columns.kept.forget();
        }
        Ok(Self {
            scheme,
            step: stored.settings.step as Real,
            steps: stored.settings.steps,
            snapshot_bytes: snapshot::size(&mut stored),
            stored,
            history: History::Start,
            kept_history: History::Start,
            kept_multipliers: 0,
            halvings: 0,
            estimate: None,
            searched: 0,
            substep: 0.0,
            host: HostForces::default(),
            work_done: WorkDone::default(),
            kept_work: WorkDone::default(),
            statistics: IntegratorStatistics::default(),
            contact_statistics: ContactStatistics::default(),
        })
    }

    /// Takes one step, divided into substeps if surfaces would collide or the error would be too large. A step that
    /// fails does not change the state, except that pins whose time has come have begun. Candidates are found here, never by
    /// [`Dispatch::detect`].
    pub fn step(&mut self, dispatch: &impl Dispatch) -> Result<(), StepError> {
        let counted = (self.statistics, self.contact_statistics);
        self.searched = 0;
        self.parts_mut().change_pins();
        match self.take_substeps(dispatch) {
            Ok(()) => {
                self.steps += 1;
                Ok(())
            }
            Err(Obstacle { cause, particle }) => {
                self.substep = 0.0;
                if cause == Cause::Stopped {
                    (self.statistics, self.contact_statistics) = counted;
                }
                let term = self.hardest_term(particle, dispatch);
                Err(StepError { step: self.steps + 1, particle, term, cause })
            }
        }
    }

    fn take_substeps(&mut self, dispatch: &impl Dispatch) -> Result<(), Obstacle> {
        let mut division = Division::begin(self);
        while let Some(substep) = division.next(self) {
            let taken = self.try_substep(substep, dispatch);
            division.note(self, taken)?;
        }
        Ok(())
    }

    /// Takes a substep. Returns its estimated error, m, if there is a largest one.
    fn try_substep(&mut self, substep: Substep, dispatch: &impl Dispatch) -> Result<Option<Real>, Obstacle> {
        let time = self.time() + substep.from * Sum::from(self.step);
        let Self { stored, scheme, step, history, searched, statistics, contact_statistics, host, work_done, .. } =
            self;
        let Stored { particles, model, pins, scratch, held, contact, forces, reactions, .. } = stored;
        let mut particles = particles.reborrow();
        let (solids, columns) = match contact {
            Some(StoredContact { model, columns, .. }) => (Some(&*model), Some(columns)),
            None => (None, None),
        };
        let colliders = solids.map(|solids| solids.colliders()).unwrap_or_default();
        let mut model = *model;
        host.add_to(&mut model, forces);
        let input = StepInput {
            model,
            pins: &pins.carried_by(colliders),
            masses: particles.masses,
            inverse_masses: particles.inverse_masses,
            time,
            step: *step * substep.length as Real,
            scheme,
            follows_contact: false,
            limit: scheme.error.map(|error| if substep.is_last_resort { Real::INFINITY } else { error }),
            has_contact: solids.is_some(),
            dispatch,
        };
        let mut scratch = scratch.reborrow();
        scratch.patches.held = held;
        let done = reactions.as_mut().map(|it| Ledger { done: work_done, reactions: Some(it.reborrow()) });
        let work = Work { integrator: statistics, contact: contact_statistics, searched, done };
        let model = solids.map(|solids| solids.view());
        let mut columns = columns.map(Fixed);
        let contact = model.as_ref().zip(columns.as_mut());
        let contact = contact.map(|(model, columns)| StepContact { model, columns, hold: substep.is_last_resort });
        let taken = step::take(&input, &mut particles, &mut scratch, contact, history, work);
        if taken.is_ok() {
            self.substep = input.step.into();
        }
        taken
    }

    fn hardest_term(&mut self, particle: u32, dispatch: &impl Dispatch) -> Option<crate::stage::Term> {
        let time = self.time();
        let Stored { particles, model, scratch, forces, .. } = &mut self.stored;
        let mut model = *model;
        self.host.add_to(&mut model, forces);
        diagnostics::hardest_term(
            &model.at(time),
            particles.masses,
            particles.positions,
            particles.velocities,
            particle,
            scratch.elements,
            // A work column: its content is of the step that failed.
            scratch.velocity_changes,
            dispatch,
        )
    }

    /// Simulated time, s.
    pub fn time(&self) -> Sum {
        self.steps as Sum * Sum::from(self.step)
    }

    /// Length of a step, s.
    pub fn step_length(&self) -> Real {
        self.step
    }

    /// Number of steps taken.
    pub fn steps(&self) -> u64 {
        self.steps
    }

    /// The point in the world from which all positions are measured, m.
    pub fn origin(&self) -> DVec3 {
        self.stored.settings.origin.into()
    }

    /// Positions, rounded, from the [`origin`](Self::origin), m.
    pub fn positions(&self) -> &[Vec3] {
        self.stored.particles.positions
    }

    /// Velocities, m/s.
    pub fn velocities(&self) -> &[Vec3] {
        self.stored.particles.velocities
    }

    /// Triangles of all cloths.
    pub fn triangles(&self) -> &'a [[u32; 3]] {
        self.stored.triangles
    }

    /// The pinned vertices.
    pub fn pins(&self) -> Pins<'_> {
        self.stored.pins.carried_by(self.colliders())
    }

    /// The colliders.
    pub fn colliders(&self) -> Colliders<'_> {
        self.stored.contact.as_ref().map(|contact| contact.model.colliders()).unwrap_or_default()
    }

    /// The integration scheme.
    pub fn scheme(&self) -> &Scheme {
        &self.scheme
    }

    /// Counts of the integrator's work since the start.
    pub fn statistics(&self) -> IntegratorStatistics {
        self.statistics
    }

    /// Counts of the contact response since the start.
    pub fn contact_statistics(&self) -> ContactStatistics {
        self.contact_statistics
    }

    /// The largest estimated error of a substep of the last step, m, if the scheme has a largest error.
    pub fn estimated_error(&self) -> Option<Real> {
        self.estimate
    }
}

impl Owner for Cloth<'_> {
    fn parts(&self) -> Parts<'_> {
        let Stored { particles, triangles, contact, .. } = &self.stored;
        Parts {
            origin: self.origin(),
            time: self.time(),
            step: self.step.into(),
            substep: self.substep,
            positions: particles.into(),
            velocities: particles.velocities,
            triangles,
            firsts: contact.as_ref().map_or(&[], |contact| contact.model.firsts),
            pins: self.pins(),
            colliders: self.colliders(),
            constraints: contact
                .as_ref()
                .map_or(&[], |StoredContact { columns, .. }| columns.constraints.part(..columns.lengths.constraints)),
        }
    }

    fn parts_mut(&mut self) -> PartsMut<'_> {
        let (origin, time, step) = (self.origin(), self.time(), self.step.into());
        let Stored { particles, triangles, model, pins, scratch, held, contact, forces, reactions, .. } =
            &mut self.stored;
        let (solids, columns) = match contact {
            Some(StoredContact { model, columns, .. }) => (Some(model.reborrow()), Some(columns.reborrow())),
            None => (None, None),
        };
        let done = &mut self.work_done;
        PartsMut {
            origin,
            time,
            step,
            substep: &mut self.substep,
            particles: particles.reborrow(),
            triangles,
            model: *model,
            host: &mut self.host,
            forces,
            pins: pins.reborrow(),
            held,
            solids,
            contact: columns,
            previous: [scratch.previous_displacements, scratch.previous_velocity_changes],
            history: &mut self.history,
            ledger: reactions.as_mut().map(|it| Ledger { done, reactions: Some(it.reborrow()) }),
        }
    }

    /// A cooked cloth has its slots from the start.
    fn add_slot(&mut self, _: Slot) -> bool {
        false
    }

    fn make_frames(&mut self, body: usize) -> Result<usize, LiveError> {
        let contact = self.stored.contact.as_ref().ok_or(LiveError::NoSlot)?;
        match contact.own_frames.get(body) {
            Some(&first) if first != NO_FRAMES => Ok(first as usize),
            _ => Err(LiveError::NoSlot),
        }
    }
}

impl Divided for Cloth<'_> {
    fn progress(&mut self) -> Progress<'_> {
        Progress {
            halvings: &mut self.halvings,
            most: most_halvings(self.stored.kept.is_some()),
            estimate: &mut self.estimate,
            limit: self.scheme.error,
            statistics: &mut self.statistics,
            contact_statistics: &mut self.contact_statistics,
        }
    }

    fn keep(&mut self) {
        let Stored { particles, scratch, contact, reactions, kept: Some(kept), .. } = &mut self.stored else { return };
        let Kept { positions, velocities, low_positions, low_velocities, multipliers, .. } = kept;
        positions.copy_from(particles.positions);
        velocities.copy_from(particles.velocities);
        low_positions.copy_from(particles.low_positions);
        low_velocities.copy_from(particles.low_velocities);
        kept.previous_displacements.copy_from(scratch.previous_displacements);
        kept.previous_velocity_changes.copy_from(scratch.previous_velocity_changes);
        self.kept_multipliers = 0;
        if let Some(contact) = contact {
            self.kept_multipliers = contact.columns.lengths.multipliers;
            let count = self.kept_multipliers;
            multipliers.part_mut(..count).copy_from(contact.columns.multipliers.part(..count));
        }
        if let Some(reactions) = reactions {
            kept.reactions.copy_from(reactions.colliders);
        }
        (self.kept_history, self.kept_work) = (self.history, self.work_done);
    }

    fn put_back(&mut self) {
        let Stored { particles, scratch, contact, reactions, kept: Some(kept), .. } = &mut self.stored else { return };
        let Kept { positions, velocities, low_positions, low_velocities, multipliers, .. } = kept;
        particles.positions.copy_from(positions);
        particles.velocities.copy_from(velocities);
        particles.low_positions.copy_from(low_positions);
        particles.low_velocities.copy_from(low_velocities);
        scratch.previous_displacements.copy_from(kept.previous_displacements);
        scratch.previous_velocity_changes.copy_from(kept.previous_velocity_changes);
        if let Some(contact) = contact {
            let count = self.kept_multipliers;
            contact.columns.multipliers.part_mut(..count).copy_from(multipliers.part(..count));
            contact.columns.lengths.multipliers = count;
        }
        if let Some(reactions) = reactions {
            reactions.colliders.copy_from(kept.reactions);
        }
        (self.history, self.work_done) = (self.kept_history, self.kept_work);
    }
}

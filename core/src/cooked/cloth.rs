//! A cloth that lies in a cooked scene and in memory of its host. It takes the same steps as a
//! [`Simulation`](crate::simulation::Simulation), bit for bit, without a heap. Columns of contact do not grow: a step that
//! lacks room fails, says how much it lacks, and leaves the state as it was.

use glam::DVec3;

use super::source::{Columns, Source};
use super::stored::{Kept, Stored, StoredContact};
use super::{ALIGNMENT, CookedError, HEADER, check, checksum, header};
use crate::broad_phase::Counts;
use crate::colliders::{Colliders, Drive};
use crate::contact::{ContactRoom, ContactScratch};
use crate::diagnostics;
use crate::dispatch::{Dispatch, block_on};
use crate::error::{LiveError, checked_vector};
use crate::halving::{self, Divided, Progress, Substep};
use crate::integrate::pins::Pins;
use crate::integrate::{IntegratorStatistics, Scheme, StepInput};
use crate::real::{Real, Sum, Vec3, to_f64, vec3};
use crate::refusal::{Cause, Obstacle, StepError};
use crate::response::ContactStatistics;
use crate::step::{self, History, StepContact, Work};

/// A cloth in borrowed memory.
pub struct Cloth<'a> {
    stored: Stored<'a>,
    scheme: Scheme,
    step: Real,
    history: History,
    kept_history: History,
    kept_multipliers: usize,
    halvings: u32,
    estimate: Option<Real>,
    searched: u64,
    steps: u64,
    statistics: IntegratorStatistics,
    contact_statistics: ContactStatistics,
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
    pub fn open(block: &'a [u8], memory: &'a mut [u8]) -> Result<Self, CookedError> {
        let header = header(block)?;
        if !(block.as_ptr() as usize).is_multiple_of(ALIGNMENT) || !(memory.as_ptr() as usize).is_multiple_of(ALIGNMENT)
        {
            return Err(CookedError::Alignment);
        }
        let columns = block.get(HEADER..).unwrap_or_default();
        if checksum(columns) != header.checksum {
            return Err(CookedError::Checksum);
        }
        let mut source = Source { block: columns, memory, needed: header.memory as usize };
        let mut stored = Stored::open(&mut source)?;
        let scheme = stored.settings.scheme()?;
        check::all(&stored, &scheme)?;
        if let Some(contact) = &mut stored.contact {
            contact.columns.kept.forget();
        }
        Ok(Self {
            scheme,
            step: stored.settings.step as Real,
            steps: stored.settings.steps,
            stored,
            history: History::Start,
            kept_history: History::Start,
            kept_multipliers: 0,
            halvings: 0,
            estimate: None,
            searched: 0,
            statistics: IntegratorStatistics::default(),
            contact_statistics: ContactStatistics::default(),
        })
    }

    /// Takes one step, divided into substeps if surfaces would collide or the error would be too large. A step that
    /// fails does not change the state.
    pub fn step(&mut self, dispatch: &impl Dispatch) -> Result<(), StepError> {
        let counted = (self.statistics, self.contact_statistics);
        self.searched = 0;
        self.change_pins();
        match block_on(halving::take_substeps(self, dispatch)) {
            Ok(()) => {
                self.steps += 1;
                Ok(())
            }
            Err(Obstacle { cause, particle }) => {
                if cause == Cause::Stopped {
                    (self.statistics, self.contact_statistics) = counted;
                }
                let term = self.hardest_term(particle, dispatch);
                Err(StepError { step: self.steps + 1, particle, term, cause })
            }
        }
    }

    fn hardest_term(&mut self, particle: u32, dispatch: &impl Dispatch) -> Option<crate::stage::Term> {
        let time = self.time();
        let Stored { particles, model, scratch, .. } = &mut self.stored;
        diagnostics::hardest_term(
            &model.at(time),
            particles.masses,
            particles.positions,
            particles.velocities,
            particle,
            scratch.elements,
            scratch.forces,
            dispatch,
        )
    }

    /// Lets the pins begin and end whose time has come at the start of this step.
    fn change_pins(&mut self) {
        let time = self.time();
        let Stored { pins, particles, .. } = &mut self.stored;
        if !pins.change(time, particles.positions) {
            return;
        }
        self.take_over_pins();
        self.hold(true);
    }

    /// Moves a vertex, pinned or free, at constant velocity to `place`, in the world, m, within `seconds`, or at once
    /// for 0. It stays pinned there. A cooked scene has a fixed number of slots for such vertices.
    pub fn move_to(&mut self, vertex: u32, place: [Sum; 3], seconds: Sum) -> Result<(), LiveError> {
        let from = self.checked_vertex(vertex)?;
        let place = checked_vector("the place", place)? - self.origin();
        if !(0.0..Sum::INFINITY).contains(&seconds) {
            return Err(LiveError::Seconds { seconds });
        }
        let now = self.time();
        let before = self.pins().held_velocity(vertex, now);
        let pins = &mut self.stored.pins;
        if !pins.move_to(vertex, [now, now + seconds], from, place, before.unwrap_or_default()) {
            return Err(LiveError::NoSlot);
        }
        self.take_over_pins();
        self.hold(before.is_none());
        Ok(())
    }

    /// Pins a vertex to a collider where it is now: it moves with the collider.
    pub fn attach(&mut self, vertex: u32, collider: u32) -> Result<(), LiveError> {
        let place = DVec3::from(to_f64(self.checked_vertex(vertex)?));
        let colliders = self.colliders();
        let missing = LiveError::NoCollider { collider, count: colliders.bodies.len() as u32 };
        let drive = colliders.bodies.get(collider as usize).ok_or(missing)?.drive();
        if matches!(drive, Drive::Cache(_)) {
            return Err(LiveError::Deforms { collider });
        }
        let anchor = vec3(drive.undo(colliders.keys, place, self.time()).into());
        if !self.stored.pins.attach(vertex, anchor, collider) {
            return Err(LiveError::NoSlot);
        }
        self.take_over_pins();
        self.hold(true);
        Ok(())
    }

    /// Removes all pins of a vertex. It keeps the velocity with which they moved it until now. Returns false if it has no
    /// pin.
    pub fn release(&mut self, vertex: u32) -> bool {
        let time = self.time();
        let Stored { pins, particles, contact, .. } = &mut self.stored;
        let colliders = contact.as_ref().map(|contact| contact.model.colliders()).unwrap_or_default();
        pins.carried_by(colliders).let_fly(vertex, time, particles);
        let released = pins.release(vertex);
        if released {
            self.take_over_pins();
            self.history.cut();
        }
        released
    }

    fn checked_vertex(&self, vertex: u32) -> Result<Vec3, LiveError> {
        let missing = LiveError::NoVertex { vertex, count: self.positions().len() as u32 };
        self.positions().get(vertex as usize).copied().ok_or(missing)
    }

    /// Copies the held axes to contact and the preconditioner.
    fn take_over_pins(&mut self) {
        let Stored { pins, particles, contact, held, .. } = &mut self.stored;
        let view = pins.carried_by(Colliders::default());
        view.write_held(held);
        if let Some(contact) = contact {
            let (cloth, _) = contact.model.inverse_masses.split_at_mut(particles.inverse_masses.len());
            view.write_inverse_masses(particles.inverse_masses, cloth);
        }
    }

    /// Gives pinned vertices the velocities of their pins. If one holds what was free, a two-step method cannot use the
    /// state from before it.
    fn hold(&mut self, held_more: bool) {
        if held_more {
            self.history.cut();
        }
        let time = self.time();
        let Stored { pins, particles, contact, .. } = &mut self.stored;
        let colliders = contact.as_ref().map(|contact| contact.model.colliders()).unwrap_or_default();
        pins.carried_by(colliders).set_out(time, particles.velocities);
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

impl Divided for Cloth<'_> {
    fn progress(&mut self) -> Progress<'_> {
        Progress {
            halvings: &mut self.halvings,
            estimate: &mut self.estimate,
            limit: self.scheme.error,
            statistics: &mut self.statistics,
            contact_statistics: &mut self.contact_statistics,
        }
    }

    async fn try_substep<D: Dispatch>(
        &mut self,
        substep: Substep,
        last_resort: bool,
        dispatch: &D,
    ) -> Result<Option<Real>, Obstacle> {
        let time = self.time() + substep.from * Sum::from(self.step);
        let Self { stored, scheme, step, history, searched, statistics, contact_statistics, .. } = self;
        let Stored { particles, model, pins, scratch, held, contact, .. } = stored;
        let mut particles = particles.reborrow();
        let (solids, columns) = match contact {
            Some(StoredContact { model, columns }) => (Some(&*model), Some(columns)),
            None => (None, None),
        };
        let colliders = solids.map(|solids| solids.colliders()).unwrap_or_default();
        let input = StepInput {
            model: *model,
            pins: &pins.carried_by(colliders),
            masses: particles.masses,
            inverse_masses: particles.inverse_masses,
            time,
            step: *step * substep.length as Real,
            scheme,
            follows_contact: false,
            limit: scheme.error.map(|error| if last_resort { Real::INFINITY } else { error }),
            has_contact: solids.is_some(),
            dispatch,
        };
        let mut scratch = scratch.reborrow();
        scratch.patches.held = held;
        let work = Work { integrator: statistics, contact: contact_statistics, searched, done: None };
        let model = solids.map(|solids| solids.view());
        let mut columns = columns.map(Fixed);
        let contact = model.as_ref().zip(columns.as_mut());
        let contact = contact.map(|(model, columns)| StepContact { model, columns, hold: last_resort });
        step::take(&input, &mut particles, &mut scratch, contact, history, work).await
    }

    fn keep(&mut self) {
        let Stored { particles, scratch, contact, kept: Some(kept), .. } = &mut self.stored else { return };
        let Kept { positions, velocities, low_positions, low_velocities, multipliers, .. } = kept;
        positions.copy_from_slice(particles.positions);
        velocities.copy_from_slice(particles.velocities);
        low_positions.copy_from_slice(particles.low_positions);
        low_velocities.copy_from_slice(particles.low_velocities);
        kept.previous_displacements.copy_from_slice(scratch.previous_displacements);
        kept.previous_velocity_changes.copy_from_slice(scratch.previous_velocity_changes);
        self.kept_multipliers = 0;
        if let Some(contact) = contact {
            self.kept_multipliers = contact.columns.lengths.multipliers;
            let count = self.kept_multipliers;
            multipliers[..count].copy_from_slice(&contact.columns.multipliers[..count]);
        }
        self.kept_history = self.history;
    }

    fn put_back(&mut self) {
        let Stored { particles, scratch, contact, kept: Some(kept), .. } = &mut self.stored else { return };
        let Kept { positions, velocities, low_positions, low_velocities, multipliers, .. } = kept;
        particles.positions.copy_from_slice(positions);
        particles.velocities.copy_from_slice(velocities);
        particles.low_positions.copy_from_slice(low_positions);
        particles.low_velocities.copy_from_slice(low_velocities);
        scratch.previous_displacements.copy_from_slice(kept.previous_displacements);
        scratch.previous_velocity_changes.copy_from_slice(kept.previous_velocity_changes);
        if let Some(contact) = contact {
            let count = self.kept_multipliers;
            contact.columns.multipliers[..count].copy_from_slice(&multipliers[..count]);
            contact.columns.lengths.multipliers = count;
        }
        self.history = self.kept_history;
    }
}

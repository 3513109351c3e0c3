//! A scene in motion with all of its columns owned: what a host with an allocator holds.

use alloc::vec;
use alloc::vec::Vec;

use crate::audit;
use crate::contact::{ContactColumns, ContactScratchColumns};
use crate::diagnostics::{self, Stretch};
use crate::dispatch::{Dispatch, block_on};
use crate::error::SceneError;
use crate::forces::{Energy, Model};
use crate::integrate::pins::Pins;
use crate::integrate::{IntegratorStatistics, Method, Scheme, StepInput};
use crate::mesh::SurfaceColumns;
use crate::particles::Particles;
use crate::real::{Real, Sum, Vec3};
use crate::response::Tally;
use crate::scene::{self, BuiltScene, Resource, SceneDesc};
use crate::scratch::ScratchColumns;
use crate::stage::Term;
use crate::step::{self, Prediction};
use crate::traffic::{self, TrafficSizes};

mod contact;
mod halving;
mod hold;
mod refusal;

pub use refusal::{Cause, StepError};

use contact::Obstacle;
use halving::Kept;

/// Room for so many candidates of each kind a vertex, to begin with.
const PAIRS_PER_VERTEX: usize = 32;

/// A simulation that a host steps.
#[derive(Clone, Debug)]
pub struct Simulation {
    built: BuiltScene,
    scratch: ScratchColumns,
    contact: Option<ContactScratchColumns>,
    /// Where a step began that is taken in halves.
    kept: Kept,
    tally: Tally,
    /// Whether the response changed the candidate state.
    touched: bool,
    /// Whether it changed the state.
    after_contact: bool,
    /// Candidates found in this step, over all attempts.
    looked_at: u64,
    scheme: Scheme,
    step: Real,
    steps: u64,
    statistics: IntegratorStatistics,
}

/// A part of a step: a step that cannot be made free of intersections is taken in halves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Substep {
    /// Where in the step it starts, 0..1.
    pub from: Sum,
    /// How much of the step it is, 0..1.
    pub length: Sum,
}

impl Substep {
    /// The whole step.
    pub const WHOLE: Self = Self { from: 0.0, length: 1.0 };
}

/// The part of a simulation that a checkpoint keeps, borrowed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct State<'a> {
    /// Steps taken.
    pub steps: u64,
    /// m.
    pub positions: &'a [Vec3],
    /// m/s.
    pub velocities: &'a [Vec3],
    /// BDF2: the state one step before, empty elsewhere and before the first step.
    pub previous: [&'a [Vec3]; 2],
    /// Whether contact changed it, so that a method that rings starts afresh.
    pub after_contact: bool,
}

impl Simulation {
    /// Builds a scene; see [`scene::build`] for what can be wrong with it.
    ///
    /// The step is the largest that fits a whole number of times into a frame and is not larger
    /// than the scene's ([`SceneDesc::timing`]).
    pub fn new(desc: &SceneDesc, resources: &[Resource]) -> Result<Self, SceneError> {
        let built = scene::build(desc, resources)?;
        let scheme = Scheme {
            method: desc.integrator.method,
            newton: desc.integrator.newton,
            tolerance: desc.integrator.tolerance as Real,
            preconditioner: desc.integrator.preconditioner,
            jacobian: desc.integrator.jacobian,
        };
        Ok(Self::from_columns(built, scheme, desc.timing().step as Real))
    }

    /// A simulation over columns made elsewhere. Pins move from the start.
    pub fn from_columns(mut built: BuiltScene, scheme: Scheme, step: Real) -> Self {
        built.pins.view().set_out(0.0, &mut built.particles.velocities);
        let scratch = ScratchColumns::build(&built, &scheme);
        let room = PAIRS_PER_VERTEX * built.particles.positions.len();
        let contact = built.contact.as_ref().map(|contact| ContactScratchColumns::build(&contact.view(), room));
        let kept = contact.as_ref().map(|_| Kept::build(&built.particles.positions, &scratch.previous_positions));
        // Only the solver's patches are cut by it.
        built.material = Default::default();
        let (statistics, tally) = (IntegratorStatistics::default(), Tally::default());
        Self {
            built,
            scratch,
            contact,
            kept: kept.unwrap_or_default(),
            tally,
            touched: false,
            after_contact: false,
            looked_at: 0,
            scheme,
            step,
            steps: 0,
            statistics,
        }
    }

    /// Takes one step, in halves where surfaces would meet. A step that cannot be taken leaves the
    /// state as it was. Waits for candidates that are found in another place, which must not need this
    /// thread for it: see [`await_step`](Self::await_step).
    pub fn step(&mut self, dispatch: &impl Dispatch) -> Result<(), StepError> {
        block_on(self.await_step(dispatch))
    }

    /// The same for a host that must not block: awaits candidates that are found in another place
    /// ([`Dispatch::detect`]). A future that is dropped before it is done may leave the state within the
    /// step: [`restore`](Self::restore) what [`state`](Self::state) was before.
    pub async fn await_step<D: Dispatch>(&mut self, dispatch: &D) -> Result<(), StepError> {
        let counted = (self.statistics, self.tally);
        self.looked_at = 0;
        let taken = match self.try_part(Substep::WHOLE, false, dispatch).await {
            Err(cannot) if cannot.may_help() => self.step_in_halves(dispatch).await,
            taken => taken,
        };
        match taken {
            Ok(()) => self.steps += 1,
            // It will be taken again.
            Err(StepError { cause: Cause::Stopped, .. }) => (self.statistics, self.tally) = counted,
            Err(_) => {}
        }
        taken
    }

    /// Takes a part of a step.
    async fn try_part<D: Dispatch>(&mut self, part: Substep, hold: bool, dispatch: &D) -> Result<(), StepError> {
        if let Prediction::NotFinite { particle } = self.predict(part, dispatch) {
            return Err(self.diverged(Cause::NotFinite, particle, dispatch));
        }
        if self.contact.is_some() {
            if let Err(Obstacle { cause, particle }) = self.resolve(part, hold, dispatch).await {
                return Err(self.diverged(cause, particle, dispatch));
            }
            // The response compares, and comparisons with what is not a number say nothing.
            let (x, v) = (&self.scratch.next_positions, &self.scratch.next_velocities);
            if let Some(particle) = diagnostics::first_non_finite(x, v) {
                return Err(self.diverged(Cause::NotFinite, particle, dispatch));
            }
        }
        self.commit();
        self.after_contact = self.touched;
        self.scratch.has_history &= part == Substep::WHOLE && !self.after_contact;
        Ok(())
    }

    /// The scheme of a part of a step. BDF2 cannot look back over an impulse, a step of another
    /// length or a pin's jump of velocity, and the implicit midpoint rings with what an impulse
    /// leaves in stiff cloth, the louder in every step: such a part is backward Euler.
    fn scheme_of(&self, part: Substep) -> Scheme {
        let cut = part != Substep::WHOLE || self.steps > 0 && !self.scratch.has_history;
        let method = match self.scheme.method {
            Method::Bdf2 if cut => Method::BackwardEuler,
            Method::ImplicitMidpoint if self.after_contact => Method::BackwardEuler,
            method => method,
        };
        Scheme { method, ..self.scheme }
    }

    /// The first phase of a step: writes the candidate state.
    pub fn predict(&mut self, part: Substep, dispatch: &impl Dispatch) -> Prediction {
        let time = self.time_at(part.from);
        // Only a method that looks back asks for jumps.
        if part != Substep::WHOLE || self.scratch.has_history && self.pins().jump(time) {
            self.scratch.has_history = false;
        }
        let (scheme, extrapolates) = (&self.scheme_of(part), !self.after_contact);
        let Self { built, scratch, step, statistics, .. } = self;
        let BuiltScene { particles, model, pins, .. } = built;
        let context = StepInput {
            model: &model.view(),
            pins: &pins.view(),
            masses: &particles.masses,
            inverse_masses: &particles.inverse_masses,
            time,
            step: *step * part.length as Real,
            scheme,
            extrapolates,
            dispatch,
        };
        let particles = Particles {
            positions: &mut particles.positions,
            velocities: &mut particles.velocities,
            masses: &particles.masses,
            inverse_masses: &particles.inverse_masses,
        };
        step::predict(&context, &particles, &mut scratch.view(), statistics)
    }

    /// The last phase of a step: the candidate becomes the state. As [`step::commit`], over owned
    /// columns.
    pub fn commit(&mut self) {
        let (particles, scratch) = (&mut self.built.particles, &mut self.scratch);
        core::mem::swap(&mut particles.positions, &mut scratch.next_positions);
        core::mem::swap(&mut particles.velocities, &mut scratch.next_velocities);
        if !scratch.previous_positions.is_empty() {
            core::mem::swap(&mut scratch.previous_positions, &mut scratch.next_positions);
            core::mem::swap(&mut scratch.previous_velocities, &mut scratch.next_velocities);
            scratch.has_history = true;
        }
    }

    fn diverged(&mut self, cause: Cause, particle: u32, dispatch: &impl Dispatch) -> StepError {
        let term = self.hardest_term(particle, dispatch);
        StepError { step: self.steps + 1, particle, term, cause }
    }

    fn hardest_term(&mut self, particle: u32, dispatch: &impl Dispatch) -> Option<Term> {
        let (particles, scratch) = (&self.built.particles, self.scratch.view());
        diagnostics::hardest_term(
            &self.built.model.view(),
            &particles.masses,
            &particles.positions,
            &particles.velocities,
            particle,
            scratch.elements,
            scratch.forces,
            dispatch,
        )
    }

    /// Simulated time, s.
    pub fn time(&self) -> Sum {
        self.steps as Sum * Sum::from(self.step)
    }

    fn time_at(&self, fraction: Sum) -> Sum {
        self.time() + fraction * Sum::from(self.step)
    }

    /// Counts of contact so far.
    pub fn tally(&self) -> Tally {
        self.tally
    }

    /// What can touch; absent: nothing.
    pub fn contact(&self) -> Option<&ContactColumns> {
        self.built.contact.as_ref()
    }

    /// Where the vertices of the cloths and then of the colliders are now, m.
    fn places(&self) -> Vec<Vec3> {
        self.positions().iter().copied().chain(self.collider_positions()).collect()
    }

    /// Where the vertices of the colliders are now, m.
    pub fn collider_positions(&self) -> Vec<Vec3> {
        let colliders = self.built.contact.as_ref().map(|contact| contact.colliders.view()).unwrap_or_default();
        let mut places = vec![Vec3::ZERO; colliders.anchors.len()];
        colliders.place(self.time(), &mut places);
        places
    }

    /// Pairs of an edge and a triangle, of cloths and colliders, that pass through one another now,
    /// by the exact test; a scene without contact is asked about its cloths.
    pub fn crossings(&self, dispatch: &impl Dispatch) -> usize {
        let positions = self.places();
        match &self.built.contact {
            Some(contact) => audit::count(&contact.surface.view(), &positions, dispatch),
            None => {
                let surface = SurfaceColumns::build(positions.len(), &self.built.triangles, &self.built.sewn());
                audit::count(&surface.view(), &positions, dispatch)
            }
        }
    }

    /// The deepest that a vertex lies in a collider now, m; none without colliders.
    pub fn penetration(&self) -> Option<Real> {
        let contact = self.built.contact.as_ref().filter(|contact| !contact.colliders.bodies.is_empty())?;
        let (colliders, places) = (contact.colliders.view(), self.collider_positions());
        Some(self.positions().iter().map(|&x| colliders.depth(&places, x)).fold(0.0, Real::max))
    }

    /// Length of a step, s.
    pub fn step_length(&self) -> Real {
        self.step
    }

    /// IntegratorStatistics done so far.
    pub fn statistics(&self) -> IntegratorStatistics {
        self.statistics
    }

    /// The scheme.
    pub fn scheme(&self) -> &Scheme {
        &self.scheme
    }

    /// The columns that the scene was built into, with the particles as they are now.
    pub fn scene(&self) -> &BuiltScene {
        &self.built
    }

    /// Bytes that its statistics streamed so far, counted ([`traffic::total_bytes`]).
    pub fn streamed_bytes(&self) -> u64 {
        traffic::total_bytes(&self.statistics, &self.model(), self.sizes())
    }

    /// What traffic depends on ([`traffic::bytes`]).
    pub fn sizes(&self) -> TrafficSizes {
        self.scratch.sizes()
    }

    /// Bytes held in columns.
    pub fn bytes(&self) -> usize {
        let contact = self.contact.as_ref().map_or(0, ContactScratchColumns::bytes);
        self.built.bytes() + self.scratch.bytes() + contact + self.kept.bytes()
    }

    /// Positions, m.
    pub fn positions(&self) -> &[Vec3] {
        &self.built.particles.positions
    }

    /// Velocities, m/s.
    pub fn velocities(&self) -> &[Vec3] {
        &self.built.particles.velocities
    }

    /// Positions and velocities, to set. What was before is forgotten: a two-step method's history, and
    /// that contact changed the state.
    pub fn state_mut(&mut self) -> (&mut [Vec3], &mut [Vec3]) {
        self.forget_the_past();
        (&mut self.built.particles.positions, &mut self.built.particles.velocities)
    }

    /// A state that is written anew does not follow from the one before it.
    fn forget_the_past(&mut self) {
        self.scratch.has_history = false;
        self.after_contact = false;
    }

    /// The listed terms.
    pub fn model(&self) -> Model<'_> {
        self.built.model.view()
    }

    /// The held vertices.
    pub fn pins(&self) -> Pins<'_> {
        self.built.pins.view()
    }

    /// Energies now, J.
    pub fn energy(&self) -> Energy {
        diagnostics::energy(&self.model(), &self.built.particles.masses, self.positions(), self.velocities())
    }

    /// Linear momentum now, kg m/s.
    pub fn momentum(&self) -> [Sum; 3] {
        diagnostics::momentum(&self.built.particles.masses, self.velocities())
    }

    /// Stretch of all edges now.
    pub fn stretch(&self) -> Stretch {
        diagnostics::stretch(&self.built.edges, &self.built.rest_lengths, self.positions())
    }

    /// What a checkpoint keeps.
    pub fn state(&self) -> State<'_> {
        let known = if self.scratch.has_history { self.scratch.previous_positions.len() } else { 0 };
        State {
            steps: self.steps,
            positions: self.positions(),
            velocities: self.velocities(),
            previous: [&self.scratch.previous_positions[..known], &self.scratch.previous_velocities[..known]],
            after_contact: self.after_contact,
        }
    }

    /// Goes on from a checkpoint of the same scene; false, and nothing done, where the lengths
    /// do not fit.
    pub fn restore(&mut self, state: &State<'_>, statistics: IntegratorStatistics, tally: Tally) -> bool {
        let count = self.positions().len();
        let history = state.previous[0].len();
        let fits = state.positions.len() == count
            && state.velocities.len() == count
            && state.previous[1].len() == history
            && (history == 0 || history == self.scratch.previous_positions.len());
        if fits {
            self.built.particles.positions.copy_from_slice(state.positions);
            self.built.particles.velocities.copy_from_slice(state.velocities);
            if history > 0 {
                self.scratch.previous_positions.copy_from_slice(state.previous[0]);
                self.scratch.previous_velocities.copy_from_slice(state.previous[1]);
            }
            self.scratch.has_history = history > 0;
            self.after_contact = state.after_contact;
            self.steps = state.steps;
            (self.statistics, self.tally) = (statistics, tally);
        }
        fits
    }

    /// Triangles of all cloths.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.built.triangles
    }
}

//! A scene in motion with all of its columns owned: what a host with an allocator holds.

use crate::diagnostics::{self, Stretch};
use crate::dispatch::Dispatch;
use crate::error::SceneError;
use crate::forces::{Energy, Model};
use crate::integrate::pins::Pins;
use crate::integrate::{Context, Scheme, Work};
use crate::particles::Particles;
use crate::real::{Real, Sum, Vec3};
use crate::scene::{self, BuiltScene, Resource, SceneDesc};
use crate::scratch::ScratchColumns;
use crate::stage::Term;
use crate::step::{self, Prediction};
use crate::traffic::Sizes;

/// A simulation that a host steps.
#[derive(Clone, Debug)]
pub struct Simulation {
    built: BuiltScene,
    scratch: ScratchColumns,
    scheme: Scheme,
    step: Real,
    steps: u64,
    work: Work,
}

/// A step whose result is not a number. The state is still that before it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Diverged {
    /// The step that failed, counted from 1.
    pub step: u64,
    /// The first particle that is not finite.
    pub particle: u32,
    /// The term that pulled hardest on it.
    pub term: Option<Term>,
}

impl core::fmt::Display for Diverged {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        let term = self.term.map_or("no term", Term::name);
        write!(f, "diverged in step {} at particle {}, pulled hardest by {term}", self.step, self.particle)
    }
}

impl core::error::Error for Diverged {}

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

    /// A simulation over columns made elsewhere.
    pub fn from_columns(mut built: BuiltScene, scheme: Scheme, step: Real) -> Self {
        let scratch = ScratchColumns::build(&built, &scheme);
        // Only the solver's patches are cut by it.
        built.material = Default::default();
        Self { built, scratch, scheme, step, steps: 0, work: Work::default() }
    }

    /// Takes one step: predict, then commit. On divergence the state stays as it was.
    pub fn step(&mut self, dispatch: &impl Dispatch) -> Result<(), Diverged> {
        match self.predict(dispatch) {
            Prediction::Fine => {
                self.commit();
                Ok(())
            }
            Prediction::NotFinite { particle } => {
                let term = self.hardest_term(particle, dispatch);
                Err(Diverged { step: self.steps + 1, particle, term })
            }
        }
    }

    /// The first phase of a step: writes the candidate state.
    pub fn predict(&mut self, dispatch: &impl Dispatch) -> Prediction {
        let time = self.time();
        let Self { built, scratch, scheme, step, work, .. } = self;
        let BuiltScene { particles, model, pins, .. } = built;
        let context = Context {
            model: &model.view(),
            pins: &pins.view(),
            masses: &particles.masses,
            inverse_masses: &particles.inverse_masses,
            time,
            step: *step,
            scheme,
            dispatch,
        };
        let particles = Particles {
            positions: &mut particles.positions,
            velocities: &mut particles.velocities,
            masses: &particles.masses,
            inverse_masses: &particles.inverse_masses,
        };
        step::predict(&context, &particles, &mut scratch.view(), work)
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
        self.steps += 1;
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

    /// Length of a step, s.
    pub fn step_length(&self) -> Real {
        self.step
    }

    /// Work done so far.
    pub fn work(&self) -> Work {
        self.work
    }

    /// The scheme.
    pub fn scheme(&self) -> &Scheme {
        &self.scheme
    }

    /// The columns that the scene was built into, with the particles as they are now.
    pub fn scene(&self) -> &BuiltScene {
        &self.built
    }

    /// What traffic depends on ([`traffic::bytes`](crate::traffic::bytes)).
    pub fn sizes(&self) -> Sizes {
        self.scratch.sizes()
    }

    /// Bytes held in columns.
    pub fn bytes(&self) -> usize {
        self.built.bytes() + self.scratch.bytes()
    }

    /// Positions, m.
    pub fn positions(&self) -> &[Vec3] {
        &self.built.particles.positions
    }

    /// Velocities, m/s.
    pub fn velocities(&self) -> &[Vec3] {
        &self.built.particles.velocities
    }

    /// Positions and velocities, to set. A two-step method forgets its history.
    pub fn state_mut(&mut self) -> (&mut [Vec3], &mut [Vec3]) {
        self.scratch.has_history = false;
        (&mut self.built.particles.positions, &mut self.built.particles.velocities)
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
        }
    }

    /// Goes on from a checkpoint of the same scene; false, and nothing done, where the lengths
    /// do not fit.
    pub fn restore(&mut self, state: &State<'_>, work: Work) -> bool {
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
            self.steps = state.steps;
            self.work = work;
        }
        fits
    }

    /// Triangles of all cloths.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.built.triangles
    }
}

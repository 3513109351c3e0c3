//! The simulation of a scene. It owns all columns and needs an allocator.

use alloc::vec;
use alloc::vec::Vec;

use glam::DVec3;

use crate::audit;
use crate::colliders::Colliders;
use crate::contact::{ContactColumns, ContactScratchColumns};
use crate::cooked;
use crate::diagnostics::{self, Stretch};
use crate::dispatch::{Dispatch, Serial, block_on};
use crate::error::SceneError;
use crate::forces::load::VertexForce;
use crate::forces::{Energy, Model};
use crate::halving::{Division, most_halvings};
use crate::implicit_contact::multiplier::Multiplier;
use crate::integrate::pins::Pins;
use crate::integrate::{IntegratorStatistics, Method, Scheme};
use crate::live::{HostForces, Owner as _};
use crate::mesh::SurfaceColumns;
use crate::particles::ParticleColumns;
use crate::reactions::{Impulse, ReactionColumns};
use crate::real::{Real, Sum, Vec3, to_f64, vec3};
use crate::refusal::Obstacle;
use crate::response::ContactStatistics;
use crate::rigid_body::{RigidBody, Rotation};
use crate::scene::{self, BuiltScene, ClothRange, Resource, SceneDesc};
use crate::scratch::ScratchColumns;
use crate::stage::Term;
use crate::step::History;
use crate::traffic::{self, TrafficSizes};
use crate::work_done::WorkDone;

mod changes;
mod materials;
mod parts;
mod snapshot;
mod substeps;
mod untangling;

pub use materials::MaterialError;
pub use snapshot::Snapshot;

pub use crate::refusal::{Cause, StepError};

pub use crate::halving::Substep;

use substeps::Kept;

/// Initial capacity: candidates of each kind per vertex.
const PAIRS_PER_VERTEX: usize = 64;

/// A simulation that the host advances step by step.
#[derive(Clone, Debug)]
pub struct Simulation {
    built: BuiltScene,
    scratch: ScratchColumns,
    contact: Option<ContactScratchColumns>,
    /// The state at the start of a step that is taken in substeps.
    kept: Kept,
    contact_statistics: ContactStatistics,
    history: History,
    /// How often the substeps are halved.
    halvings: u32,
    /// The largest estimated error of a substep of the last step, m.
    estimate: Option<Real>,
    /// Whether the work from outside is measured, and the work done since then.
    measures_work: bool,
    work_done: WorkDone,
    /// The impulses of pins and colliders, if they are measured.
    reactions: Option<ReactionColumns>,
    /// Number of candidates found in this step, over all attempts.
    searched: u64,
    /// Length of the last substep, s.
    substep: Sum,
    scheme: Scheme,
    step: Real,
    steps: u64,
    statistics: IntegratorStatistics,
    /// Forces of the host.
    host: HostForces,
    forces: Vec<VertexForce>,
    /// Hash of the triangles, by which a snapshot knows its scene.
    meshes: u64,
}

/// The state that a checkpoint stores, borrowed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct State<'a> {
    /// Number of steps taken.
    pub steps: u64,
    /// The point in the world from which positions are measured, m.
    pub origin: [Sum; 3],
    /// Positions, m.
    pub positions: &'a [Vec3],
    /// Velocities, m/s.
    pub velocities: &'a [Vec3],
    /// Rounding errors of positions and velocities, m and m/s.
    pub low: [&'a [Vec3]; 2],
    /// Changes of positions and velocities in the last step or substep; empty if the method does not need them.
    pub previous: [&'a [Vec3]; 2],
    /// Length of the last step or substep, s; 0 if the next one does not continue it.
    pub last_step: Real,
    /// How often the substeps are halved.
    pub halvings: u32,
    /// Whether contact changed this state. If so, the next step of implicit midpoint uses backward Euler.
    pub after_contact: bool,
    /// The forces of contacts in the last step, sorted by their vertices.
    pub multipliers: &'a [Multiplier],
    /// Position of each pin before any motion, m, in a scene with pins that begin or end at a time; otherwise empty.
    pub anchors: &'a [Vec3],
}

impl Simulation {
    /// Builds a scene. [`scene::build`] documents the errors; [`SceneError::Memory`] comes before anything of the size
    /// of the scene is allocated.
    ///
    /// The step is the longest that divides a frame into whole steps and is at most 0.1 % longer than the step
    /// of the scene ([`SceneDesc::timing`]). With a largest error, it is divided into substeps whose error is smaller.
    #[cfg_attr(small, optimize(size))]
    pub fn new(desc: &SceneDesc, resources: &[Resource]) -> Result<Self, SceneError> {
        scene::reserve(desc, resources)?;
        let built = scene::build(desc, resources)?;
        let scheme = Scheme {
            method: desc.integrator.method,
            newton: desc.integrator.newton,
            tolerance: desc.integrator.tolerance(),
            preconditioner: desc.integrator.preconditioner,
            jacobian: desc.integrator.jacobian,
            error: desc.integrator.error().map(|error| error as Real),
        };
        Ok(Self::from_columns(built, scheme, desc.timing().step as Real))
    }

    /// Makes a simulation of a scene that is already built. Pins start with their prescribed velocities.
    #[cfg_attr(small, optimize(size))]
    pub fn from_columns(mut built: BuiltScene, scheme: Scheme, step: Real) -> Self {
        built.pins.of_scene = built.pins.vertices.len() as u32;
        built.pins.view().set_out(0.0, &mut built.particles.velocities);
        let scratch = ScratchColumns::build(&built, &scheme);
        let room = PAIRS_PER_VERTEX * built.particles.positions.len();
        let contact = built.contact.as_ref().map(|contact| ContactScratchColumns::build(&contact.view(), room));
        let kept = built
            .divides(scheme.error)
            .then(|| Kept::build(&built.particles.positions, &scratch.previous_displacements, room / 8));
        let meshes = cooked::checksum(bytemuck::cast_slice(&built.triangles));
        // Material coordinates are needed only to cut the patches of the solver.
        built.material = Default::default();
        let (statistics, contact_statistics) = (IntegratorStatistics::default(), ContactStatistics::default());
        Self {
            built,
            scratch,
            contact,
            kept: kept.unwrap_or_default(),
            contact_statistics,
            history: History::Start,
            halvings: 0,
            estimate: None,
            measures_work: false,
            work_done: WorkDone::default(),
            reactions: None,
            searched: 0,
            substep: 0.0,
            scheme,
            step,
            steps: 0,
            statistics,
            host: HostForces::default(),
            forces: Vec::new(),
            meshes,
        }
    }

    /// Takes one step on this thread: [`step`](Self::step) by [`Serial`]. It is compiled with this crate, in the profile
    /// of this crate, so it can be fast in a program without optimization.
    pub fn take_step(&mut self) -> Result<(), StepError> {
        self.step(&Serial)
    }

    /// Takes one step, divided into substeps if surfaces would collide or the error would be too large. A step that
    /// fails does not change the state, except that pins whose time has come have begun. Blocks while candidates are
    /// found elsewhere, for example on a GPU; that work must not need this thread. [`await_step`](Self::await_step) does
    /// not block.
    pub fn step(&mut self, dispatch: &impl Dispatch) -> Result<(), StepError> {
        block_on(self.await_step(dispatch))
    }

    /// Takes one step like [`step`](Self::step), but awaits candidates that are found elsewhere
    /// ([`Dispatch::detect`]). A future that is dropped before it completes may leave the state of a substep:
    /// [`restore`](Self::restore) the [`state`](Self::state) from before the step.
    pub async fn await_step<D: Dispatch>(&mut self, dispatch: &D) -> Result<(), StepError> {
        let counted = (self.statistics, self.contact_statistics);
        self.searched = 0;
        self.parts_mut().change_pins();
        let taken = self.await_substeps(dispatch).await.map_err(|obstacle| self.diverged(obstacle, dispatch));
        match taken {
            Ok(()) => self.steps += 1,
            // The host takes this step again, so its work is not counted.
            Err(StepError { cause: Cause::Stopped, .. }) => (self.statistics, self.contact_statistics) = counted,
            Err(_) => {}
        }
        if taken.is_err() {
            self.substep = 0.0;
        }
        taken
    }

    async fn await_substeps<D: Dispatch>(&mut self, dispatch: &D) -> Result<(), Obstacle> {
        let mut division = Division::begin(self);
        while let Some(substep) = division.next(self) {
            let taken = self.try_substep(substep, dispatch).await;
            division.note(self, taken)?;
        }
        Ok(())
    }

    fn diverged(&mut self, Obstacle { cause, particle }: Obstacle, dispatch: &impl Dispatch) -> StepError {
        let term = self.hardest_term(particle, dispatch);
        StepError { step: self.steps + 1, particle, term, cause }
    }

    fn hardest_term(&mut self, particle: u32, dispatch: &impl Dispatch) -> Option<Term> {
        let mut model = self.built.model.view();
        self.host.add_to(&mut model, &self.forces);
        let model = &model.at(self.time());
        let (particles, scratch) = (&self.built.particles, self.scratch.view());
        diagnostics::hardest_term(
            model,
            &particles.masses,
            &particles.positions,
            &particles.velocities,
            particle,
            scratch.elements,
            // A work column: its content is of the step that failed.
            scratch.velocity_changes,
            dispatch,
        )
    }

    /// Gives the columns of contact no room, so that they grow only as far as steps need, and by a quarter more. A lean
    /// search tests more candidates.
    pub fn measure_room(&mut self, is_lean: bool) {
        if let Some(contact) = &self.built.contact {
            let mut columns = ContactScratchColumns::build(&contact.view(), 0);
            if is_lean {
                columns.make_lean();
            }
            self.contact = Some(columns);
        }
    }

    /// The room of the columns of contact: for candidates of each kind, and for contacts.
    pub fn room(&self) -> [usize; 2] {
        self.contact.as_ref().map(ContactScratchColumns::room).unwrap_or_default()
    }

    /// The forces of the host.
    pub(crate) fn host_forces(&self) -> (HostForces, Vec<VertexForce>) {
        (self.host, self.forces.clone())
    }

    /// The columns of the scene and of steps.
    pub(crate) fn columns(&mut self) -> (&mut BuiltScene, &mut ScratchColumns) {
        (&mut self.built, &mut self.scratch)
    }

    /// Simulated time, s.
    pub fn time(&self) -> Sum {
        self.steps as Sum * Sum::from(self.step)
    }

    fn time_at(&self, fraction: Sum) -> Sum {
        self.time() + fraction * Sum::from(self.step)
    }

    /// Counts of the contact response since the start.
    pub fn contact_statistics(&self) -> ContactStatistics {
        self.contact_statistics
    }

    /// The columns for contact; `None` in a scene without contact.
    pub fn contact(&self) -> Option<&ContactColumns> {
        self.built.contact.as_ref()
    }

    /// Current positions of the vertices of the cloths, then of the colliders, m.
    fn places(&self) -> Vec<Vec3> {
        self.positions().iter().copied().chain(self.collider_positions()).collect()
    }

    /// Current positions of the vertices of the colliders, from the [`origin`](Self::origin), m.
    pub fn collider_positions(&self) -> Vec<Vec3> {
        let colliders = self.built.contact.as_ref().map(|contact| contact.colliders.view()).unwrap_or_default();
        let mut places = vec![Vec3::ZERO; colliders.anchors.len()];
        colliders.place(self.time(), &mut places);
        places
    }

    /// Number of current crossings (pairs of edge and triangle) of cloths and colliders, by the exact test.
    /// In a scene without contact it counts the crossings of the cloths.
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

    /// Current greatest depth of a cloth vertex inside a collider, m; `None` without colliders.
    pub fn penetration(&self) -> Option<Real> {
        let contact = self.built.contact.as_ref().filter(|contact| !contact.colliders.bodies.is_empty())?;
        let (colliders, places) = (contact.colliders.view(), self.collider_positions());
        Some(self.positions().iter().map(|&x| colliders.depth(&places, x)).fold(0.0, Real::max))
    }

    /// Length of a step, s.
    pub fn step_length(&self) -> Real {
        self.step
    }

    /// Counts of the integrator's work since the start.
    pub fn statistics(&self) -> IntegratorStatistics {
        self.statistics
    }

    /// The largest [estimated error](crate::integrate::local_error) of a substep of the last step, m, if the scheme has
    /// a largest error.
    pub fn estimated_error(&self) -> Option<Real> {
        self.estimate
    }

    /// The integration scheme.
    pub fn scheme(&self) -> &Scheme {
        &self.scheme
    }

    /// The columns of the scene, with the current state of the particles.
    pub fn scene(&self) -> &BuiltScene {
        &self.built
    }

    /// Memory traffic of the counted work since the start, bytes ([`traffic::total_bytes`]).
    pub fn streamed_bytes(&self) -> u64 {
        traffic::total_bytes(&self.statistics, &self.model(), self.sizes())
    }

    /// The sizes that memory traffic depends on ([`traffic::bytes`]).
    pub fn sizes(&self) -> TrafficSizes {
        self.scratch.sizes()
    }

    /// Size of all columns, bytes.
    pub fn bytes(&self) -> usize {
        let contact = self.contact.as_ref().map_or(0, ContactScratchColumns::bytes);
        let reactions = self.reactions.as_ref().map_or(0, ReactionColumns::bytes);
        self.built.bytes() + self.scratch.bytes() + contact + self.kept.bytes() + reactions
    }

    /// The point in the world from which all positions are measured, m. It is zero unless the first cloth starts far
    /// from the world's origin.
    pub fn origin(&self) -> [Sum; 3] {
        self.built.origin.into()
    }

    /// Positions in the world, m.
    pub fn places_in_world(&self) -> impl Iterator<Item = [Sum; 3]> {
        let positions = self.built.particles.exact_positions();
        (0..positions.rounded.len()).map(move |i| (self.built.origin + positions.place(i)).into())
    }

    /// Current positions of the vertices of the colliders in the world, m.
    pub fn colliders_in_world(&self) -> impl Iterator<Item = [Sum; 3]> {
        let place = |x: Vec3| self.built.origin + DVec3::from(to_f64(x));
        self.collider_positions().into_iter().map(move |x| place(x).into())
    }

    /// Positions, rounded, from the [`origin`](Self::origin), m.
    pub fn positions(&self) -> &[Vec3] {
        &self.built.particles.positions
    }

    /// Velocities, m/s.
    pub fn velocities(&self) -> &[Vec3] {
        &self.built.particles.velocities
    }

    /// Mutable positions and velocities. Clears the history of a two-step method and the mark that contact
    /// changed the state.
    pub fn state_mut(&mut self) -> (&mut [Vec3], &mut [Vec3]) {
        self.forget_the_past();
        (&mut self.built.particles.positions, &mut self.built.particles.velocities)
    }

    /// Copies masses to contact, and the held axes to contact and the preconditioner.
    fn take_over_pins(&mut self) {
        if let Some(contact) = &mut self.built.contact {
            let of_cloth = &self.built.particles.inverse_masses;
            contact.inverse_masses[..of_cloth.len()].copy_from_slice(of_cloth);
        }
        if self.measures_work {
            self.scratch.add_work(self.built.pins.vertices.len());
        }
        self.parts_mut().take_over_pins();
    }

    /// The pinned vertices.
    pub fn pins(&self) -> Pins<'_> {
        self.built.pins.carried_by(self.colliders())
    }

    /// The colliders.
    pub fn colliders(&self) -> Colliders<'_> {
        self.built.contact.as_ref().map(|contact| contact.colliders.view()).unwrap_or_default()
    }

    /// Clears all data about previous steps, because the new state does not follow from them.
    fn forget_the_past(&mut self) {
        self.built.particles.low_positions.fill(Vec3::ZERO);
        self.built.particles.low_velocities.fill(Vec3::ZERO);
        if self.history != History::Start {
            self.history = History::Cut;
        }
        if let Some(contact) = &mut self.contact {
            contact.set_multipliers(&[]);
        }
    }

    /// The forces of now.
    pub fn model(&self) -> Model<'_> {
        let mut model = self.built.model.view();
        self.host.add_to(&mut model, &self.forces);
        model.at(self.time())
    }

    /// Measures the [work](crate::work_done) done on the cloth from now on, and counts it from here. Allocates columns
    /// that the method may not have. Each step in which pins move or overlapping surfaces are moved apart takes one
    /// more evaluation of the forces.
    pub fn measure_work(&mut self, from: WorkDone) {
        // Steps measure the energy of gravity from the origin of positions.
        (self.measures_work, self.work_done) = (true, WorkDone { gravity: from.gravity + self.lift(), ..from });
        self.scratch.add_work(self.built.pins.vertices.len());
    }

    /// Measures the [reactions](crate::reactions) of pins and colliders too, and the work of contacts and damping.
    /// Allocates the columns; each step takes one or two more evaluations of the forces. [Measures the
    /// work](Self::measure_work) too if it was not measured.
    #[cfg_attr(small, optimize(size), inline(never))]
    pub fn measure_reactions(&mut self) {
        if !self.measures_work {
            self.measure_work(WorkDone::default());
        }
        let colliders = self.built.contact.as_ref().map_or(0, |contact| contact.colliders.bodies.len());
        let pins = vec![Impulse::default(); self.built.pin_groups.len()];
        let columns = ReactionColumns { pins, colliders: vec![Impulse::default(); colliders] };
        self.kept.reactions = columns.clone();
        self.reactions = Some(columns);
    }

    /// The impulses of pins and colliders since the host last set them, if they are
    /// [measured](Self::measure_reactions).
    pub fn reactions(&self) -> Option<&ReactionColumns> {
        self.reactions.as_ref()
    }

    /// Mutable impulses; a host clears them at the start of each interval.
    pub fn reactions_mut(&mut self) -> Option<&mut ReactionColumns> {
        self.reactions.as_mut()
    }

    /// The work done on the cloth, if it is [measured](Self::measure_work).
    pub fn work_done(&self) -> WorkDone {
        let lift = if self.measures_work { self.lift() } else { 0.0 };
        WorkDone { gravity: self.work_done.gravity - lift, ..self.work_done }
    }

    /// Current energies, J.
    pub fn energy(&self) -> Energy {
        let particles = &self.built.particles;
        let positions = particles.exact_positions();
        let mut energy = diagnostics::energy(&self.model(), &particles.masses, positions, self.velocities());
        energy.gravity -= self.lift();
        energy
    }

    /// The energy of gravity at the world's origin, where heights count from, less that at the origin of positions, J.
    fn lift(&self) -> Sum {
        let gravity = self.model().gravity.map_or(Vec3::ZERO, |gravity| gravity.acceleration);
        let mass: Sum = self.built.particles.masses.iter().map(|&m| Sum::from(m)).sum();
        self.built.origin.dot(to_f64(gravity).into()) * mass
    }

    /// Current linear momentum, kg m/s.
    pub fn momentum(&self) -> [Sum; 3] {
        diagnostics::momentum(&self.built.particles.masses, self.velocities())
    }

    /// Current angular momentum about the world's origin, kg m^2/s.
    pub fn angular_momentum(&self) -> [Sum; 3] {
        let about = diagnostics::angular_momentum(&self.built.particles.masses, self.positions(), self.velocities());
        (about + self.built.origin.cross(self.momentum().into())).into()
    }

    /// The energy of the rotations of all cloths about their centres, J, and the power that backward Euler takes from it,
    /// W: in a step of h its forces, those at the end, take w^2 h^2 of the angular momentum of a rotation by w.
    #[cfg_attr(small, optimize(size), inline(never))]
    pub fn rotation(&self) -> [Sum; 2] {
        let substep = Sum::from(self.step) / Sum::from(1u32 << self.halvings);
        let rate = if self.scheme.method == Method::BackwardEuler { 2.0 * substep } else { 0.0 };
        let of = |cloth: &ClothRange| {
            let own = cloth.vertices.start as usize..cloth.vertices.end as usize;
            let [x, v] = [self.positions(), self.velocities()].map(|column| &column[own.clone()]);
            let masses = &self.built.particles.masses[own];
            RigidBody::of(masses, x).rotation(masses, x, v)
        };
        let add = |[energy, power]: [Sum; 2], own: Rotation| {
            [energy + own.energy, power + own.energy * own.velocity.length_squared() * rate]
        };
        self.built.cloths.iter().map(of).fold([0.0; 2], add)
    }

    /// Current stretch of all edges.
    pub fn stretch(&self) -> Stretch {
        diagnostics::stretch(&self.built.edges, &self.built.rest_lengths, self.positions())
    }

    /// Largest rounding of a position, relative to the mean length of an edge.
    pub fn rounding(&self) -> Sum {
        let farthest = self.positions().iter().map(|x| x.abs().max_element()).fold(0.0, Real::max);
        Sum::from(farthest * Real::EPSILON) / self.built.mean_edge()
    }

    /// The state that a checkpoint stores.
    pub fn state(&self) -> State<'_> {
        let last_step = if let History::Smooth { step } = self.history { step } else { 0.0 };
        let known = if last_step > 0.0 { self.scratch.previous_displacements.len() } else { 0 };
        let ScratchColumns { previous_displacements, previous_velocity_changes, .. } = &self.scratch;
        let particles = &self.built.particles;
        State {
            steps: self.steps,
            origin: self.origin(),
            positions: self.positions(),
            velocities: self.velocities(),
            low: [&particles.low_positions, &particles.low_velocities],
            previous: [&previous_displacements[..known], &previous_velocity_changes[..known]],
            last_step,
            halvings: self.halvings,
            after_contact: self.history == History::Corrected,
            multipliers: self.contact.as_ref().map_or(&[], ContactScratchColumns::multipliers),
            anchors: &self.built.pins.anchors[..self.built.pins.holds.len()],
        }
    }

    /// Restores a checkpoint of the same scene. Returns false and changes nothing if the lengths of the
    /// columns differ, there are too many halvings, or there is no memory for the forces of contacts.
    pub fn restore(
        &mut self,
        state: &State<'_>,
        statistics: IntegratorStatistics,
        contact_statistics: ContactStatistics,
    ) -> bool {
        let count = self.positions().len();
        let history = state.previous[0].len();
        let fits = state.positions.len() == count
            && state.velocities.len() == count
            && state.low.iter().all(|low| low.len() == count)
            && state.halvings <= most_halvings(self.built.divides(self.scheme.error))
            && state.previous[1].len() == history
            && (history == 0 || history == self.scratch.previous_displacements.len())
            && self.contact.as_mut().is_none_or(|contact| contact.grow_constraints(state.multipliers.len()));
        if fits {
            self.built.particles.positions.copy_from_slice(state.positions);
            self.built.particles.velocities.copy_from_slice(state.velocities);
            self.built.particles.low_positions.copy_from_slice(state.low[0]);
            self.shift(DVec3::from(state.origin) - self.built.origin);
            self.built.particles.low_velocities.copy_from_slice(state.low[1]);
            if history > 0 {
                self.scratch.previous_displacements.copy_from_slice(state.previous[0]);
                self.scratch.previous_velocity_changes.copy_from_slice(state.previous[1]);
            }
            self.history = if state.after_contact {
                History::Corrected
            } else if state.last_step > 0.0 && history == self.scratch.previous_displacements.len() {
                History::Smooth { step: state.last_step }
            } else if state.steps == 0 {
                History::Start
            } else {
                History::Cut
            };
            self.halvings = state.halvings;
            if let Some(contact) = &mut self.contact {
                contact.set_multipliers(state.multipliers);
            }
            self.steps = state.steps;
            if !self.built.pins.holds.is_empty() {
                // Those of the last step.
                self.built
                    .pins
                    .slots()
                    .restore(state.steps.saturating_sub(1) as Sum * Sum::from(self.step), state.anchors);
                self.take_over_pins();
            }
            (self.statistics, self.contact_statistics) = (statistics, contact_statistics);
        }
        fits
    }

    /// Adds a displacement to all positions, m.
    fn shift(&mut self, by: DVec3) {
        if by == DVec3::ZERO {
            return;
        }
        let ParticleColumns { positions, low_positions, .. } = &mut self.built.particles;
        for (high, low) in positions.iter_mut().zip(low_positions) {
            let place = by + DVec3::from(to_f64(*high)) + DVec3::from(to_f64(*low));
            *high = vec3(place.into());
            *low = vec3((place - DVec3::from(to_f64(*high))).into());
        }
    }

    /// Triangles of all cloths.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.built.triangles
    }
}

//! A simulation in either precision behind one trait. The single and double precision crates compile the
//! same sources, so one macro implements the trait for both.

use muslin_core::cooked::Room;
use muslin_core::integrate::stability::Mode;
use muslin_core::scene::Timing;
use muslin_core::work_done::WorkDone;
use serde::{Deserialize, Serialize};

use crate::args::Precision;
use crate::divergence::Divergence;
use crate::limits;
use crate::preview::Solid;
use crate::scene_file::SceneFile;
use crate::stopwatch::Stopwatch;

/// Why a step was not taken.
#[derive(Clone, Debug)]
pub enum Halt {
    /// The step cannot be taken.
    Diverged(Divergence),
    /// The stopwatch stopped the step.
    Stopped,
}

/// Numbers about the state and the work, in double precision.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Report {
    /// Steps taken.
    pub steps: u64,
    /// Simulated time, s.
    pub time: f64,
    /// Ratio of edge length to rest length: largest, mean.
    pub stretch: [f64; 2],
    /// Energies, J: kinetic, stretch, shear, bend, seam, gravity.
    pub energy: [f64; 6],
    /// Total momentum, kg m/s.
    pub momentum: [f64; 3],
    /// Evaluations of all forces.
    pub force_evaluations: u64,
    /// Iterations of conjugate gradients.
    pub cg_iterations: u64,
    /// Newton iterations.
    pub newton_iterations: u64,
    /// Products of the system matrix with a vector.
    pub matrix_products: u64,
    /// Solves ended by negative curvature.
    pub negative_curvature: u64,
    /// Solves that ended before their tolerance.
    pub unconverged: u64,
    /// Steps and substeps: committed, taken back because of their error, committed with a larger error, and largest
    /// number of halvings.
    pub substeps: [u64; 4],
    /// Bytes that this work streams, without contact.
    pub streamed_bytes: u64,
    /// Counters of contact: candidates, proximity, impacts, zones, failsafe, rejected steps.
    pub contacts: [u64; 6],
}

/// Counts from which costs are computed; they do not depend on the machine.
#[derive(Clone, Copy, Debug, Default)]
pub struct Counted {
    /// Bytes that the work streams, without contact.
    pub streamed_bytes: u64,
    /// Pairs of features whose boxes overlap.
    pub candidates: u64,
    /// Candidates nearer than the thickness.
    pub contacts: u64,
}

/// The part of a simulation that a checkpoint stores. Columns are little-endian bytes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Snapshot {
    /// Steps taken.
    pub steps: u64,
    /// Counters of work, in the order of the core's `IntegratorStatistics`.
    pub work: [u64; 11],
    /// Counters of contact, in the order of the core's `ContactStatistics`.
    pub contacts: [u64; 7],
    /// Positions and velocities, their rounding errors, for BDF2 their changes in the last step, the forces of
    /// contacts, and the positions of pins that begin or end at a time.
    pub columns: [Vec<u8>; 8],
    /// Whether contact changed the state in the last step.
    pub after_contact: bool,
    /// How often the substeps are halved.
    pub halvings: u32,
    /// Length of the last step or substep, s; 0 if the next one does not continue it.
    pub last_step: f64,
}

/// The vertices of a `[[cloth.pin]]`.
#[derive(Clone, Copy, Debug)]
pub struct PinGroup {
    /// Index of the cloth.
    pub cloth: u32,
    /// Number of the group in its cloth.
    pub number: u32,
    /// Position of its first vertex before any motion, from the origin of the engine, m.
    pub anchor: [f64; 3],
}

/// Result of untangling a start state.
#[derive(Clone, Copy, Debug, Default)]
pub struct Untangled {
    /// Crossings before.
    pub before: usize,
    /// Crossings left.
    pub after: usize,
    /// Vertices of the cloth inside colliders, before and after.
    pub inside: [usize; 2],
    /// Rounds taken.
    pub rounds: u32,
    /// Largest displacement of a vertex, m.
    pub moved: f64,
}

/// A simulation in some precision.
pub trait Engine: Send {
    /// Takes one step; on divergence the state stays as it was.
    fn step(&mut self, stopwatch: &Stopwatch<'_>) -> Result<(), Halt>;
    /// Positions in the world, m.
    fn write_state(&self, out: &mut Vec<[f64; 3]>);
    /// Mass of each vertex, kg.
    fn masses(&self) -> Vec<f64>;
    /// Triangles of all cloths.
    fn triangles(&self) -> &[[u32; 3]];
    /// Pinned vertices, also those whose pin does not hold now.
    fn pins(&self) -> &[u32];
    /// The vertices that pins hold now.
    fn held(&self) -> Vec<u32>;
    /// Counts from which costs are computed, up to now.
    fn counted(&self) -> Counted;
    /// Measures the work done on the cloth from now on; `from` is that up to now, as of [`work_done`](Self::work_done).
    fn measure_work(&mut self, from: WorkDone);
    /// The work done on the cloth since the start.
    fn work_done(&self) -> WorkDone;
    /// Whether a force may take energy.
    fn dissipates(&self) -> bool;
    /// Measures the reactions too.
    fn measure_reactions(&mut self);
    /// Impulses on the cloth since they were set, N s, and their moments about the [`origin`](Self::origin), N m s: of
    /// each group of pins, then of each collider. Empty if they are not measured.
    fn impulses(&self) -> Vec<[f64; 6]>;
    /// Sets the impulses; zero beyond the given ones.
    fn set_impulses(&mut self, impulses: &[[f64; 6]]);
    /// Each group of pins.
    fn pin_groups(&self) -> Vec<PinGroup>;
    /// The point in the world from which the columns measure positions, m.
    fn origin(&self) -> [f64; 3];
    /// Angular momentum about the world's origin, kg m^2/s.
    fn angular_momentum(&self) -> [f64; 3];
    /// The energy of the rotations of all cloths, J, and the power that the method takes of it, W.
    fn rotation(&self) -> [f64; 2];
    /// Largest rounding of a position, relative to the mean length of an edge.
    fn rounding(&self) -> f64;
    /// Numbers about the state and the work.
    fn report(&self) -> Report;
    /// Steps and substeps committed since the start.
    fn substeps(&self) -> u64;
    /// The largest estimated error of a substep of the last step, m; `None` without error control.
    fn estimated_error(&self) -> Option<f64>;
    /// The largest ratio of edge length to rest length.
    fn largest_stretch(&self) -> f64;
    /// Speed of the fastest vertex, m/s.
    fn fastest(&self) -> f64;
    /// Whether the integration method is implicit.
    fn is_implicit(&self) -> bool;
    /// Total mass, kg.
    fn mass(&self) -> f64 {
        self.masses().iter().sum()
    }
    /// Harmonic mean of the rest lengths of all edges, m.
    fn mean_edge(&self) -> f64;
    /// Largest side of the box around the smallest cloth, m.
    fn smallest_size(&self) -> f64;
    /// Largest rigidity of hinges over the one asked for, of all cloths and directions; 0 without hinges.
    fn largest_rigidity(&self) -> f64;
    /// Largest deviation of pins and colliders from their straight and even way in any step of this duration, s; m.
    fn largest_deviation(&self, duration: f64) -> f64;
    /// Time of the last frame of a point cache that moves a collider, s; 0 without one.
    fn last_frame(&self) -> f64;
    /// Mean rest length of the edges of each cloth, m.
    fn mean_edges(&self) -> Vec<f64>;
    /// The stiffest and the most damped mode of the current state, by power iteration. The iteration ends at the
    /// relative change `tolerance`, or after `most` iterations. If the stopwatch stops it, the modes are too slow.
    fn fastest_modes(&self, tolerance: f64, most: u32, stopwatch: &Stopwatch<'_>) -> [Mode; 2];
    /// Adds the state to a hash chain and returns the chain.
    fn chain(&self, chain: Option<u64>) -> u64;
    /// Number of crossings, by the exact test. It is too small if the stopwatch stops it.
    fn crossings(&self, stopwatch: &Stopwatch<'_>) -> usize;
    /// Untangles the state; `None` in a scene without contact. If the stopwatch stops it, the counts say nothing.
    fn untangle(&mut self, stopwatch: &Stopwatch<'_>) -> Option<Untangled>;
    /// The largest depth of a vertex inside a collider, m; `None` without colliders.
    fn penetration(&self) -> Option<f64>;
    /// The colliders, for drawing.
    fn solids(&self) -> Vec<Solid>;
    /// Current positions of the colliders' vertices from the [`origin`](Self::origin), m.
    fn write_solids(&self, out: &mut Vec<[f32; 3]>);
    /// The state that a checkpoint stores.
    fn snapshot(&self) -> Snapshot;
    /// Restores a snapshot; returns false if it does not fit the scene.
    fn restore(&mut self, snapshot: &Snapshot) -> bool;
    /// Gives columns of contact no room, so that they grow as far as steps need.
    fn measure_room(&mut self, is_lean: bool);
    /// The room of the columns of contact, for candidates and for contacts.
    fn room(&self) -> [usize; 2];
    /// The scene as a block of bytes, with room for candidates, contacts and vertices that a host holds.
    fn cook(&self, room: &Room) -> Vec<u8>;
}

/// Bytes of memory that a cooked scene needs, in the precision in which it was cooked; 0 if it is not one.
pub fn required_bytes(block: &[u8]) -> usize {
    let needed = [muslin_core::cooked::required_bytes(block).ok(), muslin_core_f64::cooked::required_bytes(block).ok()];
    needed.into_iter().flatten().next().unwrap_or_default()
}

/// Builds the engine of a scene. Fails with a message for the user if the scene is wrong.
pub fn build(scene: &SceneFile, precision: Precision) -> Result<(Box<dyn Engine>, Timing), String> {
    limits::check(&scene.desc)?;
    let engine: Box<dyn Engine> = match precision {
        Precision::F32 => Box::new(single::build(scene)?),
        Precision::F64 => Box::new(double::build(scene)?),
    };
    let mut positions = Vec::new();
    engine.write_state(&mut positions);
    if positions.as_flattened().iter().any(|&x| !(x as f32).is_finite()) {
        return Err("a start position is beyond single precision; check cloth.position, scale and size".into());
    }
    Ok((engine, scene.desc.timing()))
}

macro_rules! engine {
    ($module:ident, $core:ident) => {
        mod $module {
            use $core::colliders::{Body, ColliderColumns, Form};
            use $core::diagnostics::StateHash;
            use $core::error::SceneError;
            use $core::implicit_contact::multiplier::Multiplier;
            use $core::integrate::IntegratorStatistics;
            use $core::mesh::{Stitch, TriMesh};
            use $core::reactions::{self, Impulse};
            use $core::real::{Real, Vec3, to_f64};
            use $core::response::ContactStatistics;
            use $core::scene::{Content, PointCache, SceneDesc, memory};
            use $core::simulation::{Cause, Simulation, State};
            use $core::spectrum;
            use $core::work_done::WorkDone;

            use std::iter::repeat;

            use super::{
                Counted, Divergence, Engine, Halt, Mode, PinGroup, Report, SceneFile, Snapshot, Solid, Stopwatch,
                Untangled, limits,
            };

            pub fn build(scene: &SceneFile) -> Result<Simulation, String> {
                let desc: SceneDesc = toml::from_str(&scene.text).map_err(|error| error.to_string())?;
                let resources: Vec<_> =
                    scene.resources.iter().map(|(name, file)| (name.clone(), content(file))).collect();
                let needed = memory(&desc, &resources).map_err(|error| error.to_string())?;
                if !limits::has_memory(needed.bytes) {
                    return Err(explain(&desc, needed.into()));
                }
                Simulation::new(&desc, &resources).map_err(|error| explain(&desc, error))
            }

            /// The message of a scene error, with the name of the mesh file that it is about, or the limit on memory.
            fn explain(desc: &SceneDesc, error: SceneError) -> String {
                let file = match error {
                    SceneError::Memory { .. } => return format!("{error}{}", limits::memory_in_words()),
                    SceneError::Mesh { cloth, .. } => &desc.cloth[cloth as usize].mesh,
                    SceneError::ColliderMesh { collider, .. } => &desc.collider[collider as usize].file,
                    _ => &None,
                };
                match file {
                    Some(file) => format!("{error} ({file})"),
                    None => error.to_string(),
                }
            }

            fn content(file: &muslin_core::scene::Content) -> Content {
                match file {
                    muslin_core::scene::Content::Mesh(mesh) => Content::Mesh(TriMesh {
                        positions: mesh.positions.clone(),
                        triangles: mesh.triangles.clone(),
                        uvs: mesh.uvs.clone(),
                        uv_triangles: mesh.uv_triangles.clone(),
                        stitches: mesh
                            .stitches
                            .iter()
                            .map(|s| Stitch { a: s.a, edge: s.edge, weight: s.weight })
                            .collect(),
                    }),
                    muslin_core::scene::Content::Cache(cache) => {
                        Content::Cache(PointCache { points: cache.points, positions: cache.positions.clone() })
                    }
                }
            }

            fn to_single(p: &Vec3) -> [f32; 3] {
                [p.x as f32, p.y as f32, p.z as f32]
            }

            /// A collider for drawing, with those of `triangles` that use its vertices.
            fn solid(body: &Body, triangles: &[[u32; 3]]) -> Solid {
                let [first, count] = body.vertices.map(|number| number as usize);
                let own = || triangles.iter().filter(|t| body.range().contains(&(t[0] as usize))).copied().collect();
                match body.form() {
                    Form::Plane(normal) => Solid::Plane { vertex: first, normal: to_single(&normal) },
                    Form::Sphere | Form::Capsule => {
                        Solid::Round { ends: [first, first + count - 1], radius: body.radius as f32 }
                    }
                    Form::Box => Solid::Faceted(own()),
                    Form::Mesh => Solid::Smooth(own()),
                }
            }

            fn to_bytes(column: &[Vec3]) -> Vec<u8> {
                bytemuck::cast_slice::<Vec3, Real>(column).iter().flat_map(|x| x.to_le_bytes()).collect()
            }

            fn from_bytes(bytes: &[u8]) -> Vec<Vec3> {
                let scalars = bytes.as_chunks().0.iter().map(|&b| Real::from_le_bytes(b));
                let scalars: Vec<Real> = scalars.collect();
                scalars.as_chunks::<3>().0.iter().map(|&v| Vec3::from_array(v)).collect()
            }

            /// The vertices of each contact, then its force.
            fn multipliers_to_bytes(multipliers: &[Multiplier]) -> Vec<u8> {
                let mut bytes = Vec::with_capacity(size_of_val(multipliers));
                for multiplier in multipliers {
                    bytes.extend(multiplier.vertices.iter().flat_map(|v| v.to_le_bytes()));
                    bytes.extend(to_bytes(&[multiplier.force]));
                }
                bytes
            }

            fn multipliers_from_bytes(bytes: &[u8]) -> Vec<Multiplier> {
                let one = |bytes: &[u8; size_of::<Multiplier>()]| {
                    let (vertices, force) = bytes.split_at(size_of::<[u32; 4]>());
                    let vertex = |k: usize| u32::from_le_bytes(vertices.as_chunks().0[k]);
                    Multiplier { vertices: [0, 1, 2, 3].map(vertex), force: from_bytes(force)[0] }
                };
                bytes.as_chunks().0.iter().map(one).collect()
            }

            impl Engine for Simulation {
                fn step(&mut self, stopwatch: &Stopwatch<'_>) -> Result<(), Halt> {
                    Simulation::step(self, stopwatch).map_err(|diverged| {
                        let advice = match diverged.cause {
                            Cause::NotFinite => "take a smaller integrator.step, softer terms or less damping",
                            Cause::TooMuch => {
                                "take a contact.thickness well below the length of the edges, or a smaller \
                                 integrator.step"
                            }
                            Cause::Contact { pinned: true, .. } => {
                                "move the pin on a path clear of that surface, or free the vertex"
                            }
                            Cause::Contact { pinned: false, .. } => {
                                "leave the cloth room between the surfaces that close in on it, slow them down, or \
                                 take a smaller integrator.step"
                            }
                            // The columns of `Simulation` grow as long as there is memory.
                            Cause::Short { .. } => {
                                "there is no memory for so many; take a coarser mesh or a smaller contact.thickness"
                            }
                            // The shortest substeps are committed whatever their error.
                            Cause::Inaccurate | Cause::Fault => "report this as a fault of Muslin, with the scene",
                            Cause::Stopped => return Halt::Stopped,
                        };
                        let is_instability = matches!(diverged.cause, Cause::NotFinite | Cause::TooMuch);
                        let (what, advice) = (diverged.to_string(), Some(advice));
                        Halt::Diverged(Divergence { what, advice, is_instability })
                    })
                }

                fn measure_work(&mut self, from: super::WorkDone) {
                    let super::WorkDone { pins, colliders, wind, gravity, separation, .. } = from;
                    let super::WorkDone { contacts, damping, exchanged, .. } = from;
                    let from = WorkDone { pins, colliders, wind, gravity, separation, contacts, damping, exchanged };
                    Simulation::measure_work(self, from);
                }

                fn work_done(&self) -> super::WorkDone {
                    let WorkDone { pins, colliders, wind, gravity, separation, contacts, damping, exchanged } =
                        Simulation::work_done(self);
                    super::WorkDone { pins, colliders, wind, gravity, separation, contacts, damping, exchanged }
                }

                fn dissipates(&self) -> bool {
                    self.model().dissipates()
                }

                fn measure_reactions(&mut self) {
                    Simulation::measure_reactions(self);
                }

                fn impulses(&self) -> Vec<[f64; 6]> {
                    let columns = self.reactions().into_iter();
                    let sums = columns.flat_map(|columns| columns.pins.iter().chain(&columns.colliders));
                    let words = |Impulse { linear: l, angular: a }: &Impulse| [l.x, l.y, l.z, a.x, a.y, a.z];
                    sums.map(words).collect()
                }

                fn set_impulses(&mut self, impulses: &[[f64; 6]]) {
                    let columns = self.reactions_mut().into_iter();
                    let sums = columns.flat_map(|columns| columns.pins.iter_mut().chain(&mut columns.colliders));
                    for (sum, [x, y, z, angular @ ..]) in sums.zip(impulses.iter().copied().chain(repeat([0.0; 6]))) {
                        *sum = Impulse { linear: [x, y, z].into(), angular: angular.into() };
                    }
                }

                fn pin_groups(&self) -> Vec<PinGroup> {
                    let anchors = &self.scene().pins.anchors;
                    let group = |group: &reactions::PinGroup| {
                        let anchor = anchors.get(group.pins.start).map_or([0.0; 3], |&anchor| to_f64(anchor));
                        PinGroup { cloth: group.cloth, number: group.number, anchor }
                    };
                    self.scene().pin_groups.iter().map(group).collect()
                }

                fn origin(&self) -> [f64; 3] {
                    Simulation::origin(self)
                }

                fn angular_momentum(&self) -> [f64; 3] {
                    Simulation::angular_momentum(self)
                }

                fn rotation(&self) -> [f64; 2] {
                    Simulation::rotation(self)
                }

                fn rounding(&self) -> f64 {
                    Simulation::rounding(self)
                }

                fn write_state(&self, out: &mut Vec<[f64; 3]>) {
                    out.clear();
                    out.extend(self.places_in_world());
                }

                fn measure_room(&mut self, is_lean: bool) {
                    Simulation::measure_room(self, is_lean);
                }

                fn room(&self) -> [usize; 2] {
                    Simulation::room(self)
                }

                fn cook(&self, room: &muslin_core::cooked::Room) -> Vec<u8> {
                    let muslin_core::cooked::Room { pairs, contacts, hands, forces, deforms, impulses, is_lean } =
                        *room;
                    $core::cooked::cook(
                        self,
                        $core::cooked::Room { pairs, contacts, hands, forces, deforms, impulses, is_lean },
                    )
                }

                fn masses(&self) -> Vec<f64> {
                    self.scene().particles.masses.iter().map(|&mass| mass.into()).collect()
                }

                fn triangles(&self) -> &[[u32; 3]] {
                    Simulation::triangles(self)
                }

                fn pins(&self) -> &[u32] {
                    &self.scene().pins.vertices
                }

                fn held(&self) -> Vec<u32> {
                    let pins = &self.scene().pins;
                    let all = pins.vertices.iter().zip(pins.axes.iter());
                    all.filter(|(_, axes)| **axes != 0).map(|(vertex, _)| *vertex).collect()
                }

                fn counted(&self) -> Counted {
                    let ContactStatistics { candidates, proximity, .. } = self.contact_statistics();
                    Counted { streamed_bytes: self.streamed_bytes(), candidates, contacts: proximity }
                }

                fn substeps(&self) -> u64 {
                    self.statistics().committed
                }

                fn estimated_error(&self) -> Option<f64> {
                    self.estimated_error().map(Into::into)
                }

                fn report(&self) -> Report {
                    let (stretch, e, work, contact_statistics) =
                        (self.stretch(), self.energy(), self.statistics(), self.contact_statistics());
                    Report {
                        steps: self.state().steps,
                        time: self.time(),
                        stretch: [stretch.max, stretch.mean],
                        energy: [e.kinetic, e.stretch, e.shear, e.bend, e.seam, e.gravity],
                        momentum: self.momentum(),
                        force_evaluations: work.force_evaluations,
                        cg_iterations: work.cg_iterations,
                        newton_iterations: work.newton_iterations,
                        matrix_products: work.matrix_products,
                        negative_curvature: work.negative_curvature,
                        unconverged: work.unconverged,
                        substeps: [work.committed, work.inaccurate, work.exceeding, work.most_halvings],
                        streamed_bytes: self.streamed_bytes(),
                        contacts: [
                            contact_statistics.candidates,
                            contact_statistics.proximity,
                            contact_statistics.impacts,
                            contact_statistics.zones,
                            contact_statistics.failsafe,
                            contact_statistics.rejected,
                        ],
                    }
                }

                fn largest_stretch(&self) -> f64 {
                    self.stretch().max
                }

                fn fastest(&self) -> f64 {
                    let squares = self.velocities().iter().map(|v| f64::from(v.length_squared()));
                    squares.fold(0.0, f64::max).sqrt()
                }

                fn is_implicit(&self) -> bool {
                    self.scheme().method.is_implicit()
                }

                fn mean_edge(&self) -> f64 {
                    self.scene().mean_edge()
                }

                fn smallest_size(&self) -> f64 {
                    self.scene().smallest_size()
                }

                fn largest_rigidity(&self) -> f64 {
                    self.scene().largest_rigidity
                }

                fn largest_deviation(&self, duration: f64) -> f64 {
                    self.scene().largest_deviation(self.step_length().into(), duration)
                }

                fn last_frame(&self) -> f64 {
                    self.scene().last_frame()
                }

                fn mean_edges(&self) -> Vec<f64> {
                    let scene = self.scene();
                    let own = scene.cloths.iter().map(|cloth| {
                        let edges = scene.edges.iter().zip(&scene.rest_lengths);
                        let lengths = edges.filter(|(edge, _)| cloth.vertices.contains(&edge[0]));
                        let (sum, count) = lengths
                            .fold((0.0, 0_usize), |(sum, count), (_, &length)| (sum + f64::from(length), count + 1));
                        sum / count.max(1) as f64
                    });
                    own.collect()
                }

                fn fastest_modes(&self, tolerance: f64, most: u32, stopwatch: &Stopwatch<'_>) -> [Mode; 2] {
                    let modes = spectrum::fastest_modes(self.scene(), tolerance, most, stopwatch);
                    modes.map(|mode| Mode { stiffness: mode.stiffness, damping: mode.damping })
                }

                fn chain(&self, chain: Option<u64>) -> u64 {
                    let mut hash = chain.map_or_else(StateHash::default, StateHash);
                    hash.add(self.positions(), self.velocities());
                    hash.0
                }

                fn crossings(&self, stopwatch: &Stopwatch<'_>) -> usize {
                    Simulation::crossings(self, stopwatch)
                }

                fn untangle(&mut self, stopwatch: &Stopwatch<'_>) -> Option<Untangled> {
                    self.contact()?;
                    let untangled = Simulation::untangle(self, stopwatch);
                    Some(Untangled {
                        before: untangled.before,
                        after: untangled.after,
                        inside: untangled.inside,
                        rounds: untangled.rounds,
                        moved: untangled.moved.into(),
                    })
                }

                fn penetration(&self) -> Option<f64> {
                    Simulation::penetration(self).map(f64::from)
                }

                fn solids(&self) -> Vec<Solid> {
                    let colliders = self.contact().map(|contact| &contact.colliders);
                    let solids = |c: &ColliderColumns| c.bodies.iter().map(|body| solid(body, &c.triangles)).collect();
                    colliders.map(solids).unwrap_or_default()
                }

                fn write_solids(&self, out: &mut Vec<[f32; 3]>) {
                    out.clear();
                    out.extend(self.collider_positions().iter().map(to_single));
                }

                fn snapshot(&self) -> Snapshot {
                    let (state, w, t) = (self.state(), self.statistics(), self.contact_statistics());
                    Snapshot {
                        steps: state.steps,
                        work: [
                            w.force_evaluations,
                            w.cg_iterations,
                            w.newton_iterations,
                            w.matrix_products,
                            w.negative_curvature,
                            w.unconverged,
                            w.stalled_searches,
                            w.committed,
                            w.inaccurate,
                            w.exceeding,
                            w.most_halvings,
                        ],
                        contacts: [t.candidates, t.proximity, t.impacts, t.zones, t.touching, t.failsafe, t.rejected],
                        columns: [
                            to_bytes(state.positions),
                            to_bytes(state.velocities),
                            to_bytes(state.low[0]),
                            to_bytes(state.low[1]),
                            to_bytes(state.previous[0]),
                            to_bytes(state.previous[1]),
                            multipliers_to_bytes(state.multipliers),
                            to_bytes(state.anchors),
                        ],
                        after_contact: state.after_contact,
                        halvings: state.halvings,
                        last_step: state.last_step.into(),
                    }
                }

                fn restore(&mut self, snapshot: &Snapshot) -> bool {
                    let columns = [0, 1, 2, 3, 4, 5, 7].map(|i| from_bytes(&snapshot.columns[i]));
                    let w = snapshot.work;
                    let work = IntegratorStatistics {
                        force_evaluations: w[0],
                        cg_iterations: w[1],
                        newton_iterations: w[2],
                        matrix_products: w[3],
                        negative_curvature: w[4],
                        unconverged: w[5],
                        stalled_searches: w[6],
                        committed: w[7],
                        inaccurate: w[8],
                        exceeding: w[9],
                        most_halvings: w[10],
                    };
                    let t = snapshot.contacts;
                    let contact_statistics = ContactStatistics {
                        candidates: t[0],
                        proximity: t[1],
                        impacts: t[2],
                        zones: t[3],
                        touching: t[4],
                        failsafe: t[5],
                        rejected: t[6],
                    };
                    let [positions, velocities, low @ .., displacements, velocity_changes, anchors] = &columns;
                    let low = low.each_ref().map(|column| &column[..]);
                    let previous: [&[Vec3]; 2] = [displacements, velocity_changes];
                    let Snapshot { steps, after_contact, halvings, .. } = *snapshot;
                    let last_step = snapshot.last_step as Real;
                    let multipliers = &multipliers_from_bytes(&snapshot.columns[6]);
                    let state = State {
                        steps,
                        origin: self.origin(),
                        positions,
                        velocities,
                        low,
                        previous,
                        last_step,
                        halvings,
                        after_contact,
                        multipliers,
                        anchors,
                    };
                    Simulation::restore(self, &state, work, contact_statistics)
                }
            }
        }
    };
}

engine!(single, muslin_core);
engine!(double, muslin_core_f64);

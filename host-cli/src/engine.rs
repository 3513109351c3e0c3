//! A simulation in either precision behind one trait: the two crates are the same sources, so
//! one macro serves both.

use muslin_core::integrate::stability::Mode;
use muslin_core::scene::Timing;

use crate::args::Precision;
use crate::limits;
use crate::pool::Pool;
use crate::preview::Solid;
use crate::scene_file::SceneFile;
use crate::stopwatch::Stopwatch;

/// Why a step was not taken.
#[derive(Clone, Debug)]
pub enum Halt {
    /// It cannot be.
    Diverged(Divergence),
    /// The stopwatch said so.
    Stopped,
}

/// Why a step cannot be taken.
#[derive(Clone, Debug)]
pub struct Divergence {
    /// What went wrong, in which step and where.
    pub what: String,
    /// What to do about it.
    pub advice: &'static str,
}

/// Edge length over rest length beyond which nothing is whole, unless it starts so: rubber and elastane,
/// which bear the most, break between six and nine times their length.
const FLOWN_APART: f64 = 10.0;

/// Where every number is finite still and yet this is cloth no more: how it is drawn, where it started
/// less so.
pub fn flown_apart(stretch: f64, first: f64) -> Option<String> {
    (stretch > FLOWN_APART * first.max(1.0)).then(|| match stretch {
        endless if endless.is_infinite() => "the length of an edge is beyond every number".to_owned(),
        few if few < 1e4 => format!("an edge is {few:.0} times as long as at rest"),
        many => format!("an edge is {many:.1e} times as long as at rest"),
    })
}

/// Numbers about the state and the work, in double.
#[derive(Clone, Debug, Default)]
pub struct Report {
    /// Steps taken.
    pub steps: u64,
    /// Simulated time, s.
    pub time: f64,
    /// Length over rest length of edges: largest, mean.
    pub stretch: [f64; 2],
    /// kinetic, stretch, shear, bend, seam, gravity; J.
    pub energy: [f64; 6],
    /// kg m/s.
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
    /// Solves ended by their limit of iterations.
    pub unconverged: u64,
    /// Bytes that all of that streams; contact's are not counted.
    pub streamed_bytes: u64,
    /// candidates, proximity, impacts, zones, failsafe, rejected steps.
    pub contacts: [u64; 6],
}

/// IntegratorStatistics that does not depend on the machine, as far as costs are told by it.
#[derive(Clone, Copy, Debug, Default)]
pub struct Counted {
    /// Without those of contact.
    pub streamed_bytes: u64,
    /// Pairs of features whose boxes overlap.
    pub candidates: u64,
    /// Pairs that were near.
    pub contacts: u64,
}

/// What a checkpoint keeps of a simulation, as little-endian bits.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Snapshot {
    /// Steps taken.
    pub steps: u64,
    /// Counters of work, in the order of the core's `IntegratorStatistics`.
    pub work: [u64; 7],
    /// Counters of contact, in the order of the core's `Tally`.
    pub contacts: [u64; 7],
    /// Positions, velocities and, for BDF2, the same one step before.
    pub columns: [Vec<u8>; 4],
    /// Whether contact changed the state.
    pub after_contact: bool,
}

/// What came of a start state in which surfaces pass through one another.
#[derive(Clone, Copy, Debug, Default)]
pub struct Untangled {
    /// Crossings of what can touch, before.
    pub before: usize,
    /// Crossings left.
    pub after: usize,
    /// Vertices of the cloth inside colliders, before and after.
    pub inside: [usize; 2],
    /// Rounds taken.
    pub rounds: u32,
    /// The farthest that a vertex was moved, m.
    pub moved: f64,
}

/// A simulation in some precision.
pub trait Engine: Send {
    /// Takes one step; on divergence the state stays as it was.
    fn step(&mut self, stopwatch: &Stopwatch<'_>) -> Result<(), Halt>;
    /// Positions as exporters take them, m.
    fn write_positions(&self, out: &mut Vec<[f32; 3]>);
    /// Positions in double, m.
    fn write_state(&self, out: &mut Vec<[f64; 3]>);
    /// Of each vertex, kg.
    fn masses(&self) -> Vec<f64>;
    /// Triangles of all cloths.
    fn triangles(&self) -> &[[u32; 3]];
    /// Held vertices.
    fn pins(&self) -> &[u32];
    /// What of its work is told in costs, so far.
    fn counted(&self) -> Counted;
    /// Numbers about the state and the work.
    fn report(&self) -> Report;
    /// The largest length over rest length of an edge.
    fn largest_stretch(&self) -> f64;
    /// Whether its method is implicit.
    fn is_implicit(&self) -> bool;
    /// kg.
    fn mass(&self) -> f64 {
        self.masses().iter().sum()
    }
    /// Mean rest length of all edges, m.
    fn mean_edge(&self) -> f64;
    /// The same of each cloth.
    fn mean_edges(&self) -> Vec<f64>;
    /// The stiffest and the most damped mode as it stands, by so many iterations at most.
    fn fastest_modes(&self, tolerance: f64, most: u32) -> [Mode; 2];
    /// Adds the state to a hash chain and returns the chain.
    fn chain(&self, chain: Option<u64>) -> u64;
    /// Pairs of an edge and a triangle that pass through one another, by the exact test.
    fn crossings(&self, pool: &Pool) -> usize;
    /// Parts what passes through one another; none without contact.
    fn untangle(&mut self, stopwatch: &Stopwatch<'_>) -> Option<Untangled>;
    /// The deepest that a vertex lies in a collider, m; none without colliders.
    fn penetration(&self) -> Option<f64>;
    /// The colliders, to be drawn.
    fn solids(&self) -> Vec<Solid>;
    /// Where the colliders' vertices are now, m.
    fn write_solids(&self, out: &mut Vec<[f32; 3]>);
    /// What a checkpoint keeps.
    fn snapshot(&self) -> Snapshot;
    /// Goes on from a snapshot; false where it does not fit the scene.
    fn restore(&mut self, snapshot: &Snapshot) -> bool;
}

/// Builds a scene's engine; the message says what is wrong with the scene.
pub fn build(scene: &SceneFile, precision: Precision) -> Result<(Box<dyn Engine>, Timing), String> {
    limits::check(&scene.desc)?;
    let engine: Box<dyn Engine> = match precision {
        Precision::F32 => Box::new(single::build(scene)?),
        Precision::F64 => Box::new(double::build(scene)?),
    };
    let mut positions = Vec::new();
    engine.write_positions(&mut positions);
    if positions.as_flattened().iter().any(|x| !x.is_finite()) {
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
            use $core::integrate::IntegratorStatistics;
            use $core::mesh::{Stitch, TriMesh};
            use $core::real::{Real, Vec3, to_f64};
            use $core::response::Tally;
            use $core::scene::{Content, PointCache, SceneDesc};
            use $core::simulation::{Cause, Simulation, State};
            use $core::spectrum;

            use super::{
                Counted, Divergence, Engine, Halt, Mode, Pool, Report, SceneFile, Snapshot, Solid, Stopwatch, Untangled,
            };

            pub fn build(scene: &SceneFile) -> Result<Simulation, String> {
                let desc: SceneDesc = toml::from_str(&scene.text).map_err(|error| error.to_string())?;
                let resources: Vec<_> =
                    scene.resources.iter().map(|(name, file)| (name.clone(), content(file))).collect();
                Simulation::new(&desc, &resources).map_err(|error| explain(&desc, error))
            }

            /// With the file of the mesh in which something is wrong.
            fn explain(desc: &SceneDesc, error: SceneError) -> String {
                let file = match error {
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

            /// A collider and those of all triangles that are over its vertices.
            fn solid(body: &Body, triangles: &[[u32; 3]]) -> Solid {
                let [first, count] = body.vertices;
                let own = || triangles.iter().filter(|t| body.range().contains(&(t[0] as usize))).copied().collect();
                match body.form {
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

            impl Engine for Simulation {
                fn step(&mut self, stopwatch: &Stopwatch<'_>) -> Result<(), Halt> {
                    Simulation::step(self, stopwatch).map_err(|diverged| {
                        let advice = match diverged.cause {
                            Cause::NotFinite if self.scheme().method.is_implicit() => {
                                "take a smaller integrator.step, softer terms or less damping"
                            }
                            Cause::NotFinite => {
                                "take a smaller integrator.step, softer terms, less damping or an implicit method"
                            }
                            Cause::TooMuch if self.scheme().method.is_implicit() => {
                                "take a contact.thickness well below the length of the edges, or a smaller \
                                 integrator.step"
                            }
                            Cause::TooMuch => {
                                "take a contact.thickness well below the length of the edges, a smaller \
                                 integrator.step or an implicit method"
                            }
                            Cause::Contact { pinned: true, .. } => {
                                "move the pin on a path clear of that surface, or free the vertex"
                            }
                            Cause::Contact { pinned: false, .. } => {
                                "leave the cloth room between the surfaces that close in on it, slow them down, or take \
                                 a smaller integrator.step"
                            }
                            Cause::Stopped => return Halt::Stopped,
                        };
                        Halt::Diverged(Divergence { what: diverged.to_string(), advice })
                    })
                }

                fn write_positions(&self, out: &mut Vec<[f32; 3]>) {
                    out.clear();
                    out.extend(self.positions().iter().map(to_single));
                }

                fn write_state(&self, out: &mut Vec<[f64; 3]>) {
                    out.clear();
                    out.extend(self.positions().iter().map(|&x| to_f64(x)));
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

                fn counted(&self) -> Counted {
                    let Tally { candidates, proximity, .. } = self.tally();
                    Counted { streamed_bytes: self.streamed_bytes(), candidates, contacts: proximity }
                }

                fn report(&self) -> Report {
                    let (stretch, e, work, tally) = (self.stretch(), self.energy(), self.statistics(), self.tally());
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
                        streamed_bytes: self.streamed_bytes(),
                        contacts: [
                            tally.candidates,
                            tally.proximity,
                            tally.impacts,
                            tally.zones,
                            tally.failsafe,
                            tally.rejected,
                        ],
                    }
                }

                fn largest_stretch(&self) -> f64 {
                    self.stretch().max
                }

                fn is_implicit(&self) -> bool {
                    self.scheme().method.is_implicit()
                }

                fn mean_edge(&self) -> f64 {
                    let lengths = &self.scene().rest_lengths;
                    lengths.iter().map(|&length| f64::from(length)).sum::<f64>() / lengths.len().max(1) as f64
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

                fn fastest_modes(&self, tolerance: f64, most: u32) -> [Mode; 2] {
                    let modes = spectrum::fastest_modes(self.scene(), tolerance, most);
                    modes.map(|mode| Mode { stiffness: mode.stiffness, damping: mode.damping })
                }

                fn chain(&self, chain: Option<u64>) -> u64 {
                    let mut hash = chain.map_or_else(StateHash::default, StateHash);
                    hash.add(self.positions(), self.velocities());
                    hash.0
                }

                fn crossings(&self, pool: &Pool) -> usize {
                    Simulation::crossings(self, pool)
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
                    let (state, w, t) = (self.state(), self.statistics(), self.tally());
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
                        ],
                        contacts: [t.candidates, t.proximity, t.impacts, t.zones, t.touching, t.failsafe, t.rejected],
                        columns: [state.positions, state.velocities, state.previous[0], state.previous[1]]
                            .map(to_bytes),
                        after_contact: state.after_contact,
                    }
                }

                fn restore(&mut self, snapshot: &Snapshot) -> bool {
                    let columns = [0, 1, 2, 3].map(|i| from_bytes(&snapshot.columns[i]));
                    let w = snapshot.work;
                    let work = IntegratorStatistics {
                        force_evaluations: w[0],
                        cg_iterations: w[1],
                        newton_iterations: w[2],
                        matrix_products: w[3],
                        negative_curvature: w[4],
                        unconverged: w[5],
                        stalled_searches: w[6],
                    };
                    let t = snapshot.contacts;
                    let tally = Tally {
                        candidates: t[0],
                        proximity: t[1],
                        impacts: t[2],
                        zones: t[3],
                        touching: t[4],
                        failsafe: t[5],
                        rejected: t[6],
                    };
                    let [positions, velocities, previous_positions, previous_velocities] = &columns;
                    let previous: [&[Vec3]; 2] = [previous_positions, previous_velocities];
                    let Snapshot { steps, after_contact, .. } = *snapshot;
                    let state = State { steps, positions, velocities, previous, after_contact };
                    Simulation::restore(self, &state, work, tally)
                }
            }
        }
    };
}

engine!(single, muslin_core);
engine!(double, muslin_core_f64);

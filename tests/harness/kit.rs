//! The core in plain doubles, once for each precision: columns for the random elements of
//! [`states`](crate::states), scenes from text, and calls that take and return doubles.

/// Runs the same tests in f32 and in f64: in the body, `muslin` is the core and `kit` the matching module of
/// [`kit`](crate::kit).
#[macro_export]
macro_rules! both_precisions {
    ($($body:tt)*) => {
        pub(crate) mod single {
            use muslin_core as muslin;
            use $crate::kit::single as kit;
            $($body)*
        }
        pub(crate) mod double {
            use muslin_core_f64 as muslin;
            use $crate::kit::double as kit;
            $($body)*
        }
    };
}

macro_rules! kit {
    ($name:ident, $muslin:ident, $doc:literal) => {
        #[doc = $doc]
        pub mod $name {
            use $muslin::contact::{ContactColumns, ContactScratchColumns, Prediction};
            use $muslin::detection;
            use $muslin::dispatch::Serial;
            use $muslin::forces::element::Element;
            use $muslin::forces::hinge::{HingeColumns, Hinges};
            use $muslin::forces::matrix;
            use $muslin::forces::membrane::{MembraneColumns, MembraneMaterial};
            use $muslin::forces::seam::SeamColumns;
            use $muslin::forces::spring::{self, Spring, SpringColumns};
            use $muslin::forces::term::ForceTerm;
            use $muslin::forces::wind::WindColumns;
            use $muslin::forces::{self, Energy, Model, TangentScale};
            use $muslin::integrate::{Jacobian, Method, Scheme};
            use $muslin::mesh::rest::RestTriangle;
            use $muslin::mesh::{Incidence, IncidenceColumns, SurfaceColumns, TriMesh};
            use $muslin::narrow_phase::advance::{ROUNDING, advance};
            use $muslin::narrow_phase::{edge_edge_ccd, vertex_triangle_ccd};
            use $muslin::real::{Mat3, Real, Vec3, to_f64, vec3};
            use $muslin::response::friction::Law;
            use $muslin::response::{self, ContactStatistics, Settings};
            use $muslin::scene::{BuiltScene, Content, Resource, SceneDesc};
            use $muslin::scratch::{Scratch, ScratchColumns};
            use $muslin::simulation::Simulation;
            use $muslin::work_done::WorkDone;

            use std::cell::Cell;

            use glam::{DMat3, DVec3};

            use $crate::dense::Dense;
            use $crate::pieces::{Kept, Piece, Response};
            use $crate::query::{Pair, Query};
            use $crate::states::{Bar, Fold, State, Stitch, Triangle};

            /// Selects the bound for this precision.
            pub const fn bound(single: f64, double: f64) -> f64 {
                if size_of::<Real>() == 4 { single } else { double }
            }

            /// Rounds to this precision.
            pub fn narrow<const K: usize>(v: &[DVec3; K]) -> [Vec3; K] {
                v.map(|v| vec3(v.to_array()))
            }

            /// Converts to double, exactly.
            pub fn wide<const K: usize>(v: &[Vec3; K]) -> [DVec3; K] {
                v.map(|v| to_f64(v).into())
            }

            /// Springs as elements with two corners. Their force comes from the whole kernel.
            pub struct Bars(Vec<(Spring, SpringColumns)>);

            impl Element<2> for Bars {
                type Tangent = Mat3;
                fn vertices(&self) -> &[[u32; 2]] {
                    &[]
                }
                fn incidence(&self) -> Incidence<'_> {
                    Incidence::default()
                }
                fn force(&self, i: usize, x: &[Vec3; 2], v: &[Vec3; 2]) -> [Vec3; 2] {
                    let mut f = [Vec3::ZERO; 2];
                    self.0[i].1.view().add_forces(&[], x.into(), v, &mut [], &mut f, &Serial);
                    f
                }
                fn energy(&self, i: usize, x: &[Vec3; 2]) -> Energy {
                    Energy { stretch: spring::energy(x[1] - x[0], &self.0[i].0), ..Energy::default() }
                }
                fn tangent(&self, i: usize, x: &[Vec3; 2], scale: TangentScale) -> Mat3 {
                    spring::tangent(x[1] - x[0], &self.0[i].0, scale)
                }
                fn block(&self, _: usize, tangent: &Mat3, a: usize, b: usize) -> Mat3 {
                    if a == b { *tangent } else { -*tangent }
                }
                fn exact(&self, i: usize, x: &[Vec3; 2], v: &[Vec3; 2], scale: TangentScale) -> [[Mat3; 2]; 2] {
                    let near = spring::exact(x[1] - x[0], v[1] - v[0], &self.0[i].0, scale);
                    [[near, -near], [-near, near]]
                }
            }

            /// Element `i` is the spring of state `i`; the other terms are numbered in the same way.
            pub fn bars(states: &[State<Bar, 2>]) -> Bars {
                let spring = |s: &State<Bar, 2>| {
                    let Bar { rest, stiffness, damping } = s.part;
                    let spring = Spring { rest: rest as Real, stiffness: stiffness as Real, damping: damping as Real };
                    (spring, SpringColumns::build(2, &[([0, 1], spring)]))
                };
                Bars(states.iter().map(spring).collect())
            }

            /// Triangles, each with its own material.
            pub fn membrane(states: &[State<Triangle, 3>]) -> MembraneColumns {
                let vertices = corners(states.len());
                let rest: Vec<_> = states.iter().map(|s| RestTriangle { corners: s.part.rest }).collect();
                let material = |s: &State<Triangle, 3>| {
                    let ([warp, weft, shear], [stretch, turn]) = (s.part.stiffness, s.part.damping);
                    MembraneMaterial {
                        warp: warp as Real,
                        weft: weft as Real,
                        shear: shear as Real,
                        stretch_damping: stretch as Real,
                        shear_damping: turn as Real,
                    }
                };
                MembraneColumns {
                    incidence: IncidenceColumns::build(3 * states.len(), &vertices),
                    vertices,
                    weights: rest.iter().map(|t| t.weights().map(|w| w as Real)).collect(),
                    areas: rest.iter().map(|t| t.area() as Real).collect(),
                    materials: (0..states.len()).map(|i| u16::try_from(i).expect("few enough materials")).collect(),
                    table: states.iter().map(material).collect(),
                }
            }

            /// Hinges of a bending term.
            pub fn hinges(states: &[State<Fold, 4>]) -> HingeColumns {
                let vertices = corners(states.len());
                let column = |value: fn(&Fold) -> f64| states.iter().map(|s| value(&s.part) as Real).collect();
                HingeColumns {
                    incidence: IncidenceColumns::build(4 * states.len(), &vertices),
                    vertices,
                    stiffness: column(|p| p.stiffness),
                    rest_angles: column(|p| p.rest_angle),
                    least_heights: column(|p| p.least_height),
                    damping: column(|p| p.damping),
                }
            }

            /// Stitches of a seam.
            pub fn seams(states: &[State<Stitch, 3>]) -> SeamColumns {
                let vertices = corners(states.len());
                let column = |value: fn(&Stitch) -> f64| states.iter().map(|s| value(&s.part) as Real).collect();
                SeamColumns {
                    incidence: IncidenceColumns::build(3 * states.len(), &vertices),
                    vertices,
                    weights: column(|p| p.weight),
                    stiffness: column(|p| p.stiffness),
                    damping: column(|p| p.damping),
                }
            }

            /// Triangles exposed to wind.
            pub fn wind<P>(states: &[State<P, 3>], velocity: DVec3, [normal, tangential]: [f64; 2]) -> WindColumns {
                let vertices = corners(states.len());
                WindColumns {
                    incidence: IncidenceColumns::build(3 * states.len(), &vertices),
                    vertices,
                    velocity: vec3(velocity.to_array()),
                    keys: Vec::new(),
                    normal: normal as Real,
                    tangential: tangential as Real,
                }
            }

            fn corners<const K: usize>(count: usize) -> Vec<[u32; K]> {
                (0..count).map(|i| std::array::from_fn(|k| (K * i + k) as u32)).collect()
            }

            /// [`Element::force`].
            pub fn force<const K: usize>(
                term: &impl Element<K>,
                i: usize,
                x: &[DVec3; K],
                v: &[DVec3; K],
            ) -> [DVec3; K] {
                wide(&term.force(i, &narrow(x), &narrow(v)))
            }

            /// [`Element::energy`], J.
            pub fn energy<const K: usize>(term: &impl Element<K>, i: usize, x: &[DVec3; K]) -> f64 {
                term.energy(i, &narrow(x)).total()
            }

            /// [`Hinges::angle`], radians.
            pub fn angle(hinges: &Hinges<'_>, i: usize, x: &[DVec3; 4]) -> f64 {
                f64::from(hinges.angle(i, &narrow(x)))
            }

            /// All blocks of [`Element::tangent`] as a matrix.
            pub fn projected<const K: usize, E: Element<K>>(
                term: &E,
                i: usize,
                x: &[DVec3; K],
                [position, velocity]: [f64; 2],
            ) -> [[DMat3; K]; K] {
                let scale = TangentScale { position: position as Real, velocity: velocity as Real };
                let tangent = term.tangent(i, &narrow(x), scale);
                std::array::from_fn(|a| std::array::from_fn(|b| wide_block(term.block(i, &tangent, a, b))))
            }

            /// [`Element::exact`].
            pub fn exact<const K: usize>(
                term: &impl Element<K>,
                i: usize,
                x: &[DVec3; K],
                v: &[DVec3; K],
                [position, velocity]: [f64; 2],
            ) -> [[DMat3; K]; K] {
                let scale = TangentScale { position: position as Real, velocity: velocity as Real };
                term.exact(i, &narrow(x), &narrow(v), scale).map(|row| row.map(wide_block))
            }

            /// The sum of a model's forces.
            pub fn forces(model: &Model<'_>, masses: &[Real], x: &[DVec3], v: &[DVec3]) -> Vec<DVec3> {
                let column = |v: &[DVec3]| -> Vec<Vec3> { v.iter().map(|v| vec3(v.to_array())).collect() };
                let (mut scratch, mut f) = (vec![Vec3::ZERO; model.force_scratch()], vec![Vec3::ZERO; x.len()]);
                forces::evaluate(model, masses, (&column(x)).into(), &column(v), &mut scratch, &mut f, &Serial);
                f.iter().map(|&f| to_f64(f).into()).collect()
            }

            /// A model's energies, J.
            pub fn energies(model: &Model<'_>, masses: &[Real], x: &[DVec3]) -> Energy {
                let x: Vec<Vec3> = x.iter().map(|x| vec3(x.to_array())).collect();
                forces::energy(model, masses, (&x).into())
            }

            /// The assembled `-(position Kx + velocity Kv)` of the terms of `model`, by rows, determined from
            /// products with unit vectors; `N` is three times the number of vertices.
            pub fn tangents<const N: usize>(
                built: &BuiltScene,
                model: &Model<'_>,
                x: &[DVec3],
                [position, velocity]: [f64; 2],
                jacobian: Jacobian,
            ) -> Dense<N> {
                let x: Vec<Vec3> = x.iter().map(|x| vec3(x.to_array())).collect();
                let scheme = Scheme { jacobian, ..Scheme::fixed(Method::BackwardEuler, 0.1) };
                let mut columns = ScratchColumns::build(built, &scheme);
                let Scratch { assembly_map, tangents, mut matrix, .. } = columns.view();
                let scale = TangentScale { position: position as Real, velocity: velocity as Real };
                forces::write_tangents(model, &x, scale, jacobian, &assembly_map, tangents, &mut matrix, &Serial);
                let (masses, mut product) = (vec![1.0; x.len()], vec![Vec3::ZERO; x.len()]);
                let mut dense = [[0.0; N]; N];
                for column in 0..N {
                    let mut unit = vec![Vec3::ZERO; x.len()];
                    unit[column / 3][column % 3] = 1.0;
                    matrix::multiply(&matrix, &masses, 0.0, &unit, &mut product, &Serial);
                    for row in 0..N {
                        dense[row][column] = to_f64(product[row / 3])[row % 3];
                    }
                }
                dense
            }

            /// Positions at time 0.
            pub fn positions(built: &BuiltScene) -> Vec<DVec3> {
                built.particles.positions.iter().map(|&x| to_f64(x).into()).collect()
            }

            /// A query's coordinates rounded to this precision.
            pub fn rounded(query: &Query) -> Query {
                query.map(|x| wide(&[vec3(x.to_array())])[0])
            }

            /// Distance between two features, given as `[vertex, t0, t1, t2]` or `[a0, a1, b0, b1]`.
            pub fn distance(pair: Pair, x: &[DVec3; 4]) -> f64 {
                let apart = match pair {
                    Pair::VertexTriangle => vertex_triangle_ccd::apart(&narrow(x)),
                    Pair::EdgeEdge => edge_edge_ccd::apart(&narrow(x)),
                };
                DVec3::from(to_f64(apart)).length()
            }

            /// The time of impact.
            pub fn time_of_impact(query: &Query, separation: f64, tolerance: f64) -> Option<f64> {
                let (start, end) = (narrow(&query.start), narrow(&query.end));
                let (separation, tolerance) = (separation as Real, tolerance as Real);
                let time = match query.pair {
                    Pair::VertexTriangle => vertex_triangle_ccd::time_of_impact(&start, &end, separation, tolerance),
                    Pair::EdgeEdge => edge_edge_ccd::time_of_impact(&start, &end, separation, tolerance),
                };
                time.map(f64::from)
            }

            /// Safety distance that a query keeps against rounding, m.
            pub fn reserve(query: &Query) -> f64 {
                f64::from(ROUNDING) * query.size()
            }

            /// Number of distances that the time of impact evaluates.
            pub fn distances(query: &Query, separation: f64, tolerance: f64) -> u32 {
                let (start, end, count) = (narrow(&query.start), narrow(&query.end), Cell::new(0));
                let (separation, tolerance) = (separation as Real, tolerance as Real);
                let counted = |apart: fn(&[Vec3; 4]) -> Vec3| {
                    let count = &count;
                    move |x: &[Vec3; 4]| {
                        count.set(count.get() + 1);
                        apart(x)
                    }
                };
                match query.pair {
                    Pair::VertexTriangle => {
                        advance(1, &start, &end, separation, tolerance, &counted(vertex_triangle_ccd::apart))
                    }
                    Pair::EdgeEdge => advance(2, &start, &end, separation, tolerance, &counted(edge_edge_ccd::apart)),
                };
                count.get()
            }

            /// The response to pieces that move for 1 s; each piece is a cloth of its own.
            pub fn respond(pieces: &[Piece], thickness: f64, friction: f64) -> Response {
                respond_after(pieces, thickness, friction, |_| ())
            }

            /// [`respond`], with `change` applied to the predicted positions before the response.
            pub fn respond_after(
                pieces: &[Piece],
                thickness: f64,
                friction: f64,
                change: impl FnOnce(&mut [Vec3]),
            ) -> Response {
                let settings = Settings { step: 1.0, hold: false };
                respond_with(pieces, thickness, friction, settings, &[], change)
            }

            /// [`respond`] without friction, with vertices that still collide allowed to be held back, and with
            /// some axes of vertices held.
            pub fn respond_at_last(pieces: &[Piece], thickness: f64, held: &[(usize, usize)]) -> Response {
                respond_with(pieces, thickness, 0.0, Settings { step: 1.0, hold: true }, held, |_| ())
            }

            fn respond_with(
                pieces: &[Piece],
                thickness: f64,
                friction: f64,
                settings: Settings,
                held: &[(usize, usize)],
                change: impl FnOnce(&mut [Vec3]),
            ) -> Response {
                let mut contact = ContactColumns {
                    thickness: thickness as Real,
                    continuous: true,
                    laws: vec![Law { at_rest: friction as Real, kinetic: friction as Real, ..Law::default() }],
                    ..ContactColumns::default()
                };
                let (mut from, mut to, mut masses, mut triangles) = (vec![], vec![], vec![], vec![]);
                for piece in pieces {
                    let (first, last) = (from.len() as u32, piece.start.len() as u32 - 1);
                    contact.firsts.push(first);
                    // An isolated point or edge repeats its last vertex.
                    triangles.push([0, 1, 2].map(|k: u32| first + k.min(last)));
                    for ((x, d), mass) in piece.start.iter().zip(&piece.moves).zip(&piece.masses) {
                        from.push(vec3(x.to_array()));
                        to.push(vec3((x + d).to_array()));
                        masses.push(*mass);
                        contact.inverse_masses.push((1.0 / mass) as Real);
                    }
                }
                let count = from.len();
                contact.held = vec![0; count];
                for &(vertex, axis) in held {
                    contact.held[vertex] |= 1 << axis;
                }
                contact.firsts.push(count as u32);
                contact.surface = SurfaceColumns::build(count, &triangles, &[]);
                contact.material = from.clone();
                (contact.radii, contact.law_of) = (vec![0.0; count], vec![0; count]);
                let (model, mut columns) = (contact.view(), ContactScratchColumns::build(&contact.view(), 20_000));
                let (mut scratch, mut contact_statistics) = (columns.view(), ContactStatistics::default());
                detection::place(&model, [0.0, 1.0], &from, &to, &mut scratch);
                detection::sweep(&model, 10.0, &mut scratch);
                detection::detect(&model, &mut scratch, &Serial).expect("nothing stops the search");
                let displacements: Vec<_> = to.iter().zip(&from).map(|(to, from)| *to - *from).collect();
                change(&mut to);
                let prediction = Prediction { positions: &to, displacements: &displacements, low: &[] };
                let outcome =
                    response::respond(&model, &prediction, &mut scratch, settings, &mut contact_statistics, &Serial);
                let wide = |column: &[Vec3]| column.iter().map(|&x| to_f64(x).into()).collect();
                let kept = scratch.constraints.iter().filter(|c| c.contact.normal != Vec3::ZERO).map(|c| Kept {
                    vertices: c.contact.vertices.map(|v| v as usize),
                    weights: c.contact.weights.map(f64::from),
                    normal: to_f64(c.contact.normal).into(),
                    gap: c.contact.gap.into(),
                    target: c.target.into(),
                    impulse: c.normal_impulse.into(),
                    friction: to_f64(c.friction_impulse).into(),
                });
                Response {
                    outcome: outcome
                        .map_or_else(|needed| format!("no room for {needed}"), |outcome| format!("{outcome:?}")),
                    counts: [contact_statistics.proximity, contact_statistics.impacts, contact_statistics.zones],
                    failsafe: contact_statistics.failsafe,
                    start: wide(scratch.start),
                    predicted: wide(&to),
                    end: wide(scratch.end),
                    touched: scratch.response().0.iter().map(|&round| round > 0).collect(),
                    masses,
                    kept: kept.collect(),
                }
            }

            fn wide_block(m: Mat3) -> DMat3 {
                let [x, y, z] = wide(&[m.x_axis, m.y_axis, m.z_axis]);
                DMat3::from_cols(x, y, z)
            }

            /// Parses a scene.
            pub fn scene(text: &str) -> SceneDesc {
                toml::from_str(text).unwrap_or_else(|error| panic!("{error}in scene\n{text}"))
            }

            /// Builds a scene without mesh files.
            pub fn build(text: &str) -> BuiltScene {
                build_with(text, &[])
            }

            /// Builds a scene.
            pub fn build_with(text: &str, resources: &[Resource]) -> BuiltScene {
                let built = $muslin::scene::build(&scene(text), resources);
                built.unwrap_or_else(|error| panic!("{error}: in scene\n{text}"))
            }

            /// A simulation of a scene.
            pub fn simulation(text: &str, resources: &[Resource]) -> Simulation {
                let sim = Simulation::new(&scene(text), resources);
                sim.unwrap_or_else(|error| panic!("{error}: in scene\n{text}"))
            }

            /// Takes steps for a time, s; calls `see` after each step.
            pub fn run(sim: &mut Simulation, seconds: f64, mut see: impl FnMut(&Simulation)) {
                for _ in 0..(seconds / f64::from(sim.step_length())).round() as u32 {
                    sim.take_step().unwrap_or_else(|diverged| panic!("{diverged}"));
                    see(sim);
                }
            }

            /// The impulse of all pins in a time, s, and the one that the change of momentum asks for, kg m/s. Gravity
            /// is 9.81 m/s^2.
            pub fn impulses(text: &str, seconds: f64) -> [glam::DVec3; 2] {
                let mut sim = simulation(text, &[]);
                sim.measure_work(WorkDone::default());
                sim.measure_reactions();
                let before = glam::DVec3::from(sim.momentum());
                run(&mut sim, seconds, |_| ());
                let mass: f64 = sim.scene().particles.masses.iter().copied().map(f64::from).sum();
                let pins = sim.reactions().expect("measured").pins.iter().map(|sum| sum.linear).sum();
                [pins, glam::DVec3::from(sim.momentum()) - before + glam::DVec3::Y * (mass * 9.81 * seconds)]
            }

            /// The mean force on the pins of a [drawn belt](crate::belt::DRAWN) in its last second, N.
            pub fn held(text: &str) -> f64 {
                let mut sim = simulation(text, &[]);
                sim.measure_work(WorkDone::default());
                run(&mut sim, 2.0, |_| ());
                sim.measure_reactions();
                run(&mut sim, 1.0, |_| ());
                sim.reactions().expect("measured").pins[0].linear.length()
            }

            /// A mesh as a resource with the name that the scene uses.
            pub fn resource(name: &str, mesh: crate::belt::Mesh) -> Resource {
                let (positions, uvs, triangles) = (mesh.positions, mesh.uvs, mesh.triangles);
                let uv_triangles = if uvs.is_empty() { Vec::new() } else { triangles.clone() };
                (name.into(), Content::Mesh(TriMesh { positions, uvs, triangles, uv_triangles, ..TriMesh::default() }))
            }

            /// Distance that the last vertex of the first cloth falls between two times (s), m.
            pub fn falls(text: &str, resources: &[Resource], [from, until]: [f64; 2]) -> f64 {
                let mut sim = simulation(text, resources);
                let end = |sim: &Simulation| places(sim, 0).last().expect("the cloth has vertices").y;
                run(&mut sim, from, |_| ());
                let start = end(&sim);
                run(&mut sim, until - from, |_| ());
                start - end(&sim)
            }

            /// Sets the velocity of all vertices of a cloth, m/s.
            pub fn throw(sim: &mut Simulation, cloth: usize, velocity: DVec3) {
                let range = sim.scene().cloths[cloth].vertices.clone();
                sim.state_mut().1[range.start as usize..range.end as usize].fill(vec3(velocity.to_array()));
            }

            /// Positions of the vertices of a cloth, m.
            pub fn places(sim: &Simulation, cloth: usize) -> Vec<DVec3> {
                let range = sim.scene().cloths[cloth].vertices.clone();
                let positions = &sim.positions()[range.start as usize..range.end as usize];
                positions.iter().map(|&x| to_f64(x).into()).collect()
            }

            /// The mean velocity of a cloth, m/s.
            pub fn drift(sim: &Simulation, cloth: usize) -> DVec3 {
                let (masses, velocities) = (&sim.scene().particles.masses, sim.velocities());
                let range = sim.scene().cloths[cloth].vertices.clone();
                let sums = range.map(|v| v as usize).map(|v| {
                    let mass = f64::from(masses[v]);
                    (DVec3::from(to_f64(velocities[v])) * mass, mass)
                });
                let (momentum, mass) = sums.fold((DVec3::ZERO, 0.0), |(p, m), (q, n)| (p + q, m + n));
                momentum / mass
            }

            /// The largest speed of all vertices, m/s.
            pub fn fastest(sim: &Simulation) -> f64 {
                sim.velocities().iter().map(|&v| DVec3::from(to_f64(v)).length()).fold(0.0, f64::max)
            }
        }
    };
}

kit!(single, muslin_core, "The core in f32.");
kit!(double, muslin_core_f64, "The core in f64.");

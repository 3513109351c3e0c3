//! A step needs no allocator: a small spring cloth whose columns are all arrays on the stack is advanced by
//! `step::take`. It passes through the same bits as the owned `Simulation`, in both
//! precisions.
//!
//! Run: `cargo test -p muslin-tests --test borrowed`. A failure names method and step.

use harness::both_precisions;

/// Rows and columns of the sheet; its cells are divided along one diagonal.
const SIDE: usize = 3;
const VERTICES: usize = SIDE * SIDE;
const SPRINGS: usize = 16;
const ENDS: usize = 2 * SPRINGS;
/// Every vertex and every spring has a block of the matrix.
const BLOCKS: usize = VERTICES + SPRINGS;
const STEP: f64 = 0.002;
const STEPS: u32 = 50;

/// Ends of the springs: rows, columns, diagonals.
const fn springs() -> [[u32; 2]; SPRINGS] {
    let mut springs = [[0; 2]; SPRINGS];
    let (mut count, mut vertex) = (0, 0);
    while vertex < VERTICES {
        let (right, down) = (vertex % SIDE + 1 < SIDE, vertex / SIDE + 1 < SIDE);
        let there = [(right, 1), (down, SIDE), (right && down, SIDE + 1)];
        let mut k = 0;
        while k < there.len() {
            if there[k].0 {
                springs[count] = [vertex as u32, (vertex + there[k].1) as u32];
                count += 1;
            }
            k += 1;
        }
        vertex += 1;
    }
    springs
}

both_precisions! {
    use super::{BLOCKS, ENDS, SIDE, SPRINGS, STEP, STEPS, VERTICES, springs};
    use muslin::contact::NoContact;
    use muslin::dispatch::Serial;
    use muslin::forces::gravity::{Gravity, GravityColumns};
    use muslin::forces::spring::{Spring, SpringColumns, Springs};
    use muslin::forces::{Model, ModelColumns, Term};
    use muslin::forces::matrix::{Block, BlockMatrix, Mirrored, NOT_STORED, AssemblyMap};
    use glam::DVec3;
    use muslin::integrate::per_cloth::ClothSolve;
    use muslin::integrate::pins::{AT_REST, Key, Motion, PinColumns, Pins};
    use muslin::integrate::{StepInput, Method, Scheme, IntegratorStatistics};
    use muslin::particles::{ParticleColumns, Particles, PositionsMut};
    use muslin::response::ContactStatistics;
    use muslin::real::{Mat3, Real, Sum, Vec3, vec3};
    use muslin::scene::BuiltScene;
    use muslin::scratch::Scratch;
    use muslin::simulation::Simulation;
    use muslin::step::{self, History, StepContact, Work};

    const GRAVITY: Vec3 = Vec3::new(0.0, -9.81, 0.0);
    const HELD: [u32; 2] = [0, SIDE as u32 - 1];
    const AXES: [u8; 2] = [7, 5];
    /// The first pin is at rest, the second moves.
    const MOTIONS: [u32; 2] = [AT_REST, 0];
    const TABLE: [Motion; 1] = [Motion::new([0, 2], None)];
    const KEYS: [Key; 2] =
        [Key { time: 0.0, value: DVec3::ZERO }, Key { time: 1.0, value: DVec3::new(-0.3, 0.1, 0.2) }];

    fn start() -> [Vec3; VERTICES] {
        std::array::from_fn(|i| vec3([0.1 * (i % SIDE) as f64, 0.01 * (i * i % 5) as f64, 0.1 * (i / SIDE) as f64]))
    }

    fn spring(number: usize) -> Spring {
        // All springs differ, so that a wrong order shows.
        let part = number as Real;
        Spring { rest: 0.09 + 0.002 * part, stiffness: 20.0 + part, damping: 0.01 + 0.001 * part }
    }

    fn mass(vertex: usize) -> Real {
        0.002 + 0.0001 * vertex as Real
    }

    fn scheme(method: Method) -> Scheme {
        Scheme::fixed(method, 1e-4)
    }

    fn owned(method: Method) -> Simulation {
        let listed: Vec<_> = springs().into_iter().enumerate().map(|(k, ends)| (ends, spring(k))).collect();
        let built = BuiltScene {
            particles: ParticleColumns::at_rest(
                start().to_vec(),
                (0..VERTICES).map(mass).collect(),
                (0..VERTICES).map(|i| 1.0 / mass(i)).collect(),
            ),
            model: ModelColumns {
                gravity: Some(GravityColumns::constant(GRAVITY)),
                stretch_springs: Some(SpringColumns::build(VERTICES, &listed)),
                ..ModelColumns::default()
            },
            pins: PinColumns {
                vertices: HELD.to_vec(),
                axes: AXES.to_vec(),
                anchors: HELD.map(|v| start()[v as usize]).to_vec(),
                motions: MOTIONS.to_vec(),
                table: TABLE.to_vec(),
                keys: KEYS.to_vec(),
                ..PinColumns::default()
            },
            ..BuiltScene::default()
        };
        Simulation::from_columns(built, scheme(method), STEP as Real)
    }

    /// The springs at each vertex, in the order of their numbers.
    fn at(vertex: usize) -> impl Iterator<Item = (usize, u32)> {
        let other = move |ends: [u32; 2]| match ends.map(|end| end as usize == vertex) {
            [true, _] => Some(ends[1]),
            [_, true] => Some(ends[0]),
            _ => None,
        };
        springs().into_iter().enumerate().filter_map(move |(k, ends)| other(ends).map(|other| (k, other)))
    }

    /// Takes steps on arrays; calls `see` after every step.
    fn borrowed(method: Method, mut see: impl FnMut(u32, &[Vec3], &[Vec3])) {
        // Springs at each vertex.
        let (mut offsets, mut others, mut numbers) = ([0; VERTICES + 1], [0; ENDS], [0; ENDS]);
        // The matrix: the diagonal and the upper triangle, then the mirrored entries.
        let (mut rows, mut columns, mut targets) = ([0; VERTICES + 1], [0; BLOCKS], [NOT_STORED; ENDS]);
        let (mut mirrored_offsets, mut mirrored) = ([0; VERTICES + 1], [Mirrored { column: 0, block: 0 }; SPRINGS]);
        let (mut end, mut block, mut mirror) = (0, 0, 0);
        for vertex in 0..VERTICES {
            let row = block;
            columns[block] = vertex as u32;
            block += 1;
            for other in vertex + 1..VERTICES {
                if at(vertex).any(|(_, o)| o as usize == other) {
                    columns[block] = other as u32;
                    block += 1;
                }
            }
            for left in 0..vertex {
                let stored = rows[left] as usize..rows[left + 1] as usize;
                if let Some(at) = stored.clone().find(|&at| at > stored.start && columns[at] as usize == vertex) {
                    mirrored[mirror] = Mirrored { column: left as u32, block: at as u32 };
                    mirror += 1;
                }
            }
            for (number, other) in at(vertex) {
                (others[end], numbers[end]) = (other, number);
                if let Some(place) = columns[row..block].iter().position(|&column| column == other) {
                    targets[end] = place as u16;
                }
                end += 1;
            }
            (offsets[vertex + 1], rows[vertex + 1], mirrored_offsets[vertex + 1]) =
                (end as u32, block as u32, mirror as u32);
        }
        let material = numbers.map(spring);
        let (rest, stiffness, damping) =
            (material.map(|s| s.rest), material.map(|s| s.stiffness), material.map(|s| s.damping));
        let stretch = Springs { offsets: &offsets, others: &others, rest: &rest, stiffness: &stiffness, damping: &damping };
        let gravity = Gravity { acceleration: GRAVITY, keys: &[] };
        let model = Model { gravity: Some(gravity), stretch_springs: Some(stretch), ..Model::default() };
        let (masses, anchors): ([Real; VERTICES], _) = (std::array::from_fn(mass), HELD.map(|v| start()[v as usize]));
        let inverse_masses = masses.map(|m| 1.0 / m);
        let pins = Pins {
            vertices: &HELD,
            axes: &AXES,
            anchors: &anchors,
            motions: &MOTIONS,
            table: &TABLE,
            keys: &KEYS,
            ..Pins::default()
        };

        let [mut positions, mut velocities] = [start(), [Vec3::ZERO; VERTICES]];
        let [mut low_positions, mut low_velocities] = [[Vec3::ZERO; VERTICES]; 2];
        pins.set_out(0.0, &mut velocities);
        let mut particles = Particles {
            positions: &mut positions,
            velocities: &mut velocities,
            low_positions: &mut low_positions,
            low_velocities: &mut low_velocities,
            masses: &masses,
            inverse_masses: &inverse_masses,
        };
        let (mut work_columns, mut blocks) = ([[Vec3::ZERO; VERTICES]; 13], [Block::default(); BLOCKS]);
        let (mut inverse_diagonal, mut partials) = ([Mat3::ZERO; VERTICES], [[0.0; 2]; 1]);
        let [forces, next_positions, stage_velocities, displacements, velocity_changes, rounded, low, solution, residual, gradient, direction, products, preconditioned] =
            &mut work_columns;
        let mut assembly_map = AssemblyMap::default();
        assembly_map[Term::StretchSpring as usize] = &targets;
        let mut scratch = Scratch {
            forces,
            next_positions,
            stage_positions: PositionsMut { rounded, low },
            stage_velocities,
            displacements,
            velocity_changes,
            solution,
            residual,
            gradient,
            direction,
            products,
            preconditioned,
            matrix: BlockMatrix {
                offsets: &rows,
                columns: &columns,
                mirrored_offsets: &mirrored_offsets,
                mirrored: &mirrored,
                blocks: &mut blocks,
            },
            assembly_map,
            inverse_diagonal: &mut inverse_diagonal,
            cloths: &mut [ClothSolve::up_to(VERTICES as u32)],
            partials: &mut partials,
            ..Scratch::default()
        };
        let (scheme, mut statistics) = (scheme(method), IntegratorStatistics::default());
        let mut history = History::Start;
        for n in 0..STEPS {
            let context = StepInput {
                model,
                pins: &pins,
                masses: &masses,
                inverse_masses: &inverse_masses,
                time: Sum::from(n) * Sum::from(STEP as Real),
                step: STEP as Real,
                scheme: &scheme,
                follows_contact: false,
                limit: None,
                has_contact: false,
                dispatch: &Serial,
            };
            let work = Work { integrator: &mut statistics, contact: &mut ContactStatistics::default(), searched: &mut 0, done: None };
            let contact = None::<StepContact<'_, NoContact>>;
            let taken = step::take(&context, &mut particles, &mut scratch, contact, &mut history, work);
            assert_eq!(taken, Ok(None), "{} {}, step {n}", muslin::real::NAME, method.name());
            see(n + 1, particles.positions, particles.velocities);
        }
    }

    fn check(method: Method) {
        let mut sim = owned(method);
        let name = format!("{} {}", muslin::real::NAME, method.name());
        borrowed(method, |n, x, v| {
            sim.take_step().expect("finite");
            let same = x == sim.positions() && v == sim.velocities();
            assert!(same, "{name}: over arrays, step {n} gives\n{x:?}\n{v:?}\nowned, it gives\n{:?}\n{:?}", sim.positions(), sim.velocities());
        });
        let moved = sim.positions()[VERTICES - 1].distance(start()[VERTICES - 1]);
        assert!(moved > 0.01, "{name}: the sheet has moved by {moved} m only");
    }

    #[test]
    fn symplectic_euler_over_arrays() {
        check(Method::SymplecticEuler);
    }

    #[test]
    fn backward_euler_over_arrays() {
        check(Method::BackwardEuler);
    }
}

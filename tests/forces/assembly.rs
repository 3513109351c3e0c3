//! A whole model, in f64: the terms add up, the force is -dE/dx, and the assembled Jacobians are the sums of
//! the elements' Jacobians, with all terms present at once.

use glam::{DMat3, DVec3};
use harness::dense::{Dense, add_block, asymmetry, size};
use harness::differences::{gradient, jacobian};
use harness::kit::double as kit;
use harness::rng::Rng;
use harness::worst::{Worst, norm};
use muslin_core_f64::forces::element::Element;
use muslin_core_f64::forces::spring::{self, Spring, SpringColumns, Springs};
use muslin_core_f64::forces::{Model, TangentScale, Term};
use muslin_core_f64::integrate::Jacobian;
use muslin_core_f64::scene::BuiltScene;

/// 13 vertices with membrane, hinges and seams, 9 with springs; cells of 0.3 m.
const VERTICES: usize = 22;
const N: usize = 3 * VERTICES;
const SCENE: &str = r#"
    name = "everything"
    duration = 0
    gravity = [1.0, -9.81, 2.0]
    [[cloth]]
    grid = { size = [0.9, 0.6], cells = [3, 2] }
    density = 0.2
    stretch = { model = "membrane", stiffness = 90.0, weft = 60.0, damping = 0.1 }
    shear = { stiffness = 30.0, damping = 0.2 }
    bend = { model = "hinge", rigidity = 0.3, damping = 0.1 }
    seam = [{ pairs = [[0, 9], [3, 12]], stiffness = 20.0, damping = 0.1 }]
    [[cloth]]
    grid = { size = [0.6, 0.6], cells = [2, 2], pattern = "alternating" }
    density = 0.3
    stretch = { model = "spring", stiffness = 80.0, damping = 0.1 }
    bend = { model = "spring", stiffness = 7.0, damping = 0.2 }
    load = [{ select = { corners = [1, 3] }, force = [1.0, 2.0, -3.0] }]
    [drag]
    linear = 0.7
    wind = { velocity = [3.0, -1.0, 2.0], normal = 0.6, tangential = 0.07 }
"#;
const CELL: f64 = 0.3;
/// Step of the differences: a thousandth of a cell.
const STEP: f64 = 3e-4;

/// The scene, its positions perturbed by up to a quarter of a cell, and random velocities.
fn crumpled() -> (BuiltScene, [DVec3; VERTICES], [DVec3; VERTICES]) {
    let (built, rng) = (kit::build(SCENE), &mut Rng::new(91));
    let x: Vec<_> = kit::positions(&built).iter().map(|&x| x + rng.cube(0.25 * CELL)).collect();
    (built, x.try_into().expect("as many vertices"), std::array::from_fn(|_| rng.cube(CELL)))
}

fn forces(built: &BuiltScene, model: &Model<'_>, x: &[DVec3], v: &[DVec3]) -> [DVec3; VERTICES] {
    kit::forces(model, &built.particles.masses, x, v).try_into().expect("a force a vertex")
}

#[test]
fn every_term_pulls_alone_and_they_add_up() {
    let (built, x, v) = crumpled();
    let (model, mut sum) = (built.model.view(), [DVec3::ZERO; VERTICES]);
    for term in Term::ALL {
        let alone = model.only(term).unwrap_or_else(|| panic!("the model has no {}", term.name()));
        let part = forces(&built, &alone, &x, &v);
        assert!(norm(&part) > 0.0, "{} pulls nowhere", term.name());
        sum = std::array::from_fn(|i| sum[i] + part[i]);
    }
    let mut worst = Worst::new("all forces against the sum of the terms", 1e-14);
    worst.vectors(norm(&sum), &forces(&built, &model, &x, &v), &sum, || "vector a vertex".into());
    worst.check();
}

#[test]
fn gravity_is_mass_times_g_and_drag_proportional_to_area() {
    let (built, x, v) = crumpled();
    let model = built.model.view();
    let gravity = forces(&built, &model.only(Term::Gravity).expect("gravity"), &x, &v);
    let drag = forces(&built, &model.only(Term::Drag).expect("drag"), &x, &v);
    let mut worst = Worst::new("gravity and drag against their formulas", 1e-14);
    for (i, &mass) in built.particles.masses.iter().enumerate() {
        let density = if i < 13 { 0.2 } else { 0.3 };
        let want = [DVec3::new(1.0, -9.81, 2.0) * mass, v[i] * (-0.7 * mass / density)];
        worst.vectors(norm(&want), &[gravity[i], drag[i]], &want, || format!("vertex {i}"));
    }
    worst.check();
}

/// The factor is in seconds. The membrane's damping is stored per material; [`dissipation`](super::dissipation)
/// compares it with its definition.
#[test]
fn damping_is_proportional_to_stiffness() {
    let built = kit::build(SCENE);
    let model = built.model.view();
    let (stretch, bend) = (model.stretch_springs.expect("springs"), model.bend_springs.expect("springs"));
    let (hinges, seams) = (model.hinges.expect("hinges"), model.seams.expect("seams"));
    let mut worst = Worst::new("damping against seconds times stiffness", 1e-15);
    for (what, seconds, stiffness, damping) in [
        ("stretch springs", 0.1, stretch.stiffness, stretch.damping),
        ("bending springs", 0.2, bend.stiffness, bend.damping),
        ("hinges", 0.1, hinges.stiffness, hinges.damping),
        ("seams", 0.1, seams.stiffness, seams.damping),
    ] {
        let want: Vec<_> = stiffness.iter().map(|stiffness| seconds * stiffness).collect();
        worst.compare(want[0], damping, &want, || what.into());
    }
    worst.check();
}

#[test]
fn forces_of_a_model_are_the_slope_of_its_energy() {
    let (built, x, _) = crumpled();
    let model = Model { wind: None, ..built.model.view() };
    let force = forces(&built, &model, &x, &[DVec3::ZERO; VERTICES]);
    let slope = gradient(&x, STEP, |x| -kit::energies(&model, &built.particles.masses, x).total());
    let mut worst = Worst::new("a model's force against -dE/dx", 1e-7);
    worst.vectors(norm(&slope), &force, &slope, || "vector a vertex".into());
    worst.check();
}

/// df/dx is taken at zero velocity, where an assembled Jacobian is symmetric; wind enters only through df/dv.
#[test]
fn exact_jacobian_of_a_model_is_the_slope_of_its_force() {
    let (built, x, v) = crumpled();
    let model = built.model.view();
    let still = Model { wind: None, ..model };
    let negated = |f: [DVec3; VERTICES]| f.map(|f| -f);
    let mut worst = Worst::new("a model's Jacobian against -df/dx, -df/dv", 1e-6);
    let got: Dense<N> = kit::tangents(&built, &still, &x, [1.0, 0.0], Jacobian::Exact);
    let want: Dense<N> = jacobian(&x, STEP, |x| negated(forces(&built, &still, x, &[DVec3::ZERO; VERTICES])));
    worst.compare(size(&want), got.as_flattened(), want.as_flattened(), || format!("df/dx by rows of {N}"));
    assert!(asymmetry(&got) <= 1e-14 * size(&got), "df/dx is not symmetric: {:e}", asymmetry(&got));
    let got: Dense<N> = kit::tangents(&built, &model, &x, [0.0, 1.0], Jacobian::Exact);
    let want: Dense<N> = jacobian(&v, CELL, |v| negated(forces(&built, &model, &x, v)));
    worst.compare(size(&want), got.as_flattened(), want.as_flattened(), || format!("df/dv by rows of {N}"));
    worst.check();
}

/// Adds each element's projected blocks at the rows and columns of its corners.
fn scatter<const K: usize>(m: &mut Dense<N>, term: &impl Element<K>, x: &[DVec3], scale: [f64; 2]) {
    for (i, corners) in term.vertices().iter().enumerate() {
        let blocks = kit::projected(term, i, &corners.map(|c| x[c as usize]), scale);
        for (a, &row) in corners.iter().enumerate() {
            for (b, &column) in corners.iter().enumerate() {
                add_block(m, row as usize, column as usize, &blocks[a][b]);
            }
        }
    }
}

fn scatter_springs(m: &mut Dense<N>, springs: &Springs<'_>, x: &[DVec3], scale: TangentScale) {
    for near in 0..VERTICES {
        for at in springs.offsets[near] as usize..springs.offsets[near + 1] as usize {
            let far = springs.others[at] as usize;
            let (rest, stiffness, damping) = (springs.rest[at], springs.stiffness[at], springs.damping[at]);
            let block = spring::tangent(x[far] - x[near], &Spring { rest, stiffness, damping }, scale);
            add_block(m, near, near, &block);
            add_block(m, near, far, &-block);
        }
    }
}

#[test]
fn projected_jacobian_of_a_model_is_the_sum_of_its_elements() {
    let (built, x, _) = crumpled();
    let model = built.model.view();
    let (position, velocity) = (0.04, 0.2);
    let mut want = [[0.0; N]; N];
    for (i, drag) in model.drag.expect("drag").coefficients.iter().enumerate() {
        add_block(&mut want, i, i, &DMat3::from_diagonal(DVec3::splat(velocity * drag)));
    }
    scatter_springs(&mut want, &model.stretch_springs.expect("springs"), &x, TangentScale { position, velocity });
    scatter_springs(&mut want, &model.bend_springs.expect("springs"), &x, TangentScale { position, velocity });
    scatter(&mut want, &model.membrane.expect("membrane"), &x, [position, velocity]);
    scatter(&mut want, &model.hinges.expect("hinges"), &x, [position, velocity]);
    scatter(&mut want, &model.seams.expect("seams"), &x, [position, velocity]);
    scatter(&mut want, &model.wind.expect("wind"), &x, [position, velocity]);
    let got: Dense<N> = kit::tangents(&built, &model, &x, [position, velocity], Jacobian::Projected);
    let mut worst = Worst::new("a model's projected Jacobian against its elements'", 1e-14);
    worst.compare(size(&want), got.as_flattened(), want.as_flattened(), || format!("by rows of {N}"));
    worst.check();
}

/// Kernels compute springs in groups: tests hubs with numbers of springs around every possible group size.
#[test]
fn spring_forces_do_not_depend_on_how_many_meet() {
    let (rng, mut worst) = (&mut Rng::new(92), Worst::new("spring forces against one spring at a time", 1e-13));
    for hub in (0..20).chain([31, 32, 33, 127, 128, 129, 1000]) {
        let count = hub + 40;
        let x: Vec<_> = (0..count).map(|_| rng.cube(1.0)).collect();
        let v: Vec<_> = (0..count).map(|_| rng.cube(1.0)).collect();
        // Vertex 20 is the hub of a ring. The last vertex has no springs.
        let ring = (0..count as u32 - 1).map(|i| [i, (i + 1) % (count as u32 - 1)]);
        let spokes = (0..hub as u32).map(|i| [20, 22 + i]).filter(|[_, far]| *far < count as u32 - 1);
        let mut spring = || Spring { rest: rng.between(0.5, 1.5), stiffness: rng.magnitude(1.0, 100.0), damping: 0.3 };
        let springs: Vec<_> = ring.chain(spokes).map(|ends| (ends, spring())).collect();
        let mut want = vec![DVec3::ZERO; count];
        for ([near, far], spring) in springs.iter().map(|(ends, spring)| (ends.map(|i| i as usize), spring)) {
            let (d, w) = (x[far] - x[near], v[far] - v[near]);
            let (u, r) = (d.normalize(), d.length());
            let force = u * (spring.stiffness * (r - spring.rest) + spring.damping * w.dot(u));
            want[near] += force;
            want[far] -= force;
        }
        let columns = SpringColumns::build(count, &springs);
        let model = Model { stretch_springs: Some(columns.view()), ..Model::default() };
        let got = kit::forces(&model, &vec![1.0; count], &x, &v);
        worst.vectors(norm(&want), &got, &want, || format!("hub of {hub}"));
    }
    worst.check();
}

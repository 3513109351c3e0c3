//! A crumpled sheet in motion: distances and times of its candidates, checked in double precision.

use glam::DVec3;
use harness::crumpled;
use harness::kit::double::distance;
use harness::query::{Pair, Query};
use harness::rng::Rng;
use muslin_core::dispatch::Serial;
use muslin_core::geometry::aabb::Aabb;
use muslin_core::mesh::SurfaceColumns;
use muslin_core::narrow_phase::continuous::{LinearMotion, times};
use muslin_core::narrow_phase::time_of_impact::{StoredTime, TimeOfImpact};
use muslin_core::narrow_phase::{EdgeEdge, VertexTriangle};
use muslin_gpu::{DetectionQuery, DetectionResult, Detector, shaders};

use super::methods::{columns, gpu};
use harness::case::{Case, single};

/// Separation that features keep, m, and the search distance.
const SEPARATION: f64 = 0.05;
const REACH: f64 = 0.5;

/// Radii of the vertices, assigned cyclically, m.
const RADII: [f64; 4] = [0.0625, 0.03125, 0.09375, 0.0];

fn radius(vertex: u32) -> f64 {
    RADII[vertex as usize % RADII.len()]
}

/// Largest rounding error of a distance: proportional to the size of the pair.
fn rounding(query: &Query) -> f64 {
    let stage = match query.pair {
        Pair::VertexTriangle => &shaders::VERTEX_TRIANGLE,
        Pair::EdgeEdge => &shaders::EDGE_EDGE,
    };
    f64::from(stage.bound) * query.size()
}

/// Number of intervals at whose ends a motion is sampled.
const MOMENTS: u32 = 64;

struct Scene {
    start: Vec<DVec3>,
    end: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
    edges: Vec<[u32; 2]>,
    surface: SurfaceColumns,
    found: DetectionResult,
}

fn scene(query: DetectionQuery) -> Option<Scene> {
    let gpu = gpu()?;
    let (mesh, rng) = (crumpled::sheet(24), &mut Rng::new(11));
    let start: Vec<_> = mesh.positions.iter().map(|&x| single(x)).collect();
    let end: Vec<_> = start.iter().map(|&x| single(x + rng.cube(0.5))).collect();
    let (_, surface) = columns(&Case::new("", &start, &mesh.triangles, 0.0));
    let [from, to] = [&start, &end].map(|x| x.iter().map(|x| x.as_vec3()).collect::<Vec<_>>());
    let around = |(a, b): (&glam::Vec3, &glam::Vec3)| Aabb { min: a.min(*b) - 0.25, max: a.max(*b) + 0.25 };
    let boxes: Vec<_> = from.iter().zip(&to).map(around).collect();
    let radii: Vec<_> = (0..boxes.len() as u32).map(|vertex| radius(vertex) as f32).collect();
    let mut detector = Detector::new(gpu, &surface.view(), &radii, query).unwrap();
    detector.set_distances(gpu, REACH as f32, SEPARATION as f32);
    let mut found = DetectionResult::default();
    pollster::block_on(detector.detect(gpu, &boxes, &from, &to, &mut found)).unwrap();
    let edges = surface.view().edges.to_vec();
    Some(Scene { start, end, triangles: mesh.triangles, edges, surface, found })
}

/// A candidate with its results.
struct Reported {
    query: Query,
    /// Sum of the radii of both features, m.
    around: f64,
    /// The distance that the device reports.
    distance: f64,
    time: TimeOfImpact,
}

impl Reported {
    /// Distance of the features minus their radii, m.
    fn gap(&self, x: &[DVec3; 4]) -> f64 {
        distance(self.query.pair, x) - self.around
    }

    fn rounding(&self) -> f64 {
        rounding(&self.query)
    }
}

impl Scene {
    fn reported(&self, pair: Pair, candidate: [u32; 2], distance: f32, time: TimeOfImpact) -> Reported {
        let (query, r) = self.query(pair, candidate);
        let around = match pair {
            Pair::VertexTriangle => r[0] + r[1].max(r[2]).max(r[3]),
            Pair::EdgeEdge => r[0].max(r[1]) + r[2].max(r[3]),
        };
        Reported { query, around, distance: distance.into(), time }
    }

    /// A candidate's motion and the radii of its vertices.
    fn query(&self, pair: Pair, [a, b]: [u32; 2]) -> (Query, [f64; 4]) {
        let vertices = match pair {
            Pair::VertexTriangle => {
                let [x, y, z] = self.triangles[b as usize];
                [a, x, y, z]
            }
            Pair::EdgeEdge => {
                let ([x, y], [z, w]) = (self.edges[a as usize], self.edges[b as usize]);
                [x, y, z, w]
            }
        };
        let at = |x: &[DVec3]| vertices.map(|v| x[v as usize]);
        (Query { pair, start: at(&self.start), end: at(&self.end) }, vertices.map(radius))
    }

    /// The core's times for the same candidates and distances, in the same order.
    fn times_of_the_core(&self) -> Vec<StoredTime> {
        let [start, end] = [&self.start, &self.end].map(|x| x.iter().map(|x| x.as_vec3()).collect::<Vec<_>>());
        let radii: Vec<_> = (0..start.len() as u32).map(|vertex| radius(vertex) as f32).collect();
        let motion = LinearMotion { start: &start, end: &end, radii: &radii, rounds: &[], round: 0 };
        let DetectionResult { vertex_triangle, edge_edge, vertex_triangle_distances, edge_edge_distances, .. } =
            &self.found;
        let (surface, keeps) = (self.surface.view(), SEPARATION as f32);
        let [mut faces, mut edges] =
            [vertex_triangle, edge_edge].map(|all| vec![TimeOfImpact::At(f32::NAN).into(); all.len()]);
        let distances = [vertex_triangle_distances, edge_edge_distances];
        times::<VertexTriangle>(vertex_triangle, distances[0], &surface, motion, keeps, &mut faces, &Serial);
        times::<EdgeEdge>(edge_edge, distances[1], &surface, motion, keeps, &mut edges, &Serial);
        faces.extend(edges);
        faces
    }

    /// Candidates of both kinds with their distances and times.
    fn reports(&self) -> impl Iterator<Item = Reported> {
        let DetectionResult { vertex_triangle, edge_edge, .. } = &self.found;
        let of = |pair, candidates: &'_ [[u32; 2]], distances: &'_ [f32], times: &'_ [StoredTime]| {
            let all = candidates.iter().zip(distances).zip(times);
            all.map(|((&c, &d), &t)| self.reported(pair, c, d, t.into())).collect::<Vec<_>>()
        };
        let found = &self.found;
        let faces =
            of(Pair::VertexTriangle, vertex_triangle, &found.vertex_triangle_distances, &found.vertex_triangle_times);
        let edges = of(Pair::EdgeEdge, edge_edge, &found.edge_edge_distances, &found.edge_edge_times);
        faces.into_iter().chain(edges)
    }
}

#[test]
#[ignore = "takes a graphics driver"]
fn distances_are_right_to_rounding() {
    let Some(scene) = scene(DetectionQuery::Times) else { return };
    let mut near = 0;
    for reported in scene.reports() {
        let Reported { query, distance, .. } = &reported;
        let (exact, rounding, distance) = (reported.gap(&query.start), reported.rounding(), *distance);
        match distance > REACH {
            true => assert!(distance <= exact + rounding, "a bound of {distance} for {exact}: {query}"),
            false => assert!((distance - exact).abs() <= rounding, "{distance} for {exact}: {query}"),
        }
        near += usize::from(distance <= REACH);
    }
    assert!(near > 1000, "only {near} within reach");
}

#[test]
#[ignore = "takes a graphics driver"]
fn contacts_are_what_is_near_but_for_a_band() {
    let (Some(all), Some(near)) = (scene(DetectionQuery::Times), scene(DetectionQuery::Contacts)) else { return };
    assert_eq!(all.found.candidates, near.found.candidates);
    let [mut inside, mut in_band] = [0, 0];
    for (pair, candidates, contacts) in [
        (Pair::VertexTriangle, &all.found.vertex_triangle, &near.found.vertex_triangle),
        (Pair::EdgeEdge, &all.found.edge_edge, &near.found.edge_edge),
    ] {
        let mut left = contacts.iter().peekable();
        for &candidate in candidates {
            let reported = all.reported(pair, candidate, 0.0, TimeOfImpact::Never);
            let (query, band) = (&reported.query, reported.rounding());
            let exact = reported.gap(&query.start);
            let is_contact = left.next_if(|&&contact| contact == candidate).is_some();
            if (exact - REACH).abs() <= band {
                in_band += 1;
                continue;
            }
            assert_eq!(is_contact, exact < REACH, "{exact} apart: {query}");
            inside += usize::from(is_contact);
        }
        assert_eq!(left.next(), None, "a contact that is no candidate, or in another order");
    }
    println!("{inside} contacts, {in_band} at the threshold");
    assert!(inside > 1000 && in_band < inside / 100, "{inside} contacts, {in_band} at the threshold");
}

/// How much of the motion is free of impacts.
fn until(time: TimeOfImpact) -> f64 {
    match time {
        TimeOfImpact::Never => 1.0,
        TimeOfImpact::At(time) => time.into(),
        TimeOfImpact::Touching => 0.0,
    }
}

#[test]
#[ignore = "takes a graphics driver"]
fn times_are_never_late_and_not_needlessly_early() {
    let Some(scene) = scene(DetectionQuery::Times) else { return };
    let (mut hits, mut misses) = (0, 0);
    for reported in scene.reports() {
        let Reported { ref query, distance, time, .. } = reported;
        let apart = |t: f64| reported.gap(&query.at(t));
        let keeps = SEPARATION.min(0.5 * distance);
        if time == TimeOfImpact::Touching {
            assert!(distance <= 1e-3 * SEPARATION, "{distance} apart are said to touch: {query}");
            continue;
        }
        let until = until(time);
        let moments = (0..=MOMENTS).map(|i| apart(until * f64::from(i) / f64::from(MOMENTS)));
        let least = moments.fold(f64::INFINITY, f64::min);
        let rounding = reported.rounding();
        assert!(least >= keeps - rounding, "{least} apart before {until}, to keep {keeps}: {query}");
        if time == TimeOfImpact::Never {
            misses += 1;
        } else {
            hits += 1;
            let most = 1.5 * keeps + rounding;
            assert!(apart(until) <= most, "{} apart at {until}, at most {most}: {query}", apart(until));
        }
    }
    println!("{hits} meet, {misses} do not");
    assert!(hits > 100 && misses > 1000, "{hits} meet, {misses} do not");
}

/// The times may differ if features come so close that one implementation reports a collision and the other
/// does not, or if both report it at different times within that band.
#[test]
#[ignore = "takes a graphics driver"]
fn times_are_the_core_s_but_for_a_band() {
    let Some(scene) = scene(DetectionQuery::Times) else { return };
    let (mut alike, mut in_band, mut nearly_touching) = (0, 0, 0);
    for (reported, core) in scene.reports().zip(scene.times_of_the_core()) {
        let core = TimeOfImpact::from(core);
        let Reported { ref query, distance, time, .. } = reported;
        let keeps = SEPARATION.min(0.5 * distance);
        let told = format!("{time:?}, by the core {core:?}");
        let touch = [time, core].map(|time| time == TimeOfImpact::Touching);
        assert_eq!(touch[0], touch[1], "{told}, {distance} apart: {query}");
        nearly_touching += usize::from(distance > 1e-3 * SEPARATION && distance < 0.1 * SEPARATION);
        let bound = shaders::EDGE_EDGE_CCD.bound.max(shaders::VERTEX_TRIANGLE_CCD.bound);
        let is_alike = match (time, core) {
            (TimeOfImpact::At(time), TimeOfImpact::At(core)) => (time - core).abs() <= bound,
            _ => time == core,
        };
        if is_alike {
            alike += 1;
            continue;
        }
        let apart = [time, core].map(|time| reported.gap(&query.at(until(time))));
        let most = 1.5 * keeps + reported.rounding();
        assert!(apart.into_iter().any(|d| d <= most), "{told}, {apart:?} apart: {query}");
        in_band += 1;
    }
    println!("{alike} alike, {in_band} within the band, {nearly_touching} nearly touching");
    assert!(in_band < alike / 1000 && nearly_touching > 0, "{in_band} of {alike}, {nearly_touching} nearly touching");
}

//! The broad phase on crumpled sheets of ten thousand to a million triangles: how its time grows.

use std::time::Instant;

use muslin_core::broad_phase::{self, Candidates, GridColumns};
use muslin_core::geometry::aabb::Aabb;
use muslin_core::mesh::SurfaceColumns;
use muslin_core::real::Vec3;
use serde::Serialize;

use super::crumpled;
use crate::pool::Pool;

/// Cells along each side of the sheets.
const CELLS: [usize; 3] = [71, 224, 707];
/// Thicknesses, in edge lengths of the mesh.
const THICKNESSES: [f32; 2] = [0.05, 0.25];
/// Number of runs; the median time is reported.
const RUNS: usize = 7;

/// One sheet at one thickness.
#[derive(Serialize)]
pub struct Row {
    triangles: usize,
    thickness_edges: f32,
    ms: f64,
    vertex_triangle: usize,
    edge_edge: usize,
    candidates_per_s: f64,
    /// The exponent p if the time grows as triangles^p from the next smaller sheet to this one.
    growth: Option<f64>,
}

/// Measures all sheets.
pub fn measure(pool: &Pool) -> Vec<Row> {
    let mut rows: Vec<Row> = Vec::new();
    for thickness in THICKNESSES {
        for cells in CELLS {
            let mut row = row(cells, thickness, pool);
            let before = rows.last().filter(|row| row.thickness_edges == thickness);
            row.growth = before.map(|b| (row.ms / b.ms).ln() / (row.triangles as f64 / b.triangles as f64).ln());
            rows.push(row);
        }
    }
    rows
}

fn row(cells: usize, thickness: f32, pool: &Pool) -> Row {
    let mesh = crumpled::sheet(cells);
    let around = |x: Vec3| Aabb { min: x - 0.5 * thickness, max: x + 0.5 * thickness };
    let boxes: Vec<_> = mesh.positions.iter().map(|x| around(x.as_vec3())).collect();
    let surface = SurfaceColumns::build(boxes.len(), &mesh.triangles, &[]);
    let surface = surface.view();
    let mut work = GridColumns::build(boxes.len(), surface.triangles.len());
    let counts = broad_phase::candidates(&boxes, &surface, &mut work.view(), None, &mut Candidates::default(), pool)
        .expect("a pool does not stop a search");
    let mut vertex_triangle = vec![[u32::MAX; 2]; counts.vertex_triangle];
    let mut edge_edge = vec![[u32::MAX; 2]; counts.edge_edge];
    let run = |_| {
        let out = &mut Candidates { vertex_triangle: &mut vertex_triangle, edge_edge: &mut edge_edge };
        let started = Instant::now();
        broad_phase::candidates(&boxes, &surface, &mut work.view(), None, out, pool);
        started.elapsed().as_secs_f64()
    };
    let mut times: Vec<f64> = (0..RUNS).map(run).collect();
    times.sort_by(f64::total_cmp);
    let seconds = times[RUNS / 2];
    Row {
        triangles: mesh.triangles.len(),
        thickness_edges: thickness,
        ms: 1e3 * seconds,
        vertex_triangle: counts.vertex_triangle,
        edge_edge: counts.edge_edge,
        candidates_per_s: (counts.vertex_triangle + counts.edge_edge) as f64 / seconds,
        growth: None,
    }
}

/// The rows as a table for a person.
pub fn table(rows: &[Row]) -> String {
    let mut text = format!(
        "\ncrumpled sheets: candidates by the broad phase only\n{:>10}{:>11}{:>11}{:>16}{:>12}{:>14}{:>9}\n",
        "triangles", "thickness", "ms", "vertex-triangle", "edge-edge", "candidates/s", "growth"
    );
    for row in rows {
        let growth = row.growth.map(|power| format!("n^{power:.2}")).unwrap_or_default();
        text += &format!(
            "{:>10}{:>9.0} %{:>11.2}{:>16}{:>12}{:>14.3e}{growth:>9}\n",
            row.triangles,
            1e2 * row.thickness_edges,
            row.ms,
            row.vertex_triangle,
            row.edge_edge,
            row.candidates_per_s,
        );
    }
    text
}

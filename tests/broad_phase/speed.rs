//! Speed on one thread: candidates of crumpled sheets, in f32. If `MUSLIN_MESHES` is set to a folder, the
//! meshes are written there as OBJ files, so that other software can be measured.

use std::fmt::Write as _;
use std::time::Instant;

use harness::crumpled;
use muslin_core::broad_phase::{self, Candidates, GridColumns};
use muslin_core::dispatch::Serial;

use super::methods::single;
use harness::case::Case;

const RUNS: usize = 15;

#[test]
#[ignore = "a command of its own, for a quiet machine"]
fn long_form_how_fast() {
    println!("triangles  thickness  median ms   least ms  ns/triangle  vertex-triangle   edge-edge");
    for cells in [71, 100, 224, 387, 707] {
        let mesh = crumpled::sheet(cells);
        if let Ok(folder) = std::env::var("MUSLIN_MESHES") {
            let mut text = String::new();
            mesh.positions.iter().for_each(|x| writeln!(text, "v {} {} {}", x.x, x.y, x.z).expect("memory"));
            mesh.triangles
                .iter()
                .for_each(|[a, b, c]| writeln!(text, "f {} {} {}", a + 1, b + 1, c + 1).expect("memory"));
            std::fs::write(format!("{folder}/crumpled-{cells}.obj"), text).expect("a folder");
        }
        for thickness in [0.05, 0.25] {
            let case = Case::new("crumpled", &mesh.positions, &mesh.triangles, thickness / 2.0);
            let (boxes, surface) = single::columns(&case);
            let mut work = GridColumns::build(boxes.len(), surface.triangles.len());
            let surface = surface.view();
            let counts =
                broad_phase::candidates(&boxes, &surface, &mut work.view(), None, &mut Candidates::default(), &Serial)
                    .expect("nothing stops the search");
            let mut vertex_triangle = vec![[0; 2]; counts.vertex_triangle];
            let mut edge_edge = vec![[0; 2]; counts.edge_edge];
            let mut times: Vec<_> = (0..RUNS)
                .map(|_| {
                    let out = &mut Candidates { vertex_triangle: &mut vertex_triangle, edge_edge: &mut edge_edge };
                    let started = Instant::now();
                    broad_phase::candidates(&boxes, &surface, &mut work.view(), None, out, &Serial);
                    started.elapsed().as_secs_f64()
                })
                .collect();
            times.sort_by(f64::total_cmp);
            let (count, median) = (surface.triangles.len(), times[RUNS / 2]);
            println!(
                "{count:9}  {:8.0} %  {:9.2}  {:9.2}  {:11.0}  {:15}  {:10}",
                100.0 * thickness,
                1e3 * median,
                1e3 * times[0],
                1e9 * median / count as f64,
                counts.vertex_triangle,
                counts.edge_edge
            );
        }
    }
}

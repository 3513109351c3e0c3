//! `muslin detect`: counts the contacts of a mesh, the impacts of its motion to a second mesh, and its
//! crossings, with the stages that a run uses.

mod mesh;
mod on_gpu;
mod report;
mod stages;

use std::time::{Duration, Instant};

use muslin_core::audit;
use muslin_core::narrow_phase::contacts::contacts;

use crate::args::{Backend, DetectArguments, DetectStage, Method};
use crate::failure::{Failure, print_data, print_json, print_note};
use crate::mesh_io;
use crate::pool::Pool;
use mesh::Subject;
use report::{Pairs, Report, StageMs};
use stages::{CandidateLists, Touch};

/// Detects and prints a table or JSON.
pub fn detect(arguments: &DetectArguments) -> Result<(), Failure> {
    if arguments.backend == Backend::Gpu && arguments.method != Method::Grid {
        return Err(Failure::Usage(
            "--method: the GPU only has the grid; use --backend cpu for the other methods".into(),
        ));
    }
    if arguments.stage == DetectStage::Ccd && arguments.next.is_none() {
        return Err(Failure::Usage("--stage ccd needs a motion: give the mesh at its end by --next MESH".into()));
    }
    let subject = Subject::load(arguments)?;
    if let Some(note) = mesh_io::loose_note(&arguments.mesh.display(), subject.loose_vertices) {
        print_note(&note);
    }
    let pool = Pool::new(arguments.threads).map_err(|error| Failure::Tool(format!("cannot start threads: {error}")))?;
    let report = match arguments.backend {
        Backend::Cpu => pool.install(|| report(arguments, &subject, &pool)),
        Backend::Gpu => on_gpu::report(arguments, &subject, &pool)?,
    };
    match arguments.json {
        true => print_json(&report),
        false => print_data(&report.table()),
    }
}

fn report(arguments: &DetectArguments, subject: &Subject, pool: &Pool) -> Report {
    let mut ms = StageMs::default();
    let surface = subject.surface.view();
    let mut found = CandidateLists::default();
    ms.candidates = Some(milliseconds(found.find(arguments.method, &subject.boxes, &surface, pool)));
    let mut report = Report::new(arguments, subject, pool.threads());
    report.edge_edge = Pairs::of(found.edge_edge.len());
    report.vertex_triangle = Pairs::of(found.vertex_triangle.len());

    if arguments.stage >= DetectStage::Contacts {
        let (distances, time) = clocked(|| stages::distances(&found, subject, pool));
        ms.contacts = Some(milliseconds(time));
        let near = |pairs: &[[u32; 2]], distances: &[f32]| Some(contacts(pairs, distances, subject.thickness, &mut []));
        report.vertex_triangle.contacts = near(&found.vertex_triangle, &distances.vertex_triangle);
        report.edge_edge.contacts = near(&found.edge_edge, &distances.edge_edge);

        if let Some(next) = subject.next.as_ref().filter(|_| arguments.stage >= DetectStage::Ccd) {
            let (touch, time) = clocked(|| Touch::find(&found, &distances, subject, next, pool));
            ms.ccd = Some(milliseconds(time));
            report.add_touch(&touch);
        }
    }
    count_intersections(arguments, subject, pool, &mut report, &mut ms);
    report.ms = ms;
    report
}

fn count_intersections(
    arguments: &DetectArguments,
    subject: &Subject,
    pool: &Pool,
    report: &mut Report,
    ms: &mut StageMs,
) {
    if arguments.stage == DetectStage::Intersections {
        let (count, time) = clocked(|| audit::count(&subject.surface.view(), &subject.positions, pool));
        ms.intersections = Some(milliseconds(time));
        report.intersections = Some(count);
    }
}

fn clocked<R>(work: impl FnOnce() -> R) -> (R, Duration) {
    let started = Instant::now();
    (work(), started.elapsed())
}

fn milliseconds(time: Duration) -> f64 {
    1e3 * time.as_secs_f64()
}

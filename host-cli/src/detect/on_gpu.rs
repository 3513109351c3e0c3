//! The stages of detection on a graphics processor.

use muslin_core::narrow_phase::contacts::contacts;
use muslin_gpu::{DetectionQuery, DetectionResult, Detector};

use super::mesh::Subject;
use super::report::{Pairs, Report, StageMs};
use super::stages::Touch;
use super::{clocked, count_intersections, milliseconds};
use crate::args::{DetectArguments, DetectStage};
use crate::device;
use crate::failure::Failure;
use crate::pool::Pool;

/// Detects on the device. Of two detections the second is timed, when the buffers are large enough.
pub fn report(arguments: &DetectArguments, subject: &Subject, pool: &Pool) -> Result<Report, Failure> {
    let gpu = device::open()?;
    let radii = vec![0.0; subject.positions.len()];
    let next = subject.next.as_ref().filter(|_| arguments.stage >= DetectStage::Ccd);
    let wanted = if next.is_some() { DetectionQuery::Times } else { DetectionQuery::Contacts };
    let mut detector = Detector::new(&gpu, &subject.surface.view(), &radii, wanted).map_err(device::failed)?;
    detector.set_distances(&gpu, subject.thickness, 0.0);
    let (start, end) = (&subject.positions, next.unwrap_or(&subject.positions));
    let mut found = DetectionResult::default();
    let mut detect = || pollster::block_on(detector.detect(&gpu, &subject.boxes, start, end, &mut found));
    detect().map_err(device::failed)?;
    let (again, time) = clocked(detect);
    again.map_err(device::failed)?;

    let mut report = Report::new(arguments, subject, pool.threads());
    report.adapter = Some(gpu.name.clone());
    report.vertex_triangle = Pairs::of(found.candidates[0]);
    report.edge_edge = Pairs::of(found.candidates[1]);
    if arguments.stage >= DetectStage::Contacts {
        let [vertices, edges] = [&found.vertex_triangle, &found.edge_edge];
        let near = |pairs: &[[u32; 2]], distances: &[f32]| match wanted {
            DetectionQuery::Contacts => Some(pairs.len()),
            _ => Some(contacts(pairs, distances, subject.thickness, &mut [])),
        };
        report.vertex_triangle.contacts = near(vertices, &found.vertex_triangle_distances);
        report.edge_edge.contacts = near(edges, &found.edge_edge_distances);
    }
    if next.is_some() {
        report.add_touch(&Touch::of(&found.vertex_triangle_times, &found.edge_edge_times));
    }
    let mut ms = StageMs { gpu: Some(milliseconds(time)), ..StageMs::default() };
    ms.gpu_stages = device::stage_times(detector.stage_ms(&gpu));
    pool.install(|| count_intersections(arguments, subject, pool, &mut report, &mut ms));
    report.ms = ms;
    Ok(report)
}

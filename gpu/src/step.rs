//! What a step asks of a device: its candidates and their distances.

use muslin_core::broad_phase::Counts;
use muslin_core::contact::{ContactModel, ContactScratch, Pairs};
use muslin_core::response::repulsion::REACH;

use crate::buffer::Failed;
use crate::detector::{Detector, Found};
use crate::device::Gpu;

/// Finds the candidates of one scene's steps.
#[derive(Debug)]
pub struct StepDetector {
    gpu: Gpu,
    /// Made for the first step.
    detector: Option<Detector>,
    found: Found,
}

impl StepDetector {
    /// On a device.
    pub fn new(gpu: Gpu) -> Self {
        Self { gpu, detector: None, found: Found::default() }
    }

    /// Finds candidates and their distances, as `muslin_core::step::detect`; where there is too little room
    /// for them only their counts.
    pub fn detect(&mut self, model: &ContactModel<'_>, contact: &mut ContactScratch<'_>) -> Result<Counts, Failed> {
        let Self { gpu, detector, found } = self;
        let detector = match detector {
            Some(detector) => detector,
            None => detector.insert(Detector::new(gpu, &model.surface, model.radii, false)?),
        };
        detector.set_distances(gpu, REACH * model.thickness, 0.0);
        detector.detect(gpu, contact.boxes, contact.start, contact.start, found)?;
        take(&found.vertex_triangle, &found.vertex_triangle_distances, &mut contact.vertex_triangle);
        take(&found.edge_edge, &found.edge_edge_distances, &mut contact.edge_edge);
        Ok(Counts { vertex_triangle: found.vertex_triangle.len(), edge_edge: found.edge_edge.len() })
    }
}

/// Copies what was found, where there is room for all of it.
fn take(candidates: &[[u32; 2]], distances: &[f32], pairs: &mut Pairs<'_>) {
    let count = candidates.len();
    if let (Some(own), Some(far)) = (pairs.candidates.get_mut(..count), pairs.distances.get_mut(..count)) {
        own.copy_from_slice(candidates);
        far.copy_from_slice(distances);
    }
}

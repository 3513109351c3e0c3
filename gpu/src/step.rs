//! Detection for the steps of a simulation: finds candidates on a device.

use muslin_core::broad_phase::Counts;
use muslin_core::contact::{ContactModel, ContactScratch, Pairs};

use crate::buffer::DetectionError;
use crate::detector::Detector;
use crate::device::Gpu;
use crate::readback::{DetectionQuery, DetectionResult};

/// Finds the candidates of one scene's steps.
#[derive(Debug)]
pub struct StepDetector {
    gpu: Gpu,
    /// Created in the first step of a scene.
    detector: Option<Detector>,
    found: DetectionResult,
    stage_ms: Vec<(&'static str, f64)>,
    lost: Option<DetectionError>,
}

impl StepDetector {
    /// A detector that uses this device.
    pub fn new(gpu: Gpu) -> Self {
        Self { gpu, detector: None, found: DetectionResult::default(), stage_ms: Vec::new(), lost: None }
    }

    /// The device.
    pub fn gpu(&self) -> &Gpu {
        &self.gpu
    }

    /// Device time of each stage, summed over all steps, ms; empty if the device has no timestamps.
    pub fn stage_ms(&self) -> &[(&'static str, f64)] {
        &self.stage_ms
    }

    /// The error because of which the device was opened again since the last call.
    pub fn take_loss(&mut self) -> Option<DetectionError> {
        self.lost.take()
    }

    /// Discards the data of the scene. The next step uploads the surface, radii and seams of its scene again.
    pub fn forget(&mut self) {
        self.detector = None;
    }

    /// Finds candidates, for `muslin_core::dispatch::Dispatch::detect`. Pairs that do not fit their
    /// column are only counted. If the device is lost, it is opened again and the detection is repeated once.
    pub async fn detect(
        &mut self,
        model: &ContactModel<'_>,
        contact: &mut ContactScratch<'_>,
    ) -> Result<Counts, DetectionError> {
        match self.find(model, contact).await {
            Err(lost @ DetectionError::Lost(_)) => {
                let Ok(gpu) = self.gpu.reopen().await else { return Err(lost) };
                (self.gpu, self.detector, self.lost) = (gpu, None, Some(lost));
                self.find(model, contact).await
            }
            found => found,
        }
    }

    async fn find(
        &mut self,
        model: &ContactModel<'_>,
        contact: &mut ContactScratch<'_>,
    ) -> Result<Counts, DetectionError> {
        let Self { gpu, detector, found, stage_ms, .. } = self;
        let detector = match detector {
            Some(detector) => detector,
            None => detector.insert(Detector::new(gpu, &model.surface, model.radii, DetectionQuery::Candidates)?),
        };
        detector.detect(gpu, contact.boxes, contact.start, contact.start, found).await?;
        for (stage, ms) in detector.stage_ms(gpu) {
            match stage_ms.iter_mut().find(|(known, _)| *known == stage) {
                Some((_, sum)) => *sum += ms,
                None => stage_ms.push((stage, ms)),
            }
        }
        take(&found.vertex_triangle, &mut contact.vertex_triangle);
        take(&found.edge_edge, &mut contact.edge_edge);
        Ok(Counts { vertex_triangle: found.vertex_triangle.len(), edge_edge: found.edge_edge.len() })
    }
}

/// Copies the candidates, if all of them fit.
fn take(candidates: &[[u32; 2]], pairs: &mut Pairs<'_>) {
    if let Some(own) = pairs.candidates.get_mut(..candidates.len()) {
        own.copy_from_slice(candidates);
    }
}

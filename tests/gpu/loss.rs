//! Losing the device returns an error and does not panic; the step is repeated on another device with the same
//! result.

use harness::crumpled;
use muslin_core::real::Vec3;
use muslin_gpu::device::Ask;
use muslin_gpu::{DetectionError, DetectionQuery, DetectionResult, Detector, Gpu};

use super::methods::{columns, gpu};
use super::on_device::{OnDevice, begin};
use harness::case::Case;
use harness::torture::SCENES;

#[test]
#[ignore = "takes a graphics driver"]
fn what_a_lost_device_is_asked_fails() {
    if gpu().is_none() {
        return;
    }
    let mesh = crumpled::sheet(12);
    let (boxes, surface) = columns(&Case::new("", &mesh.positions, &mesh.triangles, 0.25));
    let (start, radii) = (vec![Vec3::ZERO; boxes.len()], vec![0.0; boxes.len()]);
    let lost = pollster::block_on(Gpu::open(Ask::Web)).unwrap();
    let mut detector = Detector::new(&lost, &surface.view(), &radii, DetectionQuery::Candidates).unwrap();
    let mut detect = || {
        let mut found = DetectionResult::default();
        pollster::block_on(detector.detect(&lost, &boxes, &start, &start, &mut found)).map(|()| found)
    };
    let before = detect().unwrap();
    assert!(before.edge_edge.len() > 100, "{} pairs of edges", before.edge_edge.len());
    lost.close();
    let failed = detect();
    assert!(matches!(&failed, Err(DetectionError::Lost(why)) if !why.is_empty()), "{failed:?}");
}

/// Steps before the device is lost, and in total: by then some features are in contact.
const STEPS: [u32; 2] = [15, 30];

#[test]
#[ignore = "takes a graphics driver"]
fn a_run_whose_device_is_lost_ends_the_same() {
    if gpu().is_none() {
        return;
    }
    let scene = SCENES.iter().find(|scene| scene.name == "folded").expect("the scene is there");
    let run = |loses: bool| {
        let (device, mut sim) = (OnDevice::open(), begin(scene, 0));
        for step in 0..STEPS[1] {
            if loses && step == STEPS[0] {
                device.with(|detector| detector.gpu().close());
            }
            sim.step(&device).unwrap();
        }
        assert_eq!(device.with(|detector| detector.take_loss().is_some()), loses, "opened anew");
        assert!(sim.contact_statistics().proximity > 0, "nothing touches: {:?}", sim.contact_statistics());
        sim.positions().to_vec()
    };
    assert!(run(false) == run(true), "a run whose device was lost ends elsewhere");
}

//! A device that is lost is an error and no panic, and another goes on where it stopped.

use muslin_core::real::Vec3;
use muslin_gpu::device::Ask;
use muslin_gpu::{Detector, Failed, Found, Gpu};
use muslin_tests::crumpled;

use super::case::Case;
use super::methods::{columns, gpu};

#[test]
fn another_device_finds_the_same() {
    if gpu().is_none() {
        return;
    }
    let mesh = crumpled::sheet(12);
    let (boxes, surface) = columns(&Case::new("", &mesh.positions, &mesh.triangles, 0.25));
    let (start, radii) = (vec![Vec3::ZERO; boxes.len()], vec![0.0; boxes.len()]);
    let open = || pollster::block_on(Gpu::open(Ask::Web)).unwrap();
    let detect = |gpu: &Gpu, detector: &mut Detector| {
        let mut found = Found::default();
        detector.detect(gpu, &boxes, &start, &start, &mut found).map(|()| found)
    };
    let lost = open();
    let mut detector = Detector::new(&lost, &surface.view(), &radii, false).unwrap();
    let before = detect(&lost, &mut detector).unwrap();
    assert!(before.edge_edge.len() > 100, "{} pairs of edges", before.edge_edge.len());
    lost.close();
    let failed = detect(&lost, &mut detector);
    assert!(matches!(&failed, Err(Failed::Lost(why)) if !why.is_empty()), "{failed:?}");
    let another = open();
    let mut detector = Detector::new(&another, &surface.view(), &radii, false).unwrap();
    assert!(detect(&another, &mut detector).unwrap() == before, "another device finds something else");
}

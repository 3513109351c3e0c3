//! A real pair of frames: exactly the expected candidates, and the same order in two runs.

use glam::Vec3;
use harness::cloth_ball;
use muslin_gpu::{DetectionQuery, DetectionResult, Detector};

use super::methods::{columns, gpu};
use harness::case::Case;

#[test]
#[ignore = "takes a graphics driver"]
fn counts_are_exact_and_the_order_is_repeatable() {
    let (Some(data), Some(gpu)) = (cloth_ball::load(), gpu()) else { return };
    let [first, second] = data.frames.map(|frame| frame.into_iter().map(Vec3::from_array));
    let swept = first.zip(second).map(|(a, b)| [a.min(b).as_dvec3(), a.max(b).as_dvec3()]);
    let case = Case { boxes: swept.collect(), triangles: data.triangles, ..Case::default() };
    let (boxes, surface) = columns(&case);
    let start = vec![Vec3::ZERO; boxes.len()];
    let mut detector =
        Detector::new(gpu, &surface.view(), &vec![0.0; boxes.len()], DetectionQuery::Candidates).unwrap();
    let [once, again] = [(); 2].map(|()| {
        let mut found = DetectionResult::default();
        pollster::block_on(detector.detect(gpu, &boxes, &start, &start, &mut found)).unwrap();
        detector.stage_ms(gpu).for_each(|(stage, ms)| println!("{stage}: {ms:.1} ms"));
        found
    });
    assert_eq!([once.vertex_triangle.len(), once.edge_edge.len()], [1_655_541, 5_197_332]);
    assert!(once == again, "the second time the candidates come in another order");
}

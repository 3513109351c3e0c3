//! A real pair of frames: the number of candidates equals an exact count from other software, with boxes swept
//! between the frames, in both precisions.

use glam::Vec3;
use harness::cloth_ball;

use super::methods::{double, single};
use harness::case::Case;

#[test]
fn counts_are_exact() {
    let Some(data) = cloth_ball::load() else { return };
    let [first, second] = data.frames.map(|frame| frame.into_iter().map(Vec3::from_array));
    let swept = first.zip(second).map(|(a, b)| [a.min(b).as_dvec3(), a.max(b).as_dvec3()]);
    let case = Case { boxes: swept.collect(), triangles: data.triangles, ..Case::default() };
    let expected = [1_655_541, 5_197_332];
    for grid in [single::grid, double::grid] {
        assert_eq!(grid(&case, [0, 0]).counts, expected);
    }
    let mut found = single::grid(&case, expected).sorted();
    found.vertex_triangle.dedup();
    found.edge_edge.dedup();
    assert_eq!([found.vertex_triangle.len(), found.edge_edge.len()], expected, "each once");
}

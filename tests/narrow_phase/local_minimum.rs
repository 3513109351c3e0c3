//! Selects the contacts among the features within the thickness: above a fold of two triangles, a point touches
//! each face that it is above, and the common edge only if the edge is convex.
//!
//! Run: `cargo test -p muslin-tests --test narrow_phase local_minimum`.

use glam::DVec3;
use harness::both_precisions;

/// Two triangles that share the edge from vertex 0 to vertex 1, with their far corners at `height`; vertex 4 is
/// a point, vertices 5 and 6 are an edge.
fn fold(height: f64, point: DVec3, edge: [DVec3; 2]) -> [DVec3; 7] {
    let far = |z: f64| DVec3::new(0.5, height, z);
    [DVec3::ZERO, DVec3::X, far(1.0), far(-1.0), point, edge[0], edge[1]]
}

const TRIANGLES: [[u32; 3]; 4] = [[0, 1, 2], [1, 0, 3], [4, 4, 4], [5, 6, 6]];
const ASIDE: [DVec3; 2] = [DVec3::new(9.0, 9.0, 9.0), DVec3::new(9.0, 9.0, 8.0)];

both_precisions! {
    use super::{ASIDE, TRIANGLES, fold};
    use glam::DVec3;
    use muslin::mesh::SurfaceColumns;
    use muslin::narrow_phase::local_minimum::is_local_minimum;
    use muslin::narrow_phase::{Kind, contact, gather};

    fn counts(kind: Kind, x: &[DVec3; 7], vertices: [u32; 4]) -> bool {
        let (surface, x) = (SurfaceColumns::build(x.len(), &TRIANGLES, &[]), kit::narrow(x));
        let at = gather(vertices, &x);
        let contact = contact(kind, vertices, &at, &at, 0.0).expect("the features are apart");
        is_local_minimum(kind, &surface.view(), &x, &contact)
    }

    /// Whether the point is in contact with each of the two triangles.
    fn by_face(height: f64, point: DVec3) -> [bool; 2] {
        [[4, 0, 1, 2], [4, 1, 0, 3]].map(|vertices| counts(Kind::VertexTriangle, &fold(height, point, ASIDE), vertices))
    }

    #[test]
    fn above_a_flat_face_only_that_face_counts() {
        for side in [1.0, -1.0] {
            let faces = by_face(0.0, DVec3::new(0.5, 0.1, 0.05 * side));
            assert_eq!(faces, [side > 0.0, side < 0.0], "a point beside the edge of a flat fold");
        }
        assert_eq!(by_face(0.0, DVec3::new(0.5, 0.1, 0.0)), [true; 2], "a point above the edge of a flat fold");
    }

    #[test]
    fn an_edge_counts_where_it_stands_out() {
        let above = DVec3::new(0.5, 0.1, 0.02);
        assert_eq!(by_face(-1.0, above), [true; 2], "a point above a ridge");
        assert_eq!(by_face(-1.0, DVec3::new(0.5, -0.1, 0.01)), [true; 2], "a point below a ridge touches both faces");
        let rim = counts(Kind::VertexTriangle, &fold(0.0, DVec3::new(1.1, 0.05, 0.3), ASIDE), [4, 0, 1, 2]);
        assert!(rim, "a point beside the rim");
    }

    #[test]
    fn an_edge_across_a_face_counts_only_where_it_lies_along_it() {
        let across = |tilt: f64| {
            let edge = [DVec3::new(0.5, 0.1, -0.3), DVec3::new(0.5, 0.1 + tilt, 0.3)];
            counts(Kind::EdgeEdge, &fold(0.0, DVec3::ONE * 9.0, edge), [5, 6, 0, 1])
        };
        assert!(across(0.0), "an edge that lies along the face");
        assert!(!across(0.05) && !across(-0.05), "an edge that leans: it touches with its lower end");
    }
}

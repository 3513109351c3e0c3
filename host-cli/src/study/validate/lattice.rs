//! Strips cut from the equilateral mesh in any direction of its lattice, which hang symmetrically over a line.

use std::collections::HashMap;

use muslin_core_f64::error::MeshError;
use muslin_core_f64::mesh::TriMesh;
use muslin_core_f64::mesh::edges::{self, Edge, NONE};

/// Height of a row of equilateral triangles over the length of an edge.
pub const ROW: f64 = 0.866_025_403_784_438_6;

/// A strip that hangs down on both sides of the line s = 0; s is the coordinate along the strip and z the one
/// across.
pub struct Strip {
    /// The flat strip in the xz plane, with s along x.
    pub mesh: TriMesh,
    /// Length from the line to a tip, computed from the area, since the ends are jagged.
    pub length: f64,
    /// Length of all edges.
    pub edge: f64,
    /// Vertices on the line.
    pub line: Vec<u32>,
    /// Pairs of vertices with the same s, one lattice period apart.
    pub alike: Vec<[u32; 2]>,
    /// Rigidity of the strip over the rigidity of an endless sheet: the sides lack hinges.
    pub rigidity: f64,
}

/// A lattice node: multiples of the two basis vectors, which are 60 degrees apart.
type Node = [i32; 2];

/// Position of a node, in edges.
fn place([a, b]: Node) -> [f64; 2] {
    [f64::from(a) + 0.5 * f64::from(b), ROW * f64::from(b)]
}

fn length([x, y]: [f64; 2]) -> f64 {
    x.hypot(y)
}

/// The shortest lattice vector perpendicular to another.
fn across([a, b]: Node) -> Node {
    let (r, s) = (a + 2 * b, -(2 * a + b));
    let common = gcd(r.abs(), s.abs());
    [r / common, s / common]
}

fn gcd(a: i32, b: i32) -> i32 {
    if b == 0 { a } else { gcd(b, a % b) }
}

/// A strip along the direction of a node, about one unit long on each side and `periods` lattice periods wide.
pub fn strip(along: Node, periods: u32, edge: f64) -> Result<Strip, MeshError> {
    let (direction, repeat) = (place(along), across(along));
    let [cosine, sine] = direction.map(|x| x / length(direction));
    let turned = |node: Node| {
        let [x, y] = place(node).map(|x| edge * x);
        [x * cosine + y * sine, y * cosine - x * sine]
    };
    let width = f64::from(periods) * edge * length(place(repeat));
    // Shifts the borders, so that rounding does not decide whether the centre of a triangle lies inside.
    let hair = 1e-6 * edge;
    let sides = [-0.5, 0.5].map(|side| side * width - hair);
    let reach = (1.2 * (1.0 + width) / edge).ceil() as i32 + 2;

    let (mut mesh, mut nodes, mut index) = (TriMesh::default(), Vec::new(), HashMap::new());
    let corners = |a: i32, b: i32| [[[a, b], [a, b + 1], [a + 1, b]], [[a + 1, b], [a, b + 1], [a + 1, b + 1]]];
    for corners in (-reach..reach).flat_map(|a| (-reach..reach).flat_map(move |b| corners(a, b))) {
        let centre = [0, 1].map(|axis| corners.iter().map(|&node| turned(node)[axis]).sum::<f64>() / 3.0);
        if centre[0].abs() < 1.0 - hair && (sides[0]..sides[1]).contains(&centre[1]) {
            mesh.triangles.push(corners.map(|node| {
                *index.entry(node).or_insert_with(|| {
                    let [s, z] = turned(node);
                    mesh.positions.push([s, 0.0, z]);
                    nodes.push(node);
                    nodes.len() as u32 - 1
                })
            }));
        }
    }
    let of = |vertex: usize| vertex as u32;
    let line = (0..nodes.len()).filter(|&v| mesh.positions[v][0].abs() < hair).map(of).collect();
    let beside = |[a, b]: Node| index.get(&[a + repeat[0], b + repeat[1]]);
    let alike = nodes.iter().enumerate().filter_map(|(v, &node)| Some([of(v), *beside(node)?])).collect();
    let area = mesh.triangles.len() as f64 * 0.5 * ROW * edge * edge;
    let period = edge * length(direction);
    let rigidity = held(&mesh, &edges::build(&mesh.triangles)?, edge, period) / (width * period);
    Ok(Strip { length: 0.5 * area / width, edge, line, alike, rigidity, mesh })
}

/// The area of an endless sheet with the same bending resistance along s as the hinges in one period of a strip,
/// m^2. A hinge whose edge runs across s counts for a row times an edge. If the angle between the edge and s has
/// the cosine c, the hinge turns by 1 - 4/3 c^2 times as much, and its area is multiplied by the square of this.
fn held(mesh: &TriMesh, edges: &[Edge], edge: f64, period: f64) -> f64 {
    let hinges = edges.iter().filter(|edge| edge.triangles[1] != NONE);
    let squares = hinges.map(|hinge| {
        let [a, b] = hinge.ends.map(|end| mesh.positions[end as usize][0]);
        let within = (-0.01 * period..0.99 * period).contains(&(0.5 * (a + b)));
        let turn = 1.0 - 4.0 / 3.0 * ((b - a) / edge).powi(2);
        if within { turn * turn } else { 0.0 }
    });
    squares.sum::<f64>() * ROW * edge * edge
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Hinges on edges along a strip have a ninth of the rigidity; edges on its sides have no hinge.
    #[test]
    fn sides_lack_their_hinges() {
        for (along, periods, rigidity) in
            [([1, 0], 1, 1.0 - 1.0 / 18.0), ([1, 0], 4, 1.0 - 1.0 / 72.0), ([1, 1], 3, 1.0)]
        {
            let strip = strip(along, periods, 0.05).unwrap();
            assert!((strip.rigidity - rigidity).abs() < 1e-12, "{along:?}: {}, expected {rigidity}", strip.rigidity);
        }
        let askew = [1, 20].map(|periods| 1.0 - strip([2, 1], periods, 0.05).unwrap().rigidity);
        assert!(askew[0] > 0.005 && (20.0 * askew[1] / askew[0] - 1.0).abs() < 1e-9, "{askew:?}");
    }
}

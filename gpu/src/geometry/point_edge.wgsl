// The point of an edge nearest to a point.

const EPSILON: f32 = 1.1920929e-7;

// A shape whose height is below this fraction of its length counts as flat.
const FLAT: f32 = 4.0 * EPSILON;

// The parameter of the nearest point, from 0 at `e0` to 1 at `e1`; 0 for an edge without length.
fn closest_on_edge(p: vec3<f32>, e0: vec3<f32>, e1: vec3<f32>) -> f32 {
    let edge = e1 - e0;
    let squared = dot(edge, edge);
    if squared > 0.0 {
        return clamp(dot(p - e0, edge) / squared, 0.0, 1.0);
    }
    return 0.0;
}

// The functions of the narrow phase that are specific to a vertex and a triangle.

const FIRST: u32 = 1u;
const IS_EDGES: bool = false;

struct Nearest {
    // Positive on the first feature, negative on the second.
    weights: vec4<f32>,
    // From the second to the first, m.
    between: vec3<f32>,
}

// The vertex, then the vertices of the triangle.
fn vertices_of(candidate: vec2<u32>) -> vec4<u32> {
    let at = 3u * candidate.y;
    return vec4<u32>(candidate.x, features[at], features[at + 1u], features[at + 2u]);
}

fn nearest(x: array<vec3<f32>, 4>) -> Nearest {
    let a = x[1] - x[0];
    let b = x[2] - x[0];
    let c = x[3] - x[0];
    let w = closest_weights(vec3<f32>(0.0), a, b, c);
    return Nearest(vec4<f32>(1.0, -w.x, -w.y, -w.z), -(a * w.x + b * w.y + c * w.z));
}

// A direction perpendicular to the triangle, for features that touch.
fn direction(x: array<vec3<f32>, 4>) -> vec3<f32> {
    return cross(x[2] - x[1], x[3] - x[1]);
}

// Square of the largest distance by which a point of one feature moves relative to the other.
fn approach_squared(moves: array<vec3<f32>, 4>) -> f32 {
    var most = 0.0;
    for (var k = 1u; k < 4u; k++) {
        let along = moves[0] - moves[k];
        most = max(most, dot(along, along));
    }
    return most;
}

// The radii of both features together, m.
fn radius(radii: vec4<f32>) -> f32 {
    return radii.x + max(max(radii.y, radii.z), radii.w);
}

// A lower bound on the distance of the features, from their boxes, m.
fn box_distance(x: array<vec3<f32>, 4>) -> f32 {
    let low = min(min(x[1], x[2]), x[3]);
    let high = max(max(x[1], x[2]), x[3]);
    let gaps = max(low - x[0], x[0] - high);
    return max(max(gaps.x, gaps.y), gaps.z);
}

// The functions of the narrow phase that are specific to two edges.

const FIRST: u32 = 2u;
const IS_EDGES: bool = true;

struct Nearest {
    // Positive on the first feature, negative on the second.
    weights: vec4<f32>,
    // From the second to the first, m.
    between: vec3<f32>,
}

// The ends of the first edge, then of the second.
fn vertices_of(candidate: vec2<u32>) -> vec4<u32> {
    let a = 2u * candidate.x;
    let b = 2u * candidate.y;
    return vec4<u32>(features[a], features[a + 1u], features[b], features[b + 1u]);
}

fn nearest(x: array<vec3<f32>, 4>) -> Nearest {
    let a = x[1] - x[0];
    let b = x[2] - x[0];
    let c = x[3] - x[0];
    let st = closest_parameters(vec3<f32>(0.0), a, b, c);
    return Nearest(vec4<f32>(1.0 - st.x, st.x, st.y - 1.0, -st.y), a * st.x - (b + (c - b) * st.y));
}

// A direction perpendicular to both edges, for features that touch.
fn direction(x: array<vec3<f32>, 4>) -> vec3<f32> {
    return cross(x[1] - x[0], x[3] - x[2]);
}

// Square of the largest distance by which a point of one feature moves relative to the other.
fn approach_squared(moves: array<vec3<f32>, 4>) -> f32 {
    var most = 0.0;
    for (var i = 0u; i < 2u; i++) {
        for (var j = 2u; j < 4u; j++) {
            let along = moves[i] - moves[j];
            most = max(most, dot(along, along));
        }
    }
    return most;
}

// The radii of both features together, m.
fn radius(radii: vec4<f32>) -> f32 {
    return max(radii.x, radii.y) + max(radii.z, radii.w);
}

// A lower bound on the distance of the features, from their boxes, m.
fn box_distance(x: array<vec3<f32>, 4>) -> f32 {
    let gaps = max(min(x[0], x[1]) - max(x[2], x[3]), min(x[2], x[3]) - max(x[0], x[1]));
    return max(max(gaps.x, gaps.y), gaps.z);
}

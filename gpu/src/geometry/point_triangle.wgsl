// The point of a triangle nearest to a point, as weights of its corners.

fn closest_weights(p: vec3<f32>, t0: vec3<f32>, t1: vec3<f32>, t2: vec3<f32>) -> vec3<f32> {
    let edge = t1 - t0;
    let side = t2 - t0;
    let reach = p - t0;
    let squared = dot(edge, edge);
    // A triangle without area counts as its edges.
    if squared > 0.0 {
        let foot_side = dot(side, edge) / squared;
        let foot_reach = dot(reach, edge) / squared;
        let height = side - foot_side * edge;
        let rise = reach - foot_reach * edge;
        let height_squared = dot(height, height);
        if height_squared > FLAT * FLAT * squared {
            let w2 = dot(rise, height) / height_squared;
            let w1 = foot_reach - w2 * foot_side;
            let w0 = 1.0 - w1 - w2;
            if w0 >= 0.0 && w1 >= 0.0 && w2 >= 0.0 {
                return vec3<f32>(w0, w1, w2);
            }
            return nearest_on_edges(p, t0, t1, t2, vec3<bool>(w2 < 0.0, w0 < 0.0, w1 < 0.0));
        }
    }
    return nearest_on_edges(p, t0, t1, t2, vec3<bool>(true));
}

// The weights of the nearest point on the edges that are marked in `seen`. Edge k joins corners k and k + 1.
fn nearest_on_edges(p: vec3<f32>, t0: vec3<f32>, t1: vec3<f32>, t2: vec3<f32>, seen: vec3<bool>) -> vec3<f32> {
    let corners = array<vec3<f32>, 3>(t0, t1, t2);
    var weights = vec3<f32>(1.0, 0.0, 0.0);
    var nearest = 3.4e38;
    for (var k = 0u; k < 3u; k++) {
        if !seen[k] {
            continue;
        }
        let next = (k + 1u) % 3u;
        let edge = corners[next] - corners[k];
        let s = closest_on_edge(p, corners[k], corners[next]);
        let off = p - corners[k] - s * edge;
        let distance = dot(off, off);
        if distance < nearest {
            nearest = distance;
            weights = vec3<f32>(0.0);
            weights[k] = 1.0 - s;
            weights[next] = s;
        }
    }
    return weights;
}

// The nearest points of two edges, as a parameter from 0 to 1 on each.

fn closest_parameters(a0: vec3<f32>, a1: vec3<f32>, b0: vec3<f32>, b1: vec3<f32>) -> vec2<f32> {
    let a = a1 - a0;
    let b = b1 - b0;
    let r = a0 - b0;
    let a_squared = dot(a, a);
    let b_squared = dot(b, b);
    if !(a_squared > 0.0 && b_squared > 0.0) {
        return vec2<f32>(closest_on_edge(b0, a0, a1), closest_on_edge(a0, b0, b1));
    }
    let along_a = dot(a, b) / b_squared;
    let along_r = dot(r, b) / b_squared;
    let a_across = a - along_a * b;
    let r_across = r - along_r * b;
    let across_squared = dot(a_across, a_across);
    var s = 0.0;
    if across_squared > FLAT * FLAT * a_squared {
        s = clamp(-dot(r_across, a_across) / across_squared, 0.0, 1.0);
    }
    var t = along_r + s * along_a;
    if t < 0.0 || t > 1.0 {
        t = clamp(t, 0.0, 1.0);
        s = clamp(dot(t * b - r, a) / a_squared, 0.0, 1.0);
    }
    return vec2<f32>(s, t);
}

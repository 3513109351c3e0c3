// The time at which the features of each candidate collide in the course of a step. Features with a coordinate
// that is not finite, or too large to square, count as touching.
//
// The reserve is that of the core, ROUNDING times the size: nearly twice the error of the device, whose divisions
// and roots are less exact. The size is taken over both ends of the step, because a compiler may compute
// differences of moves as moves of differences. Differences of positions are rounded only once.

@group(0) @binding(1) var<storage, read> candidates: array<vec2<u32>>;
@group(0) @binding(2) var<storage, read> features: array<u32>;
@group(0) @binding(3) var<storage, read> start: array<f32>;
@group(0) @binding(4) var<storage, read> end_of: array<f32>;
@group(0) @binding(5) var<storage, read> radii: array<f32>;
@group(0) @binding(6) var<storage, read> distances: array<f32>;
@group(0) @binding(7) var<storage, read_write> times: array<f32>;
@group(0) @binding(8) var<storage, read> counters: array<u32>;

const TOUCH: f32 = 1e-3;
const TOUCHING: f32 = 3.0;

fn position_at_end(vertex: u32) -> vec3<f32> {
    return vec3<f32>(end_of[3u * vertex], end_of[3u * vertex + 1u], end_of[3u * vertex + 2u]);
}

// An upper bound on the distance by which the features approach one another, m. It allows for rounding, however far
// they move together.
fn farthest(x: array<vec3<f32>, 4>, y: array<vec3<f32>, 4>) -> f32 {
    var most = vec3<f32>(0.0);
    for (var i = 0u; i < 4u; i++) {
        most = max(most, abs(y[i] - x[i]));
    }
    return fastest(x, y) * (1.0 + 2e-5) + 8.0 * EPSILON * max(max(most.x, most.y), most.z);
}

@compute @workgroup_size(64)
fn write_times(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) local: u32) {
    let at = workgroup_index(group) * 64u + local;
    if at >= candidate_count() {
        return;
    }
    let distance = distances[at];
    if distance <= TOUCH * params.separation {
        times[at] = TOUCHING;
        return;
    }
    let separation = min(params.separation, 0.5 * distance);
    let vertices = vertices_of(candidates[at]);
    let x = gather(vertices);
    let y = array<vec3<f32>, 4>(
        position_at_end(vertices.x), position_at_end(vertices.y),
        position_at_end(vertices.z), position_at_end(vertices.w)
    );
    if !are_moderate(x) || !are_moderate(y) {
        times[at] = TOUCHING;
        return;
    }
    // Nearly all candidates are too far apart to come near enough.
    if farthest(x, y) + ROUNDING * largest(x, y) < distance - separation {
        times[at] = NEVER;
        return;
    }
    let around = radius(gather_radii(vertices));
    let time = advance(x, y, separation + around, 0.5 * separation);
    // A time of 0 for features that are apart means that rounding hides their motion: they count as touching.
    times[at] = select(time, TOUCHING, time == 0.0);
}

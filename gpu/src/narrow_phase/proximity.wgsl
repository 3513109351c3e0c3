// The distance of the features of each candidate at the start of a step.

@group(0) @binding(1) var<storage, read> candidates: array<vec2<u32>>;
// Vertices of triangles, or ends of edges.
@group(0) @binding(2) var<storage, read> features: array<u32>;
@group(0) @binding(3) var<storage, read> start: array<f32>;
@group(0) @binding(4) var<storage, read> radii: array<f32>;
@group(0) @binding(5) var<storage, read_write> distances: array<f32>;
@group(0) @binding(6) var<storage, read> counters: array<u32>;

@compute @workgroup_size(256)
fn write_distances(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) local: u32) {
    let at = workgroup_index(group) * GROUP + local;
    if at >= candidate_count() {
        return;
    }
    let vertices = vertices_of(candidates[at]);
    let x = gather(vertices);
    let around = radius(gather_radii(vertices));
    let bound = box_distance(x) - around;
    // Beyond the reach the lower bound is enough.
    if bound > params.reach {
        distances[at] = bound;
    } else {
        distances[at] = length(nearest(x).between) - around;
    }
}

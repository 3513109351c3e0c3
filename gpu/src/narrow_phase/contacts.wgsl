// Candidates -> contacts: the candidates nearer than the reach, in their order. Edge-edge contacts come after all
// vertex-triangle contacts.

@group(0) @binding(1) var<storage, read> vertex_triangle: array<vec2<u32>>;
@group(0) @binding(2) var<storage, read> edge_edge: array<vec2<u32>>;
@group(0) @binding(3) var<storage, read> vertex_triangle_distances: array<f32>;
@group(0) @binding(4) var<storage, read> edge_edge_distances: array<f32>;
// 1 for each contact; after the scan, the number of contacts before.
@group(0) @binding(5) var<storage, read_write> counts: array<u32>;
@group(0) @binding(6) var<storage, read> blocks: array<u32>;
@group(0) @binding(7) var<storage, read_write> contacts: array<vec2<u32>>;
@group(0) @binding(8) var<storage, read_write> counters: array<u32>;

// Whether a candidate exists at this index, fits its column and is nearer than the reach.
fn is_near(at: u32) -> bool {
    if at < params.vertex_triangle {
        return at < counters[VERTEX_TRIANGLE] && vertex_triangle_distances[at] < params.reach;
    }
    let edge = at - params.vertex_triangle;
    return edge < min(counters[EDGE_EDGE], params.edge_edge) && edge_edge_distances[edge] < params.reach;
}

@compute @workgroup_size(256)
fn count_contacts(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) local: u32) {
    let at = workgroup_index(group) * GROUP + local;
    if at < params.vertex_triangle + params.edge_edge {
        counts[at] = select(0u, 1u, is_near(at));
    }
}

@compute @workgroup_size(256)
fn write_contacts(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) local: u32) {
    let at = workgroup_index(group) * GROUP + local;
    let count = params.vertex_triangle + params.edge_edge;
    if at == 0u {
        counters[CONTACTS] = counts[params.vertex_triangle];
        let all = blocks[(count + 2047u) / 2048u];
        counters[CONTACTS + 1u] = all - counts[params.vertex_triangle];
        if all > params.contacts {
            counters[STATUS] |= NO_ROOM_CONTACTS;
        }
    }
    if at < count && is_near(at) && counts[at] < params.contacts {
        if at < params.vertex_triangle {
            contacts[counts[at]] = vertex_triangle[at];
        } else {
            contacts[counts[at]] = edge_edge[at - params.vertex_triangle];
        }
    }
}

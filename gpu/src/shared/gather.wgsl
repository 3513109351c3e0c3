// Reads the positions and radii of the vertices of a candidate.

fn position(vertex: u32) -> vec3<f32> {
    return vec3<f32>(start[3u * vertex], start[3u * vertex + 1u], start[3u * vertex + 2u]);
}

fn gather(vertices: vec4<u32>) -> array<vec3<f32>, 4> {
    return array<vec3<f32>, 4>(
        position(vertices.x), position(vertices.y), position(vertices.z), position(vertices.w)
    );
}

fn gather_radii(vertices: vec4<u32>) -> vec4<f32> {
    return vec4<f32>(radii[vertices.x], radii[vertices.y], radii[vertices.z], radii[vertices.w]);
}

// Number of candidates of this kind that fit their column.
fn candidate_count() -> u32 {
    if IS_EDGES {
        return min(counters[EDGE_EDGE], params.edge_edge);
    }
    return min(counters[VERTEX_TRIANGLE], params.vertex_triangle);
}

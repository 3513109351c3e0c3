// The parameters of every stage, and the index of a workgroup.

struct Params {
    vertices: u32,
    triangles: u32,
    first_passive: u32,
    own_contact: u32,
    // 1: some vertices are sewn together.
    sewn: u32,
    // The level. In the brute-force level: the round. In `divide`: the number of levels that are run.
    level: u32,
    // In the sort: the lowest bit that this pass looks at.
    shift: u32,
    // In the scan: the number of values. In `divide`: the number of triangles of the last level that are compared.
    length: u32,
    // Capacities.
    entries: u32,
    tiles: u32,
    pairs: u32,
    vertex_triangle: u32,
    edge_edge: u32,
    // m.
    reach: f32,
    separation: f32,
    contacts: u32,
}

@group(0) @binding(0) var<uniform> params: Params;

const GROUP: u32 = 256u;
const ROW: u32 = 65535u;

// The index of a workgroup. Workgroups are arranged in rows, because browsers limit their number per dimension.
fn workgroup_index(group: vec3<u32>) -> u32 {
    return group.y * ROW + group.x;
}

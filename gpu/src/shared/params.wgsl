// What every stage is told, and its own place in the work.

struct Params {
    vertices: u32,
    triangles: u32,
    first_passive: u32,
    own_contact: u32,
    // 1: some vertices are sewn.
    sewn: u32,
    // Of pairs with the last level the round, of the division how many levels are run.
    level: u32,
    // Of the sort: the lowest bit of this pass.
    shift: u32,
    // Of the scan: how many numbers; of the division: of the last level how many are compared.
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

// Workgroups are folded into rows: none has more than the web allows.
fn workgroup_index(group: vec3<u32>) -> u32 {
    return group.y * ROW + group.x;
}

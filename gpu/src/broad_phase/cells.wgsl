// The size of the cells, then the home cell and the control bits of every sphere.

@group(0) @binding(1) var<storage, read> spheres: array<vec4<i32>>;
// Key of the home cell and control bits of each triangle.
@group(0) @binding(2) var<storage, read_write> homes: array<vec2<u32>>;
@group(0) @binding(3) var<storage, read_write> counters: array<u32>;

// The smallest integer whose square is at least n.
fn root_above(n: u32) -> u32 {
    var root = 0u;
    for (var bit = 32768u; bit > 0u; bit >>= 1u) {
        let next = root | bit;
        if next * next <= n {
            root = next;
        }
    }
    return root + select(0u, 1u, root * root < n);
}

// Runs as one invocation.
@compute @workgroup_size(1)
fn choose_grid() {
    let count = counters[SPHERES];
    let diagonal_squared = counters[SPHERES + 1u];
    let size = 2u * root_above(diagonal_squared) + root_above(2u * diagonal_squared) + 1u;
    var bits: vec3<u32>;
    for (var k = 0u; k < 3u; k++) {
        bits[k] = max(firstLeadingBit(counters[SPHERES + 2u + k] / size + 1u) + 1u, 2u);
    }
    let most = max(32u - countLeadingZeros(count) + 1u, 6u);
    while bits.x + bits.y + bits.z > most {
        var longest = 0u;
        for (var k = 1u; k < 3u; k++) {
            // Of equal axes the last one is shortened, as in the core.
            if bits[k] >= bits[longest] {
                longest = k;
            }
        }
        bits[longest] -= 1u;
    }
    counters[CELL_GRID] = size;
    for (var k = 0u; k < 3u; k++) {
        counters[CELL_GRID + 1u + k] = bits[k];
    }
}

@compute @workgroup_size(256)
fn write_cells(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) local: u32) {
    let triangle = workgroup_index(group) * GROUP + local;
    if triangle >= params.triangles {
        return;
    }
    let sphere = spheres[triangle];
    if sphere.x < 0 {
        homes[triangle] = vec2<u32>(0u);
        return;
    }
    let size = i32(counters[CELL_GRID]);
    let cover_squared = 2u * u32(sphere.w);
    var key = 0u;
    var parity = 0u;
    var upward = 0u;
    var gaps_squared: vec3<u32>;
    var field = 0u;
    for (var k = 0u; k < 3u; k++) {
        let cell = sphere[k] / size;
        let below = sphere[k] - cell * size;
        let above = size - below;
        let bits = counters[CELL_GRID + 1u + k];
        key |= (u32(cell) & ((1u << bits) - 1u)) << field;
        field += bits;
        parity |= (u32(cell) & 1u) << k;
        upward |= select(0u, 1u, above < below) << k;
        let gap = u32(min(min(above, below), 16384));
        gaps_squared[k] = gap * gap;
    }
    var mask = 0u;
    for (var across = 0u; across < 8u; across++) {
        var gap_squared = 0u;
        for (var k = 0u; k < 3u; k++) {
            gap_squared += select(0u, gaps_squared[k], ((across >> k) & 1u) == 1u);
        }
        mask |= select(0u, 1u, gap_squared <= cover_squared) << (parity ^ across);
    }
    homes[triangle] = vec2<u32>(key, mask | (parity << HOME_SHIFT) | (upward << UPWARD_SHIFT));
}

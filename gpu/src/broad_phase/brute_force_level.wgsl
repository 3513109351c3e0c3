// The last level: compares each of its triangles with all others, without cells, ROUND triangles per round.

@group(0) @binding(1) var<storage, read> levels: array<u32>;
@group(0) @binding(2) var<storage, read> triangle_boxes: array<f32>;
// The triangles of the last level.
@group(0) @binding(3) var<storage, read_write> list: array<u32>;
@group(0) @binding(4) var<storage, read_write> counts: array<u32>;
@group(0) @binding(5) var<storage, read> blocks: array<u32>;
@group(0) @binding(6) var<storage, read_write> pairs: array<vec2<u32>>;
@group(0) @binding(7) var<storage, read_write> counters: array<u32>;

@compute @workgroup_size(256)
fn count_last(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) local: u32) {
    let triangle = workgroup_index(group) * GROUP + local;
    if triangle < params.triangles {
        counts[triangle] = select(0u, 1u, levels[triangle] == counters[GRADED]);
    }
}

@compute @workgroup_size(256)
fn list_last(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) local: u32) {
    let triangle = workgroup_index(group) * GROUP + local;
    if triangle < params.triangles && levels[triangle] == counters[GRADED] {
        list[counts[triangle]] = triangle;
    }
}

const ROUND: u32 = 64u;

fn visit(b: u32, writes: bool, place: u32) -> u32 {
    let last = counters[GRADED];
    let level = levels[b];
    if level == NO_LEVEL {
        return 0u;
    }
    var found = 0u;
    let first = ROUND * params.level;
    for (var k = first; k < min(first + ROUND, counters[SINGLE]); k++) {
        let a = list[k];
        if (level != last || b > a) && triangles_overlap(a, b) && may_pair(a, b) {
            if writes && place + found < params.pairs {
                pairs[place + found] = vec2<u32>(a, b);
            }
            found++;
        }
    }
    return found;
}

@compute @workgroup_size(256)
fn count_brute_force(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) local: u32) {
    let triangle = workgroup_index(group) * GROUP + local;
    if triangle < params.triangles {
        counts[triangle] = 0u;
        if !overflowed(NO_ROOM_BEFORE_PAIRS) {
            counts[triangle] = visit(triangle, false, 0u);
        }
    }
}

@compute @workgroup_size(256)
fn write_brute_force(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) local: u32) {
    let triangle = workgroup_index(group) * GROUP + local;
    if triangle < params.triangles && !overflowed(NO_ROOM_FOR_PAIRS) {
        visit(triangle, true, counters[PAIRS] + counts[triangle]);
    }
}

// Runs as one invocation.
@compute @workgroup_size(1)
fn close_brute_force() {
    counters[PAIRS] = saturated(counters[PAIRS], blocks[(params.triangles + 2047u) / 2048u]);
    if counters[PAIRS] > params.pairs {
        counters[STATUS] |= NO_ROOM_PAIRS;
    }
}

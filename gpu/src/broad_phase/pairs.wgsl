// Pairs of triangles whose boxes overlap, each from exactly one of their common cells.
//
// In a cell, own homes meet everything after them, smaller homes only own phantoms.

// Key, object and its box in bytes.
@group(0) @binding(1) var<storage, read> boxed: array<vec4<u32>>;
@group(0) @binding(2) var<storage, read> homes: array<vec2<u32>>;
@group(0) @binding(3) var<storage, read> triangle_boxes: array<f32>;
// How many pairs each entry makes, and after the scan how many those before it do.
@group(0) @binding(4) var<storage, read_write> counts: array<u32>;
@group(0) @binding(5) var<storage, read> blocks: array<u32>;
@group(0) @binding(6) var<storage, read_write> pairs: array<vec2<u32>>;
@group(0) @binding(7) var<storage, read_write> plan: array<u32>;

const IS_HOME: u32 = 0x80000000u;
const IS_OWN: u32 = 0x40000000u;
const ALL: u32 = 0xffffffffu;
const ID: u32 = 0x3fffffffu;

fn cell_type(key: u32) -> u32 {
    let y = plan[LATTICE + 1u];
    let z = y + plan[LATTICE + 2u];
    return (key & 1u) | (((key >> y) & 1u) << 1u) | (((key >> z) & 1u) << 2u);
}

// The sign of each byte.
const SIGNS: u32 = 0x00808080u;

// Whether no byte of a difference is negative.
fn none_below(a: u32, b: u32) -> bool {
    return ((((a | SIGNS) - (b & ~SIGNS)) ^ (a ^ ~b)) & SIGNS) == 0u;
}

// Whether boxes in bytes overlap. Those far apart may seem to.
fn may_overlap(a: vec2<u32>, b: vec2<u32>) -> bool {
    return none_below(a.y, b.x) && none_below(b.y, a.x);
}

// Finds so many partners of an entry at most; writes them from a place on, if told to, and returns how
// many.
fn visit(at: u32, most: u32, writes: bool, place: u32) -> u32 {
    let entry = boxed[at];
    if (entry.y & IS_HOME) == 0u {
        return 0u;
    }
    let is_own = (entry.y & IS_OWN) != 0u;
    let a = entry.y & ID;
    let control = homes[a].y;
    let cell = cell_type(entry.x);
    let end = min(plan[ENTRIES], params.entries);
    var found = 0u;
    for (var other = at + 1u; other < end && found < most; other++) {
        let next = boxed[other];
        let kind = next.y & (IS_HOME | IS_OWN);
        // Behind own phantoms there are only smaller ones.
        if next.x != entry.x || (!is_own && kind == 0u) {
            break;
        }
        let b = next.y & ID;
        if (is_own || kind == IS_OWN) && may_overlap(entry.zw, next.zw)
            && triangles_overlap(a, b) && may_pair(a, b) && !skips(control, homes[b].y, cell) {
            if writes && place + found < params.pairs {
                pairs[place + found] = vec2<u32>(a, b);
            }
            found++;
        }
    }
    return found;
}

@compute @workgroup_size(256)
fn count_pairs(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) local: u32) {
    let at = place(group) * GROUP + local;
    if at < params.entries {
        counts[at] = 0u;
        if at < plan[ENTRIES] && !lacks(NO_ROOM_BEFORE_PAIRS) {
            counts[at] = visit(at, ALL, false, 0u);
        }
    }
}

// After the scan.
fn pairs_before(at: u32) -> u32 {
    if at < params.entries {
        return counts[at];
    }
    return blocks[(params.entries + 2047u) / 2048u];
}

@compute @workgroup_size(256)
fn write_pairs(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) local: u32) {
    let at = place(group) * GROUP + local;
    if at < min(plan[ENTRIES], params.entries) && !lacks(NO_ROOM_FOR_PAIRS) {
        let before = pairs_before(at);
        visit(at, pairs_before(at + 1u) - before, true, plan[PAIRS] + before);
    }
}

// One invocation: later pairs come behind these.
@compute @workgroup_size(1)
fn close_pairs() {
    plan[PAIRS] = saturated(plan[PAIRS], pairs_before(params.entries));
    if plan[PAIRS] > params.pairs {
        plan[STATUS] |= NO_ROOM_PAIRS;
    }
}

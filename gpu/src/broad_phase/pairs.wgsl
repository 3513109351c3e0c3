// Pairs of triangles whose boxes overlap, each found in exactly one of their common cells.
//
// One workgroup searches one tile: each invocation compares its entry with the other entries of the tile, which
// the workgroup reads together.

// Key, object and box in bytes of each entry.
@group(0) @binding(1) var<storage, read> boxed: array<vec4<u32>>;
// The first entry and the first other entry of each tile.
@group(0) @binding(2) var<storage, read> tiles: array<vec2<u32>>;
@group(0) @binding(3) var<storage, read> homes: array<vec2<u32>>;
@group(0) @binding(4) var<storage, read> triangle_boxes: array<f32>;
// Number of pairs of each tile; after the scan, the number of pairs of all tiles before it.
@group(0) @binding(5) var<storage, read_write> counts: array<u32>;
@group(0) @binding(6) var<storage, read> blocks: array<u32>;
@group(0) @binding(7) var<storage, read_write> pairs: array<vec2<u32>>;
@group(0) @binding(8) var<storage, read_write> counters: array<u32>;

const WORD: u32 = 32u;
// A placeholder: a phantom in a cell that does not exist.
const NOTHING: vec4<u32> = vec4<u32>(0xffffffffu, 0u, 0u, 0u);

var<workgroup> others: array<vec4<u32>, SIDE>;
var<workgroup> hits: array<u32, SIDE>;

fn cell_type(key: u32) -> u32 {
    let y = counters[CELL_GRID + 1u];
    let z = y + counters[CELL_GRID + 2u];
    return (key & 1u) | (((key >> y) & 1u) << 1u) | (((key >> z) & 1u) << 2u);
}

// The sign bits of the three bytes.
const SIGNS: u32 = 0x00808080u;

// Whether no byte of the difference a - b is negative.
fn none_below(a: u32, b: u32) -> bool {
    return ((((a | SIGNS) - (b & ~SIGNS)) ^ (a ^ ~b)) & SIGNS) == 0u;
}

// Whether boxes in bytes may overlap. Boxes that are far apart can pass, because coordinates are modulo 256.
fn may_overlap(a: vec2<u32>, b: vec2<u32>) -> bool {
    return none_below(a.y, b.x) && none_below(b.y, a.x);
}

// Reads the entry of an invocation, and one of the other entries for the whole workgroup.
fn load(tile: u32, local: u32) -> vec4<u32> {
    let place = tiles[tile] + local;
    let end = min(counters[ENTRIES], params.entries);
    others[local] = NOTHING;
    if place.y < end {
        others[local] = boxed[place.y];
    }
    if place.x < end {
        return boxed[place.x];
    }
    return NOTHING;
}

// A bit for each partner of an entry among the WORD others from `half` on. The first `few` others do not come
// after the entry and are skipped.
fn among(half: u32, entry: vec4<u32>, few: u32) -> u32 {
    let is_own = kind_of(entry.y) == OWN_HOME;
    let a = entry.y & ID;
    let control = homes[a].y;
    let cell = cell_type(entry.x);
    var found = 0u;
    for (var k = max(few, half); k < half + WORD; k++) {
        let other = others[k];
        if other.x == entry.x && (is_own || kind_of(other.y) == OWN_PHANTOM) && may_overlap(entry.zw, other.zw) {
            let b = other.y & ID;
            if triangles_overlap(a, b) && may_pair(a, b) && !skips(control, homes[b].y, cell) {
                found |= 1u << (k - half);
            }
        }
    }
    return found;
}

// A bit for each partner of an entry among all others of the tile.
fn partners(tile: u32, local: u32, entry: vec4<u32>) -> vec2<u32> {
    if (entry.y & IS_HOME) == 0u {
        return vec2<u32>(0u);
    }
    let place = tiles[tile] + vec2<u32>(local + 1u, 0u);
    let few = place.x - min(place.x, place.y);
    return vec2<u32>(among(0u, entry, few), among(WORD, entry, few));
}

// The partners of an invocation's entry, and in `hits` the number of partners for each invocation of the workgroup.
// If `is_wanted` is false, there are no partners. All invocations of the workgroup must call it.
fn find(tile: u32, local: u32, is_wanted: bool) -> vec2<u32> {
    var entry = NOTHING;
    if is_wanted {
        entry = load(tile, local);
    }
    workgroupBarrier();
    var found = vec2<u32>(0u);
    if is_wanted {
        found = partners(tile, local, entry);
    }
    hits[local] = countOneBits(found.x) + countOneBits(found.y);
    workgroupBarrier();
    return found;
}

// Number of pairs that the invocations of the workgroup before `local` found.
fn hits_before(local: u32) -> u32 {
    var sum = 0u;
    for (var k = 0u; k < local; k++) {
        sum += hits[k];
    }
    return sum;
}

// One workgroup per tile.
@compute @workgroup_size(64)
fn count_pairs(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) local: u32) {
    let tile = workgroup_index(group);
    let is_there = tile < min(counters[TILES], params.tiles) && !overflowed(NO_ROOM_BEFORE_PAIRS);
    find(tile, local, is_there);
    if local == 0u && tile < params.tiles {
        counts[tile] = hits_before(SIDE);
    }
}

// Number of pairs of all tiles before `tile`; valid after the scan.
fn pairs_before(tile: u32) -> u32 {
    if tile < params.tiles {
        return counts[tile];
    }
    return blocks[(params.tiles + 2047u) / 2048u];
}

@compute @workgroup_size(64)
fn write_pairs(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) local: u32) {
    let tile = workgroup_index(group);
    let has_some = tile < params.tiles && pairs_before(tile) < pairs_before(tile + 1u)
        && !overflowed(NO_ROOM_FOR_PAIRS);
    let found = find(tile, local, has_some);
    if !any(found != vec2<u32>(0u)) {
        return;
    }
    let own = boxed[tiles[tile].x + local].y & ID;
    var at = counters[PAIRS] + pairs_before(tile) + hits_before(local);
    for (var half = 0u; half < 2u; half++) {
        var left = found[half];
        while left != 0u {
            let other = others[half * WORD + firstTrailingBit(left)];
            left &= left - 1u;
            if at < params.pairs {
                pairs[at] = vec2<u32>(own, other.y & ID);
            }
            at++;
        }
    }
}

// Runs as one invocation. Later levels append their pairs after these.
@compute @workgroup_size(1)
fn close_pairs() {
    counters[PAIRS] = saturated(counters[PAIRS], pairs_before(params.tiles));
    if counters[PAIRS] > params.pairs {
        counters[STATUS] |= NO_ROOM_PAIRS;
    }
}

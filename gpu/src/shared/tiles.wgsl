// Splits the comparisons of entries into tiles of one size: a row of 64 entries with 64 others at a time.
//
// In a cell, own homes are compared with all entries after them, smaller homes only with own phantoms.

// Key, object and box in bytes of each entry, sorted by key. In a cell, own homes come first, then smaller homes,
// own phantoms and smaller phantoms.
@group(0) @binding(1) var<storage, read> boxed: array<vec4<u32>>;
// Number of tiles of each row; after the scan, the number of tiles of all rows before it.
@group(0) @binding(2) var<storage, read_write> counts: array<u32>;
@group(0) @binding(3) var<storage, read> blocks: array<u32>;
// The first entry and the first other entry of each tile.
@group(0) @binding(4) var<storage, read_write> tiles: array<vec2<u32>>;
@group(0) @binding(5) var<storage, read_write> counters: array<u32>;

var<workgroup> first: atomic<u32>;
var<workgroup> last: atomic<u32>;

fn row_count() -> u32 {
    return (params.entries + SIDE - 1u) / SIDE;
}

// The first entry from `start` on that is not in the cell or is of a lower kind.
fn end_of(cell: u32, kind: u32, start: u32, end: u32) -> u32 {
    var low = start;
    var high = end;
    while low < high {
        let middle = low + (high - low) / 2u;
        let entry = boxed[middle].xy;
        if entry.x == cell && kind_of(entry.y) >= kind {
            low = middle + 1u;
        } else {
            high = middle;
        }
    }
    return low;
}

// The first other entry of a row and the number of its tiles, returned to all invocations of its workgroup.
fn span(row: u32, local: u32) -> vec2<u32> {
    if local == 0u {
        atomicStore(&first, 0xffffffffu);
        atomicStore(&last, 0u);
    }
    workgroupBarrier();
    let at = row * SIDE + local;
    let end = min(counters[ENTRIES], params.entries);
    if at < end {
        let entry = boxed[at].xy;
        let kind = kind_of(entry.y);
        if kind >= SMALLER_HOME {
            var from_others = at + 1u;
            if kind == SMALLER_HOME {
                from_others = end_of(entry.x, SMALLER_HOME, from_others, end);
            }
            let to_others = end_of(entry.x, select(OWN_PHANTOM, 0u, kind == OWN_HOME), from_others, end);
            if from_others < to_others {
                atomicMin(&first, from_others);
                atomicMax(&last, to_others);
            }
        }
    }
    workgroupBarrier();
    let start = atomicLoad(&first);
    let stop = max(atomicLoad(&last), start);
    return vec2<u32>(start, (stop - start + SIDE - 1u) / SIDE);
}

// One workgroup per row.
@compute @workgroup_size(64)
fn count_tiles(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) local: u32) {
    let row = workgroup_index(group);
    let own = span(row, local);
    if local == 0u && row < row_count() {
        counts[row] = select(own.y, 0u, overflowed(NO_ROOM_BEFORE_TILES));
    }
}

@compute @workgroup_size(64)
fn write_tiles(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) local: u32) {
    let row = workgroup_index(group);
    let own = span(row, local);
    if row == 0u && local == 0u {
        let all = blocks[(row_count() + 2047u) / 2048u];
        counters[TILES] = all;
        counters[MOST_TILES] = max(counters[MOST_TILES], all);
        if all > params.tiles {
            counters[STATUS] |= NO_ROOM_TILES;
        }
    }
    if row >= row_count() || overflowed(NO_ROOM_BEFORE_TILES) {
        return;
    }
    for (var k = local; k < own.y && counts[row] + k < params.tiles; k += SIDE) {
        tiles[counts[row] + k] = vec2<u32>(SIDE * row, own.x + SIDE * k);
    }
}

// Levels of triangles by size: a histogram of sizes, its division into levels, and the level of every triangle.

@group(0) @binding(1) var<storage, read> triangle_boxes: array<f32>;
@group(0) @binding(2) var<storage, read_write> levels: array<u32>;
// The count of each bin, then the level of each bin.
@group(0) @binding(3) var<storage, read_write> histogram: array<atomic<u32>>;
@group(0) @binding(4) var<storage, read_write> counters: array<atomic<u32>>;

const MOST: u32 = 8u;
const FEW: u32 = 32u;
const REACH: u32 = 8u;
const BINS: u32 = 1024u;
const UNBOUNDED: u32 = 1020u;
const INFINITE: u32 = 0x7f800000u;
const LARGEST: f32 = 3.4028234663852886e38;

// Maps a number to an integer; the integers compare as the numbers do.
fn ordered(x: f32) -> u32 {
    let bits = bitcast<u32>(x);
    return select(bits | 0x80000000u, ~bits, (bits & 0x80000000u) != 0u);
}

struct Extent {
    is_valid: bool,
    bits: u32,
}

// The largest extent of a triangle's box, as bits. It is infinite if the box is unbounded or the extent overflows.
fn extent(triangle: u32) -> Extent {
    var bits = 0u;
    var is_valid = true;
    for (var k = 0u; k < 3u; k++) {
        let low = triangle_boxes[6u * triangle + k];
        let high = triangle_boxes[6u * triangle + 3u + k];
        is_valid = is_valid && low <= high;
        // Halves are compared, because the difference itself may overflow.
        let is_unbounded = low <= -LARGEST || high >= LARGEST || 0.5 * high - 0.5 * low > 0.5 * LARGEST;
        bits = max(bits, select(bitcast<u32>(high - low), INFINITE, is_unbounded));
    }
    return Extent(is_valid, bits & 0x7fffffffu);
}

var<workgroup> counts: array<atomic<u32>, BINS>;
var<workgroup> scene: array<atomic<u32>, 6>;

@compute @workgroup_size(256)
fn count_sizes(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) local: u32) {
    if local < 3u {
        atomicStore(&scene[local], 0xffffffffu);
    }
    workgroupBarrier();
    let triangle = workgroup_index(group) * GROUP + local;
    if triangle < params.triangles {
        let size = extent(triangle);
        let bin = size.bits >> 21u;
        if size.is_valid {
            atomicAdd(&counts[bin], 1u);
        }
        if size.is_valid && bin < UNBOUNDED {
            for (var k = 0u; k < 3u; k++) {
                atomicMin(&scene[k], ordered(triangle_boxes[6u * triangle + k]));
                atomicMax(&scene[3u + k], ordered(triangle_boxes[6u * triangle + 3u + k]));
            }
        }
    }
    workgroupBarrier();
    for (var bin = local; bin < BINS; bin += GROUP) {
        let count = atomicLoad(&counts[bin]);
        if count > 0u {
            atomicAdd(&histogram[bin], count);
        }
    }
    if local < 3u {
        atomicMin(&counters[SCENE + local], atomicLoad(&scene[local]));
        atomicMax(&counters[SCENE + 3u + local], atomicLoad(&scene[3u + local]));
    }
}

var<workgroup> bins: array<u32, BINS>;
var<workgroup> table: array<u32, BINS>;

@compute @workgroup_size(256)
fn divide(@builtin(local_invocation_index) local: u32) {
    for (var bin = local; bin < BINS; bin += GROUP) {
        bins[bin] = atomicLoad(&histogram[bin]);
    }
    workgroupBarrier();
    if local == 0u {
        var left = 0u;
        for (var bin = 0u; bin < BINS; bin++) {
            left += bins[bin];
            table[bin] = 0u;
        }
        var next = 0u;
        var level = 0u;
        while level < MOST && left - bins[UNBOUNDED] > FEW {
            let quantile = left / 16u;
            var passed = 0u;
            var start = next;
            while start < UNBOUNDED && passed + bins[start] <= quantile {
                passed += bins[start];
                start++;
            }
            let end = min(start + REACH, UNBOUNDED);
            for (var bin = next; bin < end; bin++) {
                table[bin] = level;
                left -= bins[bin];
            }
            next = end;
            level++;
        }
        for (var bin = next; bin < BINS; bin++) {
            table[bin] = level;
        }
        atomicStore(&counters[GRADED], level);
        atomicStore(&counters[SINGLE], left);
        // The host runs only params.level levels, and rounds for params.length triangles of the last level.
        if level > params.level {
            atomicOr(&counters[STATUS], NO_ROOM_LEVELS);
        }
        if left > params.length {
            atomicOr(&counters[STATUS], NO_ROOM_ROUNDS);
        }
    }
    workgroupBarrier();
    for (var bin = local; bin < BINS; bin += GROUP) {
        atomicStore(&histogram[BINS + bin], table[bin]);
    }
}

@compute @workgroup_size(256)
fn assign(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) local: u32) {
    let triangle = workgroup_index(group) * GROUP + local;
    if triangle >= params.triangles {
        return;
    }
    let size = extent(triangle);
    var level = NO_LEVEL;
    if size.is_valid {
        level = atomicLoad(&histogram[BINS + (size.bits >> 21u)]);
        if level < MOST {
            atomicMax(&counters[EXTENTS + level], size.bits);
        }
    }
    levels[triangle] = level;
}

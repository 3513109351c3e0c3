// Stable radix sort by cell, four bits per pass. Entries are counted by digit and block. The scan of these counts,
// digit by digit, gives the places where each block's entries of a digit begin.

@group(0) @binding(1) var<storage, read> entries: array<vec2<u32>>;
@group(0) @binding(2) var<storage, read_write> sorted: array<vec2<u32>>;
// One number per digit and block, ordered by digit.
@group(0) @binding(3) var<storage, read_write> counts: array<u32>;
@group(0) @binding(4) var<storage, read> counters: array<u32>;

const EACH: u32 = 8u;
const BLOCK: u32 = 2048u;
const DIGITS: u32 = 16u;
const HALF: u32 = 8u;

fn digit(key: u32) -> u32 {
    return (key >> params.shift) & (DIGITS - 1u);
}

fn count() -> u32 {
    return min(counters[ENTRIES], params.entries);
}

fn blocks() -> u32 {
    return (params.entries + BLOCK - 1u) / BLOCK;
}

var<workgroup> digit_counts: array<atomic<u32>, DIGITS>;

@compute @workgroup_size(256)
fn count_digits(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) local: u32) {
    let block = workgroup_index(group);
    let end = min(count(), (block + 1u) * BLOCK);
    for (var at = block * BLOCK + local; at < end; at += GROUP) {
        atomicAdd(&digit_counts[digit(entries[at].x)], 1u);
    }
    workgroupBarrier();
    if local < DIGITS && block < blocks() {
        counts[local * blocks() + block] = atomicLoad(&digit_counts[local]);
    }
}

// Entries of each invocation by digit, then the sums up to and including it. A word holds two digits that differ
// by eight.
var<workgroup> ranks: array<u32, 2048>;

@compute @workgroup_size(256)
fn scatter(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) local: u32) {
    let block = workgroup_index(group);
    let start = block * BLOCK + local * EACH;
    let end = min(count(), start + EACH);
    var own = array<u32, HALF>();
    for (var at = start; at < end; at++) {
        let bin = digit(entries[at].x);
        own[bin % HALF] += 1u << (16u * (bin / HALF));
    }
    var sums = own;
    for (var row = 0u; row < HALF; row++) {
        ranks[row * GROUP + local] = own[row];
    }
    workgroupBarrier();
    for (var reach = 1u; reach < GROUP; reach <<= 1u) {
        if local >= reach {
            for (var row = 0u; row < HALF; row++) {
                sums[row] += ranks[row * GROUP + local - reach];
            }
        }
        workgroupBarrier();
        for (var row = 0u; row < HALF; row++) {
            ranks[row * GROUP + local] = sums[row];
        }
        workgroupBarrier();
    }
    for (var row = 0u; row < HALF; row++) {
        sums[row] -= own[row];
    }
    for (var at = start; at < end; at++) {
        let entry = entries[at];
        let bin = digit(entry.x);
        let half = 16u * (bin / HALF);
        let rank = (sums[bin % HALF] >> half) & 0xffffu;
        sums[bin % HALF] += 1u << half;
        sorted[counts[bin * blocks() + block] + rank] = entry;
    }
}

// Exclusive prefix sums: first the sum of each block, then the prefix sums of the blocks, then those of all numbers.

@group(0) @binding(1) var<storage, read_write> numbers: array<u32>;
// The sum of all numbers before each block; after the last block, the sum of all numbers.
@group(0) @binding(2) var<storage, read_write> blocks: array<u32>;

const EACH: u32 = 8u;
const BLOCK: u32 = 2048u;

var<workgroup> sums: array<u32, GROUP>;

// The sum over all invocations of the workgroup before this one. The last of `sums` is then the sum over the whole
// workgroup.
fn before(local: u32, own: u32) -> u32 {
    sums[local] = own;
    workgroupBarrier();
    for (var reach = 1u; reach < GROUP; reach <<= 1u) {
        var sum = sums[local];
        if local >= reach {
            sum = saturated(sum, sums[local - reach]);
        }
        workgroupBarrier();
        sums[local] = sum;
        workgroupBarrier();
    }
    return sums[local] - own;
}

fn number(at: u32) -> u32 {
    if at < params.length {
        return numbers[at];
    }
    return 0u;
}

@compute @workgroup_size(256)
fn sum_blocks(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) local: u32) {
    let block = workgroup_index(group);
    let start = block * BLOCK + local * EACH;
    var sum = 0u;
    for (var k = 0u; k < EACH; k++) {
        sum = saturated(sum, number(start + k));
    }
    sums[local] = sum;
    workgroupBarrier();
    for (var reach = GROUP / 2u; reach > 0u; reach >>= 1u) {
        if local < reach {
            sums[local] = saturated(sums[local], sums[local + reach]);
        }
        workgroupBarrier();
    }
    if local == 0u && block * BLOCK < params.length {
        blocks[block] = sums[0];
    }
}

// Runs as one workgroup.
@compute @workgroup_size(256)
fn scan_blocks(@builtin(local_invocation_index) local: u32) {
    let count = (params.length + BLOCK - 1u) / BLOCK;
    var carry = 0u;
    for (var start = 0u; start < count; start += GROUP) {
        let at = start + local;
        var own = 0u;
        if at < count {
            own = blocks[at];
        }
        let sum = before(local, own);
        if at < count {
            blocks[at] = saturated(carry, sum);
        }
        carry = saturated(carry, sums[GROUP - 1u]);
        workgroupBarrier();
    }
    if local == 0u {
        blocks[count] = carry;
    }
}

@compute @workgroup_size(256)
fn spread(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) local: u32) {
    let block = workgroup_index(group);
    let start = block * BLOCK + local * EACH;
    var own = 0u;
    for (var k = 0u; k < EACH; k++) {
        own = saturated(own, number(start + k));
    }
    var sum = before(local, own);
    if block * BLOCK >= params.length {
        return;
    }
    sum += blocks[block];
    for (var k = 0u; k < EACH; k++) {
        let at = start + k;
        if at < params.length {
            let next = sum + numbers[at];
            numbers[at] = sum;
            sum = next;
        }
    }
}

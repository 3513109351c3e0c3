// One entry for each cell that an object touches, in this order: own homes, smaller homes, own phantoms, smaller
// phantoms. Own objects belong to this level, smaller ones to levels before.

@group(0) @binding(1) var<storage, read> homes: array<vec2<u32>>;
@group(0) @binding(2) var<storage, read> levels: array<u32>;
// Four sections with one number per triangle: its number of entries; after the scan, the number before it.
@group(0) @binding(3) var<storage, read_write> counts: array<u32>;
// After the last block: the sum of all counts.
@group(0) @binding(4) var<storage, read> blocks: array<u32>;
// Key of the cell and object of each entry.
@group(0) @binding(5) var<storage, read_write> entries: array<vec2<u32>>;
@group(0) @binding(6) var<storage, read_write> counters: array<u32>;

@compute @workgroup_size(256)
fn count_entries(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) local: u32) {
    let triangle = workgroup_index(group) * GROUP + local;
    if triangle >= params.triangles {
        return;
    }
    let control = homes[triangle].y;
    let is_own = levels[triangle] == params.level;
    let is_present = control != 0u;
    let homes_here = select(0u, 1u, is_present);
    let phantoms = select(0u, countOneBits(control & MASK) - 1u, is_present);
    counts[triangle] = select(0u, homes_here, is_own);
    counts[params.triangles + triangle] = select(homes_here, 0u, is_own);
    counts[2u * params.triangles + triangle] = select(0u, phantoms, is_own);
    counts[3u * params.triangles + triangle] = select(phantoms, 0u, is_own);
}

fn push(at: u32, key: u32, object: u32) {
    if at < params.entries {
        entries[at] = vec2<u32>(key, object);
    }
}

@compute @workgroup_size(256)
fn write_entries(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) local: u32) {
    let triangle = workgroup_index(group) * GROUP + local;
    if triangle == 0u {
        let all = blocks[(4u * params.triangles + 2047u) / 2048u];
        counters[ENTRIES] = all;
        counters[MOST_ENTRIES] = max(counters[MOST_ENTRIES], all);
        if all > params.entries {
            counters[STATUS] |= NO_ROOM_ENTRIES;
        }
    }
    if triangle >= params.triangles {
        return;
    }
    let key = homes[triangle].x;
    let control = homes[triangle].y;
    if control == 0u {
        return;
    }
    let own = select(0u, IS_OWN, levels[triangle] == params.level);
    let section = select(1u, 0u, own != 0u);
    push(counts[section * params.triangles + triangle], key, triangle | own | IS_HOME);
    var at = counts[(2u + section) * params.triangles + triangle];
    let parity = home(control);
    var phantoms = control & MASK & ~(1u << parity);
    while phantoms != 0u {
        let across = firstTrailingBit(phantoms) ^ parity;
        phantoms &= phantoms - 1u;
        var neighbour = key;
        var field = 0u;
        for (var k = 0u; k < 3u; k++) {
            let bits = counters[CELL_GRID + 1u + k];
            if ((across >> k) & 1u) == 1u {
                let one = 1u << field;
                let mask = ((1u << bits) - 1u) << field;
                let is_upward = ((control >> (UPWARD_SHIFT + k)) & 1u) == 1u;
                let stepped = select(neighbour - one, neighbour + one, is_upward);
                neighbour = (neighbour & ~mask) | (stepped & mask);
            }
            field += bits;
        }
        push(at, neighbour, triangle | own);
        at++;
    }
}

// The boxes of triangles in bytes, three bytes per word, and a copy of them beside the key of each entry, so
// that neighbouring invocations read contiguous memory.
//
// Coordinates are rounded down to units, of which a triangle spans at most 60, and taken modulo 256.

@group(0) @binding(1) var<storage, read> quantized_boxes: array<i32>;
@group(0) @binding(2) var<storage, read> triangles: array<u32>;
@group(0) @binding(3) var<storage, read> levels: array<u32>;
@group(0) @binding(4) var<storage, read> entries: array<vec2<u32>>;
// Minimum and maximum of each box.
@group(0) @binding(5) var<storage, read_write> byte_boxes: array<vec2<u32>>;
// Key, object and box of each entry.
@group(0) @binding(6) var<storage, read_write> boxed: array<vec4<u32>>;
@group(0) @binding(7) var<storage, read> counters: array<u32>;

// Packs a corner into three bytes. Converts from units of which a triangle spans at most 2^10 to units of which
// it spans at most 60.
fn word(corner: vec3<i32>) -> u32 {
    let bytes = vec3<u32>((corner * 15) >> vec3<u32>(8u)) & vec3<u32>(0xffu);
    return bytes.x | (bytes.y << 8u) | (bytes.z << 16u);
}

@compute @workgroup_size(256)
fn write_byte_boxes(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) local: u32) {
    let triangle = workgroup_index(group) * GROUP + local;
    if triangle >= params.triangles || levels[triangle] > params.level {
        return;
    }
    var low = vec3<i32>(0x7fffffff);
    var high = vec3<i32>(-1);
    for (var k = 0u; k < 3u; k++) {
        let at = 6u * triangles[3u * triangle + k];
        low = min(low, vec3<i32>(quantized_boxes[at], quantized_boxes[at + 1u], quantized_boxes[at + 2u]));
        high = max(high, vec3<i32>(quantized_boxes[at + 3u], quantized_boxes[at + 4u], quantized_boxes[at + 5u]));
    }
    byte_boxes[triangle] = vec2<u32>(word(low), word(high));
}

@compute @workgroup_size(256)
fn gather(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) local: u32) {
    let at = workgroup_index(group) * GROUP + local;
    if at < min(counters[ENTRIES], params.entries) {
        let entry = entries[at];
        boxed[at] = vec4<u32>(entry, byte_boxes[entry.y & ID]);
    }
}

// The boxes of vertices rounded down to integers, and the scale of the rounding. Boxes that overlap still overlap
// afterwards, because rounding is monotone.

@group(0) @binding(1) var<storage, read> boxes: array<f32>;
@group(0) @binding(2) var<storage, read_write> quantized_boxes: array<i32>;
@group(0) @binding(3) var<storage, read_write> counters: array<u32>;

const FINE: i32 = 9;
const RANGE: i32 = 26;
const MOST: f32 = 134217728.0;
const EMPTY: i32 = 134217728;

fn unordered(bits: u32) -> f32 {
    return bitcast<f32>(select(~bits, bits & 0x7fffffffu, (bits & 0x80000000u) != 0u));
}

fn exponent(bits: u32) -> i32 {
    return i32(bits >> 23u) - 127;
}

// Runs as one invocation. It also resets the counters of the spheres for this level.
@compute @workgroup_size(1)
fn choose_scale() {
    let low = vec3<f32>(unordered(counters[SCENE]), unordered(counters[SCENE + 1u]), unordered(counters[SCENE + 2u]));
    let high =
        vec3<f32>(unordered(counters[SCENE + 3u]), unordered(counters[SCENE + 4u]), unordered(counters[SCENE + 5u]));
    let size = high - low;
    let whole = bitcast<u32>(max(max(size.x, size.y), size.z));
    let extent = counters[EXTENTS + params.level];
    let shift = clamp(min(FINE - exponent(extent), RANGE - exponent(whole)), -126, 127);
    for (var k = 0u; k < 3u; k++) {
        counters[QUANTIZATION + k] = bitcast<u32>(low[k]);
    }
    counters[QUANTIZATION + 3u] = u32(shift + 127) << 23u;
    for (var k = 0u; k < 5u; k++) {
        counters[SPHERES + k] = 0u;
    }
}

@compute @workgroup_size(256)
fn write_quantized_boxes(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) local: u32) {
    let vertex = workgroup_index(group) * GROUP + local;
    if vertex >= params.vertices {
        return;
    }
    let scale = bitcast<f32>(counters[QUANTIZATION + 3u]);
    var is_valid = true;
    for (var k = 0u; k < 3u; k++) {
        is_valid = is_valid && boxes[6u * vertex + k] <= boxes[6u * vertex + 3u + k];
    }
    for (var k = 0u; k < 6u; k++) {
        let origin = bitcast<f32>(counters[QUANTIZATION + k % 3u]);
        let unit = i32(clamp((boxes[6u * vertex + k] - origin) * scale, 0.0, MOST));
        quantized_boxes[6u * vertex + k] = select(select(0, EMPTY, k < 3u), unit, is_valid);
    }
}

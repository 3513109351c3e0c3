// The boxes of triangles: unions of the boxes of their vertices.
//
// The host replaces an invalid box by one whose minimum is the largest number and whose maximum is the
// smallest one, so that no adapter has to handle NaN.

@group(0) @binding(1) var<storage, read> boxes: array<f32>;
@group(0) @binding(2) var<storage, read> triangles: array<u32>;
@group(0) @binding(3) var<storage, read> given: array<u32>;
@group(0) @binding(4) var<storage, read_write> triangle_boxes: array<f32>;
@group(0) @binding(5) var<storage, read_write> owned: array<u32>;

const LARGEST: f32 = 3.4028234663852886e38;
const OWNS_VERTEX: u32 = 1u;
const OWNS_EDGE: u32 = 8u;
const IS_FACE: u32 = 64u;

@compute @workgroup_size(256)
fn write_bounds(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) local: u32) {
    let triangle = workgroup_index(group) * GROUP + local;
    if triangle >= params.triangles {
        return;
    }
    var low = vec3<f32>(LARGEST);
    var high = vec3<f32>(-LARGEST);
    var owns = given[triangle];
    for (var k = 0u; k < 3u; k++) {
        let at = 6u * triangles[3u * triangle + k];
        let least = vec3<f32>(boxes[at], boxes[at + 1u], boxes[at + 2u]);
        let greatest = vec3<f32>(boxes[at + 3u], boxes[at + 4u], boxes[at + 5u]);
        if all(least <= greatest) {
            low = min(low, least);
            high = max(high, greatest);
        } else {
            owns &= ~(IS_FACE | (OWNS_VERTEX << k) | (OWNS_EDGE << k) | (OWNS_EDGE << ((k + 2u) % 3u)));
        }
    }
    for (var k = 0u; k < 3u; k++) {
        triangle_boxes[6u * triangle + k] = low[k];
        triangle_boxes[6u * triangle + 3u + k] = high[k];
    }
    owned[triangle] = owns;
}

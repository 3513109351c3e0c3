// The spheres around the boxes of triangles, in units, and their count and maxima, from which the cells are chosen.

@group(0) @binding(1) var<storage, read> quantized_boxes: array<i32>;
@group(0) @binding(2) var<storage, read> triangles: array<u32>;
@group(0) @binding(3) var<storage, read> levels: array<u32>;
// Twice the centre, and the squared diagonal of the box. The centre of an absent triangle is -1.
@group(0) @binding(4) var<storage, read_write> spheres: array<vec4<i32>>;
@group(0) @binding(5) var<storage, read_write> counters: array<atomic<u32>>;

var<workgroup> all_of: array<atomic<u32>, 5>;

@compute @workgroup_size(256)
fn write_spheres(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) local: u32) {
    let triangle = workgroup_index(group) * GROUP + local;
    if triangle < params.triangles {
        var sphere = vec4<i32>(-1, -1, -1, 0);
        // A level that does not exist has no objects.
        if levels[triangle] <= params.level && params.level < atomicLoad(&counters[GRADED]) {
            sphere = around(triangle);
            atomicAdd(&all_of[0], 1u);
            atomicMax(&all_of[1], u32(sphere.w));
            for (var k = 0u; k < 3u; k++) {
                atomicMax(&all_of[2u + k], u32(sphere[k]));
            }
        }
        spheres[triangle] = sphere;
    }
    workgroupBarrier();
    if local == 0u {
        atomicAdd(&counters[SPHERES], atomicLoad(&all_of[0]));
    } else if local < 5u {
        atomicMax(&counters[SPHERES + local], atomicLoad(&all_of[local]));
    }
}

fn around(triangle: u32) -> vec4<i32> {
    var low = vec3<i32>(0x7fffffff);
    var high = vec3<i32>(-1);
    for (var k = 0u; k < 3u; k++) {
        let at = 6u * triangles[3u * triangle + k];
        low = min(low, vec3<i32>(quantized_boxes[at], quantized_boxes[at + 1u], quantized_boxes[at + 2u]));
        high = max(high, vec3<i32>(quantized_boxes[at + 3u], quantized_boxes[at + 4u], quantized_boxes[at + 5u]));
    }
    let size = high - low;
    return vec4<i32>(low + high, dot(size, size));
}

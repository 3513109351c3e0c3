// Pairs of triangles -> the pairs of features that the two triangles own and whose boxes overlap.
//
// The fifteen pairs of features are bits of a word, for r and c from 0 to 2: bit 4 r + c is edge r of the first
// with edge c of the second triangle, bit 4 r + 3 is vertex r of the first with the second triangle, and bit
// 12 + c is vertex c of the second with the first triangle.

@group(0) @binding(1) var<storage, read> boxes: array<f32>;
@group(0) @binding(2) var<storage, read> triangles: array<u32>;
@group(0) @binding(3) var<storage, read> owned: array<u32>;
@group(0) @binding(4) var<storage, read> triangle_boxes: array<f32>;
@group(0) @binding(5) var<storage, read> sewn: array<u32>;
@group(0) @binding(6) var<storage, read> pairs: array<vec2<u32>>;
@group(0) @binding(7) var<storage, read_write> masks: array<u32>;
@group(0) @binding(8) var<storage, read> counters: array<u32>;

const OWNS_VERTEX: u32 = 1u;
const OWNS_EDGE: u32 = 8u;
const IS_FACE: u32 = 64u;

struct Box {
    low: vec3<f32>,
    high: vec3<f32>,
}

fn box_of(vertex: u32) -> Box {
    let at = 6u * vertex;
    return Box(
        vec3<f32>(boxes[at], boxes[at + 1u], boxes[at + 2u]),
        vec3<f32>(boxes[at + 3u], boxes[at + 4u], boxes[at + 5u]),
    );
}

fn box_of_triangle(triangle: u32) -> Box {
    let at = 6u * triangle;
    return Box(
        vec3<f32>(triangle_boxes[at], triangle_boxes[at + 1u], triangle_boxes[at + 2u]),
        vec3<f32>(triangle_boxes[at + 3u], triangle_boxes[at + 4u], triangle_boxes[at + 5u]),
    );
}

fn around(a: Box, b: Box) -> Box {
    return Box(min(a.low, b.low), max(a.high, b.high));
}

fn overlap(a: Box, b: Box) -> bool {
    return all(a.low <= b.high) && all(b.low <= a.high);
}

fn corners_of(triangle: u32) -> vec3<u32> {
    let at = 3u * triangle;
    return vec3<u32>(triangles[at], triangles[at + 1u], triangles[at + 2u]);
}

// Whether two vertices are different and not sewn together.
fn are_apart(a: u32, b: u32) -> bool {
    return a != b && !joins(a, b);
}

fn touches_face(vertex: u32, face: vec3<u32>, face_box: Box) -> bool {
    return overlap(box_of(vertex), face_box)
        && are_apart(vertex, face.x) && are_apart(vertex, face.y) && are_apart(vertex, face.z);
}

fn features_of(a: u32, b: u32) -> u32 {
    let p = corners_of(a);
    let q = corners_of(b);
    let owns = vec2<u32>(owned[a], owned[b]);
    let whole = array<Box, 2>(box_of_triangle(a), box_of_triangle(b));
    var mask = 0u;
    for (var r = 0u; r < 3u; r++) {
        if (owns.x & (OWNS_VERTEX << r)) != 0u && (owns.y & IS_FACE) != 0u && touches_face(p[r], q, whole[1]) {
            mask |= 1u << (4u * r + 3u);
        }
        if (owns.y & (OWNS_VERTEX << r)) != 0u && (owns.x & IS_FACE) != 0u && touches_face(q[r], p, whole[0]) {
            mask |= 1u << (12u + r);
        }
        if (owns.x & (OWNS_EDGE << r)) == 0u {
            continue;
        }
        let first = vec2<u32>(p[r], p[(r + 1u) % 3u]);
        let first_box = around(box_of(first.x), box_of(first.y));
        for (var c = 0u; c < 3u; c++) {
            if (owns.y & (OWNS_EDGE << c)) == 0u {
                continue;
            }
            let second = vec2<u32>(q[c], q[(c + 1u) % 3u]);
            if overlap(first_box, around(box_of(second.x), box_of(second.y)))
                && are_apart(first.x, second.x) && are_apart(first.x, second.y)
                && are_apart(first.y, second.x) && are_apart(first.y, second.y) {
                mask |= 1u << (4u * r + c);
            }
        }
    }
    return mask;
}

@compute @workgroup_size(256)
fn find_features(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) local: u32) {
    let pair = workgroup_index(group) * GROUP + local;
    if pair < params.pairs {
        masks[pair] = 0u;
        if pair < counters[PAIRS] && !overflowed(NO_ROOM_FOR_PAIRS) {
            masks[pair] = features_of(pairs[pair].x, pairs[pair].y);
        }
    }
}

// Tests that a pair of triangles must pass.

// Whether features of two triangles may touch at all.
fn may_pair(a: u32, b: u32) -> bool {
    let is_passive = vec2<bool>(a >= params.first_passive, b >= params.first_passive);
    return !all(is_passive) && (any(is_passive) || params.own_contact != 0u);
}

// Whether the boxes of two triangles share a point.
fn triangles_overlap(a: u32, b: u32) -> bool {
    var overlap = true;
    for (var k = 0u; k < 3u; k++) {
        overlap = overlap && triangle_boxes[6u * a + k] <= triangle_boxes[6u * b + 3u + k]
            && triangle_boxes[6u * b + k] <= triangle_boxes[6u * a + 3u + k];
    }
    return overlap;
}

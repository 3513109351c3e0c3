// The pairs of features as candidates: a vertex and a triangle, or two edges, the smaller index first.

@group(0) @binding(1) var<storage, read> triangles: array<u32>;
@group(0) @binding(2) var<storage, read> triangle_edges: array<u32>;
@group(0) @binding(3) var<storage, read> pairs: array<vec2<u32>>;
@group(0) @binding(4) var<storage, read> masks: array<u32>;
// Number of vertex-triangle candidates of each pair, then of edge-edge candidates of each pair; after the scan,
// the number before.
@group(0) @binding(5) var<storage, read_write> counts: array<u32>;
@group(0) @binding(6) var<storage, read_write> vertex_triangle: array<vec2<u32>>;
@group(0) @binding(7) var<storage, read_write> edge_edge: array<vec2<u32>>;
@group(0) @binding(8) var<storage, read_write> counters: array<u32>;

const FACES: u32 = 0x7888u;
const EDGES: u32 = 0x0777u;

@compute @workgroup_size(256)
fn count_candidates(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) local: u32) {
    let pair = workgroup_index(group) * GROUP + local;
    if pair < params.pairs {
        counts[pair] = countOneBits(masks[pair] & FACES);
        counts[params.pairs + pair] = countOneBits(masks[pair] & EDGES);
    }
}

@compute @workgroup_size(256)
fn write_candidates(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) local: u32) {
    let pair = workgroup_index(group) * GROUP + local;
    let count = min(counters[PAIRS], params.pairs);
    if pair >= count {
        return;
    }
    let a = pairs[pair].x;
    let b = pairs[pair].y;
    var face = counts[pair];
    // The scan counts edge-edge candidates after all vertex-triangle candidates.
    var edge = counts[params.pairs + pair] - counts[params.pairs];
    var left = masks[pair];
    while left != 0u {
        let bit = firstTrailingBit(left);
        left &= left - 1u;
        let row = bit / 4u;
        let column = bit % 4u;
        if row < 3u && column < 3u {
            let ends = vec2<u32>(triangle_edges[3u * a + row], triangle_edges[3u * b + column]);
            if edge < params.edge_edge {
                edge_edge[edge] = vec2<u32>(min(ends.x, ends.y), max(ends.x, ends.y));
            }
            edge++;
        } else {
            if face < params.vertex_triangle {
                let vertex = select(triangles[3u * b + column % 3u], triangles[3u * a + row % 3u], row < 3u);
                vertex_triangle[face] = vec2<u32>(vertex, select(a, b, row < 3u));
            }
            face++;
        }
    }
    if pair + 1u == count {
        counters[VERTEX_TRIANGLE] = face;
        counters[EDGE_EDGE] = edge;
        if face > params.vertex_triangle {
            counters[STATUS] |= NO_ROOM_VERTEX_TRIANGLE;
        }
        if edge > params.edge_edge {
            counters[STATUS] |= NO_ROOM_EDGE_EDGE;
        }
    }
}

//! Counts on triangle meshes by brute force, independent of the core's edges.

use std::collections::BTreeMap;

/// How often each directed side occurs.
pub fn sides(triangles: &[[u32; 3]]) -> BTreeMap<[u32; 2], u32> {
    let mut sides = BTreeMap::new();
    for [a, b, c] in triangles {
        for side in [[*a, *b], [*b, *c], [*c, *a]] {
            *sides.entry(side).or_insert(0) += 1;
        }
    }
    sides
}

/// Directed sides without a neighbour.
pub fn border_sides(triangles: &[[u32; 3]]) -> Vec<[u32; 2]> {
    let sides = sides(triangles);
    sides.keys().copied().filter(|&[a, b]| !sides.contains_key(&[b, a])).collect()
}

/// Marks the vertices that lie on the border.
pub fn border(triangles: &[[u32; 3]], vertices: usize) -> Vec<bool> {
    let mut border = vec![false; vertices];
    for vertex in border_sides(triangles).into_iter().flatten() {
        border[vertex as usize] = true;
    }
    border
}

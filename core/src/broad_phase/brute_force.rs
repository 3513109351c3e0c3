//! The candidates by comparison of all pairs of features, without cells or ownership; for tests.

use alloc::vec;
use alloc::vec::Vec;

use super::bounds::around;
use super::{Candidates, Counts, IS_FACE, Surface};
use crate::geometry::aabb::Aabb;

/// Writes the candidates, and returns their numbers.
pub fn candidates(boxes: &[Aabb], surface: &Surface<'_>, out: &mut Candidates<'_>) -> Counts {
    let mut counts = Counts::default();
    let part_of = parts(boxes.len(), surface);
    let may_pair = |a: u32, b: u32| match (part_of[a as usize], part_of[b as usize]) {
        (Membership::Active, Membership::Active) => surface.own_contact,
        (Membership::Active, Membership::Passive) | (Membership::Passive, Membership::Active) => true,
        _ => false,
    };
    let are_apart = |a: &[u32], b: &[u32]| a.iter().all(|a| b.iter().all(|b| a != b && !surface.sewn.joins(*a, *b)));
    let triangle_box = |t: &[u32; 3]| around(t.map(|v| &boxes[v as usize]));
    let triangle_boxes: Vec<_> = surface.triangles.iter().map(triangle_box).collect();
    let edge_boxes: Vec<_> = surface.edges.iter().map(|e| around(e.map(|v| &boxes[v as usize]))).collect();

    for vertex in 0..boxes.len() as u32 {
        let vertex_box = around([&boxes[vertex as usize]]);
        for (triangle, corners) in surface.triangles.iter().enumerate() {
            if surface.owned[triangle] & IS_FACE != 0
                && vertex_box.overlaps(&triangle_boxes[triangle])
                && may_pair(vertex, corners[0])
                && are_apart(&[vertex], corners)
            {
                out.add_vertex_triangle(&mut counts, vertex, triangle as u32);
            }
        }
    }
    for (a, first) in surface.edges.iter().enumerate() {
        for (b, second) in surface.edges.iter().enumerate().skip(a + 1) {
            if edge_boxes[a].overlaps(&edge_boxes[b]) && may_pair(first[0], second[0]) && are_apart(first, second) {
                out.add_edge_edge(&mut counts, a as u32, b as u32);
            }
        }
    }
    counts
}

#[derive(Clone, Copy)]
enum Membership {
    None,
    Active,
    Passive,
}

/// The part of the surface that each vertex belongs to.
fn parts(vertices: usize, surface: &Surface<'_>) -> Vec<Membership> {
    let mut parts = vec![Membership::None; vertices];
    for (triangle, corners) in (0..).zip(surface.triangles) {
        for &v in corners {
            parts[v as usize] = if triangle < surface.first_passive { Membership::Active } else { Membership::Passive };
        }
    }
    parts
}

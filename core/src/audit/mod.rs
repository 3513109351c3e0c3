//! Finds all intersections of a surface exactly. This audit shares no code with collision detection except the
//! [`Surface`] that both examine.
//!
//! A *crossing* is an edge and a triangle that are not neighbours and that [meet](edge_meets_triangle). Neighbours
//! share a vertex or have two vertices that are sewn together. If two triangles pass through each other, their
//! common line ends on an edge of one of them. So the crossings reveal every intersection except those between the
//! two sides of a seam and a fold that lies flat on its own hinge. Only faces and their edges are tested. Passive
//! features are not tested against each other, and without [`Surface::own_contact`] the cloth is not tested against
//! itself. Positions must be finite.
//!
//! Edges that are near each other query a [`tree`] of the triangles' boxes together, and only the pairs whose boxes
//! overlap are tested exactly. If all n triangles overlap, this takes on the order of n^2 exact tests. All work
//! happens in a [`Room`] that is allocated once.

pub mod tree;

use crate::broad_phase::{IS_FACE, Surface};
use crate::column::Column;
use crate::geometry::aabb::Aabb;
use crate::geometry::intersect::edge_meets_triangle;
use crate::real::Vec3;
use crate::scratch::MAY_BE_LEAN;
use tree::{Boxed, Tree};

/// Number of edges that query a tree together.
const GROUP: usize = 8;

/// Work columns for the trees of a surface and for its edges.
#[derive(Debug)]
pub struct Room<'a> {
    /// One slot per triangle.
    pub boxes: &'a mut [Boxed],
    /// Twice the number of [`nodes`](tree::nodes) of a tree over all triangles.
    pub bounds: &'a mut [Aabb],
    /// One slot per edge.
    pub edges: &'a mut [u32],
    /// One slot per edge.
    pub taken: &'a mut [bool],
}

impl Room<'_> {
    /// The same columns for a shorter time.
    pub fn reborrow(&mut self) -> Room<'_> {
        let Self { boxes, bounds, edges, taken } = self;
        Room { boxes, bounds, edges, taken }
    }
}

/// Edges of faces, with near edges next to each other, and the trees of the triangles that they may cross.
struct Question<'a> {
    edges: &'a [u32],
    trees: [Option<Tree<'a>>; 2],
}

/// The smallest crossing, `[edge, triangle]`, that exists in the positions `after` a motion but not in the
/// positions `before`. Crossings that disappear do not matter.
pub fn new_crossing(surface: &Surface<'_>, before: &[Vec3], after: &[Vec3], room: &mut Room<'_>) -> Option<[u32; 2]> {
    let mut least: Option<[u32; 2]> = None;
    for_each(surface, after, room, &mut |crossing| {
        if !crosses(surface, before, crossing) {
            least = Some(least.map_or(crossing, |least| least.min(crossing)));
        }
    });
    least
}

/// Whether there is a crossing, `[edge, triangle]`, that a condition holds for.
pub fn any_crossing(
    surface: &Surface<'_>,
    positions: &[Vec3],
    room: &mut Room<'_>,
    holds: impl Fn([u32; 2]) -> bool,
) -> bool {
    let mut any = false;
    for_each(surface, positions, room, &mut |crossing| any |= holds(crossing));
    any
}

/// Calls `found` with all crossings. Without room, all edges are compared with all triangles.
fn for_each(surface: &Surface<'_>, positions: &[Vec3], room: &mut Room<'_>, found: &mut dyn FnMut([u32; 2])) {
    if MAY_BE_LEAN && room.edges.is_empty() {
        return compare_all(surface, positions, found);
    }
    for Question { edges, trees } in questions(surface, positions, room) {
        for group in edges.chunks(GROUP) {
            visit(surface, positions, group, &trees, found);
        }
    }
}

/// Calls `found` with all crossings, without room.
#[inline(never)]
fn compare_all(surface: &Surface<'_>, positions: &[Vec3], found: &mut dyn FnMut([u32; 2])) {
    let (passive, count) = (surface.first_passive, surface.triangles.len() as u32);
    for (edge, &ends) in (0..).zip(surface.edges) {
        // An edge of both parts counts as an edge of the cloth, which comes first.
        let owner = faces(surface).find(|&face| surface.triangle_edges.at(face as usize).contains(&edge));
        let Some(owner) = owner else { continue };
        let own = around(&positions.gather(&ends));
        let others = match (owner >= passive, surface.own_contact) {
            (true, _) => 0..passive,
            (false, true) => 0..count,
            (false, false) => passive..count,
        };
        for triangle in faces(surface).filter(|face| others.contains(face)) {
            let corners = || positions.gather(&surface.triangles.at(triangle as usize));
            if own.overlaps(&around(&corners())) && crosses(surface, positions, [edge, triangle]) {
                found([edge, triangle]);
            }
        }
    }
}

/// All edges of faces that may cross a triangle, in two parts: the edges of the cloth and the passive edges.
#[inline(never)]
#[cfg_attr(small, optimize(size))]
fn questions<'a>(surface: &Surface<'_>, positions: &[Vec3], room: &'a mut Room<'_>) -> [Question<'a>; 2] {
    let (mut cloth, mut total) = (0, 0);
    for (slot, triangle) in room.boxes.iter_mut().zip(faces(surface)) {
        let corners = positions.gather(&surface.triangles.at(triangle as usize));
        *slot = Boxed::new(triangle, around(&corners));
        cloth += usize::from(triangle < surface.first_passive);
        total += 1;
    }
    let (of_cloth, passive) = room.boxes.part_mut(..total).cut_mut(cloth);
    let (bounds, others) = room.bounds.cut_mut(tree::nodes(cloth));
    let [cloth, passive] = [Tree::build(of_cloth, bounds), Tree::build(passive, others)];
    room.taken.fill(false);
    let mut count = 0;
    let [mut moving, mut held] = [0; 2];
    // An edge of both parts counts as an edge of the cloth.
    for (tree, end) in [(&cloth, &mut moving), (&passive, &mut held)] {
        for edge in tree.numbers().flat_map(|face| surface.triangle_edges.at(face as usize)) {
            if !room.taken.at(edge as usize) {
                room.taken.set(edge as usize, true);
                room.edges.set(count, edge);
                count += 1;
            }
        }
        *end = count;
    }
    let (moving, held) = room.edges.part(..held).cut(moving);
    let own = surface.own_contact.then_some(cloth);
    [Question { edges: moving, trees: [own, Some(passive)] }, Question { edges: held, trees: [Some(cloth), None] }]
}

/// Calls `found` with all crossings, `[edge, triangle]`, of at most [`GROUP`] edges with the triangles of the
/// trees. It is long, so it is compiled only once for all callers.
#[inline(never)]
fn visit(
    surface: &Surface<'_>,
    positions: &[Vec3],
    edges: &[u32],
    trees: &[Option<Tree<'_>>; 2],
    found: &mut dyn FnMut([u32; 2]),
) {
    let mut boxes = [Aabb::EMPTY; GROUP];
    for (bounds, &edge) in boxes.iter_mut().zip(edges) {
        *bounds = around(&positions.gather(&surface.edges.at(edge as usize)));
    }
    let all = boxes.iter().fold(Aabb::EMPTY, |all, one| all.union(one));
    for tree in trees.iter().flatten() {
        tree.overlapping(&all, &mut |one| {
            let triangle = one.number();
            for (&edge, _) in edges.iter().zip(&boxes).filter(|(_, own)| own.overlaps(&one.around)) {
                if crosses(surface, positions, [edge, triangle]) {
                    found([edge, triangle]);
                }
            }
        });
    }
}

/// Whether an edge and a triangle are not neighbours and meet.
#[inline(never)]
fn crosses(surface: &Surface<'_>, positions: &[Vec3], [edge, triangle]: [u32; 2]) -> bool {
    let (ends, corners) = (surface.edges.at(edge as usize), surface.triangles.at(triangle as usize));
    let is_sewn = |a: u32| corners.iter().any(|&b| surface.sewn.joins(a, b));
    let is_near = |a: u32| corners.contains(&a) || !surface.sewn.offsets.is_empty() && is_sewn(a);
    !ends.into_iter().any(is_near) && edge_meets_triangle(positions.gather(&ends), positions.gather(&corners))
}

/// The triangles that are faces.
fn faces(surface: &Surface<'_>) -> impl Iterator<Item = u32> {
    (0..surface.triangles.len() as u32).filter(|&triangle| surface.owned.at(triangle as usize) & IS_FACE != 0)
}

#[inline(never)]
fn around(points: &[Vec3]) -> Aabb {
    points.iter().fold(Aabb::EMPTY, |all, &point| all.union(&Aabb { min: point, max: point }))
}

/// The functions that need an allocator.
#[cfg(feature = "alloc")]
pub use owned::{RoomColumns, count, crossings, triangle_pairs};

#[cfg(feature = "alloc")]
mod owned {
    use alloc::vec;
    use alloc::vec::Vec;

    use super::{Aabb, Boxed, GROUP, Question, Room, Surface, Vec3, faces, questions, tree, visit};
    use crate::dispatch::Dispatch;

    /// The owned columns of [`Room`].
    #[derive(Clone, Debug, Default)]
    pub struct RoomColumns {
        boxes: Vec<Boxed>,
        bounds: Vec<Aabb>,
        edges: Vec<u32>,
        taken: Vec<bool>,
    }

    impl RoomColumns {
        /// Allocates the columns for a surface.
        #[cfg_attr(small, optimize(size))]
        pub fn build(surface: &Surface<'_>) -> Self {
            let (triangles, edges) = (surface.triangles.len(), surface.edges.len());
            Self {
                boxes: vec![Boxed::new(0, Aabb::EMPTY); triangles],
                bounds: vec![Aabb::EMPTY; 2 * tree::nodes(triangles)],
                edges: vec![0; edges],
                taken: vec![false; edges],
            }
        }

        /// Borrows the columns.
        pub fn view(&mut self) -> Room<'_> {
            let Self { boxes, bounds, edges, taken } = self;
            Room { boxes, bounds, edges, taken }
        }

        /// Size of the columns in bytes.
        pub fn bytes(&self) -> usize {
            let (trees, edges) = (size_of_val(&self.boxes[..]) + size_of_val(&self.bounds[..]), self.edges.len());
            trees + edges * (size_of::<u32>() + size_of::<bool>())
        }
    }

    /// Number of crossings. It is too small if the dispatch [stops](Dispatch::stopped).
    pub fn count(surface: &Surface<'_>, positions: &[Vec3], dispatch: &impl Dispatch) -> usize {
        let counts = of_groups(surface, positions, dispatch, |count: &mut u32, _| *count += 1);
        counts.into_iter().map(|count| count as usize).sum()
    }

    /// The crossings, `[edge, triangle]`, in ascending order. Some are missing if the dispatch
    /// [stops](Dispatch::stopped).
    pub fn crossings(surface: &Surface<'_>, positions: &[Vec3], dispatch: &impl Dispatch) -> Vec<[u32; 2]> {
        let found = of_groups(surface, positions, dispatch, |found: &mut Vec<_>, crossing| found.push(crossing));
        let mut found = found.concat();
        found.sort_unstable();
        found
    }

    /// Calls `add` with all crossings of each group of edges, in no particular order, and returns one result per
    /// group.
    fn of_groups<T: Clone + Default + Send>(
        surface: &Surface<'_>,
        positions: &[Vec3],
        dispatch: &impl Dispatch,
        add: impl Fn(&mut T, [u32; 2]) + Sync,
    ) -> Vec<T> {
        let mut room = RoomColumns::build(surface);
        let mut out = Vec::new();
        for Question { edges, trees } in questions(surface, positions, &mut room.view()) {
            let mut of_these = vec![T::default(); edges.len().div_ceil(GROUP)];
            dispatch.run(&mut of_these[..], |start, out: &mut [T]| {
                for (group, out) in edges.chunks(GROUP).skip(start).zip(out) {
                    if dispatch.stopped() {
                        break;
                    }
                    visit(surface, positions, group, &trees, &mut |crossing| add(out, crossing));
                }
            });
            out.append(&mut of_these);
        }
        out
    }

    /// The pairs of triangles of some crossings, the smaller index first, in ascending order. Each triangle that
    /// has a crossing edge is paired with the triangle that the edge crosses.
    pub fn triangle_pairs(surface: &Surface<'_>, crossings: &[[u32; 2]]) -> Vec<[u32; 2]> {
        let mut sides: Vec<[u32; 2]> = faces(surface)
            .flat_map(|triangle| surface.triangle_edges[triangle as usize].map(|edge| [edge, triangle]))
            .collect();
        sides.sort_unstable();
        let mut pairs = Vec::new();
        for &[edge, crossed] in crossings {
            let first = sides.partition_point(|side| side[0] < edge);
            let owners = sides[first..].iter().take_while(|side| side[0] == edge);
            pairs.extend(owners.map(|&[_, owner]| [owner.min(crossed), owner.max(crossed)]));
        }
        pairs.sort_unstable();
        pairs.dedup();
        pairs
    }
}

//! Flaps: if a contour cuts a sheet, the part on one side of the contour moves back as a whole through the surface
//! that cuts it off, and draws the surrounding sheet along. The motion decreases to zero over several times its
//! length, so that the sheet is compressed a little and does not fold.
//!
//! A contour that ends within the sheet is continued along the line where the parts that grow from its two sides
//! meet.

use alloc::collections::VecDeque;
use alloc::vec;
use alloc::vec::Vec;

use super::contour::Crossing;
use super::topology::Topology;
use super::{Displacements, Scene};
use crate::real::{Real, Vec3, sqrt};

/// The motion of a whole flap decreases to zero over this multiple of its length, so the sheet around it is
/// compressed by at most an eighth.
pub const FALLOFF: Real = 8.0;

/// The same factor for a flap whose vertices move by their own depths.
const SHALLOW_FALLOFF: Real = 2.0;

/// Smallest length of the mean of the unit normals along a contour. Below it, the normals give no common direction
/// out.
const ALIGNED: Real = 0.3;

/// Ratio of length to extent below which a flap is shallow.
const SHALLOW: Real = 0.5;

/// A sheet counts as torn if more than one in this many vertices lies on both sides of the contour.
const TORN: usize = 6;

/// The greatest number of places along a contour from which depths are measured.
const SAMPLES: usize = 64;

/// A part of a sheet, and its motion back.
#[derive(Clone, Debug)]
pub struct Flap {
    /// The vertices of the flap, and the depth of each below the surface that cuts the flap off, m.
    pub members: Vec<(u32, Real)>,
    /// The direction of the motion back, a unit vector.
    pub out: Vec3,
    /// The distance that the deepest vertex has to move, m.
    pub length: Real,
    /// The greatest distance of a vertex of the flap from the contour, m.
    pub extent: Real,
    /// Whether some vertices of the flap cannot move.
    pub held: bool,
}

impl Flap {
    /// Whether the flap is so flat that each vertex may move by its own depth.
    pub fn is_shallow(&self) -> bool {
        self.length < SHALLOW * self.extent
    }

    /// Requests the motion back, either of the flap as a whole or of each vertex by its own depth.
    pub fn back(
        &self,
        scene: &Scene<'_>,
        topology: &Topology,
        whole: bool,
        places: &[Vec3],
        displacements: &mut Displacements,
    ) {
        let length = |depth: Real| if whole { self.length } else { depth.max(0.0) + scene.gap };
        let members: Vec<_> = self.members.iter().map(|&(v, depth)| (v, self.out * length(depth))).collect();
        let falloff = if whole { FALLOFF } else { SHALLOW_FALLOFF };
        draw(scene, topology, &members, falloff, places, displacements);
    }
}

/// Adds the flaps on both sides of a strand of a contour that have vertices that can move. `strand` has the
/// crossings whose edges belong to the strand. Flaps do not grow across the edges in `cut`, which are in ascending
/// order.
pub fn beside(
    scene: &Scene<'_>,
    topology: &Topology,
    strand: &[&Crossing],
    cut: &[u32],
    places: &[Vec3],
    flaps: &mut Vec<Flap>,
) {
    let sides = strand.iter().map(|crossing| {
        let [a, b] = [crossing.vertices[0], crossing.vertices[1]];
        let up = (places[b as usize] - places[a as usize]).dot(crossing.normal);
        if up < 0.0 { [b, a] } else { [a, b] }
    });
    let sides: Vec<[u32; 2]> = sides.collect();
    if torn(&sides) {
        return;
    }
    for (side, members) in grow(scene, topology, &sides, cut).into_iter().enumerate() {
        let moving = members.iter().filter(|&&v| scene.model.inverse_masses.at(v as usize) != Vec3::ZERO).count();
        if moving > 0 {
            let (held, outward) = (moving < members.len(), if side == 0 { 1.0 } else { -1.0 });
            flaps.extend(way_back(scene, strand, outward, members, held, places));
        }
    }
}

/// Whether many vertices lie on both sides of the strand. A corner that pokes through a sheet cuts no part off it.
fn torn(sides: &[[u32; 2]]) -> bool {
    let mut seen: Vec<(u32, usize)> = sides.iter().flat_map(|&[below, above]| [(below, 0), (above, 1)]).collect();
    seen.sort_unstable();
    seen.dedup();
    let both = seen.windows(2).filter(|two| two[0].0 == two[1].0).count();
    TORN * both > seen.len()
}

/// The vertices below and above a strand. Each belongs to the side that is nearer in edges along the sheet.
fn grow(scene: &Scene<'_>, topology: &Topology, sides: &[[u32; 2]], cut: &[u32]) -> [Vec<u32>; 2] {
    let surface = &scene.model.surface;
    let (mut of, mut queue) = (vec![2u8; scene.model.inverse_masses.len()], VecDeque::new());
    let mut members = [Vec::new(), Vec::new()];
    for side in 0..2 {
        for ends in sides {
            if of[ends[side] as usize] == 2 {
                of[ends[side] as usize] = side as u8;
                queue.push_back(ends[side]);
            }
        }
    }
    while let Some(v) = queue.pop_front() {
        let side = of[v as usize];
        members[side as usize].push(v);
        for &slot in topology.at.view().at(v as usize) {
            let (edge, end) = (slot / 2, slot as usize % 2);
            let other = surface.edges[edge as usize][1 - end] as usize;
            if of[other] == 2 && cut.binary_search(&edge).is_err() {
                of[other] = side;
                queue.push_back(other as u32);
            }
        }
    }
    members
}

/// The motion of a part back along the mean normal, or `None` if the normals have no common direction. If they
/// deviate from their mean by an angle, the surface bulges over the part by about its extent times the tangent of
/// the angle.
fn way_back(
    scene: &Scene<'_>,
    strand: &[&Crossing],
    outward: Real,
    members: Vec<u32>,
    held: bool,
    places: &[Vec3],
) -> Option<Flap> {
    let mean = strand.iter().map(|crossing| crossing.normal).sum::<Vec3>() * (outward / strand.len() as Real);
    let aligned = sqrt(mean.length_squared()).min(1.0);
    if aligned < ALIGNED {
        return None;
    }
    let out = mean / aligned;
    let stride = strand.len().div_ceil(SAMPLES);
    let (mut deepest, mut extent): (Real, Real) = (0.0, 0.0);
    let below = |v: u32| {
        let x = places[v as usize];
        let near = strand.iter().step_by(stride).map(|crossing| crossing.place - x);
        let arm = near.min_by(|a, b| a.length_squared().total_cmp(&b.length_squared())).unwrap_or(Vec3::ZERO);
        let depth = out.dot(arm);
        deepest = deepest.max(depth);
        extent = extent.max(arm.length_squared());
        (v, depth)
    };
    let members = members.into_iter().map(below).collect();
    let bulge = sqrt(extent * (1.0 - aligned * aligned)) / aligned;
    Some(Flap { members, out, length: deepest + bulge + scene.gap, extent: sqrt(extent), held })
}

/// Requests the motion of some vertices, and a motion that decreases with distance of the vertices around them on
/// the sheet.
pub fn draw(
    scene: &Scene<'_>,
    topology: &Topology,
    members: &[(u32, Vec3)],
    falloff: Real,
    places: &[Vec3],
    displacements: &mut Displacements,
) {
    // For each vertex, its fraction of the motion of a member, and the index of this member.
    let mut parts: Vec<(Real, u32)> = vec![(0.0, 0); places.len()];
    let (mut queue, mut reached) = (VecDeque::new(), Vec::new());
    for (k, &(v, _)) in (0..).zip(members) {
        parts[v as usize] = (1.0, k);
        queue.push_back(v);
        reached.push(v);
    }
    while let Some(v) = queue.pop_front() {
        let (part, member) = parts[v as usize];
        let reach = falloff * sqrt(members[member as usize].1.length_squared());
        for other in topology.neighbours(&scene.model.surface, v) {
            let edge = sqrt((places[other as usize] - places[v as usize]).length_squared());
            let left = part - edge / reach;
            if left > parts[other as usize].0 {
                if parts[other as usize].0 == 0.0 {
                    reached.push(other);
                }
                parts[other as usize] = (left, member);
                queue.push_back(other);
            }
        }
    }
    for v in reached {
        let (part, member) = parts[v as usize];
        displacements.add(v, members[member as usize].1 * part, part);
    }
}

//! The data of detection and response: the surfaces that can touch, and the columns that a step writes. Vertices of the
//! cloth come first, then those of the colliders.

use crate::audit::Room;
use crate::broad_phase::{Counts, Grid, KeptPairs, Surface};
use crate::colliders::{Body, Colliders};
use crate::column::Column;
use crate::geometry::aabb::Aabb;
use crate::implicit_contact::augmented_contact::{AugmentedContact, ContactLines};
use crate::implicit_contact::multiplier::Multiplier;
use crate::inverse_masses::InverseMasses;
use crate::keys::Key;
use crate::narrow_phase::time_of_impact::StoredTime;
use crate::real::{Real, Vec3};
use crate::response::constraint::Constraint;
use crate::response::friction::Law;

/// Contact as a scene describes it, borrowed.
#[derive(Clone, Copy, Debug)]
pub struct ContactModel<'a> {
    /// Features nearer than this are in contact, m.
    pub thickness: Real,
    /// Whether collisions during the step are tested.
    pub continuous: bool,
    /// The surfaces that can touch.
    pub surface: Surface<'a>,
    /// The colliders.
    pub colliders: Colliders<'a>,
    /// First vertex of each cloth and, last, of the colliders.
    pub firsts: &'a [u32],
    /// Position of each cloth vertex before its cloth was placed, m. Neighbours on a sheet may be nearer than the
    /// thickness.
    pub material: &'a [Vec3],
    /// Radius around each vertex, m; not zero only for spheres and capsules.
    pub radii: &'a [Real],
    /// The inverse masses.
    pub inverse_masses: InverseMasses<'a>,
    /// Index of each vertex's law of friction; a contact follows the larger.
    pub law_of: &'a [u32],
    /// The laws.
    pub laws: &'a [Law],
}

impl ContactModel<'_> {
    /// Number of vertices of the cloth.
    pub fn cloth(&self) -> usize {
        self.material.len()
    }
}

/// A [`ContactModel`] of which the host changes some columns between steps.
#[derive(Debug)]
pub struct Solids<'a> {
    /// m.
    pub thickness: Real,
    /// Whether collisions during the step are tested.
    pub continuous: bool,
    /// The surfaces that can touch.
    pub surface: Surface<'a>,
    /// The colliders.
    pub bodies: &'a mut [Body],
    /// Position of each vertex of them before any motion, m.
    pub anchors: &'a [Vec3],
    /// The keys of their motions.
    pub keys: &'a [Key],
    /// Vertex positions of all caches, frame after frame, m.
    pub frames: &'a mut [Vec3],
    /// First vertex of each cloth and, last, of the colliders.
    pub firsts: &'a [u32],
    /// m.
    pub material: &'a [Vec3],
    /// m.
    pub radii: &'a [Real],
    /// 1/kg; zero for colliders.
    pub inverse_masses: &'a [Real],
    /// Bits of the held axes of each vertex.
    pub held: &'a mut [u8],
    /// Index of each vertex's law.
    pub law_of: &'a [u32],
    /// The laws.
    pub laws: &'a [Law],
}

impl Solids<'_> {
    /// The same columns for a shorter time.
    pub fn reborrow(&mut self) -> Solids<'_> {
        Solids { bodies: self.bodies, frames: self.frames, held: self.held, ..*self }
    }

    /// The colliders, to read.
    pub fn colliders(&self) -> Colliders<'_> {
        Colliders { bodies: self.bodies, anchors: self.anchors, keys: self.keys, frames: self.frames }
    }

    /// The borrowed view that kernels take.
    pub fn view(&self) -> ContactModel<'_> {
        ContactModel {
            thickness: self.thickness,
            continuous: self.continuous,
            surface: self.surface,
            colliders: self.colliders(),
            firsts: self.firsts,
            material: self.material,
            radii: self.radii,
            inverse_masses: InverseMasses { along_free: self.inverse_masses, held: self.held },
            law_of: self.law_of,
            laws: self.laws,
        }
    }
}

/// The columns that a step writes. They have one entry per vertex unless stated otherwise.
#[derive(Debug)]
pub struct ContactScratch<'a> {
    /// Positions at the start of the step, m.
    pub start: &'a mut [Vec3],
    /// Positions at the end of the step, m.
    pub end: &'a mut [Vec3],
    /// Displacements from start to end, m. They are stored because the ends are rounded.
    pub displacements: &'a mut [Vec3],
    /// Rotation of each collider in the step, rad.
    pub turns: &'a mut [Vec3],
    /// Boxes around the motion. After a search, the response uses the memory for [columns of its
    /// own](ResponseColumns).
    pub boxes: &'a mut [Aabb],
    /// Boxes in which the vertices may end: there, the candidates are complete.
    pub ends: &'a mut [Aabb],
    /// The kind of the candidates.
    pub searched: &'a mut Searched,
    /// Numbers of candidates.
    pub counts: &'a mut Counts,
    /// Numbers of candidates that may be contacts of the step. They come first; the others were tested.
    pub open: &'a mut Counts,
    /// Pairs of a vertex and a triangle.
    pub vertex_triangle: Pairs<'a>,
    /// Pairs of edges.
    pub edge_edge: Pairs<'a>,
    /// The valid entries in the columns below.
    pub lengths: &'a mut Lengths,
    /// The constraints; the length of the slice is their capacity.
    pub constraints: &'a mut [Constraint],
    /// The contacts that an implicit step is solved with; the same capacity.
    pub contacts: &'a mut [AugmentedContact],
    /// Work column of that solve, four contacts in each entry.
    pub lines: &'a mut [ContactLines],
    /// The forces of contacts in the last step, which the next one starts from; the same capacity.
    pub multipliers: &'a mut [Multiplier],
    /// Indices of constraints; the same capacity.
    pub order: &'a mut [u32],
    /// Columns of the broad phase.
    pub grid: Grid<'a>,
    /// Pairs that last over many steps.
    pub kept: KeptPairs<'a>,
    /// Columns of the exact test.
    pub room: Room<'a>,
}

/// The columns that only the response needs, one entry per vertex. They lie in the column of the boxes, which every
/// search writes anew.
#[derive(Debug)]
pub struct ResponseColumns<'a> {
    /// The part of the displacements that only separates surfaces and changes no velocity, m.
    pub corrections: &'a mut [Vec3],
    /// The round in which the response last moved each vertex; 0 if it did not.
    pub rounds: &'a mut [u32],
    /// Union-find over vertices.
    pub zones: &'a mut [u32],
    /// Whether a zone with this root must be solved: 1, else 0.
    pub wanted: &'a mut [u32],
}

impl<'a> ResponseColumns<'a> {
    /// The columns in those of the boxes.
    pub fn within(boxes: &'a mut [Aabb]) -> Self {
        let count = boxes.len();
        let (corrections, rest) = bytemuck::must_cast_slice_mut::<Aabb, Vec3>(boxes).cut_mut(count);
        let (rounds, rest) = bytemuck::must_cast_slice_mut::<Vec3, u32>(rest).cut_mut(count);
        let (zones, rest) = rest.cut_mut(count);
        Self { corrections, rounds, zones, wanted: rest.part_mut(..count) }
    }
}

/// The motion of the cloth in a step without contact, by vertex.
#[derive(Clone, Copy, Debug)]
pub struct Prediction<'a> {
    /// Positions at its end, m.
    pub positions: &'a [Vec3],
    /// Displacements from the exact positions at the start, m.
    pub displacements: &'a [Vec3],
    /// Rounding errors of the positions at the start, m; may be empty.
    pub low: &'a [Vec3],
}

impl Prediction<'_> {
    /// The displacement of a vertex from its rounded position, where gaps are measured, m.
    #[inline]
    pub fn displacement(&self, vertex: usize) -> Vec3 {
        self.low.get(vertex).copied().unwrap_or_default() + self.displacements.at(vertex)
    }
}

/// The kind of the candidates.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, bytemuck::CheckedBitPattern, bytemuck::NoUninit)]
#[repr(u32)]
pub enum Searched {
    /// No pairs have been searched in this step.
    #[default]
    Nothing,
    /// The pairs within [reach](crate::response::repulsion::REACH) at the start of the step.
    Near,
    /// The pairs whose boxes around their motion overlap.
    Swept,
    /// Those of them whose triangles overlap in the [frame](crate::broad_phase::comoving) that moves with them, too.
    Comoving,
}

/// The valid entries in the columns of [`ContactScratch`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct Lengths {
    /// Constraints that the solve took part in; after the response, all constraints.
    pub constraints: usize,
    /// Contacts of the solve.
    pub contacts: usize,
    /// Multipliers.
    pub multipliers: usize,
}

impl ContactScratch<'_> {
    /// The same columns for a shorter time.
    pub fn reborrow(&mut self) -> ContactScratch<'_> {
        ContactScratch {
            start: self.start,
            end: self.end,
            displacements: self.displacements,
            turns: self.turns,
            boxes: self.boxes,
            ends: self.ends,
            searched: self.searched,
            counts: self.counts,
            open: self.open,
            lengths: self.lengths,
            constraints: self.constraints,
            contacts: self.contacts,
            lines: self.lines,
            multipliers: self.multipliers,
            order: self.order,
            vertex_triangle: self.vertex_triangle.reborrow(),
            edge_edge: self.edge_edge.reborrow(),
            grid: self.grid.reborrow(),
            kept: self.kept.reborrow(),
            room: self.room.reborrow(),
        }
    }

    /// Sets the motion of the cloth to a prediction.
    pub fn set_motion(&mut self, prediction: &Prediction<'_>) {
        self.end.part_mut(..prediction.positions.len()).copy_from(prediction.positions);
        for (v, displacement) in self.displacements.iter_mut().enumerate().take(prediction.displacements.len()) {
            *displacement = prediction.displacement(v);
        }
    }

    /// The notes of the last response: the round in which it last moved each vertex, or 0, and the part of each
    /// displacement that only separates surfaces, m.
    pub fn response(&self) -> (&[u32], &[Vec3]) {
        let (corrections, rest) = bytemuck::must_cast_slice::<Aabb, Vec3>(self.boxes).cut(self.boxes.len());
        (bytemuck::must_cast_slice::<Vec3, u32>(rest).part(..self.boxes.len()), corrections)
    }

    /// Whether there is room for so many candidates.
    pub fn has_room(&self, counts: Counts) -> bool {
        let Counts { vertex_triangle, edge_edge } = counts;
        vertex_triangle <= self.vertex_triangle.distances.len() && edge_edge <= self.edge_edge.distances.len()
    }
}

/// The owner of the columns of contact, which a step asks for more room. An owner without a heap has no more.
pub trait ContactRoom {
    /// The columns.
    fn columns(&mut self) -> ContactScratch<'_>;
    /// Makes room for so many candidates; false if it cannot.
    fn grow_pairs(&mut self, needed: Counts) -> bool;
    /// Makes room for so many constraints; false if it cannot.
    fn grow_constraints(&mut self, needed: usize) -> bool;
    /// Makes room for the pairs that last, if the last search lacked it. Without room, each step searches anew.
    fn grow_kept(&mut self) {}
}

/// Stands for the owner of columns in a scene without contact. It has no values.
#[derive(Debug)]
pub enum NoContact {}

impl ContactRoom for NoContact {
    fn columns(&mut self) -> ContactScratch<'_> {
        match *self {}
    }
    fn grow_pairs(&mut self, _: Counts) -> bool {
        match *self {}
    }
    fn grow_constraints(&mut self, _: usize) -> bool {
        match *self {}
    }
}

/// Candidates of one kind, with distance and time of impact.
#[derive(Debug)]
pub struct Pairs<'a> {
    /// The features.
    pub candidates: &'a mut [[u32; 2]],
    /// Distance at the start less the radii, m; beyond reach, a lower bound.
    pub distances: &'a mut [Real],
    /// Time of impact.
    pub times: &'a mut [StoredTime],
}

impl Pairs<'_> {
    /// Swaps two candidates and their distances. Their times of impact are left where they are.
    pub(crate) fn swap(&mut self, a: usize, b: usize) {
        let (candidate, distance) = (self.candidates.at(a), self.distances.at(a));
        self.candidates.set(a, self.candidates.at(b));
        self.distances.set(a, self.distances.at(b));
        self.candidates.set(b, candidate);
        self.distances.set(b, distance);
    }

    fn reborrow(&mut self) -> Pairs<'_> {
        Pairs { candidates: self.candidates, distances: self.distances, times: self.times }
    }
}

#[cfg(feature = "alloc")]
pub(crate) use owned::grow;
/// The owned columns.
#[cfg(feature = "alloc")]
pub use owned::{ContactColumns, ContactScratchColumns};

#[cfg(feature = "alloc")]
mod owned {
    use alloc::vec;
    use alloc::vec::Vec;

    use super::{
        Aabb, AugmentedContact, Constraint, ContactLines, ContactModel, ContactRoom, ContactScratch, Counts,
        InverseMasses, Law, Lengths, Multiplier, Pairs, Real, Searched, Solids, StoredTime, Surface, Vec3,
    };
    use crate::audit::RoomColumns;
    use crate::broad_phase::GridColumns;
    use crate::broad_phase::kept_pairs::KeptPairColumns;
    use crate::colliders::ColliderColumns;
    use crate::mesh::ownership::SurfaceColumns;
    use crate::narrow_phase::time_of_impact::TimeOfImpact;

    /// The owned columns of [`ContactModel`].
    #[derive(Clone, Debug, Default)]
    pub struct ContactColumns {
        /// m.
        pub thickness: Real,
        /// Whether collisions during the step are tested.
        pub continuous: bool,
        /// Whether a step that contact cannot resolve is taken in halves.
        pub halving: bool,
        /// The surfaces that can touch.
        pub surface: SurfaceColumns,
        /// The colliders.
        pub colliders: ColliderColumns,
        /// First vertex of each cloth and, last, of the colliders.
        pub firsts: Vec<u32>,
        /// Position of each cloth vertex before its cloth was placed, m.
        pub material: Vec<Vec3>,
        /// m.
        pub radii: Vec<Real>,
        /// 1/kg; zero for colliders.
        pub inverse_masses: Vec<Real>,
        /// Bits of the held axes of each vertex.
        pub held: Vec<u8>,
        /// Index of each vertex's law.
        pub law_of: Vec<u32>,
        /// The laws.
        pub laws: Vec<Law>,
    }

    impl ContactColumns {
        /// The borrowed view that kernels take.
        pub fn view(&self) -> ContactModel<'_> {
            ContactModel {
                thickness: self.thickness,
                continuous: self.continuous,
                surface: self.surface.view(),
                colliders: self.colliders.view(),
                firsts: &self.firsts,
                material: &self.material,
                radii: &self.radii,
                inverse_masses: InverseMasses { along_free: &self.inverse_masses, held: &self.held },
                law_of: &self.law_of,
                laws: &self.laws,
            }
        }

        /// The borrowed view that a host changes.
        #[cfg_attr(small, optimize(size), inline(never))]
        pub(crate) fn solids(&mut self) -> Solids<'_> {
            Solids {
                thickness: self.thickness,
                continuous: self.continuous,
                surface: self.surface.view(),
                bodies: &mut self.colliders.bodies,
                anchors: &self.colliders.anchors,
                keys: &self.colliders.keys,
                frames: &mut self.colliders.frames,
                firsts: &self.firsts,
                material: &self.material,
                radii: &self.radii,
                inverse_masses: &self.inverse_masses,
                held: &mut self.held,
                law_of: &self.law_of,
                laws: &self.laws,
            }
        }

        /// Bytes held.
        pub fn bytes(&self) -> usize {
            self.surface.bytes()
                + self.colliders.bytes()
                + size_of_val(&self.firsts[..])
                + size_of_val(&self.material[..])
                + size_of_val(&self.radii[..])
                + size_of_val(&self.inverse_masses[..])
                + size_of_val(&self.held[..])
                + size_of_val(&self.law_of[..])
                + size_of_val(&self.laws[..])
        }
    }

    /// Lengthens a column; false, and no change, if there is no memory.
    pub(crate) fn grow<T: Clone>(column: &mut Vec<T>, length: usize, value: T) -> bool {
        let more = length.saturating_sub(column.len());
        let has_room = column.try_reserve_exact(more).is_ok();
        if has_room {
            column.resize(column.len() + more, value);
        }
        has_room
    }

    /// Whether edges of the cloth, which has so many vertices, may pair with others: spheres and planes have none.
    fn edges_may_pair(surface: &Surface<'_>, cloth: u32) -> bool {
        surface.own_contact || surface.edges.iter().any(|&[a, b]| a != b && a.min(b) >= cloth)
    }

    /// Owned columns of one kind of candidates.
    #[derive(Clone, Debug, Default)]
    struct PairColumns {
        candidates: Vec<[u32; 2]>,
        distances: Vec<Real>,
        times: Vec<StoredTime>,
    }

    impl PairColumns {
        /// Makes room for so many; false if there is no memory.
        fn grow(&mut self, capacity: usize) -> bool {
            // The column that tells the capacity comes last.
            grow(&mut self.candidates, capacity, [0; 2])
                && grow(&mut self.times, capacity, TimeOfImpact::Never.into())
                && grow(&mut self.distances, capacity, 0.0)
        }

        fn view(&mut self) -> Pairs<'_> {
            Pairs { candidates: &mut self.candidates, distances: &mut self.distances, times: &mut self.times }
        }

        fn bytes(&self) -> usize {
            size_of_val(&self.candidates[..]) + size_of_val(&self.distances[..]) + size_of_val(&self.times[..])
        }
    }

    /// The owned columns of [`ContactScratch`].
    #[derive(Clone, Debug, Default)]
    pub struct ContactScratchColumns {
        start: Vec<Vec3>,
        end: Vec<Vec3>,
        displacements: Vec<Vec3>,
        turns: Vec<Vec3>,
        boxes: Vec<Aabb>,
        ends: Vec<Aabb>,
        searched: Searched,
        counts: Counts,
        open: Counts,
        vertex_triangle: PairColumns,
        edge_edge: PairColumns,
        lengths: Lengths,
        constraints: Vec<Constraint>,
        contacts: Vec<AugmentedContact>,
        lines: Vec<ContactLines>,
        multipliers: Vec<Multiplier>,
        order: Vec<u32>,
        grid: GridColumns,
        kept: KeptPairColumns,
        room: RoomColumns,
    }

    impl ContactScratchColumns {
        /// Columns for a model, with room for `pairs` candidates of each kind and an eighth as many
        /// constraints. They grow if a step needs more.
        #[cfg_attr(small, optimize(size))]
        pub fn build(model: &ContactModel<'_>, pairs: usize) -> Self {
            let vertices = model.radii.len();
            let column = vec![Vec3::ZERO; vertices];
            let mut columns = Self {
                start: column.clone(),
                end: column.clone(),
                displacements: column,
                turns: vec![Vec3::ZERO; model.colliders.bodies.len()],
                boxes: vec![Aabb::EMPTY; vertices],
                ends: vec![Aabb::EMPTY; vertices],
                grid: GridColumns::build(vertices, model.surface.triangles.len()),
                kept: KeptPairColumns::build(vertices, [3 * pairs / 4; 2]),
                room: RoomColumns::build(&model.surface),
                ..Self::default()
            };
            columns.grow_pairs(Counts { vertex_triangle: pairs, edge_edge: pairs });
            columns.grow_constraints(pairs / 8);
            columns
        }

        /// Columns with exactly this room. Only implicit methods solve a step together with its contacts.
        pub(crate) fn fit(model: &ContactModel<'_>, room: crate::cooked::Room, is_implicit: bool) -> Self {
            let mut columns = Self::build(model, 0);
            let edge_edge = if edges_may_pair(&model.surface, model.cloth() as u32) { room.pairs } else { 0 };
            columns.vertex_triangle.grow(room.pairs);
            columns.edge_edge.grow(edge_edge);
            columns.kept = KeptPairColumns::build(model.radii.len(), [room.pairs, edge_edge]);
            columns.fit_constraints(room.contacts);
            if !is_implicit {
                (columns.contacts, columns.lines, columns.multipliers) = Default::default();
            }
            if room.is_lean {
                columns.make_lean();
            }
            columns
        }

        /// Removes the columns without which a search and an audit take longer.
        pub(crate) fn make_lean(&mut self) {
            self.kept = KeptPairColumns::default();
            self.grid = GridColumns::default();
            self.room = RoomColumns::default();
        }

        /// Makes room for at least so many candidates. Returns false if there was enough, or if there is no memory.
        pub fn grow_pairs(&mut self, counts: Counts) -> bool {
            let mut grown = false;
            for (pairs, needed) in
                [(&mut self.vertex_triangle, counts.vertex_triangle), (&mut self.edge_edge, counts.edge_edge)]
            {
                if needed > pairs.distances.len() {
                    if !pairs.grow(needed + needed / 4) {
                        return false;
                    }
                    grown = true;
                }
            }
            grown
        }

        /// Makes room for at least so many constraints; false if there is no memory.
        #[cfg_attr(small, optimize(size))]
        pub fn grow_constraints(&mut self, needed: usize) -> bool {
            needed <= self.constraints.len() || self.fit_constraints(needed + needed / 4)
        }

        fn fit_constraints(&mut self, length: usize) -> bool {
            // The column that tells the capacity comes last.
            grow(&mut self.order, length, 0)
                && grow(&mut self.contacts, length, AugmentedContact::default())
                && grow(&mut self.lines, length.div_ceil(4), ContactLines::default())
                && grow(&mut self.multipliers, length, Multiplier::default())
                && grow(&mut self.constraints, length, Constraint::default())
        }

        /// The room for candidates of each kind, and for contacts.
        pub fn room(&self) -> [usize; 2] {
            let pairs = self.vertex_triangle.distances.len().max(self.edge_edge.distances.len());
            [pairs, self.constraints.len()]
        }

        /// Forgets the pairs that last over many steps. Call it when other surfaces can touch than before.
        pub fn forget_pairs(&mut self) {
            self.kept.forget();
        }

        /// The constraints of the last step.
        pub fn constraints(&self) -> &[Constraint] {
            &self.constraints[..self.lengths.constraints]
        }

        /// The forces of contacts in the last step.
        pub fn multipliers(&self) -> &[Multiplier] {
            &self.multipliers[..self.lengths.multipliers]
        }

        /// Replaces them. There must be [room](Self::grow_constraints) for as many constraints.
        pub fn set_multipliers(&mut self, multipliers: &[Multiplier]) {
            self.multipliers[..multipliers.len()].copy_from_slice(multipliers);
            self.lengths.multipliers = multipliers.len();
        }

        /// Bytes held.
        pub fn bytes(&self) -> usize {
            3 * size_of_val(&self.start[..])
                + size_of_val(&self.turns[..])
                + 2 * size_of_val(&self.boxes[..])
                + self.vertex_triangle.bytes()
                + self.edge_edge.bytes()
                + size_of_val(&self.constraints[..])
                + size_of_val(&self.order[..])
                + size_of_val(&self.contacts[..])
                + size_of_val(&self.lines[..])
                + size_of_val(&self.multipliers[..])
                + self.grid.bytes()
                + self.kept.bytes()
                + self.room.bytes()
        }

        /// The borrowed view that a step takes.
        #[cfg_attr(small, optimize(size), inline(never))]
        pub fn view(&mut self) -> ContactScratch<'_> {
            ContactScratch {
                start: &mut self.start,
                end: &mut self.end,
                displacements: &mut self.displacements,
                turns: &mut self.turns,
                boxes: &mut self.boxes,
                ends: &mut self.ends,
                searched: &mut self.searched,
                counts: &mut self.counts,
                open: &mut self.open,
                vertex_triangle: self.vertex_triangle.view(),
                edge_edge: self.edge_edge.view(),
                lengths: &mut self.lengths,
                constraints: &mut self.constraints,
                contacts: &mut self.contacts,
                lines: &mut self.lines,
                multipliers: &mut self.multipliers,
                order: &mut self.order,
                grid: self.grid.view(),
                kept: self.kept.view(),
                room: self.room.view(),
            }
        }
    }

    impl ContactRoom for ContactScratchColumns {
        fn columns(&mut self) -> ContactScratch<'_> {
            self.view()
        }
        fn grow_pairs(&mut self, needed: Counts) -> bool {
            Self::grow_pairs(self, needed)
        }
        fn grow_constraints(&mut self, needed: usize) -> bool {
            Self::grow_constraints(self, needed)
        }
        fn grow_kept(&mut self) {
            self.kept.grow();
        }
    }
}

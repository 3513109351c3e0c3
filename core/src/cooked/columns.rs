//! The columns of a cooked scene, in their order. Whoever adds a column to a view adds it here, and raises
//! [`VERSION`](super::VERSION).
//!
//! | kind | where it lies |
//! |---|---|
//! | `constant`, `value`, `flag` | in the block |
//! | `state` | in the block; it is copied to the memory |
//! | `scratch`, `cell` | in the memory, all zero at first |
//! | `part` | its columns follow |
//! | `fresh` | nowhere: it begins with its default |

use super::CookedError;
use super::source::{Columns, Source};
use crate::audit::Room;
use crate::broad_phase::{Grid, KeptPairs, Sewn, Surface};
use crate::contact::{ContactScratch, Pairs};
use crate::forces::drag::Drag;
use crate::forces::gravity::Gravity;
use crate::forces::hinge::Hinges;
use crate::forces::load::Loads;
use crate::forces::matrix::BlockMatrix;
use crate::forces::membrane::Membrane;
use crate::forces::seam::Seams;
use crate::forces::spring::Springs;
use crate::forces::wind::Wind;
use crate::forces::{Model, Term};
use crate::integrate::coarse::{CoarseFactor, Patches};
use crate::mesh::Incidence;
use crate::particles::{Particles, PositionsMut};
use crate::reactions::Reactions;
use crate::scratch::Scratch;

/// Reads and writes a view by the list of its fields.
macro_rules! columns {
    ($view:ident { $($kind:ident $field:ident),* $(,)? }) => {
        impl<'a> $crate::cooked::source::Columns<'a> for $view<'a> {
            fn open(source: &mut $crate::cooked::source::Source<'a>) -> Result<Self, $crate::cooked::CookedError> {
                Ok(Self { $($field: source.$kind()?),* })
            }

            #[cfg(feature = "alloc")]
            fn cook(&self, sink: &mut $crate::cooked::sink::Sink) {
                $(sink.$kind(&self.$field);)*
            }
        }
    };
}

pub(super) use columns;

impl<'a, T: Columns<'a>> Columns<'a> for Option<T> {
    fn open(source: &mut Source<'a>) -> Result<Self, CookedError> {
        if source.flag()? { T::open(source).map(Some) } else { Ok(None) }
    }

    #[cfg(feature = "alloc")]
    fn cook(&self, sink: &mut super::sink::Sink) {
        sink.flag(&self.is_some());
        if let Some(part) = self {
            part.cook(sink);
        }
    }
}

/// The places of all terms in the matrix.
impl<'a> Columns<'a> for [&'a [u16]; Term::ALL.len()] {
    fn open(source: &mut Source<'a>) -> Result<Self, CookedError> {
        let mut slots: Self = [&[]; Term::ALL.len()];
        for slots in &mut slots {
            *slots = source.constant()?;
        }
        Ok(slots)
    }

    #[cfg(feature = "alloc")]
    fn cook(&self, sink: &mut super::sink::Sink) {
        self.iter().for_each(|slots| sink.constant(slots));
    }
}

columns! { Particles {
    state positions, state velocities, state low_positions, state low_velocities, constant masses,
    constant inverse_masses,
} }

columns! { Model {
    part gravity, part drag, part stretch_springs, part bend_springs, part membrane, part hinges, part seams, part wind,
    part loads,
} }
columns! { Gravity { value acceleration, constant keys } }
columns! { Drag { constant coefficients } }
columns! { Springs { constant offsets, constant others, constant rest, constant stiffness, constant damping } }
columns! { Membrane {
    constant vertices, constant weights, constant areas, constant materials, constant table, part incidence,
} }
columns! { Hinges {
    constant vertices, constant stiffness, constant rest_angles, constant least_heights, constant damping, part incidence,
} }
columns! { Seams { constant vertices, constant weights, constant stiffness, constant damping, part incidence } }
columns! { Wind { constant vertices, value velocity, constant keys, value normal, value tangential, part incidence } }
columns! { Loads { constant vertices, constant parts, constant groups, constant keys, fresh moment, fresh of_host } }
columns! { Incidence { constant offsets, constant slots } }

columns! { Scratch {
    scratch forces, scratch elements, scratch next_positions, scratch displacements, scratch velocity_changes,
    part stage_positions, scratch stage_velocities, scratch pin_forces,
    scratch previous_displacements, scratch previous_velocity_changes, scratch base_offsets, scratch base_velocities,
    fresh last_step, part matrix, part assembly_map, scratch tangents, scratch solution, scratch residual,
    scratch gradient, scratch base_residual, scratch direction, scratch products, scratch preconditioned,
    scratch inverse_diagonal, part patches, part coarse, state cloths, scratch partials,
} }
columns! { Reactions { fresh groups, scratch pins, scratch colliders } }
columns! { PositionsMut { scratch rounded, scratch low } }
columns! { BlockMatrix {
    constant offsets, constant columns, constant mirrored_offsets, constant mirrored, scratch blocks,
} }
columns! { Patches { constant labels, constant coordinates, constant held, constant first_columns, constant offsets } }
columns! { CoarseFactor {
    scratch values, scratch own, scratch elastic_values, scratch elastic_own, scratch inverse_diagonal, scratch rounded,
    scratch vector, scratch motions,
} }

columns! { Surface {
    constant triangles, constant triangle_edges, constant owned, constant edges, part incidence, part sewn,
    value first_passive, flag own_contact,
} }
columns! { Sewn { constant offsets, constant others } }

columns! { ContactScratch {
    scratch start, scratch end, scratch displacements, scratch turns, scratch boxes, scratch ends, cell searched,
    cell counts, cell open, part vertex_triangle, part edge_edge, cell lengths, scratch constraints, scratch contacts,
    scratch lines, scratch multipliers, scratch order, part grid, part kept, part room,
} }
columns! { Pairs { scratch candidates, scratch distances, scratch times } }
columns! { Grid {
    scratch triangle_boxes, scratch moving_boxes, scratch owned, scratch levels, scratch quantized_boxes, scratch spheres,
    scratch byte_boxes, scratch homes, scratch entries, scratch spare,
} }
columns! { KeptPairs { scratch boxes, scratch vertex_triangle, scratch edge_edge, cell counts } }
columns! { Room { scratch boxes, scratch bounds, scratch edges, scratch taken } }

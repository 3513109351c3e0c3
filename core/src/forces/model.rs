//! The model: the force terms that a scene names. The list of all terms is below the macro.

use super::term::ForceTerm;
use super::{drag, gravity, hinge, load, membrane, seam, spring, wind};
use crate::keys::Moment;

/// Makes [`Term`], [`Model`], [`ModelColumns`] and `for_each_term` from the list. `$d` is a dollar sign: the
/// inner macro needs its own.
macro_rules! force_terms {
    ($d:tt $( $(#[$doc:meta])* $field:ident, $name:ident, $text:literal, $view:ty, $columns:ty; )*) => {
        /// A force term.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum Term {
            $( $(#[$doc])* $name, )*
        }

        impl Term {
            /// Every term, in the order of evaluation.
            pub const ALL: [Self; [$( $text ),*].len()] = [$( Self::$name ),*];

            /// The name for messages and reports.
            pub const fn name(self) -> &'static str {
                match self {
                    $( Self::$name => $text, )*
                }
            }
        }

        /// The terms, borrowed. A term that the scene does not name is `None`.
        #[derive(Clone, Copy, Debug, Default)]
        pub struct Model<'a> {
            $( $(#[$doc])* pub $field: Option<$view>, )*
        }

        impl Model<'_> {
            /// The model with only one of its terms. `None` if the model does not have the term.
            pub fn only(&self, term: Term) -> Option<Self> {
                match term {
                    $( Term::$name => {
                        self.$field.map(|term| Self { $field: Some(term), ..Self::default() })
                    } )*
                }
            }

            /// The model with only its conservative terms.
            pub fn conservative(&self) -> Self {
                Self { $( $field: self.$field.filter(ForceTerm::is_conservative), )* }
            }
        }

        /// The owned columns of a [`Model`].
        #[cfg(feature = "alloc")]
        #[derive(Clone, Debug, Default)]
        pub struct ModelColumns {
            $( $(#[$doc])* pub $field: Option<$columns>, )*
        }

        #[cfg(feature = "alloc")]
        impl ModelColumns {
            /// The borrowed view that kernels take.
            pub fn view(&self) -> Model<'_> {
                Model { $( $field: self.$field.as_ref().map(|columns| columns.view()), )* }
            }
        }

        /// Runs the body for every term that the model has, in the order of evaluation.
        macro_rules! for_each_term {
            ($d model:ident, |$d name:pat_param, $d term:ident| $d body:expr) => {
                $( if let Some($d term) = &$d model.$field {
                    let $d name = $crate::forces::Term::$name;
                    $d body;
                } )*
            };
        }
    };
}

// A row: the field of the model, the name in code and in reports, the view that kernels take, its owned columns.
// Terms are evaluated in this order.
force_terms! { $
    /// Gravity.
    gravity, Gravity, "gravity", gravity::Gravity<'a>, gravity::GravityColumns;
    /// Linear drag.
    drag, Drag, "drag", drag::Drag<'a>, drag::DragColumns;
    /// Springs along the edges.
    stretch_springs, StretchSpring, "stretch (springs)", spring::Springs<'a>, spring::SpringColumns;
    /// Springs between unshared vertices of neighbouring triangles.
    bend_springs, BendSpring, "bend (springs)", spring::Springs<'a>, spring::SpringColumns;
    /// Stretch and shear of triangles.
    membrane, Membrane, "stretch and shear (membrane)", membrane::Membrane<'a>, membrane::MembraneColumns;
    /// Angles between neighbouring triangles.
    hinges, Hinge, "bend (hinges)", hinge::Hinges<'a>, hinge::HingeColumns;
    /// Sewn vertices.
    seams, Seam, "seam", seam::Seams<'a>, seam::SeamColumns;
    /// Wind on triangles.
    wind, Wind, "wind", wind::Wind<'a>, wind::WindColumns;
    /// Loads on some vertices.
    loads, Load, "load", load::Loads<'a>, load::LoadColumns;
}

// Gravity sets the forces, and drag the matrix; the terms after them add.
const _: () = assert!(Term::Gravity as usize == 0 && Term::Drag as usize == 1);

pub(crate) use for_each_term;

impl Model<'_> {
    /// The forces at a time, s, or at a [`Moment`] of a step.
    pub fn at(&self, moment: impl Into<Moment>) -> Self {
        let moment = moment.into();
        Self {
            gravity: self.gravity.map(|gravity| gravity.at(moment)),
            wind: self.wind.map(|wind| wind.at(moment)),
            loads: self.loads.map(|loads| loads.at(moment)),
            ..*self
        }
    }

    /// Whether gravity or a load changes with time. Then the potential energy changes at a fixed position too.
    pub fn potential_varies(&self) -> bool {
        self.gravity.is_some_and(|gravity| !gravity.keys.is_empty()) || self.loads.is_some_and(|loads| loads.vary())
    }

    /// Whether any force depends on velocities.
    pub fn dissipates(&self) -> bool {
        let mut any = false;
        for_each_term!(self, |_, term| any |= term.dissipates());
        any
    }

    /// Number of vectors that [`evaluate`](super::evaluate) needs as scratch.
    pub fn force_scratch(&self) -> usize {
        let mut most = 0;
        for_each_term!(self, |_, term| most = most.max(term.force_scratch()));
        most
    }

    /// Number of scalars that [`write_tangents`](super::write_tangents) needs as scratch.
    pub fn tangent_scratch(&self) -> usize {
        let mut most = 0;
        for_each_term!(self, |_, term| most = most.max(term.tangent_scratch()));
        most
    }

    /// Bytes of the columns.
    pub fn bytes(&self) -> usize {
        let mut sum = 0;
        for_each_term!(self, |_, term| sum += term.bytes());
        sum
    }
}

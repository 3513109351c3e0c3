//! A contact in the augmented Lagrangian of a step. With the relative velocity u of its nearest points, the impulse of
//! the contact is
//!
//! ```text
//! along the normal n   p = max(0, p0 + s (w - n . u))
//! across it            q = q0 - s (u - n n . u), shortened to the bound b where it is longer
//! ```
//!
//! where w is the normal velocity that keeps the contact apart, p0 and q0 are the multipliers, which start as the
//! impulses of the step before, and s is a stiffness. The bound b is the coefficient of friction times p. Bounds and
//! multipliers are updated while the step is solved; between two updates the impulses are the gradient of a convex
//! function [Simo 1992, Alart 1991].

use crate::column::Column;
use crate::forces::matrix::{self, BlockMatrix};
use crate::integrate::convex_term::{ConvexTerm, Curvature};
use crate::real::{Lanes, Mat3, Real, Sum, Vec3, dot_sum, outer, scaled_identity, sqrt};

/// Stiffness of a contact relative to that of the cloth at its vertices. A larger value needs more iterations; a
/// smaller value leaves more of a sudden contact to the response.
pub const STIFFNESS: Real = 0.3;

/// Factor of the stiffness of a contact that an update of its multiplier finds violated, or pushing apart.
const HARDENING: Real = 10.0;

/// How often a contact becomes stiffer in a step. Stiffer ones would only make the solve slow.
const MOST_HARDENINGS: u16 = 8;

/// Whether a contact slides.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, bytemuck::CheckedBitPattern, bytemuck::NoUninit)]
#[repr(u16)]
pub enum Friction {
    /// It was at rest before the step. The static coefficient bounds its friction, even if it slides now.
    #[default]
    Rests,
    /// It slid before. The static coefficient bounds its friction.
    Sticks,
    /// The kinetic coefficient bounds its friction.
    Slips,
}

/// A contact in the augmented Lagrangian of a step.
#[derive(Clone, Copy, Debug, Default, PartialEq, bytemuck::CheckedBitPattern, bytemuck::NoUninit)]
#[repr(C)]
pub struct AugmentedContact {
    /// Vertices of both features. Those that are not the cloth's have a prescribed motion.
    pub vertices: [u32; 4],
    /// Weights of the vertices in the nearest points: positive on the first feature, negative on the second.
    pub weights: [Real; 4],
    /// Unit vector from the second feature to the first.
    pub normal: Vec3,
    /// Distance of the nearest point from the centre or axis of a round collider, m; 0: the contact is with another
    /// surface.
    pub centre_distance: Real,
    /// w: least normal velocity, m/s.
    pub least_velocity: Real,
    /// Normal velocity by which the contact may be violated before it becomes stiffer, m/s.
    pub slack: Real,
    /// u: relative velocity, m/s. Input: that of the start of the solve.
    pub velocity: Vec3,
    /// p0 n + q0, kg m/s.
    pub multiplier: Vec3,
    /// Coefficients of friction, static and kinetic.
    pub coefficients: [Real; 2],
    /// Index of the contact's constraint in the response.
    pub constraint: u32,
    /// How often the stiffness was raised; computed.
    pub hardenings: u16,
    /// Whether it slides; computed.
    pub friction: Friction,
    /// s, kg; computed.
    pub stiffness: Real,
    /// b, kg m/s; computed.
    pub bound: Real,
    /// p n + q, kg m/s; computed.
    pub impulse: Vec3,
    /// Change of u along the search direction; computed.
    pub change: Vec3,
}

/// A contact along a search direction g: the parts of the derivative of its potential. With the velocity u + a g,
/// its normal impulse is that of `along - a s change_along`, and the square of the one across is quadratic in a.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ContactLine {
    along: Real,
    change_along: Real,
    squared: Real,
    slide: Real,
    change_squared: Real,
    stiffness: Real,
    bound: Real,
}

/// Four [contacts along a search direction](ContactLine), one in each lane. A line of zeros adds nothing.
#[derive(Clone, Copy, Debug, Default, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct ContactLines {
    along: Lanes,
    change_along: Lanes,
    squared: Lanes,
    slide: Lanes,
    change_squared: Lanes,
    stiffness: Lanes,
    bound: Lanes,
}

impl ContactLines {
    /// Writes one lane.
    #[inline]
    pub fn set(&mut self, lane: usize, line: &ContactLine) {
        self.along.as_mut_array().set(lane, line.along);
        self.change_along.as_mut_array().set(lane, line.change_along);
        self.squared.as_mut_array().set(lane, line.squared);
        self.slide.as_mut_array().set(lane, line.slide);
        self.change_squared.as_mut_array().set(lane, line.change_squared);
        self.stiffness.as_mut_array().set(lane, line.stiffness);
        self.bound.as_mut_array().set(lane, line.bound);
    }

    /// The products of the impulses with g, and `g . H g`, where -H is the derivative of an impulse, at the velocities
    /// u + `length` g.
    #[inline]
    fn slopes_and_curvatures(&self, length: Real) -> [Lanes; 2] {
        let Self { change_along, change_squared, stiffness, bound, .. } = *self;
        let way = stiffness * Lanes::splat(length);
        let along = self.along - way * change_along;
        let slide = self.slide - way * change_squared;
        let squared = self.squared - way * (self.slide + self.slide - way * change_squared);
        let pushes = along.simd_gt(Lanes::ZERO);
        let slips = squared.simd_gt(bound * bound);
        let part = bound / squared.sqrt();
        let curved = change_squared - slide * slide / squared;
        let curved = curved.simd_gt(Lanes::ZERO).bitselect(part * curved, Lanes::ZERO);
        let slope = pushes.bitselect(along * change_along, Lanes::ZERO) + slips.bitselect(part * slide, slide);
        let squares = pushes.bitselect(change_along * change_along, Lanes::ZERO);
        [slope, stiffness * (squares + slips.bitselect(curved, change_squared))]
    }
}

/// The products of the impulses with g, and `g . H g`, where -H is the derivative of the impulses, at the velocities
/// u + `length` g; summed over all contacts.
pub fn slope_and_curvature(lines: &[ContactLines], length: Real) -> [Sum; 2] {
    let mut sums = [0.0; 2];
    for line in lines {
        for (sum, lanes) in sums.iter_mut().zip(line.slopes_and_curvatures(length)) {
            let [a, b, c, d] = lanes.to_array().map(Sum::from);
            *sum += (a + b) + (c + d);
        }
    }
    sums
}

/// Impulses before they are cut off: the normal one, and the one across the normal.
struct Trial {
    along: Real,
    across: Vec3,
}

impl AugmentedContact {
    /// Sets the stiffness, and the bound of friction from the multiplier. A contact that pushes without one sticks
    /// until the first update.
    ///
    /// The stiffness suffices to remove the normal multiplier within the slack. A softer contact that carries a heavy
    /// sheet throws a light one far away before it lets go.
    pub fn start(&mut self, masses: &[Real], matrix: &BlockMatrix<'_>) {
        let along = self.normal.dot(self.multiplier);
        let of_cloth = STIFFNESS / self.compliance(masses, matrix).max(Real::MIN_POSITIVE);
        self.stiffness = of_cloth.max(along / self.slack);
        self.bound = if along > 0.0 {
            self.coefficients[0] * along
        } else if self.coefficients[0] > 0.0 {
            Real::INFINITY
        } else {
            0.0
        };
        self.impulse = self.impulse_at(self.velocity);
    }

    /// How the vertices give way along the normal, each for itself: sum W^2 / (n . A n), 1/kg.
    fn compliance(&self, masses: &[Real], matrix: &BlockMatrix<'_>) -> Real {
        let of_vertex = |(&v, weight): (&u32, Real)| {
            let Some(&mass) = masses.get(v as usize) else { return 0.0 };
            let diagonal = matrix.offsets.at(v as usize) as usize;
            let Some(block) = matrix.blocks.element(diagonal).map(matrix::to_mat3) else { return 0.0 };
            weight * weight / (mass + self.normal.dot(block * self.normal).max(0.0))
        };
        self.vertices.iter().zip(self.weights).map(of_vertex).sum()
    }

    fn trial(&self, velocity: Vec3) -> Trial {
        let force = self.multiplier - velocity * self.stiffness;
        let along = self.normal.dot(force);
        Trial { along: along + self.stiffness * self.least_velocity, across: force - self.normal * along }
    }

    /// The impulse at a relative velocity, kg m/s.
    #[inline(never)]
    pub fn impulse_at(&self, velocity: Vec3) -> Vec3 {
        let Trial { along, across } = self.trial(velocity);
        let squared = across.length_squared();
        let friction = if squared > self.bound * self.bound { across * (self.bound / sqrt(squared)) } else { across };
        self.normal * along.max(0.0) + friction
    }

    /// The contact along a search direction that changes u by `change`; `None` if it stays without impulse on it.
    #[inline]
    pub fn line(&self, change: Vec3) -> Option<ContactLine> {
        let Trial { along, across } = self.trial(self.velocity);
        let change_along = self.normal.dot(change);
        let change_across = change - self.normal * change_along;
        let line = ContactLine {
            along,
            change_along,
            squared: across.length_squared(),
            slide: across.dot(change_across),
            change_squared: change_across.length_squared(),
            stiffness: self.stiffness,
            bound: self.bound,
        };
        let never_pushes = along <= 0.0 && change_along >= 0.0;
        (!(never_pushes && self.bound == 0.0)).then_some(line)
    }

    /// Makes the impulse the multiplier. A contact that is violated pushes harder afterwards, one that pushes apart
    /// pushes less [Hestenes 1969]. If it does so by more than its slack, it also becomes stiffer: the multiplier of a
    /// landing is so large that updates with the stiffness of the cloth would need a hundred steps to remove it.
    pub fn update_multiplier(&mut self) {
        let violation = self.least_velocity - self.normal.dot(self.velocity);
        let is_off = violation > self.slack || violation < -self.slack && self.normal_impulse() > 0.0;
        if is_off && self.hardenings < MOST_HARDENINGS {
            self.stiffness *= HARDENING;
            self.hardenings += 1;
        }
        self.multiplier = self.impulse;
        self.impulse = self.impulse_at(self.velocity);
    }

    /// Sets the bound of friction from the normal impulse. A contact that slid before slips where it would need more than
    /// the static coefficient allows, and sticks again where it needs less than the kinetic one allows. One that slides from
    /// rest does so by the static coefficient until the next step: if it slipped at once, its neighbours would have to hold
    /// more, and a whole sheet that should stick would come loose.
    pub fn update_friction(&mut self) {
        let Trial { along, across } = self.trial(self.velocity);
        let (along, needed) = (along.max(0.0), sqrt(across.length_squared()));
        let [at_rest, kinetic] = self.coefficients;
        self.friction = match self.friction {
            Friction::Sticks if needed > at_rest * along => Friction::Slips,
            Friction::Slips if needed < kinetic * along => Friction::Sticks,
            unchanged => unchanged,
        };
        self.bound = along * if self.friction == Friction::Slips { kinetic } else { at_rest };
        self.impulse = self.impulse_at(self.velocity);
    }

    /// The matrix from relative velocity to impulse that the preconditioner assumes; `None` if the contact does not
    /// push.
    #[inline(never)]
    pub fn matrix(&self) -> Option<Mat3> {
        let Trial { along, across } = self.trial(self.velocity);
        if along <= 0.0 {
            return None;
        }
        let squared = across.length_squared();
        let part = if squared > self.bound * self.bound { self.bound / sqrt(squared) } else { 1.0 };
        let normal = outer(self.normal, self.normal);
        Some((normal + (scaled_identity(1.0) - normal) * part) * self.stiffness)
    }

    /// Relative velocity of the nearest points for a column over the cloth's vertices.
    #[inline]
    pub fn gather(&self, column: &[Vec3]) -> Vec3 {
        let parts = self.vertices.iter().zip(self.weights);
        parts.map(|(&v, weight)| column.get(v as usize).map_or(Vec3::ZERO, |&x| x * weight)).sum()
    }

    /// Adds the impulse to a column over the cloth's vertices.
    #[inline]
    pub fn scatter_impulse(&self, out: &mut [Vec3]) {
        for (&v, weight) in self.vertices.iter().zip(self.weights) {
            if let Some(out) = out.get_mut(v as usize) {
                *out += self.impulse * weight;
            }
        }
    }

    /// Normal impulse, kg m/s.
    pub fn normal_impulse(&self) -> Real {
        self.normal.dot(self.impulse)
    }

    /// Speed of sliding at a relative velocity, m/s.
    pub fn slide(&self, velocity: Vec3) -> Real {
        sqrt((velocity - self.normal * self.normal.dot(velocity)).length_squared())
    }
}

/// The contacts of a solve, as a term of its function: the sum of their potentials.
pub struct ActiveContacts<'a> {
    contacts: &'a mut [AugmentedContact],
    lines: &'a mut [ContactLines],
    /// Number of contacts in the lines.
    count: usize,
}

impl<'a> ActiveContacts<'a> {
    /// `lines` has room for all contacts, four in each.
    pub fn new(contacts: &'a mut [AugmentedContact], lines: &'a mut [ContactLines]) -> Self {
        Self { contacts, lines, count: 0 }
    }
}

impl ConvexTerm for ActiveContacts<'_> {
    fn is_zero(&self) -> bool {
        self.contacts.is_empty()
    }

    fn visit_curvature(&self, visit: &mut dyn FnMut(&Curvature)) {
        for contact in &*self.contacts {
            if let Some(matrix) = contact.matrix() {
                visit(&Curvature { vertices: contact.vertices, weights: contact.weights, matrix });
            }
        }
    }

    fn add_impulses(&self, out: &mut [Vec3]) {
        for contact in self.contacts.iter().filter(|contact| contact.impulse != Vec3::ZERO) {
            contact.scatter_impulse(out);
        }
    }

    fn set_direction(&mut self, direction: &[Vec3]) -> Sum {
        let mut slope = 0.0;
        self.count = 0;
        for contact in &mut *self.contacts {
            contact.change = contact.gather(direction);
            slope += dot_sum(contact.impulse, contact.change);
            if let Some(line) = contact.line(contact.change) {
                let Some(lines) = self.lines.element_mut(self.count / 4) else { continue };
                if self.count.is_multiple_of(4) {
                    *lines = ContactLines::default();
                }
                lines.set(self.count % 4, &line);
                self.count += 1;
            }
        }
        slope
    }

    fn slope_and_curvature(&self, length: Real) -> [Sum; 2] {
        slope_and_curvature(self.lines.part(..self.count.div_ceil(4)), length)
    }

    fn advance(&mut self, length: Real) {
        for contact in &mut *self.contacts {
            contact.velocity += contact.change * length;
            contact.impulse = contact.impulse_at(contact.velocity);
        }
    }

    fn update(&mut self, is_early: bool) {
        for contact in &mut *self.contacts {
            contact.update_friction();
            if is_early {
                contact.update_multiplier();
            }
        }
    }
}

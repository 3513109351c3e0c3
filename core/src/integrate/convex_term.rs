//! A convex function of the velocities that is minimised together with the quadratic one of an implicit step. It is
//! piecewise quadratic between its updates. The solver knows no more about contacts than this.

use crate::real::{Mat3, Real, Sum, Vec3};

/// A convex, piecewise quadratic function of the velocities of all vertices.
pub trait ConvexTerm {
    /// Whether it is zero everywhere.
    fn is_zero(&self) -> bool;
    /// Calls `visit` for each part of its second derivative.
    fn visit_curvature(&self, visit: &mut dyn FnMut(&Curvature));
    /// Adds its negative gradient to a column over the vertices, kg m/s.
    fn add_impulses(&self, out: &mut [Vec3]);
    /// Sets the search direction. Returns the product of the negative gradient with it.
    fn set_direction(&mut self, direction: &[Vec3]) -> Sum;
    /// Along the direction, at a multiple of it: the product of the negative gradient with it, and the curvature.
    fn slope_and_curvature(&self, length: Real) -> [Sum; 2];
    /// Moves by a multiple of the direction.
    fn advance(&mut self, length: Real);
    /// Changes the function as the minimum approaches. `is_early` says whether this is one of the first updates.
    fn update(&mut self, is_early: bool);
}

/// A part of a second derivative: `W^T matrix W`, where W sums the velocities of four vertices by their weights.
#[derive(Clone, Copy, Debug)]
pub struct Curvature {
    /// The vertices; those that are not the cloth's do not count.
    pub vertices: [u32; 4],
    /// Their weights.
    pub weights: [Real; 4],
    /// Symmetric, kg.
    pub matrix: Mat3,
}

/// The term that is zero.
#[derive(Clone, Copy, Debug)]
pub struct NoTerm;

impl ConvexTerm for NoTerm {
    fn is_zero(&self) -> bool {
        true
    }
    fn visit_curvature(&self, _: &mut dyn FnMut(&Curvature)) {}
    fn add_impulses(&self, _: &mut [Vec3]) {}
    fn set_direction(&mut self, _: &[Vec3]) -> Sum {
        0.0
    }
    fn slope_and_curvature(&self, _: Real) -> [Sum; 2] {
        [0.0; 2]
    }
    fn advance(&mut self, _: Real) {}
    fn update(&mut self, _: bool) {}
}

//! Friction: Coulomb's cone with a static and a kinetic coefficient, and optionally one that
//! depends on the speed, mu(v) = mu_k + (mu_s - mu_k) exp(-(v / v_s)^2) + c v [Stribeck 1902,
//! Armstrong 1994].

use bytemuck::{Pod, Zeroable};

use crate::real::{Real, Vec3, exp, sqrt};

/// A law of friction.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Law {
    /// Static coefficient.
    pub at_rest: Real,
    /// Kinetic coefficient.
    pub kinetic: Real,
    /// v_s, m/s. With 0, the kinetic coefficient holds as soon as a contact slides.
    pub stribeck: Real,
    /// c, s/m.
    pub viscous: Real,
}

impl Law {
    /// The coefficient of a contact that slides at `speed`, m/s.
    pub fn sliding(&self, speed: Real) -> Real {
        let decayed = match self.stribeck {
            limit if limit > 0.0 => exp(-(speed / limit) * (speed / limit)),
            _ => 0.0,
        };
        self.kinetic + (self.at_rest - self.kinetic) * decayed + self.viscous * speed
    }

    /// The coefficients of a contact in a step. `speed` is that of its sliding before friction, m/s.
    pub fn coefficients(&self, speed: Real) -> FrictionCoefficients {
        FrictionCoefficients { at_rest: self.at_rest, kinetic: self.sliding(speed) }
    }
}

/// The coefficients of friction of a contact in a step. They are computed once per step: coefficients that followed the
/// corrections of a step would make them oscillate.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct FrictionCoefficients {
    /// Of a contact that sticks.
    pub at_rest: Real,
    /// Of a contact that slides.
    pub kinetic: Real,
}

impl FrictionCoefficients {
    /// One coefficient, whether the contact sticks or slides.
    pub fn always(coefficient: Real) -> Self {
        Self { at_rest: coefficient, kinetic: coefficient }
    }

    /// Whether there is any friction.
    pub fn has_friction(self) -> bool {
        self.at_rest > 0.0 || self.kinetic > 0.0
    }

    /// The friction impulse of a contact: the `needed` one while it sticks, else on the cone.
    pub fn limit(self, needed: Vec3, normal: Real) -> Vec3 {
        let size = sqrt(needed.length_squared());
        if size > self.at_rest * normal {
            return needed * ((self.kinetic * normal).min(size) / size);
        }
        // The square of a very small impulse is zero. Without a normal impulse there is no friction either.
        if normal > 0.0 { needed } else { Vec3::ZERO }
    }
}

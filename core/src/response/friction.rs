//! Friction: Coulomb's cone with a static and a kinetic coefficient, and optionally one that
//! depends on the speed, mu(v) = mu_k + (mu_s - mu_k) exp(-(v / v_s)^2) + c v [Stribeck 1902,
//! Armstrong 1994].

use bytemuck::{Pod, Zeroable};

use crate::real::{Real, Vec3, exp, sqrt};

/// A law of friction.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Law {
    /// Up to which a contact sticks.
    pub at_rest: Real,
    /// While it slides.
    pub kinetic: Real,
    /// v_s, m/s; 0: the static coefficient is gone as soon as something slides.
    pub stribeck: Real,
    /// c, s/m.
    pub viscous: Real,
}

impl Law {
    /// The coefficient of a contact that slides, m/s.
    pub fn sliding(&self, speed: Real) -> Real {
        let decayed = match self.stribeck {
            limit if limit > 0.0 => exp(-(speed / limit) * (speed / limit)),
            _ => 0.0,
        };
        self.kinetic + (self.at_rest - self.kinetic) * decayed + self.viscous * speed
    }

    /// What a contact bears in a step. `speed` is that of its sliding before friction, m/s.
    pub fn grip(&self, speed: Real) -> Grip {
        Grip { sticks: self.at_rest, slides: self.sliding(speed) }
    }
}

/// The friction that a contact bears in a step, of its normal impulse. It is judged once: a
/// coefficient that followed the corrections of a step would be chased by them.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Grip {
    /// Up to which it sticks.
    pub sticks: Real,
    /// Beyond that.
    pub slides: Real,
}

impl Grip {
    /// The same whether it sticks or slides.
    pub fn always(coefficient: Real) -> Self {
        Self { sticks: coefficient, slides: coefficient }
    }

    /// Whether there is any friction.
    pub fn rubs(self) -> bool {
        self.sticks > 0.0 || self.slides > 0.0
    }

    /// The tangential impulse of a contact: as wanted while it sticks, else on the cone.
    pub fn limit(self, wanted: Vec3, normal: Real) -> Vec3 {
        let size = sqrt(wanted.length_squared());
        if size > self.sticks * normal {
            return wanted * ((self.slides * normal).min(size) / size);
        }
        // What is too small to be squared does not stick to nothing.
        if normal > 0.0 { wanted } else { Vec3::ZERO }
    }
}

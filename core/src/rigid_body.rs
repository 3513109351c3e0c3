//! A cloth as if it were rigid: its mass, its inertia, and the rotation that has the same angular momentum.

use glam::DVec3;

use crate::real::{Real, Sum, Vec3, to_f64, vec3};

/// A rigid body.
#[derive(Clone, Copy, Debug, Default, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct RigidBody {
    /// Its mass, kg.
    pub mass: Sum,
    /// Its centre of mass, m.
    pub centre: DVec3,
    /// Columns of the inertia about the centre, kg m^2.
    pub inertia: [DVec3; 3],
}

/// A rotation about the centre of mass.
#[derive(Clone, Copy, Debug, Default)]
pub struct Rotation {
    /// Velocity of the centre, m/s.
    pub drift: DVec3,
    /// Angular velocity, 1/s.
    pub velocity: DVec3,
    /// Energy without that of the drift, J.
    pub energy: Sum,
}

fn double(v: Vec3) -> DVec3 {
    to_f64(v).into()
}

impl RigidBody {
    /// That of particles with these masses, kg, and positions, m.
    #[cfg_attr(small, optimize(size), inline(never))]
    pub fn of(masses: &[Real], x: &[Vec3]) -> Self {
        let particles = || masses.iter().zip(x).map(|(&m, &x)| (Sum::from(m), double(x)));
        let (mass, sum) = particles().fold((0.0, DVec3::ZERO), |(mass, sum), (m, x)| (mass + m, sum + x * m));
        let mut body = Self { mass, centre: sum / mass, ..Self::default() };
        for (m, x) in particles() {
            let arm = x - body.centre;
            for (column, axis) in body.inertia.iter_mut().zip(DVec3::AXES) {
                *column += arm.cross(axis.cross(arm)) * m;
            }
        }
        body
    }

    /// The moment about the centre of a column at these positions, m.
    #[cfg_attr(small, optimize(size), inline(never))]
    pub fn moment(&self, x: &[Vec3], column: impl Iterator<Item = DVec3>) -> DVec3 {
        x.iter().zip(column).map(|(&x, value)| (double(x) - self.centre).cross(value)).sum()
    }

    /// The rotation of particles with these masses, kg, positions, m, and velocities, m/s; none if all mass lies on a line.
    #[cfg_attr(small, optimize(size), inline(never))]
    pub fn rotation(&self, masses: &[Real], x: &[Vec3], v: &[Vec3]) -> Rotation {
        let momenta = || masses.iter().zip(v).map(|(&m, &v)| double(v) * Sum::from(m));
        self.with_momentum(momenta().sum(), self.moment(x, momenta()))
    }

    /// The rotation with a momentum, kg m/s, and an angular momentum about the centre, kg m^2/s.
    #[cfg_attr(small, optimize(size), inline(never))]
    pub fn with_momentum(&self, momentum: DVec3, moment: DVec3) -> Rotation {
        // Cramer's rule; the matrix is symmetric.
        let [a, b, c] = self.inertia;
        let minors = [b.cross(c), c.cross(a), a.cross(b)];
        let velocity = DVec3::from(minors.map(|minor| moment.dot(minor))) / a.dot(minors[0]);
        let velocity = if velocity.is_finite() { velocity } else { DVec3::ZERO };
        Rotation { drift: momentum / self.mass, velocity, energy: 0.5 * velocity.dot(moment) }
    }
}

impl Rotation {
    /// Turns velocities by the rotation during a time, s, by the formula of Rodrigues.
    #[cfg_attr(small, optimize(size), inline(never))]
    pub fn turn(&self, time: Sum, velocities: &mut [Vec3]) {
        let rate = self.velocity.length();
        if rate == 0.0 {
            return;
        }
        let half = libm::sin(0.5 * time * rate) / rate;
        let (sine, versine) = ((libm::sin(time * rate) / rate) as Real, (2.0 * half * half) as Real);
        let [drift, axis] = [self.drift, self.velocity].map(|of| vec3(of.into()));
        for v in velocities {
            let across = axis.cross(*v - drift);
            *v += across * sine + axis.cross(across) * versine;
        }
    }
}

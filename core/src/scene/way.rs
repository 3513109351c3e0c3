//! How far a scene can take its cloth.

use super::collider::ColliderMotionDesc;
use super::{ClothDesc, MotionDesc, SceneDesc, VectorDesc};

impl SceneDesc {
    /// An estimate of the way of the cloth until the end, m: by gravity, wind, loads, start velocities and spins, pins
    /// and colliders, as if nothing resisted. A start velocity of a whole cloth counts where pins or contact can change
    /// it. Of a spin counts the part by which paths curve, and a collider that follows a point cache counts as one that
    /// goes the size. `size` is the largest side of the box around the cloth, m, and `mass` the mass of the cloth, kg.
    #[cfg_attr(small, optimize(size))]
    pub fn way(&self, size: f64, mass: f64) -> f64 {
        let time = self.duration;
        let of_cloth = |cloth: &ClothDesc| {
            let acceleration = self.acceleration(cloth, size, mass);
            self.speed(cloth) * time + 0.5 * acceleration * time * time
        };
        let pins = self.cloth.iter().flat_map(|cloth| &cloth.pin).filter_map(|pin| pin.motion.as_ref());
        let pins = pins.map(|motion| motion.way(time, size));
        let colliders = self.collider.iter().map(|collider| match &collider.motion {
            None => 0.0,
            Some(ColliderMotionDesc::Keys(motion)) => motion.way(time, size),
            Some(ColliderMotionDesc::Cache(_)) => size,
        });
        self.cloth.iter().map(of_cloth).fold(0.0, f64::max) + pins.chain(colliders).fold(0.0, f64::max)
    }

    /// The speed, m/s, that cloth starts with and can lose.
    #[cfg_attr(small, optimize(size))]
    fn speed(&self, cloth: &ClothDesc) -> f64 {
        let can_change = self.contact.is_some() || !cloth.pin.is_empty();
        let of_all = if can_change { length(cloth.velocity) } else { 0.0 };
        cloth.start.iter().map(|part| length(part.velocity)).fold(of_all, f64::max)
    }

    /// The acceleration by gravity, wind, loads and spins, m/s^2.
    #[cfg_attr(small, optimize(size))]
    fn acceleration(&self, cloth: &ClothDesc, size: f64, mass: f64) -> f64 {
        let wind = self.drag.as_ref().and_then(|drag| drag.wind.as_ref());
        let pressure = wind.map_or(0.0, |wind| wind.normal.max(wind.tangential) * wind.velocity.largest());
        let load: f64 = cloth.load.iter().map(|load| load.force.largest()).sum();
        let spin = cloth.spin.map_or(0.0, |spin| 0.5 * size * spin.rate * spin.rate);
        self.largest_gravity() + spin + pressure / cloth.density + load / mass
    }

    /// The largest gravity, m/s^2.
    pub fn largest_gravity(&self) -> f64 {
        self.gravity.as_ref().map_or(0.0, VectorDesc::largest)
    }
}

impl MotionDesc {
    /// The largest way until `time`, s, of something of this `size`, m.
    #[cfg_attr(small, optimize(size))]
    fn way(&self, time: f64, size: f64) -> f64 {
        let turn = self.turn.map_or(0.0, |turn| turn.rate.abs() * turn.until.unwrap_or(time).min(time) * size);
        turn + largest(&self.keys)
    }
}

impl VectorDesc {
    /// Its largest length.
    #[cfg_attr(small, optimize(size))]
    fn largest(&self) -> f64 {
        match self {
            Self::Constant(v) => length(*v),
            Self::Keys(keys) => largest(keys),
        }
    }
}

/// The largest length of the vectors in keys.
fn largest(keys: &[[f64; 4]]) -> f64 {
    keys.iter().map(|&[_, x, y, z]| length([x, y, z])).fold(0.0, f64::max)
}

fn length(v: [f64; 3]) -> f64 {
    libm::sqrt(v.iter().map(|x| x * x).sum())
}

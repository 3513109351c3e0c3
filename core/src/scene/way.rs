//! How far a scene can take its cloth.

use super::collider::ColliderMotionDesc;
use super::{ClothDesc, SceneDesc, VectorDesc};

impl SceneDesc {
    /// An estimate of the way of the cloth until the end, m: by gravity, wind, loads, start velocities and spins, pins
    /// and colliders, as if nothing resisted. A start velocity of a whole cloth counts where pins or contact can change
    /// it, and of a spin the part by which paths curve. `size` is the largest side of the box around the cloth, m.
    #[cfg_attr(small, optimize(size))]
    pub fn way(&self, size: f64) -> f64 {
        let time = self.duration;
        let of_cloth =
            |cloth: &ClothDesc| self.speed(cloth) * time + 0.5 * self.acceleration(cloth, size) * time * time;
        let pins = self.cloth.iter().flat_map(|cloth| &cloth.pin).filter_map(|pin| pin.motion.as_ref());
        let colliders = self.collider.iter().filter_map(|collider| match collider.motion.as_ref()? {
            ColliderMotionDesc::Keys(motion) => Some(motion),
            ColliderMotionDesc::Cache(_) => None,
        });
        let keys = pins.chain(colliders).flat_map(|motion| &motion.keys);
        self.cloth.iter().map(of_cloth).fold(0.0, f64::max)
            + keys.map(|&[_, x, y, z]| length([x, y, z])).fold(0.0, f64::max)
    }

    /// The speed, m/s, that cloth starts with.
    #[cfg_attr(small, optimize(size))]
    fn speed(&self, cloth: &ClothDesc) -> f64 {
        let changes = self.contact.is_some() || !cloth.pin.is_empty();
        let whole = if changes { length(cloth.velocity) } else { 0.0 };
        cloth.start.iter().map(|part| length(part.velocity)).fold(whole, f64::max)
    }

    /// The acceleration by gravity, wind, loads and spins, m/s^2.
    #[cfg_attr(small, optimize(size))]
    fn acceleration(&self, cloth: &ClothDesc, size: f64) -> f64 {
        let wind = self.drag.as_ref().and_then(|drag| drag.wind.as_ref());
        let pressure = wind.map_or(0.0, |wind| wind.normal.max(wind.tangential) * wind.velocity.largest());
        let load: f64 = cloth.load.iter().map(|load| load.force.largest()).sum();
        let spin = cloth.spin.map_or(0.0, |spin| 0.5 * size * spin.rate * spin.rate);
        self.largest_gravity() + spin + (pressure + load / (size * size)) / cloth.density
    }

    /// The largest gravity, m/s^2.
    pub fn largest_gravity(&self) -> f64 {
        self.gravity.as_ref().map_or(0.0, VectorDesc::largest)
    }
}

impl VectorDesc {
    /// Its largest length.
    #[cfg_attr(small, optimize(size))]
    fn largest(&self) -> f64 {
        match self {
            Self::Constant(v) => length(*v),
            Self::Keys(keys) => keys.iter().map(|&[_, x, y, z]| length([x, y, z])).fold(0.0, f64::max),
        }
    }
}

fn length(v: [f64; 3]) -> f64 {
    libm::sqrt(v.iter().map(|x| x * x).sum())
}

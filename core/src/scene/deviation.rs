//! How far pins and colliders move from the straight and even way that a step takes them.

use super::BuiltScene;
use crate::colliders::Drive;
use crate::motion::Motion;
use crate::real::Sum;
use crate::step;

impl BuiltScene {
    /// The largest deviation of pins and colliders from their straight and even way in any step of this length, s; m.
    /// It is largest in a step with a key, with a frame of a point cache or with the end of a rotation, or the same in
    /// all steps.
    #[cfg_attr(small, optimize(size))]
    pub fn largest_deviation(&self, step: Sum) -> Sum {
        let colliders = self.contact.as_ref().map(|contact| contact.colliders.view()).unwrap_or_default();
        let pins = self.pins.view();
        let mut most: Sum = 0.0;
        let mut see = |time: Sum| {
            let start = libm::floor(time.max(0.0) / step) * step;
            let deviation = step::deviation(&pins, &colliders, &self.particles.positions, [start, start + step]);
            most = most.max(deviation);
        };
        see(0.0);
        let of_bodies = colliders.bodies.iter().map(|body| body.drive);
        for drive in of_bodies.chain(pins.table.iter().map(|&motion| Drive::Motion(motion))) {
            match drive {
                Drive::Rest => {}
                Drive::Cache(cache) => (0..cache.frames).for_each(|frame| see(frame as Sum / cache.rate)),
                Drive::Motion(Motion { turn, .. }) => {
                    see(turn.map(|turn| turn.until).filter(|until| until.is_finite()).unwrap_or_default());
                }
            }
        }
        colliders.keys.iter().chain(pins.keys).for_each(|key| see(key.time));
        most
    }
}

//! The motion of pins and colliders in a built scene: when it ends, and how far it is from the straight and even way
//! that a step takes them.

use super::BuiltScene;
use crate::colliders::Drive;
use crate::integrate::pins::Pins;
use crate::real::Sum;
use crate::step;

impl BuiltScene {
    /// Time of the last frame of a point cache that moves a collider, s; 0 without one.
    #[cfg_attr(small, optimize(size), inline(never))]
    pub fn last_frame(&self) -> Sum {
        let bodies = self.contact.iter().flat_map(|contact| &contact.colliders.bodies);
        let ends = bodies.map(|body| if let Drive::Cache(cache) = body.drive() { cache.end() } else { 0.0 });
        ends.fold(0.0, Sum::max)
    }

    /// The largest deviation of pins and colliders from their straight and even way in any step of a run, m; `step` is
    /// the length of a step and `duration` that of the run, s. It is largest in a step with a key, with a frame of a point
    /// cache or with the end of a rotation, or the same in all steps.
    #[cfg_attr(small, optimize(size))]
    pub fn largest_deviation(&self, step: Sum, duration: Sum) -> Sum {
        let colliders = self.contact.as_ref().map(|contact| contact.colliders.view()).unwrap_or_default();
        let pins = self.pins.carried_by(colliders);
        let mut axes = self.pins.axes.clone();
        let mut most: Sum = 0.0;
        let mut see = |time: Sum| {
            if !(0.0..duration).contains(&time) {
                return;
            }
            let start = libm::floor(time / step) * step;
            for (axes, hold) in axes.iter_mut().zip(&self.pins.holds) {
                *axes = hold.axes_after(start);
            }
            let pins = Pins { axes: &axes, ..pins };
            let deviation = step::deviation(&pins, &colliders, &self.particles.positions, [start, start + step]);
            most = most.max(deviation);
        };
        see(0.0);
        let of_bodies = colliders.bodies.iter().map(|body| body.drive());
        for drive in of_bodies.chain(pins.table.iter().map(|&motion| Drive::Motion(motion))) {
            match drive {
                Drive::Rest | Drive::Host(_) => {}
                Drive::Cache(cache) => {
                    (0..cache.frames).for_each(|frame| see(cache.start + frame as Sum / cache.rate));
                }
                Drive::Motion(motion) => {
                    see(motion.turn().map(|turn| turn.until).filter(|until| until.is_finite()).unwrap_or_default());
                }
            }
        }
        colliders.keys.iter().chain(pins.keys).for_each(|key| see(key.time));
        most
    }
}

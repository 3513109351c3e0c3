//! Vectors over time, by keys: linear between two keys, constant before the first and after the last. They are computed
//! in double in both precisions.

use glam::DVec3;

use crate::real::{Real, Sum};

/// A key: a vector at a time. For a motion the vector is an offset, m.
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct Key {
    /// Time, s.
    pub time: Sum,
    /// The vector.
    pub value: DVec3,
}

/// The side from which a rate is evaluated at a time: rates jump at keys and where a rotation stops.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum JumpSide {
    /// The rate up to that time.
    Before,
    /// The rate from that time on.
    After,
}

impl JumpSide {
    /// Whether a change at time `change` lies in the past of `time`. Times are multiples of a rounded step,
    /// so times that differ by less than the rounding count as equal.
    pub(crate) fn has_passed(self, change: Sum, time: Sum) -> bool {
        let rounding = Sum::from(Real::EPSILON) * time.abs();
        match self {
            Self::Before => change < time - rounding,
            Self::After => change <= time + rounding,
        }
    }
}

/// The vector at a time, and its rate on the given side of that time, 1/s.
pub(crate) fn interpolate(keys: &[Key], time: Sum, side: JumpSide) -> (DVec3, DVec3) {
    let after = keys.partition_point(|key| side.has_passed(key.time, time));
    match (after.checked_sub(1).and_then(|before| keys.get(before)), keys.get(after)) {
        (Some(a), Some(b)) => {
            let span = b.time - a.time;
            let slope = (b.value - a.value) / span;
            let part = ((time - a.time) / span).clamp(0.0, 1.0);
            (a.value + (b.value - a.value) * part, slope)
        }
        (Some(only), None) | (None, Some(only)) => (only.value, DVec3::ZERO),
        (None, None) => (DVec3::ZERO, DVec3::ZERO),
    }
}

/// How far the vector would be at the end of a time from its value there if it went on as before a key within: the
/// largest distance over these keys, along the axes of the mask (1, 0). It is as far as cloth flies on that a collider
/// throws and leaves.
#[cfg_attr(small, optimize(size), inline(never))]
pub(crate) fn deviation(keys: &[Key], mask: DVec3, [start, end]: [Sum; 2]) -> Sum {
    let first = keys.partition_point(|key| JumpSide::After.has_passed(key.time, start));
    let last = keys.partition_point(|key| JumpSide::Before.has_passed(key.time, end));
    let (at_end, _) = interpolate(keys, end, JumpSide::Before);
    let of = |key: &Key| {
        let (_, before) = interpolate(keys, key.time, JumpSide::Before);
        ((key.value + before * (end - key.time) - at_end) * mask).length()
    };
    keys.get(first..last).unwrap_or_default().iter().map(of).fold(0.0, Sum::max)
}

/// A time at which a method evaluates forces in a step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Moment {
    /// The time, s.
    pub time: Sum,
    /// Start and end of the step, s.
    pub step: [Sum; 2],
}

impl From<Sum> for Moment {
    /// A time outside of any step.
    fn from(time: Sum) -> Self {
        Self { time, step: [time; 2] }
    }
}

impl Moment {
    /// The vector that a method takes at this time. If keys lie within the step, the mean over the step differs from
    /// the mean of its two ends; this difference is added at all times of the step. So a gust that is shorter than the
    /// step gives its impulse, and where the vector is linear over the step, every method keeps its order.
    pub fn value(&self, keys: &[Key]) -> DVec3 {
        let at = |time| interpolate(keys, time, JumpSide::After).0;
        let [start, end] = self.step;
        let [first, last] = [keys.partition_point(|key| key.time <= start), keys.partition_point(|key| key.time < end)];
        let within = keys.get(first..last).unwrap_or_default();
        if within.is_empty() || keys.len() == 1 {
            return at(self.time);
        }
        let ends = [start, end].map(|time| Key { time, value: at(time) });
        let (mut twice_the_integral, mut before) = (DVec3::ZERO, ends[0]);
        for &key in within.iter().chain(&ends[1..]) {
            twice_the_integral += (before.value + key.value) * (key.time - before.time);
            before = key;
        }
        at(self.time) + 0.5 * (twice_the_integral / (end - start) - (ends[0].value + ends[1].value))
    }
}

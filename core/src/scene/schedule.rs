//! The changes that a scene schedules after its start.

use super::collider::ColliderMotionDesc;
use super::{MotionDesc, SceneDesc, VectorDesc};

impl SceneDesc {
    /// Time of the last change that the scene schedules: a key, or the start or end of a pin or a rotation, s. Of a rotation
    /// without an end the first turn counts: then it has been everywhere. Point caches do not count ([`BuiltScene::last_frame`](super::BuiltScene::last_frame)).
    pub fn last_change(&self) -> f64 {
        let vectors = (self.gravity.iter())
            .chain(self.drag.iter().filter_map(|drag| drag.wind.as_ref()).map(|wind| &wind.velocity))
            .chain(self.cloth.iter().flat_map(|cloth| &cloth.load).map(|load| &load.force));
        let pins = || self.cloth.iter().flat_map(|cloth| &cloth.pin);
        let motions = pins().filter_map(|pin| pin.motion.as_ref()).chain(self.collider.iter().filter_map(|collider| {
            match collider.motion.as_ref()? {
                ColliderMotionDesc::Keys(motion) => Some(motion),
                ColliderMotionDesc::Cache(_) => None,
            }
        }));
        let holds = pins().flat_map(|pin| [pin.from, pin.until.unwrap_or(0.0)]);
        vectors.map(VectorDesc::last_key).chain(motions.map(MotionDesc::end)).chain(holds).fold(0.0, f64::max)
    }
}

impl VectorDesc {
    /// Time of the last key, s; 0 if it is constant.
    fn last_key(&self) -> f64 {
        match self {
            Self::Constant(_) => 0.0,
            Self::Keys(keys) => last_time(keys),
        }
    }
}

impl MotionDesc {
    /// Time of the last key or of the end of the rotation, s.
    fn end(&self) -> f64 {
        let whole_turn = |rate: f64| if rate == 0.0 { 0.0 } else { core::f64::consts::TAU / rate.abs() };
        let turned = self.turn.as_ref().map(|turn| turn.until.unwrap_or(whole_turn(turn.rate)));
        last_time(&self.keys).max(turned.unwrap_or(0.0))
    }
}

fn last_time(keys: &[[f64; 4]]) -> f64 {
    keys.last().map_or(0.0, |&[time, ..]| time)
}

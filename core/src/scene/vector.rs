//! Vectors of a scene that may change with time.

use alloc::vec;
use alloc::vec::Vec;

use glam::DVec3;

use super::check::finite;
use crate::error::SceneError;
use crate::keys::{Key, Moment};
use crate::real::{Real, Vec3, vec3};

/// A vector, constant or by keys over time.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(untagged))]
pub enum VectorDesc {
    /// A constant vector.
    Constant([f64; 3]),
    /// Time, s, then the vector. Linear between keys, constant before the first and after the last.
    Keys(#[cfg_attr(feature = "schema", schemars(with = "Section"))] Vec<[f64; 4]>),
}

/// The keys of a vector.
#[cfg(feature = "serde")]
#[derive(serde::Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
struct Section {
    keys: Vec<[f64; 4]>,
}

impl VectorDesc {
    /// Checks that there is a key, that all numbers are finite and that the times increase. `key` is the key in the
    /// scene that errors name.
    pub(super) fn check(&self, key: &'static str) -> Result<(), SceneError> {
        let keys = match self {
            Self::Constant(vector) => return finite(key, vector),
            Self::Keys(keys) => keys,
        };
        let times_increase = keys.windows(2).all(|k| k[0][0] < k[1][0]);
        let are_finite = keys.as_flattened().iter().all(|&x| (x as Real).is_finite());
        if times_increase && are_finite && !keys.is_empty() { Ok(()) } else { Err(SceneError::VectorKeys { key }) }
    }

    /// The keys; one for a constant vector.
    pub(super) fn keys(&self) -> Vec<Key> {
        match self {
            Self::Constant(vector) => vec![Key { time: 0.0, value: DVec3::from(*vector) }],
            Self::Keys(keys) => keys.iter().map(|&[time, x, y, z]| Key { time, value: DVec3::new(x, y, z) }).collect(),
        }
    }

    /// The vector at the start, and its keys if it changes.
    pub(super) fn over_time(&self) -> (Vec3, Vec<Key>) {
        let keys = self.keys();
        let start = vec3(Moment::default().value(&keys).into());
        (start, if keys.len() > 1 { keys } else { Vec::new() })
    }
}

#[cfg(feature = "serde")]
impl<'de> serde::Deserialize<'de> for VectorDesc {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        use serde::de::value::{MapAccessDeserializer, SeqAccessDeserializer};

        struct Visitor;

        impl<'de> serde::de::Visitor<'de> for Visitor {
            type Value = VectorDesc;

            fn expecting(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
                f.write_str("[x, y, z], or { keys = [[time, x, y, z], ..] }")
            }

            fn visit_seq<A: serde::de::SeqAccess<'de>>(self, seq: A) -> Result<VectorDesc, A::Error> {
                serde::Deserialize::deserialize(SeqAccessDeserializer::new(seq)).map(VectorDesc::Constant)
            }

            fn visit_map<A: serde::de::MapAccess<'de>>(self, map: A) -> Result<VectorDesc, A::Error> {
                let Section { keys } = serde::Deserialize::deserialize(MapAccessDeserializer::new(map))?;
                Ok(VectorDesc::Keys(keys))
            }
        }

        deserializer.deserialize_any(Visitor)
    }
}

//! Reads the contact section of a scene: thickness and friction.

use alloc::vec;
use alloc::vec::Vec;

use super::build::BuiltScene;
use super::check::{not_negative, positive};
use super::{Resource, SceneDesc, collider};
use crate::contact::ContactColumns;
use crate::error::SceneError;
use crate::mesh::ownership::SurfaceColumns;
use crate::real::{Real, vec3};
use crate::response::friction::Law;

/// Contact between all surfaces of a scene.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Deserialize), serde(deny_unknown_fields))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ContactDesc {
    /// Thickness, m: features nearer than this are in contact.
    pub thickness: f64,
    /// Friction of cloth, and of colliders that do not give their own.
    #[cfg_attr(feature = "serde", serde(default))]
    pub friction: FrictionDesc,
    /// Whether cloths collide with themselves and with one another.
    #[cfg_attr(feature = "serde", serde(default = "yes", rename = "self"))]
    pub own: bool,
    /// Whether impacts during the step are detected. Without it, only proximity keeps surfaces apart.
    #[cfg_attr(feature = "serde", serde(default = "yes"))]
    pub continuous: bool,
    /// Whether a step in which surfaces would pass through each other is taken in two halves, each of which may be halved
    /// again. Otherwise vertices that would collide are held back at once, and a cooked scene needs no copy of its state.
    /// Error control divides steps too, and excludes it.
    #[cfg_attr(feature = "serde", serde(default = "yes"))]
    pub halving: bool,
}

impl ContactDesc {
    /// The defaults of a scene file, with a thickness, m.
    pub fn of(thickness: f64) -> Self {
        Self { thickness, friction: FrictionDesc::default(), own: true, continuous: true, halving: true }
    }
}

/// Coefficients of friction. A scene may give a single number for the static and the kinetic one.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(from = "Given"))]
pub struct FrictionDesc {
    /// Static coefficient: contacts stick up to it.
    pub at_rest: f64,
    /// Kinetic coefficient: of contacts that slide.
    pub kinetic: f64,
    /// Sliding speed at which the excess of the static over the kinetic coefficient has decayed to
    /// 1/e, m/s. Absent: every contact that slides has the kinetic coefficient.
    pub stribeck: Option<f64>,
    /// Growth of the coefficient with the sliding speed, s/m.
    pub viscous: f64,
}

impl FrictionDesc {
    /// The same static and kinetic coefficient.
    pub fn both(mu: f64) -> Self {
        Self { at_rest: mu, kinetic: mu, ..Self::default() }
    }

    /// The law with these coefficients. `key` is the key in the scene that errors name.
    pub(super) fn law(&self, key: &'static str) -> Result<Law, SceneError> {
        not_negative(key, self.at_rest)?;
        not_negative(key, self.kinetic)?;
        not_negative("friction.viscous", self.viscous)?;
        if let Some(speed) = self.stribeck {
            positive("friction.stribeck", speed)?;
        }
        if self.at_rest < self.kinetic {
            return Err(SceneError::StaticBelowKinetic { at_rest: self.at_rest, kinetic: self.kinetic });
        }
        Ok(Law {
            at_rest: self.at_rest as Real,
            kinetic: self.kinetic as Real,
            stribeck: self.stribeck.unwrap_or(0.0) as Real,
            viscous: self.viscous as Real,
        })
    }
}

/// The columns of contact; `None` if the scene has no contact section.
pub(super) fn columns(
    scene: &SceneDesc,
    built: &BuiltScene,
    resources: &[Resource],
) -> Result<Option<ContactColumns>, SceneError> {
    let Some(contact) = &scene.contact else {
        return if scene.collider.is_empty() { Ok(None) } else { Err(SceneError::ColliderWithoutContact) };
    };
    if !contact.halving && scene.integrator.error().is_some() {
        return Err(SceneError::ErrorWithoutHalving);
    }
    let mut columns = ContactColumns {
        thickness: positive("contact.thickness", contact.thickness)? as Real,
        continuous: contact.continuous,
        halving: contact.halving,
        laws: vec![contact.friction.law("contact.friction")?],
        ..ContactColumns::default()
    };
    for (index, desc) in scene.collider.iter().enumerate() {
        let law = match &desc.friction {
            Some(friction) => {
                columns.laws.push(friction.law("collider.friction")?);
                columns.laws.len() as u32 - 1
            }
            None => 0,
        };
        collider::add(&mut columns.colliders, desc, index as u32, law, built.origin, resources)?;
    }
    let (cloth, colliders) = (built.particles.positions.len(), columns.colliders.anchors.len());
    columns.firsts = built.cloths.iter().map(|range| range.vertices.start).chain([cloth as u32]).collect();
    columns.material = built.material.iter().map(|&x| vec3(x.into())).collect();
    columns.inverse_masses.clone_from(&built.particles.inverse_masses);
    columns.inverse_masses.resize(cloth + colliders, 0.0);
    columns.held = vec![0; cloth + colliders];
    built.pins.view().write_held(&mut columns.held);
    columns.radii = vec![0.0; cloth];
    columns.law_of = vec![0; cloth];
    for body in &columns.colliders.bodies {
        columns.radii.extend(body.range().map(|_| body.radius));
        columns.law_of.extend(body.range().map(|_| body.law));
    }
    let passive = columns.colliders.triangles.iter().map(|t| t.map(|v| cloth as u32 + v));
    let triangles: Vec<_> = built.triangles.iter().copied().chain(passive).collect();
    columns.surface = SurfaceColumns::build(cloth + colliders, &triangles, &built.sewn());
    columns.surface.first_passive = built.triangles.len() as u32;
    columns.surface.own_contact = contact.own;
    Ok(Some(columns))
}

#[cfg(feature = "serde")]
fn yes() -> bool {
    true
}

/// Coefficients of friction by name.
#[cfg(feature = "serde")]
#[derive(serde::Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
struct Coefficients {
    /// Static coefficient: contacts stick up to it.
    #[serde(rename = "static")]
    at_rest: f64,
    /// Kinetic coefficient: of contacts that slide.
    kinetic: f64,
    /// Sliding speed at which the excess of the static over the kinetic coefficient has decayed to 1/e, m/s. Absent:
    /// every contact that slides has the kinetic coefficient.
    stribeck: Option<f64>,
    /// Growth of the coefficient with the sliding speed, s/m.
    #[serde(default)]
    viscous: f64,
}

/// Friction as a scene gives it.
#[cfg(feature = "schema")]
#[derive(schemars::JsonSchema)]
#[schemars(untagged)]
#[expect(dead_code, reason = "it describes the forms that the reader below accepts")]
enum Given {
    /// The same static and kinetic coefficient.
    Both(f64),
    /// Several coefficients.
    Each(Coefficients),
}

#[cfg(feature = "serde")]
impl<'de> serde::Deserialize<'de> for FrictionDesc {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Visitor;

        impl<'de> serde::de::Visitor<'de> for Visitor {
            type Value = FrictionDesc;

            fn expecting(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
                f.write_str("a number, or { static = .., kinetic = .. }")
            }

            fn visit_f64<E: serde::de::Error>(self, mu: f64) -> Result<FrictionDesc, E> {
                Ok(FrictionDesc::both(mu))
            }

            fn visit_i64<E: serde::de::Error>(self, mu: i64) -> Result<FrictionDesc, E> {
                Ok(FrictionDesc::both(mu as f64))
            }

            fn visit_map<A: serde::de::MapAccess<'de>>(self, map: A) -> Result<FrictionDesc, A::Error> {
                let c: Coefficients =
                    serde::Deserialize::deserialize(serde::de::value::MapAccessDeserializer::new(map))?;
                let Coefficients { at_rest, kinetic, stribeck, viscous } = c;
                Ok(FrictionDesc { at_rest, kinetic, stribeck, viscous })
            }
        }

        deserializer.deserialize_any(Visitor)
    }
}

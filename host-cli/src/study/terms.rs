//! The terms of a scene, and how to run the scene without each of them, with a simpler one, or with an additional
//! one.

use muslin_core::scene::{BendModel, ClothDesc, ContactDesc, FrictionDesc, SceneDesc, StretchModel};
use serde::Serialize;
use toml::Value;

use crate::args::Precision;

use super::bending_spring;

/// The action on a term.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum VariantKind {
    /// The term is switched off.
    Off,
    /// The term is replaced by a simpler one.
    Simpler,
    /// The term is added: the scene does not model it.
    Added,
}

/// A key of the scene and its new value; `None` removes the key.
pub type Edit = (String, Option<Value>);

/// A term of the model and the action on it.
#[derive(Clone, Debug)]
pub struct Term {
    /// Name in rows.
    pub name: &'static str,
    /// The action on the term.
    pub kind: VariantKind,
    /// The term as the subject of a sentence.
    pub subject: String,
    /// The changed scene, in words after a comma: "without bending".
    pub run: String,
    /// Larger terms that include this one: switching them off switches it off too.
    pub part_of: &'static [&'static str],
    /// Changes of the scene.
    pub edits: Vec<Edit>,
    /// Precision of the run.
    pub precision: Precision,
}

impl Term {
    fn new(name: &'static str, kind: VariantKind, run: String, edits: Vec<Edit>) -> Self {
        let (part_of, precision): (&[_], _) = (&[], Precision::F32);
        Self { name, kind, subject: name.into(), run, part_of, edits, precision }
    }

    fn off(name: &'static str, edits: Vec<Edit>) -> Self {
        Self::new(name, VariantKind::Off, format!("without {name}"), edits)
    }

    fn simpler(name: &'static str, than: &str, edits: Vec<Edit>) -> Self {
        let term = Self::new(name, VariantKind::Simpler, format!("with {than}"), edits);
        Self { subject: format!("{name} instead of {than}"), ..term }
    }

    /// Marks the term as a part of larger terms.
    fn within(self, part_of: &'static [&'static str]) -> Self {
        Self { part_of, ..self }
    }

    /// Switches several terms off at once. None of them may be a part of another.
    pub fn together<'a>(terms: impl Iterator<Item = &'a Self>) -> Self {
        let edits = terms.flat_map(|term| term.edits.iter().cloned()).collect();
        let term = Self::new("all of these", VariantKind::Off, "without them all".into(), edits);
        Self { subject: "the sum of these".into(), ..term }
    }
}

/// Every term that the scene models, in the order of the scene, followed by terms that could be added. `mean_edges`
/// are the mean edge lengths of the cloths, m.
pub fn of(scene: &SceneDesc, mean_edges: &[f64]) -> Vec<Term> {
    let contact = scene.contact.as_ref();
    let terms = [
        membrane(scene),
        shear(scene),
        hinges(scene, mean_edges),
        bending(scene),
        damping(scene),
        drag(scene),
        wind(scene),
        contact.and_then(self_collision),
        contact.and_then(continuous),
        contact.and_then(|contact| friction(scene, contact)),
        contact.map(|_| whole_contact(scene)),
        newton(scene),
        Some(double_precision()),
    ];
    terms.into_iter().flatten().collect()
}

fn removed(key: &str) -> Edit {
    (key.into(), None)
}

/// One edit for each cloth for which `value` returns a value.
fn in_cloths(scene: &SceneDesc, key: &str, value: impl Fn(usize, &ClothDesc) -> Option<Value>) -> Vec<Edit> {
    let cloths = scene.cloth.iter().enumerate();
    cloths.filter_map(|(index, cloth)| Some((format!("cloth.{index}.{key}"), Some(value(index, cloth)?)))).collect()
}

/// Replaces the membranes by springs of the same Young's modulus. Springs resist shear themselves, so the shear
/// term is removed with the membrane.
fn membrane(scene: &SceneDesc) -> Option<Term> {
    let mut edits = in_cloths(scene, "stretch.model", |_, cloth| {
        let stretch = cloth.stretch.as_ref().filter(|stretch| stretch.model == StretchModel::Membrane);
        stretch.map(|_| Value::String("spring".into()))
    });
    let modelled = !edits.is_empty();
    edits.extend(["cloth.stretch.weft", "cloth.shear"].map(removed));
    modelled.then(|| {
        let shear = if scene.cloth.iter().any(|cloth| cloth.shear.is_some()) { " with its shear" } else { "" };
        let term = Term::simpler("membrane", "springs", edits);
        Term { subject: format!("the membrane{shear} instead of springs"), ..term }
    })
}

fn shear(scene: &SceneDesc) -> Option<Term> {
    let modelled = scene.cloth.iter().any(|cloth| cloth.shear.is_some());
    modelled.then(|| Term::off("shear", vec![removed("cloth.shear")]).within(&["membrane"]))
}

/// Replaces hinges by bending springs of comparable stiffness; each cloth's stiffness follows from its own mean
/// edge.
fn hinges(scene: &SceneDesc, mean_edges: &[f64]) -> Option<Term> {
    let hinged = |cloth: &ClothDesc| cloth.bend.clone().filter(|bend| bend.model == BendModel::Hinge);
    let mut edits = in_cloths(scene, "bend.stiffness", |index, cloth| {
        Some(Value::Float(bending_spring::stiffness(hinged(cloth)?.rigidity?, *mean_edges.get(index)?)))
    });
    edits.extend(in_cloths(scene, "bend.model", |_, cloth| hinged(cloth).map(|_| Value::String("spring".into()))));
    let modelled = !edits.is_empty();
    edits.push(removed("cloth.bend.rigidity"));
    modelled.then(|| Term::simpler("hinge bending", "bending springs", edits).within(&["bending"]))
}

fn bending(scene: &SceneDesc) -> Option<Term> {
    let modelled = scene.cloth.iter().any(|cloth| cloth.bend.is_some());
    modelled.then(|| Term::off("bending", vec![removed("cloth.bend")]))
}

/// Switches off the damping of the cloth; seams keep their damping.
fn damping(scene: &SceneDesc) -> Option<Term> {
    let damped = |cloth: &ClothDesc| {
        let stretch = cloth.stretch.as_ref().map(|stretch| stretch.damping);
        let shear = cloth.shear.as_ref().map(|shear| shear.damping);
        let bend = cloth.bend.as_ref().map(|bend| bend.damping);
        [stretch, shear, bend].into_iter().flatten().any(|damping| damping > 0.0)
    };
    let edits = ["cloth.stretch.damping", "cloth.shear.damping", "cloth.bend.damping"].map(removed);
    scene.cloth.iter().any(damped).then(|| Term::off("damping", edits.into()))
}

fn drag(scene: &SceneDesc) -> Option<Term> {
    let modelled = scene.drag.as_ref().is_some_and(|drag| drag.linear > 0.0);
    modelled.then(|| Term::off("drag", vec![removed("drag.linear")]))
}

fn wind(scene: &SceneDesc) -> Option<Term> {
    let modelled = scene.drag.as_ref().is_some_and(|drag| drag.wind.is_some());
    modelled.then(|| Term::off("wind", vec![removed("drag.wind")]))
}

fn self_collision(contact: &ContactDesc) -> Option<Term> {
    let edits = vec![("contact.self".into(), Some(Value::Boolean(false)))];
    contact.own.then(|| Term::off("self-collision", edits).within(&["contact"]))
}

fn continuous(contact: &ContactDesc) -> Option<Term> {
    let edits = vec![("contact.continuous".into(), Some(Value::Boolean(false)))];
    contact.continuous.then(|| Term::off("continuous testing", edits).within(&["contact"]))
}

/// Switches off all friction, including the friction of the colliders.
fn friction(scene: &SceneDesc, contact: &ContactDesc) -> Option<Term> {
    let own = scene.collider.iter().filter_map(|collider| collider.friction);
    let acts = |f: FrictionDesc| f.at_rest.max(f.kinetic).max(f.viscous) > 0.0;
    let edits = vec![("contact.friction".into(), Some(Value::Float(0.0))), removed("collider.friction")];
    own.chain([contact.friction]).any(acts).then(|| Term::off("friction", edits).within(&["contact"]))
}

/// Switches off contact and removes all colliders: the core does not accept colliders without contact.
fn whole_contact(scene: &SceneDesc) -> Term {
    let term = Term::off("contact", ["contact", "collider"].map(removed).into());
    let with = if scene.collider.is_empty() { "" } else { ", with all colliders," };
    Term { subject: format!("{}{with}", term.subject), ..term }
}

/// The name of the term of Newton's method.
pub const NEWTON: &str = "Newton's method";

/// Number of iterations in which a step usually converges.
pub const CONVERGED: u32 = 20;

fn newton(scene: &SceneDesc) -> Option<Term> {
    let iterations = |n: u32| vec![("integrator.newton".into(), Some(Value::Integer(n.into())))];
    let name = NEWTON;
    scene.integrator.method.is_implicit().then(|| match scene.integrator.newton {
        1 => Term::new(name, VariantKind::Added, format!("with {name}"), iterations(CONVERGED)),
        _ => Term::simpler(name, "one Newton iteration", iterations(1)),
    })
}

fn double_precision() -> Term {
    let term = Term::new("double precision", VariantKind::Added, "in double precision".into(), Vec::new());
    Term { precision: Precision::F64, ..term }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bending_springs_are_those_of_each_cloths_own_edges() {
        let cloth = "[[cloth]]\ngrid = { size = [0.3, 0.3], cells = [4, 4] }\ndensity = 0.2\n\
                     bend = { model = \"hinge\", rigidity = 1e-5 }\n";
        let scene =
            toml::from_str(&format!("name = \"two\"\nduration = 1.0\n{cloth}{cloth}[integrator]\nstep = 0.01\n"));
        let springs = hinges(&scene.unwrap(), &[0.01, 0.03]).unwrap();
        let stiffness = |index: usize| {
            let key = format!("cloth.{index}.bend.stiffness");
            let edit = springs.edits.iter().find(|(edited, _)| *edited == key);
            edit.and_then(|(_, value)| value.as_ref()?.as_float()).unwrap()
        };
        // The stiffness falls as the inverse square of the edge.
        assert!((stiffness(0) / stiffness(1) - 9.0).abs() < 1e-12);
    }
}

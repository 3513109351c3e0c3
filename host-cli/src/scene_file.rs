//! A scene from a file or from the built-in table, with overrides and the mesh files it names.

use std::path::{Path, PathBuf};

use muslin_core::mesh::TriMesh;
use muslin_core::scene::{BUILT_IN, SceneDesc};
use toml::{Table, Value};

use crate::failure::Failure;
use crate::mesh_io;

/// A scene ready to be built.
pub struct SceneFile {
    /// The description.
    pub desc: SceneDesc,
    /// The same as TOML, overrides included.
    pub text: String,
    /// Mesh files by the names that the scene gives them.
    pub resources: Vec<(String, TriMesh)>,
}

/// Loads `scene`, a path or a built-in name, with `key=value` overrides.
///
/// Errors are of usage: they name the line of the file or the override.
pub fn load(scene: &str, overrides: &[String]) -> Result<SceneFile, Failure> {
    let (label, text, directory) = read(scene)?;
    let in_file = |error: toml::de::Error| Failure::Usage(format!("{label}: {}", explain(&error)));
    let table: Table = toml::from_str(&text).map_err(in_file)?;
    for key in ["contact", "collider"] {
        if table.contains_key(key) {
            let message = format!("{label}: [{key}] is not modelled by this version; remove it to run without contact");
            return Err(Failure::Usage(message));
        }
    }
    // From the text, because only it knows lines and columns.
    let mut desc: SceneDesc = toml::from_str(&text).map_err(in_file)?;
    let mut text = text;
    if !overrides.is_empty() {
        (desc, text) = apply(table, overrides)?;
    }
    let resources = load_resources(&desc, &directory)?;
    Ok(SceneFile { desc, text, resources })
}

/// Label for messages, text, and the directory that names in the scene are relative to.
fn read(scene: &str) -> Result<(String, String, PathBuf), Failure> {
    let path = Path::new(scene);
    if let Some((name, text)) = BUILT_IN.iter().find(|(name, _)| *name == scene).filter(|_| !path.is_file()) {
        return Ok((format!("built-in scene {name}"), (*text).into(), PathBuf::from(".")));
    }
    match std::fs::read_to_string(path) {
        Ok(text) => Ok((scene.into(), text, path.parent().unwrap_or(Path::new(".")).into())),
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => {
            let names = BUILT_IN.iter().map(|(name, _)| *name);
            let hint = match nearest(scene, names.clone()) {
                Some(name) => format!("did you mean the built-in scene {name}?"),
                None => format!("built-in scenes are {}", names.collect::<Vec<_>>().join(", ")),
            };
            Err(Failure::Usage(format!("there is no file {scene}; {hint}")))
        }
        Err(error) => Err(Failure::Usage(format!("cannot read {scene}: {error}"))),
    }
}

/// Applies overrides one by one, so that an error names the one that made it.
fn apply(mut table: Table, overrides: &[String]) -> Result<(SceneDesc, String), Failure> {
    let mut desc = None;
    for text in overrides {
        let failed = |why: &str| Failure::Usage(format!("--set {text}: {why}"));
        let (key, value) = text.split_once('=').ok_or_else(|| failed("must be KEY=VALUE"))?;
        let path: Vec<&str> = key.trim().split('.').collect();
        set(&mut Value::Table(std::mem::take(&mut table)), &path, &parse_value(value.trim()))
            .and_then(|value| match value {
                Value::Table(changed) => Ok(changed),
                _ => Err("the scene is no table".into()),
            })
            .map(|changed| table = changed)
            .map_err(|why| failed(&why))?;
        let parsed: SceneDesc = table.clone().try_into().map_err(|error| failed(&explain(&error)))?;
        desc = Some(parsed);
    }
    let text = toml::to_string(&table).map_err(|error| Failure::Usage(error.to_string()))?;
    let desc = desc.ok_or_else(|| Failure::Usage("no override was given".into()))?;
    Ok((desc, text))
}

/// A TOML value; what is none is a string, so that `integrator.method=rk4` needs no quotes.
fn parse_value(text: &str) -> Value {
    toml::from_str::<Table>(&format!("value = {text}"))
        .ok()
        .and_then(|mut table| table.remove("value"))
        .unwrap_or_else(|| Value::String(text.into()))
}

/// `value` with the key at `path` set. An array of tables takes an index, or the key in each.
fn set(value: &mut Value, path: &[&str], new: &Value) -> Result<Value, String> {
    let Some((first, rest)) = path.split_first() else { return Ok(new.clone()) };
    match value {
        Value::Table(table) => {
            let mut inner = table.remove(*first).unwrap_or_else(|| Value::Table(Table::new()));
            let changed = set(&mut inner, rest, new)?;
            table.insert((*first).into(), changed);
        }
        Value::Array(items) => match first.parse::<usize>() {
            Ok(index) => {
                let count = items.len();
                let item = items.get_mut(index).ok_or_else(|| format!("there is no {first}, only {count}"))?;
                *item = set(item, rest, new)?;
            }
            Err(_) => {
                for item in items {
                    *item = set(item, path, new)?;
                }
            }
        },
        _ => return Err(format!("{first} is inside a value that is no section")),
    }
    Ok(value.clone())
}

/// The parser's message, with the nearest known key where one is unknown.
fn explain(error: &toml::de::Error) -> String {
    let message = error.message();
    let quoted: Vec<&str> = message.split('`').skip(1).step_by(2).collect();
    let hint = match quoted.split_first() {
        Some((unknown, known)) if message.starts_with("unknown") => nearest(unknown, known.iter().copied()),
        _ => None,
    };
    let text = error.to_string();
    match hint {
        Some(known) => format!("{}\ndid you mean `{known}`?", text.trim_end()),
        None => text.trim_end().into(),
    }
}

/// The most similar of some names, where it is similar at all.
fn nearest<'a>(name: &str, known: impl Iterator<Item = &'a str>) -> Option<&'a str> {
    known
        .map(|candidate| (strsim::jaro_winkler(name, candidate), candidate))
        .filter(|(similarity, _)| *similarity > 0.75)
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, candidate)| candidate)
}

fn load_resources(desc: &SceneDesc, directory: &Path) -> Result<Vec<(String, TriMesh)>, Failure> {
    let of_cloth = desc.cloth.iter().flat_map(|cloth| {
        let seams = cloth.seam.iter().filter_map(|seam| seam.file.as_ref());
        cloth.mesh.iter().chain(&cloth.state).chain(seams)
    });
    let mut names: Vec<&String> = of_cloth.collect();
    names.sort_unstable();
    names.dedup();
    let load = |name: &String| {
        let mesh = mesh_io::load(&directory.join(name)).map_err(|error| Failure::Usage(error.to_string()))?;
        Ok((name.clone(), mesh))
    };
    names.into_iter().map(load).collect()
}

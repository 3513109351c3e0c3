//! Loads a scene from a file or from the built-in table, with overrides and the files that it names.

mod change;
mod comments;
mod hint;
mod keys;

pub use change::Change;

use std::io;
use std::path::{Component, Path, PathBuf};
use std::sync::Arc;

use muslin_core::scene::{BUILT_IN, ColliderMotionDesc, Content, Resource, SceneDesc};
use toml::{Table, Value};

use crate::args::SceneArguments;
use crate::failure::Failure;
use crate::limits;
use crate::mesh_io;

/// The key of a scene's name. The name is optional: its default is the file name.
const NAME: &str = "name";

/// A scene ready to be built.
#[derive(Clone)]
pub struct SceneFile {
    /// The description.
    pub desc: SceneDesc,
    /// The scene as TOML, overrides included.
    pub text: String,
    /// Contents of the files, by the names that the scene gives them.
    pub resources: Arc<[Resource]>,
}

impl SceneFile {
    /// The same scene with new values for some keys, such as `integrator.step`; `None` removes a key.
    pub fn changed<Key: AsRef<str>>(&self, changes: &[(Key, Option<Value>)]) -> Result<Self, Failure> {
        self.edited(|scene| {
            changes.iter().try_for_each(|(key, value)| {
                let path: Vec<_> = key.as_ref().split('.').collect();
                match value {
                    Some(value) => change::set(scene, &path, value),
                    None => {
                        change::remove(scene, &path);
                        Ok(())
                    }
                }
            })
        })
    }

    /// The same scene with the numbers at some keys multiplied by `factor`; missing keys are ignored.
    pub fn scaled(&self, keys: &[&str], factor: f64) -> Result<Self, Failure> {
        self.edited(|scene| {
            keys.iter().for_each(|key| change::scale(scene, &key.split('.').collect::<Vec<_>>(), factor));
            Ok(())
        })
    }

    fn edited(&self, edit: impl FnOnce(&mut Value) -> Result<(), String>) -> Result<Self, Failure> {
        let failed = |why: String| Failure::Tool(format!("{}: {why}", self.desc.name));
        let mut scene: Value = toml::from_str(&self.text).map_err(|error| failed(explain(&error)))?;
        edit(&mut scene).map_err(failed)?;
        let desc: SceneDesc = scene.clone().try_into().map_err(|error| failed(explain(&error)))?;
        let text = toml::to_string(&scene).map_err(|error| failed(error.to_string()))?;
        Ok(Self { desc: SceneDesc { name: self.desc.name.clone(), ..desc }, text, resources: self.resources.clone() })
    }
}

/// The output folder: the folder that the arguments name, or a folder in `out` named after the scene.
pub fn folder(arguments: &SceneArguments, scene: &SceneFile) -> Result<PathBuf, Failure> {
    // A scene file gives the folder its own name: a copy of a built-in scene must not overwrite the results of
    // the original.
    let file = Path::new(&arguments.scene);
    let stem = file.file_stem().filter(|_| file.is_file());
    let name = stem.map_or(Path::new(&scene.desc.name), Path::new);
    match (&arguments.out, name.components().collect::<Vec<_>>().as_slice()) {
        (Some(out), _) => Ok(out.into()),
        (None, [Component::Normal(_)]) => Ok(Path::new("out").join(name)),
        _ => Err(Failure::Usage(format!("the scene's name {name:?} cannot be the name of a folder; give --out DIR"))),
    }
}

/// Loads the scene that the command line names, with its overrides.
pub fn asked(arguments: &SceneArguments) -> Result<SceneFile, Failure> {
    let duration = arguments.duration.map(|duration| format!("duration={duration:?}"));
    let overrides: Vec<_> = arguments.set.iter().cloned().chain(duration).collect();
    load(&arguments.scene, &overrides)
}

/// Loads `scene`, a path or a built-in name, with `key=value` overrides.
///
/// Errors are usage errors: they name the line of the file or the override.
pub fn load(scene: &str, overrides: &[String]) -> Result<SceneFile, Failure> {
    let source = Source::read(scene, Path::new(""))?;
    let changes = overrides.iter().map(|text| Change::parse(text)).collect::<Result<Vec<_>, _>>()?;
    source.with(&changes)
}

/// The text of the scene `given`, a path or a built-in name, with the values of `scene`, which was made from it.
/// Unchanged values keep their places and their comments.
pub fn commented(given: &str, scene: &SceneFile) -> Result<String, Failure> {
    let wanted = toml::from_str(&scene.text).map_err(|error| Failure::Tool(explain(&error)))?;
    let given = Source::read(given, Path::new(""))?;
    comments::with_values(&given.text, &wanted).map_err(|why| Failure::Tool(format!("{}: {why}", given.label)))
}

/// A scene as its file has it, before any change.
#[derive(Clone)]
pub struct Source {
    label: String,
    desc: SceneDesc,
    text: String,
    table: Table,
    directory: PathBuf,
}

impl Source {
    /// Reads `scene`, a path relative to `directory` or a built-in name.
    pub fn read(scene: &str, directory: &Path) -> Result<Self, Failure> {
        let (label, text, directory) = read(scene, directory)?;
        let in_file = |error| Failure::Usage(format!("{label}: {}", explain(&error)));
        let table: Table = toml::from_str(&text).map_err(in_file)?;
        // Parsed from the text, not from the table, so that errors have lines and columns.
        let mut desc: SceneDesc = toml::from_str(&text).map_err(in_file)?;
        if !table.contains_key(NAME) {
            desc.name = Path::new(scene).file_stem().unwrap_or_default().to_string_lossy().into();
        }
        Ok(Self { label, desc, text, table, directory })
    }

    /// The description with these changes, and its text. The files that it names are not read.
    pub fn describe(&self, changes: &[Change]) -> Result<(SceneDesc, String), Failure> {
        match changes {
            [] => Ok((self.desc.clone(), self.text.clone())),
            _ => {
                let (mut desc, text) = change::apply(self.table.clone(), changes)?;
                if changes.iter().all(|change| change.key != NAME) {
                    desc.name.clone_from(&self.desc.name);
                }
                Ok((desc, text))
            }
        }
    }

    /// The scene with these changes, and the contents of the files that it names.
    pub fn with(&self, changes: &[Change]) -> Result<SceneFile, Failure> {
        let (desc, text) = self.describe(changes)?;
        let resources =
            load_resources(&desc, &self.directory).map_err(|why| Failure::Usage(format!("{}: {why}", self.label)))?;
        Ok(SceneFile { desc, text, resources: resources.into() })
    }
}

/// A scene from generated text that names no files.
pub fn from_text(label: &str, text: String) -> Result<SceneFile, Failure> {
    let failed = |error: toml::de::Error| Failure::Tool(format!("{label}: {}", explain(&error)));
    let desc: SceneDesc = toml::from_str(&text).map_err(failed)?;
    Ok(SceneFile { desc, text, resources: Arc::default() })
}

/// Reads a scene: label for messages, text, and the directory to which file names in it are relative.
fn read(scene: &str, directory: &Path) -> Result<(String, String, PathBuf), Failure> {
    let path = directory.join(scene);
    if let Some((name, text)) = BUILT_IN.iter().find(|(name, _)| *name == scene).filter(|_| !path.is_file()) {
        return Ok((format!("built-in scene {name}"), (*text).into(), PathBuf::from(".")));
    }
    let label = path.display().to_string();
    match limits::read_text(&path) {
        Ok(text) => Ok((label, text, path.parent().unwrap_or(Path::new(".")).into())),
        Err(error) if error.kind() == io::ErrorKind::NotFound => {
            let names = BUILT_IN.iter().map(|(name, _)| *name);
            let hint = match hint::nearest(scene, names.clone()) {
                Some(name) => format!("did you mean the built-in scene {name}?"),
                None => format!("built-in scenes are {}", names.collect::<Vec<_>>().join(", ")),
            };
            Err(Failure::Usage(format!("there is no file {label}; {hint}")))
        }
        Err(error) => Err(Failure::Usage(format!("cannot read {label}: {error}"))),
    }
}

/// The parser's message, with the most similar known key if it is about an unknown key.
pub fn explain(error: &toml::de::Error) -> String {
    let message = error.message();
    // The names of Rust types mean nothing to the author of a scene.
    let text = error.to_string().replace(", expected f64", ", expected a number");
    let text = match text.split_once("expected struct ") {
        Some((before, after)) => {
            let rest = after.trim_start_matches(|letter: char| letter.is_alphanumeric());
            format!("{before}expected a section of keys{rest}")
        }
        None => text,
    };
    if message.contains("expected a sequence") && message.contains("map") {
        return format!(
            "{}\nwrite [[cloth]] and [[cloth.pin]], in double brackets: a scene may have several",
            text.trim_end()
        );
    }
    if message.starts_with("invalid mantissa") || message.starts_with("invalid fraction") {
        return format!("{}\nwrite digits on both sides of the point, as in 0.3", text.trim_end());
    }
    match hint::known(message) {
        Some(known) => format!("{}\ndid you mean `{known}`?", text.trim_end()),
        None => text.trim_end().into(),
    }
}

/// Loads the files that a scene names; names are relative to `directory`.
fn load_resources(desc: &SceneDesc, directory: &Path) -> Result<Vec<Resource>, String> {
    let of_cloth = desc.cloth.iter().flat_map(|cloth| {
        let seams = cloth.seam.iter().filter_map(|seam| seam.file.as_ref());
        cloth.mesh.iter().chain(&cloth.state).chain(seams)
    });
    let of_colliders = desc.collider.iter().filter_map(|collider| collider.file.as_ref());
    let caches = desc.collider.iter().filter_map(|collider| match &collider.motion {
        Some(ColliderMotionDesc::Cache(name)) => Some(name),
        _ => None,
    });
    let meshes = load_each(of_cloth.chain(of_colliders), |name| {
        mesh_io::load(&directory.join(name)).map(Content::Mesh).map_err(|error| error.to_string())
    })?;
    let caches = load_each(caches, |name| {
        mesh_io::pc2::load(&directory.join(name)).map(Content::Cache).map_err(|error| error.to_string())
    })?;
    Ok(meshes.into_iter().chain(caches).collect())
}

/// Loads each name once.
fn load_each<'a>(
    names: impl Iterator<Item = &'a String>,
    load: impl Fn(&str) -> Result<Content, String>,
) -> Result<Vec<Resource>, String> {
    let mut names: Vec<_> = names.collect();
    names.sort_unstable();
    names.dedup();
    names.into_iter().map(|name| Ok((name.clone(), load(name)?))).collect()
}

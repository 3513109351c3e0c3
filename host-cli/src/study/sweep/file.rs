//! The file of a sweep: a scene, changes for all runs, and a grid of changes that differ between runs.

use std::collections::BTreeMap;
use std::path::Path;

use serde::Deserialize;
use toml::de::{DeTable, DeValue};
use toml::{Table, Value};

use crate::args::Precision;
use crate::failure::Failure;
use crate::limits;
use crate::scene_file::{self, Change, Source};

/// The contents of the file.
#[derive(Clone)]
pub struct Sweep {
    /// Name of the file in messages.
    pub label: String,
    /// The scene that is changed.
    pub scene: Source,
    /// Precisions in which each combination is run.
    pub precisions: Vec<Precision>,
    /// Changes that all runs make.
    pub set: Vec<Change>,
    /// The values of each key that differs between runs, in the order of the file.
    pub grid: Vec<Vec<Change>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Desc {
    scene: String,
    duration: Option<f64>,
    #[serde(default)]
    precision: Precisions,
    #[serde(default)]
    set: Table,
    #[serde(default)]
    grid: Table,
}

#[derive(Deserialize)]
#[serde(untagged, expecting = "precision must be \"f32\", \"f64\" or a list of them")]
enum Precisions {
    One(Precision),
    Several(Vec<Precision>),
}

impl Default for Precisions {
    fn default() -> Self {
        Self::One(Precision::F32)
    }
}

/// A key of a section, and the position of its value in bytes from the start of the file.
struct Entry {
    key: String,
    value: Value,
    place: usize,
}

/// Name and text of the file, for messages with a line number.
struct Text {
    label: String,
    text: String,
}

impl Text {
    fn failed(&self, why: &str) -> Failure {
        Failure::Usage(format!("{}: {why}", self.label))
    }

    fn line(&self, entry: &Entry) -> String {
        let line = self.text[..entry.place].matches('\n').count() + 1;
        format!("line {line}: {}", entry.key)
    }

    fn change(&self, entry: &Entry, value: &Value) -> Change {
        let asked = format!("{}: {} = {value}", self.label, self.line(entry));
        Change { asked, key: entry.key.clone(), value: value.clone() }
    }

    /// The changes for the values of one key of the grid.
    fn axis(&self, entry: &Entry) -> Result<Vec<Change>, Failure> {
        let values = values(entry).map_err(|why| self.failed(&format!("{} {why}", self.line(entry))))?;
        Ok(values.iter().map(|value| self.change(entry, value)).collect())
    }
}

impl Sweep {
    /// Reads a sweep and its scene. Errors are usage errors and name the line.
    pub fn read(path: &Path) -> Result<Self, Failure> {
        let label = path.display().to_string();
        let text = limits::read_text(path);
        let text = text.map_err(|error| Failure::Usage(format!("cannot read {label}: {error}")))?;
        Self::parse(label, text, path.parent().unwrap_or(Path::new("")))
    }

    /// Reads a sweep and its scene from a text. Scenes that it names lie in `directory`.
    pub fn parse(label: String, text: String, directory: &Path) -> Result<Self, Failure> {
        let file = Text { label, text };
        let explained = |error| file.failed(&scene_file::explain(&error));
        let desc: Desc = toml::from_str(&file.text).map_err(explained)?;
        let mut places = BTreeMap::new();
        find_places(DeTable::parse(&file.text).map_err(explained)?.get_ref(), "", &mut places);

        let mut set = entries(desc.set, "set", &places);
        set.extend(desc.duration.map(|seconds| Entry {
            key: "duration".into(),
            value: Value::Float(seconds),
            place: places.get("duration").copied().unwrap_or(0),
        }));
        let grid = entries(desc.grid, "grid", &places);
        if let Some(again) = given_twice(set.iter().chain(&grid)) {
            return Err(file.failed(&format!("{} is given twice", file.line(again))));
        }
        Ok(Self {
            scene: Source::read(&desc.scene, directory)?,
            precisions: precisions(desc.precision).map_err(|why| file.failed(&why))?,
            set: set.iter().map(|entry| file.change(entry, &entry.value)).collect(),
            grid: grid.iter().map(|entry| file.axis(entry)).collect::<Result<_, _>>()?,
            label: file.label,
        })
    }
}

/// Finds the positions of the values by their keys, in whichever form the keys are written.
fn find_places(section: &DeTable<'_>, prefix: &str, places: &mut BTreeMap<String, usize>) {
    for (key, value) in section {
        let key = format!("{prefix}{}", key.get_ref());
        match value.get_ref() {
            DeValue::Table(inner) if !inner.is_empty() => find_places(inner, &format!("{key}."), places),
            _ => drop(places.insert(key, value.span().start)),
        }
    }
}

/// The keys and values of a section in the order in which they are written: `"cloth.density" = 0.2`,
/// `cloth.density = 0.2` and a section `[set.cloth]` mean the same.
fn entries(section: Table, name: &str, places: &BTreeMap<String, usize>) -> Vec<Entry> {
    let mut entries = Vec::new();
    flatten(section, "", &mut entries);
    for entry in &mut entries {
        entry.place = places.get(&format!("{name}.{}", entry.key)).copied().unwrap_or(0);
    }
    entries.sort_by_key(|entry| entry.place);
    entries
}

fn flatten(section: Table, prefix: &str, entries: &mut Vec<Entry>) {
    for (key, value) in section {
        let key = format!("{prefix}{key}");
        match value {
            Value::Table(inner) if !inner.is_empty() => flatten(inner, &format!("{key}."), entries),
            value => entries.push(Entry { key, value, place: 0 }),
        }
    }
}

fn given_twice<'a>(entries: impl Iterator<Item = &'a Entry>) -> Option<&'a Entry> {
    let mut keys = Vec::new();
    entries.into_iter().find(|entry| {
        let again = keys.contains(&&entry.key);
        keys.push(&entry.key);
        again
    })
}

/// The values of a key of the grid.
fn values(entry: &Entry) -> Result<&[Value], String> {
    let Value::Array(values) = &entry.value else {
        return Err("must be a list of the values to run, such as [0.01, 0.005]".into());
    };
    match values.iter().enumerate().find(|(place, value)| values[..*place].contains(value)) {
        _ if values.is_empty() => Err("lists no value, so there is nothing to run".into()),
        Some((_, again)) => Err(format!("lists {again} twice")),
        None => Ok(values),
    }
}

fn precisions(asked: Precisions) -> Result<Vec<Precision>, String> {
    match asked {
        Precisions::One(one) => Ok(vec![one]),
        Precisions::Several(list) if matches!(list.as_slice(), [_]) => Ok(list),
        Precisions::Several(list) if matches!(list.as_slice(), [a, b] if a != b) => Ok(list),
        Precisions::Several(_) => Err("precision must name one or both of \"f32\" and \"f64\", each once".into()),
    }
}

//! Overrides: new values for the keys of a scene.

use muslin_core::scene::SceneDesc;
use toml::{Table, Value};

use crate::failure::Failure;

use super::{explain, keys};

/// A new value for a key of a scene.
#[derive(Clone, Debug)]
pub struct Change {
    /// Origin of the change, as messages name it.
    pub asked: String,
    /// The key with its sections, such as `integrator.step`.
    pub key: String,
    /// The new value.
    pub value: Value,
}

impl Change {
    /// Parses `key=value`.
    pub fn parse(text: &str) -> Result<Self, Failure> {
        let asked = format!("--set {text}");
        match text.split_once('=').map(|(key, value)| (key.trim(), value)) {
            Some((key, value)) if key.split('.').all(|part| !part.is_empty()) => {
                Ok(Self { asked, key: key.into(), value: parse_value(value.trim()) })
            }
            _ => Err(Failure::Usage(format!("{asked}: must be KEY=VALUE, such as integrator.step=0.001"))),
        }
    }
}

/// Applies overrides one by one, so that an error names the override that caused it. Only the final result must
/// be a valid scene: a new section may need several overrides.
pub fn apply(table: Table, changes: &[Change]) -> Result<(SceneDesc, String), Failure> {
    let mut scene = Value::Table(table);
    let mut first_failure = None;
    for change in changes {
        let failed = |why: String| Failure::Usage(format!("{}: {why}", change.asked));
        set(&mut scene, &change.key.split('.').collect::<Vec<_>>(), &change.value).map_err(failed)?;
        if let Err(error) = scene.clone().try_into::<SceneDesc>() {
            let why = || no_list(change, &error).or_else(|| elsewhere(change, &error));
            first_failure.get_or_insert_with(|| failed(why().unwrap_or_else(|| explain(&error))));
        }
    }
    let desc = scene.clone().try_into();
    let desc = desc.map_err(|error| first_failure.unwrap_or_else(|| Failure::Usage(explain(&error))))?;
    let text = toml::to_string(&scene).map_err(|error| Failure::Usage(error.to_string()))?;
    Ok((desc, text))
}

/// The message for a key of a list that the scene lacks; `None` if the error is another one.
fn no_list(change: &Change, error: &toml::de::Error) -> Option<String> {
    let text = error.to_string();
    let (_, place) = text.split_once("invalid type: map, expected a sequence\nin `")?;
    let list = place.split('`').next()?;
    let sections = change.key.split('.').filter(|part| part.parse::<usize>().is_err()).collect::<Vec<_>>().join(".");
    let key = sections.strip_prefix(list)?.strip_prefix('.')?;
    let (owner, name) = list.rsplit_once('.').map_or(("the scene", list), |(_, name)| ("a cloth of the scene", name));
    let value = &change.value;
    Some(format!("{owner} has no {name}; a new one needs all its keys: {list}=[{{ {key} = {value}, .. }}]"))
}

/// The message for a key that stands in another section; `None` if the error is not about the key, or no key of a scene
/// ends like it.
fn elsewhere(change: &Change, error: &toml::de::Error) -> Option<String> {
    let unknown = error.message().strip_prefix("unknown field `")?.split('`').next()?;
    let last = change.key.split('.').find(|part| *part == unknown).and(change.key.rsplit('.').next())?;
    let known = keys::all();
    let ending = |end: &str| known.iter().filter(|key| key.ends_with(&format!(".{end}"))).cloned().collect::<Vec<_>>();
    let keys = [&change.key, last].map(ending).into_iter().find(|keys| !keys.is_empty())?;
    Some(format!("there is no key {}; did you mean {}?", change.key, keys.join(" or ")))
}

/// Parses a TOML value, or a number without digits on one side of the point. Any other text becomes a string, so that
/// `integrator.method=rk4` needs no quotes.
fn parse_value(text: &str) -> Value {
    let value = toml::from_str::<Table>(&format!("value = {text}")).ok().and_then(|mut table| table.remove("value"));
    let number = || text.parse().ok().filter(|_| text.contains('.')).map(Value::Float);
    value.or_else(number).unwrap_or_else(|| Value::String(text.into()))
}

/// Sets the key at `path` inside `value`. In an array the next part of the path is an index; if it is not, the
/// key is set in each item.
pub fn set(value: &mut Value, path: &[&str], new: &Value) -> Result<(), String> {
    let Some((first, rest)) = path.split_first() else {
        *value = new.clone();
        return Ok(());
    };
    match value {
        Value::Table(table) => set(table.entry(*first).or_insert_with(|| Value::Table(Table::new())), rest, new),
        Value::Array(items) => match (first.parse::<usize>(), items.len()) {
            (_, 0) => Err(format!("the array is empty, so no entry can have {first}")),
            (Ok(index), count) => match items.get_mut(index) {
                Some(item) => set(item, rest, new),
                None => Err(format!("there is no index {index}; indices go from 0 to {}", count - 1)),
            },
            (Err(_), _) => items.iter_mut().try_for_each(|item| set(item, path, new)),
        },
        _ => Err(format!("{first} is inside a value that is not a section")),
    }
}

/// Multiplies the number at `path` inside `value`, in each item of an array. A missing key stays missing.
pub fn scale(value: &mut Value, path: &[&str], factor: f64) {
    match (value, path) {
        (Value::Array(items), _) => items.iter_mut().for_each(|item| scale(item, path, factor)),
        (Value::Table(table), [first, rest @ ..]) => {
            if let Some(inner) = table.get_mut(*first) {
                scale(inner, rest, factor);
            }
        }
        (Value::Float(number), []) => *number *= factor,
        (value @ Value::Integer(_), []) => {
            *value = Value::Float(factor * value.as_integer().unwrap_or_default() as f64);
        }
        _ => {}
    }
}

/// Removes the key at `path` inside `value`, if it exists; in each item of an array.
pub fn remove(value: &mut Value, path: &[&str]) {
    match (value, path) {
        (Value::Table(table), [key]) => drop(table.remove(*key)),
        (Value::Table(table), [first, rest @ ..]) => table.get_mut(*first).into_iter().for_each(|v| remove(v, rest)),
        (Value::Array(items), _) => items.iter_mut().for_each(|item| remove(item, path)),
        _ => {}
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_need_no_digits_before_or_behind_the_point() {
        for (text, number) in [(".3", 0.3), ("-.3", -0.3), ("2.", 2.0), ("0.3", 0.3), ("1e-3", 1e-3)] {
            assert_eq!(parse_value(text), Value::Float(number), "{text}");
        }
        for text in ["rk4", "cloth.obj", ".", "inf."] {
            assert_eq!(parse_value(text), Value::String(text.into()), "{text}");
        }
    }
}

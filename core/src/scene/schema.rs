//! The [JSON Schema](https://json-schema.org) of scenes, made from the types that read them and from their docstrings.

use alloc::vec::Vec;

use schemars::Schema;
use schemars::generate::SchemaSettings;
use schemars::transform::RecursiveTransform;

use super::SceneDesc;

/// The schema of a scene, for editors that complete and check scene files, and for types in other languages.
pub fn schema() -> Schema {
    let settings = SchemaSettings::draft2020_12().with_transform(RecursiveTransform(without_null));
    settings.into_generator().into_root_schema_for::<SceneDesc>()
}

/// A key that is absent is left out, because TOML has no null.
fn without_null(schema: &mut Schema) {
    let Some(object) = schema.as_object_mut() else { return };
    object.retain(|key, value| key != "default" || !value.is_null());
    if let Some(types) = object.get_mut("type")
        && let Some([only, _null]) = types.as_array().map(Vec::as_slice)
    {
        *types = only.clone();
    }
    let choices = object.get("anyOf").and_then(|choices| choices.as_array());
    if let Some([only, other]) = choices.map(Vec::as_slice)
        && other.get("type").is_some_and(|name| name == "null")
        && let Some(only) = only.as_object().cloned()
    {
        object.remove("anyOf");
        object.extend(only);
    }
}

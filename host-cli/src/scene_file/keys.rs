//! The keys of a scene, as its parser knows them: the error about an unknown key lists the keys of its section.

use muslin_core::scene::SceneDesc;
use toml::{Table, Value};

/// All keys with their sections, such as `integrator.step`, without indices.
pub fn all() -> Vec<String> {
    let mut keys = Vec::new();
    add_keys("", &|section| section, &mut keys);
    keys
}

/// Adds the keys of a section, and of the sections in it. `scene` wraps the section into a scene.
fn add_keys(section: &str, scene: &dyn Fn(Value) -> Value, keys: &mut Vec<String>) {
    for is_list in [false, true] {
        let scene = |section: Value| scene(if is_list { Value::Array(vec![section]) } else { section });
        // No key has an empty name.
        let Err(error) = scene(of_one_key("", true.into())).try_into::<SceneDesc>() else { continue };
        let Some(expected) = error.message().strip_prefix("unknown field ``, expected ") else { continue };
        for name in expected.split('`').skip(1).step_by(2) {
            let key = if section.is_empty() { name.into() } else { format!("{section}.{name}") };
            add_keys(&key, &|value| scene(of_one_key(name, value)), keys);
            keys.push(key);
        }
        return;
    }
}

fn of_one_key(name: &str, value: Value) -> Value {
    Value::Table(Table::from_iter([(name.into(), value)]))
}

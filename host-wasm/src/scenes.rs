//! The built-in scenes.

use muslin_core::scene::BUILT_IN;
use wasm_bindgen::prelude::wasm_bindgen;

/// The names of the built-in scenes.
#[wasm_bindgen(js_name = sceneNames)]
pub fn scene_names() -> Vec<String> {
    BUILT_IN.iter().map(|(name, _)| (*name).to_owned()).collect()
}

/// The text of a built-in scene, in TOML.
#[wasm_bindgen(js_name = sceneText)]
pub fn scene_text(name: &str) -> Option<String> {
    BUILT_IN.iter().find(|(known, _)| *known == name).map(|(_, text)| (*text).to_owned())
}

/// The built-in scenes: name and scene file, one table for command line, web page, tests and
/// benches.
pub const BUILT_IN: &[(&str, &str)] = &[
    ("cantilever", include_str!("../../scenes/cantilever.toml")),
    ("curtain", include_str!("../../scenes/curtain.toml")),
    ("flag", include_str!("../../scenes/flag.toml")),
    ("hanging", include_str!("../../scenes/hanging.toml")),
    ("skirt", include_str!("../../scenes/skirt.toml")),
    ("swing", include_str!("../../scenes/swing.toml")),
];

/// The built-in scenes: name and text of the scene file. The command line, the web page, the tests
/// and the benches share this table.
pub const BUILT_IN: &[(&str, &str)] = &[
    ("ball", include_str!("../../scenes/ball.toml")),
    ("cantilever", include_str!("../../scenes/cantilever.toml")),
    ("curtain", include_str!("../../scenes/curtain.toml")),
    ("flag", include_str!("../../scenes/flag.toml")),
    ("fold", include_str!("../../scenes/fold.toml")),
    ("funnel", include_str!("../../scenes/funnel.toml")),
    ("hanging", include_str!("../../scenes/hanging.toml")),
    ("poncho", include_str!("../../scenes/poncho.toml")),
    ("skirt", include_str!("../../scenes/skirt.toml")),
    ("stack", include_str!("../../scenes/stack.toml")),
    ("swing", include_str!("../../scenes/swing.toml")),
    ("tablecloth", include_str!("../../scenes/tablecloth.toml")),
    ("twist", include_str!("../../scenes/twist.toml")),
];

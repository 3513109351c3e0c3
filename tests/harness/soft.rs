//! Soft cloth, without an integrator.

/// A soft, damped sheet that is held at two corners: its motion is smooth.
pub const SOFT: &str = r#"
    name = "soft"
    duration = 0.4
    frame_rate = 60
    gravity = [0.0, -9.81, 0.0]
    drag = { linear = 0.1 }
    [[cloth]]
    grid = { size = [0.4, 0.35], cells = [4, 4] }
    density = 0.2
    stretch = { model = "membrane", stiffness = 5.0, damping = 0.01 }
    shear = { stiffness = 2.0 }
    bend = { model = "hinge", rigidity = 1e-4 }
    pin = [{ select = { corners = [0, 1] } }]
"#;

/// A sheet of 0.2 kg/m^2, so soft that the modes that grow under explicit Euler do not amplify the rounding errors.
/// `scene` and `cloth` are further keys.
pub fn sheet(scene: &str, cloth: &str) -> String {
    format!(
        r#"
        duration = 1.0
        {scene}
        [[cloth]]
        grid = {{ size = [0.4, 0.35], cells = [4, 4] }}
        density = 0.2
        stretch = {{ model = "membrane", stiffness = 0.1 }}
        shear = {{ stiffness = 0.05 }}
        {cloth}"#
    )
}

/// A free sheet of 1 m and 500 N/m that falls for 2.5 s, without an integrator.
pub const FALLING: &str = r#"
    name = "falling"
    duration = 2.5
    frame_rate = 30
    gravity = [0.0, -9.81, 0.0]
    [[cloth]]
    grid = { size = [1.0, 1.0], cells = [16, 16] }
    density = 0.2
    stretch = { model = "membrane", stiffness = 500.0 }
    shear = { stiffness = 100.0 }
    bend = { model = "hinge", rigidity = 1e-5 }
"#;

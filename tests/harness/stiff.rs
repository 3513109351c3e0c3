//! Stiff cloth, without an integrator.

/// A sheet of 4 cm in the air.
pub const STIFF: &str = r#"
    name = "stiff"
    duration = 0.1
    gravity = [0.0, -9.81, 0.0]
    [[cloth]]
    grid = { size = [0.04, 0.04], cells = [6, 6] }
    rotation = [30.0, 20.0, 10.0]
    density = 0.2
    stretch = { model = "membrane", stiffness = 1e5 }
    shear = { stiffness = 3e4 }
    bend = { model = "hinge", rigidity = 1e-3 }
"#;

/// A sheet that swings from one edge.
pub const SWINGING: &str = r#"
    name = "swinging"
    duration = 1.0
    gravity = [0.0, -9.81, 0.0]
    [[cloth]]
    grid = { size = [0.5, 0.5], cells = [12, 12] }
    density = 0.2
    stretch = { model = "membrane", stiffness = 2000.0 }
    shear = { stiffness = 500.0 }
    bend = { model = "hinge", rigidity = 2e-5 }
    pin = [{ select = { edge = "left" } }]
"#;

//! Physically possible scenes from seeds: coarse, short, of every size, material, step, method and place.

use harness::rng::Rng;

const METHODS: [&str; 7] =
    ["explicit-euler", "symplectic-euler", "midpoint", "rk4", "backward-euler", "implicit-midpoint", "bdf2"];

/// Directions and strengths of gravity, m/s^2.
const GRAVITIES: [[f64; 3]; 6] =
    [[0.0; 3], [0.0, -1.62, 0.0], [0.0, -9.81, 0.0], [0.0, -9.81, 0.0], [0.0, -25.0, 0.0], [7.0, -5.0, -4.0]];

/// A scene.
pub struct Scene {
    /// Its file.
    pub text: String,
    /// Size of the cloth, m.
    pub size: f64,
    /// Number of steps.
    pub steps: u32,
    /// Length of a step, s.
    step: f64,
}

impl Scene {
    /// The scene with steps of half the length, and a quarter of their largest error.
    pub fn halved(&self) -> Self {
        let halve = |line: &str| match line.split_once(" = ") {
            Some(("step", _)) => format!("step = {:?}", 0.5 * self.step),
            Some(("error", error)) => format!("error = {:?}", 0.25 * error.parse::<f64>().expect("a number")),
            _ => line.to_owned(),
        };
        let lines: Vec<_> = self.text.lines().map(halve).collect();
        Self { text: lines.join("\n"), size: self.size, steps: 2 * self.steps, step: 0.5 * self.step }
    }
}

/// The material of a sheet.
struct Sheet {
    size: f64,
    cells: [u32; 2],
    density: f64,
    stiffness: f64,
    /// Shortest edge, m.
    edge: f64,
}

impl Sheet {
    /// Longest stable step of explicit methods, roughly, s.
    fn limit(&self) -> f64 {
        0.7 * self.edge * (self.density / self.stiffness).sqrt()
    }
}

/// The scene of a seed.
pub fn scene(seed: u64) -> Scene {
    let rng = &mut Rng::new(seed.wrapping_mul(0x2545_f491_4f6c_dd1d));
    let (gravity, method) = (rng.pick(&GRAVITIES), rng.pick(&METHODS));
    let wind = wind(rng);
    let pinned =
        rng.pick(&["", "", "corners = [0, 1]", "corners = [0, 1, 2, 3]", "edge = \"back\"", "edge = \"left\""]);
    let sheet = sheet(rng, gravity, &wind, pinned);
    let (steps, per_frame) = (rng.pick(&[1, 2, 3, 6, 10, 30]), rng.pick(&[1, 2, 5, 6]));
    let is_calm = METHODS[4..].contains(&method) || sheet.limit() > 2e-6;
    let has_contact = rng.pick(&[false, false, true]) && is_calm;
    let (step, integrator) = integrator(rng, method, &sheet, has_contact);
    let position = match rng.pick(&[false, true]) {
        true => rng.direction() * rng.magnitude(1.0, 1e6),
        false => rng.direction() * sheet.size,
    };
    let rotation = match has_contact {
        true => [0.0, 0.0, rng.pick(&[0.0, 0.0, 20.0])],
        false => [rng.pick(&[0.0, 0.0, 90.0, 37.0]), 0.0, rng.pick(&[0.0, 0.0, 90.0, -65.0])],
    };
    let contact = match has_contact {
        true => contact(rng, &sheet, position.y, [position.x, position.z], rotation[2]),
        false => String::new(),
    };
    let duration = f64::from(steps * per_frame) * step;
    let text = format!(
        "duration = {duration:?}\nframe_rate = {:?}\n{}\n[[cloth]]\ngrid = {{ size = {:?}, cells = {:?}, pattern = {:?} }}\n\
         position = {:?}\nrotation = {rotation:?}\ndensity = {:?}\n{}{}{}{wind}{contact}{integrator}",
        1.0 / (f64::from(per_frame) * step),
        if gravity == [0.0; 3] { String::new() } else { format!("gravity = {gravity:?}") },
        [sheet.size, sheet.edge * f64::from(sheet.cells[1])],
        sheet.cells,
        rng.pick(&["equilateral", "diagonal", "alternating"]),
        position.to_array(),
        sheet.density,
        driven(rng, &sheet, duration),
        material(rng, &sheet, step),
        pins(rng, &sheet, pinned, duration),
        wind = wind.text,
    );
    Scene { text, size: sheet.size, steps: steps * per_frame, step }
}

/// The air.
struct Wind {
    text: String,
    /// Largest pressure on cloth at rest, N/m^2.
    pressure: f64,
}

fn wind(rng: &mut Rng) -> Wind {
    if rng.pick(&[true, true, false]) {
        return Wind { text: String::new(), pressure: 0.0 };
    }
    let (speed, normal) = (rng.magnitude(0.1, 20.0), rng.magnitude(0.01, 1.0));
    let velocity = (rng.direction() * speed).to_array();
    let text =
        format!("[drag]\nwind = {{ velocity = {velocity:?}, normal = {normal:?}, tangential = {:?} }}\n", 0.1 * normal);
    Wind { text, pressure: normal * speed }
}

/// A sheet that its load stretches by some per cent at most: four corners bear fifty times the load of the middle.
fn sheet(rng: &mut Rng, gravity: [f64; 3], wind: &Wind, pinned: &str) -> Sheet {
    let (size, density) = (rng.magnitude(1e-3, 100.0), rng.magnitude(0.01, 10.0));
    let cells = [4 + (rng.bits() % 7) as u32, 4 + (rng.bits() % 7) as u32];
    let load = density * gravity.iter().map(|x| x * x).sum::<f64>().sqrt() + wind.pressure;
    let least = load * size * if pinned.starts_with("corners") { 50.0 } else { 5.0 };
    let stiffness = rng.magnitude(least.clamp(1.0, 5e6), 1e7);
    Sheet { size, cells, density, stiffness, edge: size / f64::from(cells[0]) }
}

/// Length of a step, s, and the section. Steps of explicit methods are mostly near their limit of stability. With
/// contact, explicit steps are at most as long, and implicit ones at most thirty times as long: cloth that explodes
/// takes minutes.
fn integrator(rng: &mut Rng, method: &str, sheet: &Sheet, has_contact: bool) -> (f64, String) {
    let is_implicit = METHODS[4..].contains(&method);
    let limit = sheet.limit();
    let step = match (is_implicit, rng.pick(&[false, true])) {
        (true, true) => rng.magnitude(1e-3, 0.1),
        (false, true) => limit * rng.magnitude(0.02, 2.0),
        (_, false) => rng.magnitude(1e-6, 0.1),
    };
    let longest = match (has_contact, is_implicit) {
        (true, true) => 20.0 * limit,
        (true, false) => limit,
        (false, _) => 0.1,
    };
    let step = step.min(longest).clamp(1e-6, 0.1);
    let error = match is_implicit && rng.pick(&[false, true]) {
        true => sheet.size * rng.magnitude(1e-5, 1e-2),
        false => 0.0,
    };
    let newton = if is_implicit { rng.pick(&[1, 1, 10]) } else { 1 };
    (step, format!("[integrator]\nmethod = {method:?}\nstep = {step:?}\nerror = {error:?}\nnewton = {newton}\n"))
}

fn material(rng: &mut Rng, sheet: &Sheet, step: f64) -> String {
    let &Sheet { stiffness: k, edge, .. } = sheet;
    let mut damping = || rng.pick(&[0.0, step]) * rng.magnitude(1e-3, 0.3);
    let (stretch, bend) = (damping(), damping());
    let mut text = match rng.pick(&[true, false]) {
        true => format!(
            "stretch = {{ model = \"membrane\", stiffness = {k:?}, damping = {stretch:?} }}\nshear = {{ stiffness = {:?} }}\n",
            k * rng.magnitude(0.01, 0.5)
        ),
        false => format!("stretch = {{ model = \"spring\", stiffness = {k:?}, damping = {stretch:?} }}\n"),
    };
    text += &match rng.pick(&["none", "hinge", "spring"]) {
        "hinge" => {
            let rigidity = k * edge * edge * rng.magnitude(1e-7, 1e-2);
            format!("bend = {{ model = \"hinge\", rigidity = {rigidity:?}, damping = {bend:?} }}\n")
        }
        "spring" => {
            let stiffness = k * rng.magnitude(1e-5, 0.1);
            format!("bend = {{ model = \"spring\", stiffness = {stiffness:?}, damping = {bend:?} }}\n")
        }
        _ => String::new(),
    };
    text
}

/// A spin, start velocities, a load or a mass that strain the cloth by some per cent at most. A load moves it by its
/// size at most.
fn driven(rng: &mut Rng, sheet: &Sheet, duration: f64) -> String {
    let &Sheet { size, density, stiffness: k, .. } = sheet;
    let wave = (k / density).sqrt();
    let axis = rng.direction().to_array();
    let along = |amount: f64| axis.map(|x| x * amount);
    match rng.pick(&["", "", "", "spin", "velocity", "part", "load", "mass"]) {
        "spin" => {
            let rate = wave / size * rng.magnitude(1e-4, 0.1);
            format!("spin = {{ axis = {axis:?}, rate = {rate:?} }}\n")
        }
        "velocity" => format!("velocity = {:?}\n", along(wave * rng.magnitude(1e-4, 0.02))),
        "part" => {
            let velocity = along(wave * rng.magnitude(1e-4, 0.02));
            format!("start = [{{ select = {{ edge = \"right\" }}, velocity = {velocity:?} }}]\n")
        }
        "load" => {
            let least = density * size * size * size / (duration * duration);
            let force = along(least.min(0.02 * k * size) * rng.magnitude(1e-4, 1.0));
            let share = rng.pick(&["length", "vertex"]);
            format!("load = [{{ select = {{ edge = \"right\" }}, force = {force:?}, share = {share:?} }}]\n")
        }
        "mass" => {
            let mass = density * size * size * rng.magnitude(1e-3, 10.0);
            format!("mass = [{{ select = {{ edge = \"front\" }}, mass = {mass:?}, share = \"length\" }}]\n")
        }
        _ => String::new(),
    }
}

/// Pins at rest, or so slow that the wave which they send out strains the cloth by some per cent at most.
fn pins(rng: &mut Rng, sheet: &Sheet, select: &str, duration: f64) -> String {
    if select.is_empty() {
        return String::new();
    }
    let wave = (sheet.stiffness / sheet.density).sqrt();
    let way = (duration * wave * rng.magnitude(1e-4, 0.05)).min(sheet.size);
    let [x, y, z] = (rng.direction() * way).to_array();
    let motion = match rng.pick(&[false, true]) {
        true => format!("motion = {{ keys = [[0.0, 0.0, 0.0, 0.0], [{duration:?}, {x:?}, {y:?}, {z:?}]] }}\n"),
        false => String::new(),
    };
    format!("[[cloth.pin]]\nselect = {{ {select} }}\n{motion}")
}

/// Contact with a sphere or a plane below the lowest corner, or of the cloth with itself alone.
fn contact(rng: &mut Rng, sheet: &Sheet, height: f64, [x, z]: [f64; 2], tilt: f64) -> String {
    let thickness = sheet.edge * rng.magnitude(0.03, 0.3);
    let top =
        height - 0.5 * sheet.size * tilt.to_radians().sin() - 1.5 * thickness - sheet.size * rng.magnitude(1e-5, 0.1);
    let radius = sheet.size * rng.magnitude(0.2, 1.0);
    let collider = match rng.pick(&["sphere", "plane", "none"]) {
        "sphere" => {
            format!("[[collider]]\nshape = \"sphere\"\ncenter = {:?}\nradius = {radius:?}\n", [x, top - radius, z])
        }
        "plane" => format!("[[collider]]\nshape = \"plane\"\npoint = {:?}\nnormal = [0.0, 1.0, 0.0]\n", [x, top, z]),
        _ => String::new(),
    };
    let own = collider.is_empty() || rng.pick(&[false, true]);
    let friction = rng.pick(&[0.0, 0.3]);
    format!("[contact]\nthickness = {thickness:?}\nfriction = {friction:?}\nself = {own}\n{collider}")
}

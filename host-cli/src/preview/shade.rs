//! Colours of fabric, solids and floor in the light. All colours are linear RGB until they are encoded.

use glam::Vec3;

use super::view::View;

const FRONT: Vec3 = Vec3::new(0.60, 0.135, 0.075);
const BACK: Vec3 = Vec3::new(0.085, 0.23, 0.28);
const SOLID: Vec3 = Vec3::new(0.27, 0.28, 0.295);
const KEY: Vec3 = Vec3::new(1.05, 0.98, 0.88);
const FILL: Vec3 = Vec3::new(0.16, 0.19, 0.24);
const SKY: Vec3 = Vec3::new(0.36, 0.40, 0.46);
const GROUND: Vec3 = Vec3::new(0.15, 0.13, 0.12);
/// Towards the fill light, from the right.
const TOWARDS_FILL: Vec3 = Vec3::new(0.88, 0.18, 0.44);

const TOP: Vec3 = Vec3::new(0.83, 0.84, 0.85);
const BOTTOM: Vec3 = Vec3::new(0.62, 0.63, 0.65);
/// Colour of pinned vertices.
pub const PIN: Vec3 = Vec3::new(0.012, 0.014, 0.02);
/// Colour of the bar that shows the time.
pub const BAR: Vec3 = Vec3::new(0.16, 0.20, 0.24);

/// Kind of a visible surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Face {
    /// The front of the cloth.
    Front,
    /// The back of the cloth.
    Back,
    /// A collider.
    Solid,
}

/// A piece of a surface as the camera sees it.
pub struct Surface {
    /// Towards the camera, of length 1.
    pub to_eye: Vec3,
    /// Normal on the visible side, of length 1.
    pub normal: Vec3,
    /// Kind of the surface.
    pub side: Face,
    /// Fraction of the key light that reaches the surface, 0 to 1.
    pub lit: f32,
}

/// Colour of a surface in the light of a sky, a key light and a fill light. Fabric also has a soft highlight, a
/// sheen at the rim and a little transmitted light.
pub fn surface(view: &View, surface: &Surface) -> Vec3 {
    let Surface { to_eye, normal, side, lit } = *surface;
    let to_key = view.light.direction;
    let towards_key = normal.dot(to_key);
    let through = if side == Face::Solid { 0.0 } else { 0.22 * (-towards_key).max(0.0) };
    let key = KEY * lit * (towards_key.max(0.0) + through);
    let fill = FILL * normal.dot(TOWARDS_FILL).max(0.0);
    let ambient = GROUND.lerp(SKY, 0.5 + 0.5 * normal.y);
    let highlight = 0.10 * lit * normal.dot((to_key + to_eye).normalize_or_zero()).max(0.0).powi(28);
    let sheen = 0.22 * (1.0 - normal.dot(to_eye).clamp(0.0, 1.0)).powi(4);
    match side {
        Face::Front => FRONT * (key + fill + ambient) + KEY * highlight + SKY * sheen,
        Face::Back => BACK * (key + fill + ambient) + KEY * highlight + SKY * sheen,
        Face::Solid => SOLID * (key + fill + ambient),
    }
}

/// Wall and floor in one: a gradient down the picture (`down` from 0 to 1), darkened on the floor by a faint
/// grid and the shadow, both of which fade away from the cloth.
pub fn backdrop(view: &View, [x, y]: [f32; 2], down: f32, lit: impl Fn(Vec3) -> f32) -> Vec3 {
    let plain = TOP.lerp(BOTTOM, down);
    let Some((point, [floor, _])) = floor_point(view, x, y).zip(view.floor) else { return plain };
    let away = (point - floor).length() / view.extent;
    let near = (1.0 - away / 1.5).clamp(0.0, 1.0);
    let near = near * near * (3.0 - 2.0 * near);
    plain * (1.0 - near * (0.45 * (1.0 - lit(point)) + 0.12 * grid(view, point, [x, y])))
}

fn floor_point(view: &View, x: f32, y: f32) -> Option<Vec3> {
    let [floor, up] = view.floor?;
    let (eye, ray) = (view.camera.eye, view.camera.ray(x, y));
    let (height, sinking) = (up.dot(eye - floor), -up.dot(ray));
    (sinking > 1e-4 && height > 0.0).then(|| eye + ray * (height / sinking))
}

/// Fraction of a pixel of the floor that grid lines cover, 0 to 1.
fn grid(view: &View, point: Vec3, [x, y]: [f32; 2]) -> f32 {
    let spacing = round_length(view.extent / 7.0);
    let beside = [floor_point(view, x + 1.0, y), floor_point(view, x, y + 1.0)];
    let line = |along: fn(Vec3) -> f32| {
        let width: f32 = beside.iter().flatten().map(|&p| (along(p) - along(point)).abs()).sum();
        let off = along(point) / spacing;
        let off = (off - off.round()).abs() * spacing;
        (1.2 - off / width.max(1e-12)).clamp(0.0, 1.0)
    };
    line(|p| p.x).max(line(|p| p.z))
}

/// The largest number that is not above `length` and is 1, 2 or 5 times a power of ten.
fn round_length(length: f32) -> f32 {
    let power = 10_f32.powf(length.log10().floor());
    [5.0, 2.0].into_iter().find(|digit| digit * power <= length).unwrap_or(1.0) * power
}

/// Encodes a colour as sRGB with 8 bits per channel.
pub fn encode(linear: Vec3) -> [u8; 3] {
    linear.to_array().map(|x| {
        let x = x.clamp(0.0, 1.0);
        let encoded = if x <= 0.003_130_8 { 12.92 * x } else { 1.055 * x.powf(1.0 / 2.4) - 0.055 };
        (encoded * 255.0).round() as u8
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_are_round() {
        for (length, round) in [(1.0, 1.0), (1.9, 1.0), (4.9, 2.0), (0.07, 0.05), (730.0, 500.0)] {
            assert!((round_length(length) / round - 1.0).abs() < 1e-5, "{length}");
        }
    }

    #[test]
    fn encodes_srgb() {
        assert_eq!(encode(Vec3::new(0.0, 0.216, 1.5)), [0, 128, 255]);
        assert_eq!(encode(Vec3::NAN), [0, 0, 0]);
    }
}

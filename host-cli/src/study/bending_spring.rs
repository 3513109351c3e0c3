//! Stiffness of a bending spring that replaces a hinge, on two equilateral triangles with a common edge of length
//! l.
//!
//! Hinge: E = 1/2 ke angle^2 with ke = D l^2 / (A1 + A2) = 2 D / sqrt(3). Spring between the opposite vertices,
//! which are sqrt(3) l apart when flat: E = 1/2 k (sqrt(3) l (1 - cos(angle / 2)))^2. For small angles the energy
//! of the hinge grows as the square of the angle, the energy of the spring as its fourth power: they agree at one
//! angle only.

/// Angle at which both store the same energy, radians: 30 degrees, a visible fold. At smaller angles the springs
/// are softer, as the square of the angle; at larger angles they are stiffer.
const AGREE_AT: f64 = core::f64::consts::FRAC_PI_6;

/// Stiffness of the spring, N/m, that replaces hinges of rigidity D, N m, on a mesh with the mean edge l, m.
pub fn stiffness(rigidity: f64, mean_edge: f64) -> f64 {
    let shortened = 3f64.sqrt() * mean_edge * (1.0 - (AGREE_AT / 2.0).cos());
    2.0 / 3f64.sqrt() * rigidity * (AGREE_AT / shortened).powi(2)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Builds two triangles, bends them in space and measures the distance of their opposite vertices.
    #[test]
    fn it_stores_the_hinges_energy_at_that_angle() {
        let (rigidity, edge) = (3e-5, 0.02_f64);
        let height = edge * 60f64.to_radians().sin();
        let span = |angle: f64| {
            let (sine, cosine) = angle.sin_cos();
            let [far, other] = [[height, 0.0], [-height * cosine, height * sine]];
            (far[0] - other[0]).hypot(far[1] - other[1])
        };
        let area = 0.5 * edge * height;
        let ratio = |angle: f64| {
            let hinge = 0.5 * rigidity * edge * edge / (2.0 * area) * angle * angle;
            0.5 * stiffness(rigidity, edge) * (span(0.0) - span(angle)).powi(2) / hinge
        };
        assert!((ratio(AGREE_AT) - 1.0).abs() < 1e-12, "{}", ratio(AGREE_AT));
        // At a tenth of the angle the spring stores a hundredth of the hinge's energy. The next term of the cosine
        // changes this by 1.2 %.
        let less = ratio(AGREE_AT / 10.0);
        assert!((less / 0.01 - 1.0).abs() < 0.013, "{less}");
    }
}

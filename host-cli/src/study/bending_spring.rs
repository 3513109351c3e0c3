//! A bending spring beside a hinge, on two equilateral triangles of edge l over a common edge.
//!
//! Hinge: E = 1/2 ke angle^2 with ke = D l^2 / (A1 + A2) = 2 D / sqrt(3). Spring between the far
//! vertices, sqrt(3) l apart when flat: E = 1/2 k (sqrt(3) l (1 - cos(angle / 2)))^2. The first grows
//! by the square of a small angle, the second by its fourth power: they agree at one angle only.

/// Where both store the same energy, radians: 30 degrees, a visible fold. Flatter, the springs
/// are softer, as the square of the angle; sharper, they are stiffer.
const AGREE_AT: f64 = core::f64::consts::FRAC_PI_6;

/// N/m, of a spring that stands for hinges of a rigidity D, N m, on a mesh of a mean edge l, m.
pub fn stiffness(rigidity: f64, mean_edge: f64) -> f64 {
    let shortened = 3f64.sqrt() * mean_edge * (1.0 - (AGREE_AT / 2.0).cos());
    2.0 / 3f64.sqrt() * rigidity * (AGREE_AT / shortened).powi(2)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two triangles built and bent in space, their far vertices measured.
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
        // A tenth of the angle: a hundredth of the energy, and 1.2 % of that by the cosine's next term.
        let less = ratio(AGREE_AT / 10.0);
        assert!((less / 0.01 - 1.0).abs() < 0.013, "{less}");
    }
}

//! A crumpled sheet of any size, folded so densely that several layers lie close together everywhere.
//!
//! Its profile is a meander whose direction varies with the arc length s as `SWING sin(2 pi s / WAVE)`, with
//! loops that nearly touch [Langbein 1966, sine-generated curves]. Along the other side of the sheet the meander
//! shifts and bends. The bench measures the sheet and the tests check it: they share this file.

use std::f64::consts::TAU;

use glam::DVec3;

/// Amplitude of the meander's direction, radians: at 2.2 its loops touch.
const SWING: f64 = 2.15;

/// Arc length of one period of the meander, in edge lengths.
const WAVE: f64 = 36.0;

/// Largest random displacement of a vertex along each axis, in edge lengths.
const NOISE: f64 = 0.15;

/// A triangle mesh.
#[derive(Clone, Debug)]
pub struct Mesh {
    /// Positions, in edge lengths.
    pub positions: Vec<DVec3>,
    /// Vertices of each triangle.
    pub triangles: Vec<[u32; 3]>,
}

/// A square sheet of `cells` x `cells` cells of two triangles each, with edges of about length 1.
pub fn sheet(cells: usize) -> Mesh {
    let (noise, side) = (&mut Noise(7), cells + 1);
    let profile = meander(side + 2 * WAVE as usize);
    let mut positions = Vec::with_capacity(side * side);
    for j in 0..side {
        let along = j as f64 / WAVE;
        let shift = WAVE * (0.5 + 0.3 * (TAU * along / 2.7).sin());
        let lift = 4.0 * (TAU * along).sin() + 2.0 * (TAU * along * 2.3).cos();
        for i in 0..side {
            let at = i as f64 + shift;
            let (low, part) = (at as usize, at.fract());
            let [x, y] = [0, 1].map(|k| profile[low][k] * (1.0 - part) + profile[low + 1][k] * part);
            positions.push(DVec3::new(x, y + lift, 0.75 * j as f64) + noise.next());
        }
    }
    Mesh { positions, triangles: triangles(cells) }
}

/// Random numbers that are equal on every machine [Steele 2014, SplitMix64].
struct Noise(u64);

impl Noise {
    /// Uniform in `-NOISE..NOISE` along each axis.
    fn next(&mut self) -> DVec3 {
        DVec3::from_array(std::array::from_fn(|_| {
            self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
            let mut z = self.0;
            z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
            z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
            z ^= z >> 31;
            let unit = (z >> 11) as f64 / (1u64 << 53) as f64;
            -NOISE + 2.0 * NOISE * unit
        }))
    }
}

/// Points along the meander, at distances of 1 along the arc.
fn meander(points: usize) -> Vec<[f64; 2]> {
    const STEPS: usize = 8;
    let mut at = [0.0; 2];
    let walk = (0..STEPS * points).map(|step| {
        let from = at;
        let angle = SWING * (TAU * (step as f64 / STEPS as f64) / WAVE).sin();
        at = [at[0] + angle.cos() / STEPS as f64, at[1] + angle.sin() / STEPS as f64];
        from
    });
    walk.step_by(STEPS).collect()
}

fn triangles(cells: usize) -> Vec<[u32; 3]> {
    let vertex = |i: usize, j: usize| (j * (cells + 1) + i) as u32;
    let mut triangles = Vec::with_capacity(2 * cells * cells);
    for j in 0..cells {
        for i in 0..cells {
            let [a, b, c, d] = [vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1), vertex(i, j + 1)];
            triangles.extend(if (i + j) % 2 == 0 { [[a, b, c], [a, c, d]] } else { [[a, b, d], [b, c, d]] });
        }
    }
    triangles
}

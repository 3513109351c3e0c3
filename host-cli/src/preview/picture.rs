//! Draws one snapshot of the cloth and of the colliders.

use glam::Vec3;

use super::image::Image;
use super::raster;
use super::shade::{self, Face, Surface};
use super::shadow::ShadowMap;
use super::view::View;

/// Samples along each side of a pixel.
const SAMPLES: usize = 2;
/// Texels over which shadows are softened on cloth and floor.
const SOFTNESS: [i32; 2] = [2, 7];
/// Radius of a pin's dot, pixels.
const PIN_RADIUS: f32 = 2.0;
/// A solid's triangle is shaded flat if the cosine between its normal and the normal of a corner is below this.
const CREASED: f32 = 0.8;

/// The cloth and the solids at one instant.
pub struct Things<'a> {
    /// Vertices of the cloth, metres.
    pub cloth: &'a [Vec3],
    /// Triangles of the cloth.
    pub triangles: &'a [[u32; 3]],
    /// Vertices of the solids, metres.
    pub solids: &'a [Vec3],
    /// Triangles of the solids.
    pub others: &'a [[u32; 3]],
}

/// The cloth and the solids, prepared for drawing: first the cloth, then the solids.
struct Scenery<'a> {
    points: Vec<Vec3>,
    normals: Vec<Vec3>,
    /// The cloth's triangles whose corners are all in the followed space, then the triangles of the solids.
    triangles: Vec<[usize; 3]>,
    /// Number of the cloth's triangles.
    fabric: usize,
    shadows: ShadowMap<'a>,
}

/// The surface point that a sample of the picture sees.
#[derive(Clone, Copy)]
struct Hit {
    /// Inverse depth, 1/metres; 0 if the sample sees no surface.
    nearness: f32,
    triangle: usize,
    weights: [f32; 3],
}

/// Draws everything and the pins; `progress`, from 0 to 1, is shown as a bar along the bottom.
pub fn draw(view: &View, things: &Things<'_>, pins: &[u32], progress: f32) -> Image {
    let scenery = Scenery::new(view, things);
    let hits = scenery.hits(view);
    let [width, height] = view.size;
    let pixel = |k: usize| scenery.pixel(view, &hits, k % width, k / width);
    let mut pixels: Vec<Vec3> = (0..width * height).map(pixel).collect();
    for &pin in pins.iter().filter_map(|&pin| things.cloth.get(pin as usize)) {
        draw_pin(view, &hits, pin, &mut pixels);
    }
    draw_bar(view, progress, &mut pixels);
    Image { size: view.size, pixels: pixels.into_iter().map(shade::encode).collect() }
}

impl<'a> Scenery<'a> {
    fn new(view: &'a View, things: &Things<'_>) -> Self {
        let Things { cloth, triangles, solids, others } = *things;
        let points = [cloth, solids].concat();
        let shown = |v: usize| match cloth.get(v) {
            Some(&point) => view.shows(point),
            None => points.get(v).is_some_and(|point| point.is_finite()),
        };
        let whole = |triangle: &[usize; 3]| triangle.iter().all(|&v| shown(v));
        let fabric = triangles.iter().map(|t| t.map(|v| v as usize));
        // A vertex index beyond the cloth must not refer to a vertex of a solid.
        let fabric = fabric.filter(|t| t.iter().all(|&v| v < cloth.len()));
        let mut triangles: Vec<[usize; 3]> = fabric.filter(whole).collect();
        let fabric = triangles.len();
        triangles.extend(others.iter().map(|t| t.map(|v| cloth.len() + v as usize)).filter(whole));
        let shadows = view.light.shadows(triangles.iter().map(|t| t.map(|v| points[v])));
        let normals = normals(&points, &triangles);
        Scenery { points, normals, triangles, fabric, shadows }
    }

    fn corners(&self, triangle: usize) -> [Vec3; 3] {
        self.triangles[triangle].map(|v| self.points[v])
    }

    /// The point of the nearest triangle that each sample sees.
    fn hits(&self, view: &View) -> Vec<Hit> {
        let size = view.size.map(|s| s * SAMPLES);
        let mut hits = vec![Hit { nearness: 0.0, triangle: 0, weights: [0.0; 3] }; size[0] * size[1]];
        let scale = Vec3::new(SAMPLES as f32, SAMPLES as f32, 1.0);
        for triangle in 0..self.triangles.len() {
            let corners = self.corners(triangle).map(|corner| view.camera.project(corner) * scale);
            if corners.iter().any(|corner| corner.z <= 0.0) {
                continue;
            }
            raster::triangle(size, corners, |sample, weights| {
                let weights: [f32; 3] = std::array::from_fn(|k| weights[k] * corners[k].z);
                let nearness: f32 = weights.iter().sum();
                if nearness > hits[sample].nearness {
                    hits[sample] = Hit { nearness, triangle, weights: weights.map(|w| w / nearness) };
                }
            });
        }
        hits
    }

    /// Colour of a pixel: the mean over its samples.
    fn pixel(&self, view: &View, hits: &[Hit], x: usize, y: usize) -> Vec3 {
        let samples = samples(view, x, y).map(|sample| hits[sample]).filter(|hit| hit.nearness > 0.0);
        let (count, seen) = samples.fold((0, Vec3::ZERO), |(n, sum), hit| (n + 1, sum + self.surface(view, hit)));
        let free = (SAMPLES * SAMPLES - count) as f32;
        let behind = if count < SAMPLES * SAMPLES { self.backdrop(view, x, y) } else { Vec3::ZERO };
        (seen + behind * free) / (SAMPLES * SAMPLES) as f32
    }

    fn surface(&self, view: &View, hit: Hit) -> Vec3 {
        let blend = |values: [Vec3; 3]| (0..3).map(|k| values[k] * hit.weights[k]).sum::<Vec3>();
        let corners = self.corners(hit.triangle);
        let point = blend(corners);
        let to_eye = (view.camera.eye - point).normalize_or_zero();
        let flat = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
        let front = flat.dot(to_eye) > 0.0;
        let normals = self.triangles[hit.triangle].map(|v| self.normals[v]);
        let solid = hit.triangle >= self.fabric;
        let creased = solid && normals.iter().any(|normal| normal.dot(flat.normalize_or_zero()) < CREASED);
        let smooth = if creased { flat } else { blend(normals) }.normalize_or_zero();
        let normal = if front { smooth } else { -smooth };

        let side = match (solid, front) {
            (false, true) => Face::Front,
            (false, false) => Face::Back,
            (true, _) => Face::Solid,
        };

        // The point is moved off the surface towards the light, so that the surface does not shade itself.
        let light = &view.light;
        let off = normal * normal.dot(light.direction).signum();
        let lit = self.shadows.lit(point + (off * 3.0 + light.direction) * light.texel, SOFTNESS[0]);
        shade::surface(view, &Surface { to_eye, normal, side, lit })
    }

    fn backdrop(&self, view: &View, x: usize, y: usize) -> Vec3 {
        let down = y as f32 / view.size[1] as f32;
        let centre = [x as f32 + 0.5, y as f32 + 0.5];
        shade::backdrop(view, centre, down, |point| self.shadows.lit(point, SOFTNESS[1]))
    }
}

/// The samples of a pixel.
fn samples(view: &View, x: usize, y: usize) -> impl Iterator<Item = usize> + use<> {
    let row = view.size[0] * SAMPLES;
    (0..SAMPLES * SAMPLES).map(move |k| (y * SAMPLES + k / SAMPLES) * row + x * SAMPLES + k % SAMPLES)
}

/// Normals of the vertices: the mean of their triangles' normals, weighted by area.
fn normals(points: &[Vec3], triangles: &[[usize; 3]]) -> Vec<Vec3> {
    let mut normals = vec![Vec3::ZERO; points.len()];
    for triangle in triangles {
        let [a, b, c] = triangle.map(|v| points[v]);
        let normal = (b - a).cross(c - a);
        triangle.iter().for_each(|&v| normals[v] += normal);
    }
    normals.into_iter().map(Vec3::normalize_or_zero).collect()
}

/// Draws a dot on a pinned vertex, unless something hides it.
fn draw_pin(view: &View, hits: &[Hit], pin: Vec3, pixels: &mut [Vec3]) {
    let place = view.camera.project(pin);
    let inside = (0.0..view.size[0] as f32).contains(&place.x) && (0.0..view.size[1] as f32).contains(&place.y);
    if !view.shows(pin) || !inside || place.z <= 0.0 {
        return;
    }
    let hidden =
        |sample: usize| hits[sample].nearness > 0.0 && 1.0 / place.z - 1.0 / hits[sample].nearness > 0.01 * view.extent;
    if samples(view, place.x as usize, place.y as usize).all(hidden) {
        return;
    }
    let around =
        |x: f32, count: usize| (x - PIN_RADIUS - 1.0).max(0.0) as usize..count.min((x + PIN_RADIUS + 2.0) as usize);
    for y in around(place.y, view.size[1]) {
        for x in around(place.x, view.size[0]) {
            let off = (x as f32 + 0.5 - place.x).hypot(y as f32 + 0.5 - place.y);
            let pixel = &mut pixels[y * view.size[0] + x];
            *pixel = pixel.lerp(shade::PIN, (PIN_RADIUS + 0.5 - off).clamp(0.0, 1.0));
        }
    }
}

/// Draws a bar, three pixels high, that shows the part of the run that has passed.
fn draw_bar(view: &View, progress: f32, pixels: &mut [Vec3]) {
    let [width, height] = view.size;
    let passed = ((width as f32 * progress) as usize).min(width);
    for y in height.saturating_sub(3)..height {
        pixels[y * width..][..passed].iter_mut().for_each(|pixel| *pixel = shade::BAR);
    }
}

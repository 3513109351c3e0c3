//! Exact signs of areas and volumes.
//!
//! A determinant is computed in ordinary arithmetic first. Where its rounding error may decide the sign, all of its
//! products are computed without error, as sums of doubles, and added without error to an expansion [Shewchuk 1997]: a
//! sum of doubles of increasing size that do not overlap. The largest one has the sign of the sum.
//!
//! The signs are exact unless a product under- or overflows: in f32 for all finite coordinates, in f64 for coordinates
//! that are 0 or have sizes from 1e-70 to 1e70.

use crate::column::Column;

/// Three coordinates.
pub(super) type Point = [f64; 3];

/// Twice the area of a projected triangle and six times the volume of a tetrahedron have this many products at most, if
/// each difference of coordinates is a sum of two doubles.
const PRODUCTS: usize = 6 * 2 * 2 * 2;

/// A product of three doubles is a sum of this many.
const PARTS: usize = 4;

/// Sign of the volume of a tetrahedron; 0 if the points are coplanar.
pub(super) fn volume(a: Point, b: Point, c: Point, d: Point) -> i8 {
    match plain_volume([a, b, c], d) {
        0 => exact_volume([a, b, c], d),
        sign => sign,
    }
}

/// Sign of the volume of a triangle and a point in ordinary arithmetic; 0 if the rounding error may decide. The
/// error is at most 8 unit roundoffs times the sum of the magnitudes of the products [Shewchuk 1997]; 32 are
/// allowed.
#[inline]
pub(super) fn plain_volume([a, b, c]: [Point; 3], d: Point) -> i8 {
    let [[ax, ay, az], [bx, by, bz], [cx, cy, cz]] = [a, b, c].map(|p| [p[0] - d[0], p[1] - d[1], p[2] - d[2]]);
    let part = |a: f64, plus: f64, minus: f64| (a * (plus - minus), a.abs() * (plus.abs() + minus.abs()));
    let parts = [part(ax, by * cz, bz * cy), part(ay, bz * cx, bx * cz), part(az, bx * cy, by * cx)];
    let [(x, x_size), (y, y_size), (z, z_size)] = parts;
    let (volume, size) = (x + y + z, x_size + y_size + z_size);
    if volume.abs() > 16.0 * f64::EPSILON * size { sign(volume) } else { 0 }
}

/// It is rarely needed and long.
#[cold]
#[inline(never)]
fn exact_volume([a, b, c]: [Point; 3], d: Point) -> i8 {
    let [[ax, ay, az], [bx, by, bz], [cx, cy, cz]] =
        [a, b, c].map(|p| [difference(p[0], d[0]), difference(p[1], d[1]), difference(p[2], d[2])]);
    let mut sum = Expansion::default();
    for (a, plus, minus) in [(ax, [by, cz], [bz, cy]), (ay, [bz, cx], [bx, cz]), (az, [bx, cy], [by, cx])] {
        sum.add_products(a, plus);
        sum.add_products(a.map(|part| -part), minus);
    }
    sum.sign()
}

/// Sign of the area of a triangle in a plane; 0 if its points are collinear. The rounding error is at most 3 unit
/// roundoffs times the sum of the magnitudes of the products [Shewchuk 1997]; 8 are allowed.
#[inline]
pub(super) fn area(a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> i8 {
    let [[ax, ay], [bx, by]] = [a, b].map(|p| [p[0] - c[0], p[1] - c[1]]);
    let (plus, minus) = (ax * by, ay * bx);
    let area = plus - minus;
    if area.abs() > 4.0 * f64::EPSILON * (plus.abs() + minus.abs()) { sign(area) } else { exact_area(a, b, c) }
}

#[cold]
#[inline(never)]
fn exact_area(a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> i8 {
    let [[ax, ay], [bx, by]] = [a, b].map(|p| [difference(p[0], c[0]), difference(p[1], c[1])]);
    let mut sum = Expansion::default();
    sum.add_products([1.0, 0.0], [ax, by]);
    sum.add_products([-1.0, 0.0], [ay, bx]);
    sum.sign()
}

pub(super) fn sign(value: f64) -> i8 {
    i8::from(value > 0.0) - i8::from(value < 0.0)
}

/// A sum of doubles of increasing size that do not overlap.
struct Expansion {
    parts: [f64; PARTS * PRODUCTS],
    count: usize,
}

impl Default for Expansion {
    fn default() -> Self {
        Self { parts: [0.0; _], count: 0 }
    }
}

impl Expansion {
    /// Adds the product of three sums of two doubles.
    fn add_products(&mut self, x: [f64; 2], [y, z]: [[f64; 2]; 2]) {
        for x in x.into_iter().filter(|&x| x != 0.0) {
            for y in y.into_iter().filter(|&y| y != 0.0) {
                let (high, low) = product(x, y);
                for z in z.into_iter().filter(|&z| z != 0.0) {
                    for (high, low) in [product(low, z), product(high, z)] {
                        self.add(low);
                        self.add(high);
                    }
                }
            }
        }
    }

    /// Adds a double [Shewchuk 1997, grow-expansion]. Zeros are dropped.
    fn add(&mut self, value: f64) {
        let (mut carried, mut count) = (value, 0);
        for k in 0..self.count {
            let (high, low) = sum(carried, self.parts.at(k));
            carried = high;
            if low != 0.0 {
                self.parts.set(count, low);
                count += 1;
            }
        }
        if carried != 0.0 {
            self.parts.set(count, carried);
            count += 1;
        }
        self.count = count;
    }

    fn sign(&self) -> i8 {
        self.count.checked_sub(1).map_or(0, |last| sign(self.parts.at(last)))
    }
}

/// A sum and its rounding error [Knuth 1998, 4.2.2].
fn sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    let of_b = sum - a;
    (sum, (a - (sum - of_b)) + (b - of_b))
}

/// A difference and its rounding error.
fn difference(a: f64, b: f64) -> [f64; 2] {
    let (high, low) = sum(a, -b);
    [high, low]
}

/// A product and its rounding error [Dekker 1971].
fn product(a: f64, b: f64) -> (f64, f64) {
    let product = a * b;
    let ([a_high, a_low], [b_high, b_low]) = (halves(a), halves(b));
    (product, a_low * b_low - (((product - a_high * b_high) - a_low * b_high) - a_high * b_low))
}

/// Two doubles of at most 26 bits [Dekker 1971].
fn halves(a: f64) -> [f64; 2] {
    const SPLITTER: f64 = ((1u64 << 27) + 1) as f64;
    let wide = SPLITTER * a;
    let high = wide - (wide - a);
    [high, a - high]
}

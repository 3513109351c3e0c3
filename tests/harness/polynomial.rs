//! Polynomials with integer coefficients, isolation of their roots in [0, 1], and the signs of other
//! polynomials at these roots. All is exact: Descartes' rule of signs after a Moebius map, and bisection
//! [Collins 1976].

use std::ops::{Add, Mul, Neg, Sub};

use num_bigint::{BigInt, Sign};
use num_integer::Integer;
use num_traits::{One, Zero};

/// Coefficients from the constant up; the last is not zero. The zero polynomial has no coefficients.
#[derive(Clone, Debug, PartialEq)]
pub struct Polynomial(Vec<BigInt>);

/// A number in [0, 1]: `numerator / 2^level`, or the only root between that number and
/// `(numerator + 1) / 2^level`.
#[derive(Clone, Debug)]
pub enum Root {
    /// The number itself.
    At(BigInt, u32),
    /// The root of a square-free polynomial in the open interval above it.
    Above(BigInt, u32, Polynomial),
}

impl Polynomial {
    /// The line from the value `start` at 0 to the value `end` at 1.
    pub fn line(start: &BigInt, end: &BigInt) -> Self {
        Self(vec![start.clone(), end - start]).trimmed()
    }

    /// Whether the polynomial is zero.
    pub fn is_zero(&self) -> bool {
        self.0.is_empty()
    }

    /// Each root in [0, 1] once. The zero polynomial returns no roots.
    pub fn roots(&self) -> Vec<Root> {
        if self.is_zero() {
            return Vec::new();
        }
        let square_free = self.divided(&gcd(self.clone(), self.derivative()));
        let mut roots: Vec<_> = [BigInt::zero(), BigInt::one()]
            .into_iter()
            .filter(|end| square_free.sign(end, 0) == Sign::NoSign)
            .map(|end| Root::At(end, 0))
            .collect();
        let mut intervals = vec![(BigInt::zero(), 0)];
        while let Some((left, level)) = intervals.pop() {
            match square_free.variations(&left, level) {
                0 => {}
                1 => roots.push(Root::Above(left, level, square_free.clone())),
                _ => {
                    let middle = 2 * &left + 1;
                    if square_free.sign(&middle, level + 1) == Sign::NoSign {
                        roots.push(Root::At(middle.clone(), level + 1));
                    }
                    intervals.extend([(2 * left, level + 1), (middle, level + 1)]);
                }
            }
        }
        roots
    }

    /// The sign at `numerator / 2^level`.
    fn sign(&self, numerator: &BigInt, level: u32) -> Sign {
        let (mut value, mut power) = (BigInt::zero(), 0);
        for coefficient in self.0.iter().rev() {
            value = value * numerator + (coefficient << power);
            power += level;
        }
        value.sign()
    }

    /// Descartes' bound on the number of roots strictly between `left / 2^level` and `(left + 1) / 2^level`;
    /// exact if it is 0 or 1.
    fn variations(&self, left: &BigInt, level: u32) -> usize {
        let degree = self.0.len().saturating_sub(1) as u32;
        let mut c: Vec<_> = (0u32..).zip(&self.0).map(|(i, c)| c << (level * (degree - i))).collect();
        shift(&mut c, left);
        c.reverse();
        shift(&mut c, &BigInt::one());
        c.retain(|c| !c.is_zero());
        c.windows(2).filter(|pair| pair[0].sign() != pair[1].sign()).count()
    }

    fn derivative(&self) -> Self {
        Self((1u32..).zip(self.0.iter().skip(1)).map(|(i, c)| c * i).collect())
    }

    /// The quotient, up to a positive factor.
    fn divided(&self, by: &Self) -> Self {
        let (mut rest, lead) = (self.0.clone(), &by.0[by.0.len() - 1]);
        let mut quotient = vec![BigInt::zero(); (rest.len() + 1).saturating_sub(by.0.len())];
        for i in (0..quotient.len()).rev() {
            rest.iter_mut().chain(&mut quotient).for_each(|c| *c *= lead * lead);
            let factor = &rest[i + by.0.len() - 1] / lead;
            for (j, c) in by.0.iter().enumerate() {
                rest[i + j] -= &factor * c;
            }
            quotient[i] = factor;
        }
        Self(quotient).primitive()
    }

    /// The remainder, up to a positive factor.
    fn remainder(&self, by: &Self) -> Self {
        let (mut rest, lead) = (self.clone(), &by.0[by.0.len() - 1]);
        while rest.0.len() >= by.0.len() {
            let (top, offset) = (rest.0[rest.0.len() - 1].clone(), rest.0.len() - by.0.len());
            rest.0.iter_mut().for_each(|c| *c *= lead * lead);
            for (j, c) in by.0.iter().enumerate() {
                rest.0[offset + j] -= &top * lead * c;
            }
            rest = rest.trimmed();
        }
        rest.primitive()
    }

    fn primitive(self) -> Self {
        let content = self.0.iter().fold(BigInt::zero(), |a, c| a.gcd(c));
        if content.is_zero() { self } else { Self(self.0.iter().map(|c| c / &content).collect()) }
    }

    fn trimmed(mut self) -> Self {
        while self.0.last().is_some_and(Zero::is_zero) {
            self.0.pop();
        }
        self
    }
}

impl Root {
    /// The sign of a polynomial at this root.
    pub fn sign(&self, of: &Polynomial) -> Sign {
        match self {
            _ if of.is_zero() => Sign::NoSign,
            Self::At(numerator, level) => of.sign(numerator, *level),
            Self::Above(left, level, root_of) => {
                let common = gcd(root_of.clone(), of.clone());
                let (mut left, mut level) = (left.clone(), *level);
                loop {
                    match (common.variations(&left, level), of.variations(&left, level)) {
                        (1, _) => return Sign::NoSign,
                        (_, 0) => return of.sign(&(2 * left + 1), level + 1),
                        _ => {}
                    }
                    let middle = 2 * &left + 1;
                    level += 1;
                    if root_of.sign(&middle, level) == Sign::NoSign {
                        return of.sign(&middle, level);
                    }
                    left = if root_of.variations(&(2 * &left), level) == 1 { 2 * left } else { middle };
                }
            }
        }
    }
}

/// The coefficients of `p(x + by)`.
fn shift(c: &mut [BigInt], by: &BigInt) {
    for start in 1..c.len() {
        for i in (start..c.len()).rev() {
            let upper = &c[i] * by;
            c[i - 1] += upper;
        }
    }
}

fn gcd(mut a: Polynomial, mut b: Polynomial) -> Polynomial {
    while !b.is_zero() {
        (a, b) = (b.clone(), a.remainder(&b));
    }
    a.primitive()
}

impl Add for &Polynomial {
    type Output = Polynomial;
    fn add(self, other: Self) -> Polynomial {
        let at = |p: &Polynomial, i: usize| p.0.get(i).cloned().unwrap_or_default();
        Polynomial((0..self.0.len().max(other.0.len())).map(|i| at(self, i) + at(other, i)).collect()).trimmed()
    }
}

impl Neg for &Polynomial {
    type Output = Polynomial;
    fn neg(self) -> Polynomial {
        Polynomial(self.0.iter().map(|c| -c).collect())
    }
}

impl Sub for &Polynomial {
    type Output = Polynomial;
    fn sub(self, other: Self) -> Polynomial {
        self + &-other
    }
}

impl Mul for &Polynomial {
    type Output = Polynomial;
    fn mul(self, other: Self) -> Polynomial {
        if self.is_zero() || other.is_zero() {
            return Polynomial(Vec::new());
        }
        let mut product = vec![BigInt::zero(); self.0.len() + other.0.len() - 1];
        for (i, a) in self.0.iter().enumerate() {
            for (j, b) in other.0.iter().enumerate() {
                product[i + j] += a * b;
            }
        }
        Polynomial(product)
    }
}

//! Complex arithmetic for the one-pole resonator.

use std::ops::{Add, Mul};

/// Complex number `re + i im`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Complex {
    pub(crate) re: f64,
    pub(crate) im: f64,
}

impl Complex {
    pub(crate) const ZERO: Self = Self { re: 0.0, im: 0.0 };

    /// Complex exponential `exp(re + i im)`.
    pub(crate) fn exp(re: f64, im: f64) -> Self {
        let (sin, cos) = im.sin_cos();
        Self { re: cos, im: sin } * re.exp()
    }

    /// Magnitude `|z|`.
    pub(crate) fn magnitude(self) -> f64 {
        self.re.hypot(self.im)
    }
}

impl Add for Complex {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self { re: self.re + other.re, im: self.im + other.im }
    }
}

impl Mul for Complex {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        Self { re: self.re * other.re - self.im * other.im, im: self.re * other.im + self.im * other.re }
    }
}

impl Mul<f64> for Complex {
    type Output = Self;

    fn mul(self, factor: f64) -> Self {
        Self { re: self.re * factor, im: self.im * factor }
    }
}

//! Fourier transform of a power-of-two length.

use std::f64::consts::TAU;
use std::ops::{Add, Mul, Sub};

#[derive(Clone, Copy, Debug)]
pub(super) struct Complex {
    pub(super) re: f64,
    pub(super) im: f64,
}

impl Complex {
    pub(super) const ZERO: Self = Self { re: 0.0, im: 0.0 };
}

impl Add for Complex {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self { re: self.re + other.re, im: self.im + other.im }
    }
}

impl Sub for Complex {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self { re: self.re - other.re, im: self.im - other.im }
    }
}

impl Mul for Complex {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        Self { re: self.re * other.re - self.im * other.im, im: self.re * other.im + self.im * other.re }
    }
}

/// Transform `X[k] = Σ x[n] e^{-2πi kn/N}`, in place; N is a power of two.
pub(super) fn forward(values: &mut [Complex]) {
    transform(values, -1.0);
}

/// Inverse of [`forward`], in place.
pub(super) fn inverse(values: &mut [Complex]) {
    transform(values, 1.0);
    let scale = 1.0 / values.len() as f64;
    values.iter_mut().for_each(|value| *value = Complex { re: scale * value.re, im: scale * value.im });
}

fn transform(values: &mut [Complex], sign: f64) {
    let length = values.len();
    let bits = length.trailing_zeros();
    for index in 1..length {
        let reversed = index.reverse_bits() >> (usize::BITS - bits);
        if index < reversed {
            values.swap(index, reversed);
        }
    }
    let turns: Vec<Complex> = (0..length / 2)
        .map(|index| {
            let (im, re) = (sign * TAU * index as f64 / length as f64).sin_cos();
            Complex { re, im }
        })
        .collect();
    let mut half = 1;
    while half < length {
        let stride = length / (2 * half);
        for group in values.chunks_exact_mut(2 * half) {
            let (low, high) = group.split_at_mut(half);
            for (index, (low, high)) in low.iter_mut().zip(high).enumerate() {
                let turned = *high * turns[index * stride];
                (*low, *high) = (*low + turned, *low - turned);
            }
        }
        half *= 2;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn transform_is_the_sum_that_defines_it_and_comes_back() {
        let signal: Vec<Complex> =
            (0..16).map(|n| Complex { re: f64::from(n * n % 7), im: f64::from(n % 3) }).collect();
        let mut values = signal.clone();
        forward(&mut values);
        for (bin, value) in values.iter().enumerate() {
            let sum = signal.iter().enumerate().fold(Complex::ZERO, |sum, (n, &x)| {
                let (im, re) = (-TAU * (bin * n) as f64 / 16.0).sin_cos();
                sum + x * Complex { re, im }
            });
            assert!((sum.re - value.re).hypot(sum.im - value.im) < 1e-12, "bin {bin}");
        }
        inverse(&mut values);
        let error = |(a, b): (&Complex, &Complex)| (a.re - b.re).hypot(a.im - b.im);
        assert!(values.iter().zip(&signal).map(error).fold(0.0, f64::max) < 1e-13);
    }
}

//! Where round the circle a loop's gain is looked at.

use std::f64::consts::{PI, TAU};

use super::super::closed_loop::BandPass;
use super::super::lattice::squared;
use super::super::response::near_poles;
use super::super::{Coefficients, RATE_HZ};

/// Angles all over the circle, closer together towards 0 Hz ...
const ALL_OVER: u32 = 48;
const TOWARDS_ZERO: f64 = 1.7;
/// ... and so many on either side of a loop's centre, up to two of its widths away.
const NEAR: i32 = 5;
/// Sharpness of the smooth maximum.
const SHARP: f64 = 200.0;

/// The loops' sum of moduli, `Σ |γ_s B_s|`, at angles that any filter is looked at.
pub(super) struct Circle<'a> {
    bands: &'a [BandPass],
    gains: &'a [f64],
    /// ω in radians a sample, and the sum.
    sums: Vec<(f64, f64)>,
}

impl<'a> Circle<'a> {
    /// Of loops at centres of widths, both in Hz.
    pub(super) fn new(bands: &'a [BandPass], gains: &'a [f64], centres_hz: &[f64], widths_hz: &[f64]) -> Self {
        let wide = (0..=ALL_OVER).map(|step| PI * (f64::from(step) / f64::from(ALL_OVER)).powf(TOWARDS_ZERO));
        let near = centres_hz.iter().zip(widths_hz).flat_map(|(centre_hz, width_hz)| {
            (-NEAR..=NEAR).map(move |step| {
                let apart = f64::from(step) / f64::from(NEAR);
                (TAU * (centre_hz + 2.0 * width_hz * apart * apart.abs()) / RATE_HZ).clamp(0.0, PI)
            })
        });
        let mut circle = Self { bands, gains, sums: Vec::new() };
        circle.sums = wide.chain(near).map(|angular| (angular, circle.sum(angular))).collect();
        circle
    }

    fn sum(&self, angular: f64) -> f64 {
        self.bands.iter().zip(self.gains).map(|(band, gain)| (gain * band.magnitude(angular)).abs()).sum()
    }

    /// `|F| Σ |γ_s B_s|` at all angles, those close by the filter's own poles last.
    pub(super) fn gains_round(&self, filter: &Coefficients) -> Vec<f64> {
        let squared = squared(filter);
        let own = near_poles(filter).map(|angular| (angular, self.sum(angular)));
        self.sums.iter().copied().chain(own).map(|(angular, sum)| squared(angular).sqrt() * sum).collect()
    }

    /// The largest of them, smoothed: at most a little more.
    pub(super) fn largest(&self, filter: &Coefficients) -> f64 {
        let all = self.gains_round(filter);
        let most = all.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
        let above: f64 = all.iter().map(|gain| (SHARP * (gain / most - 1.0)).exp()).sum();
        most * (1.0 + above.ln() / SHARP)
    }
}

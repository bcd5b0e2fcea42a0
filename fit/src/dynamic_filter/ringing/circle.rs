//! Gain round the loops at sample points of the unit circle.

use std::f64::consts::{PI, TAU};

use crate::dynamic_filter::closed_loop::BandPass;
use crate::dynamic_filter::lattice::squared;
use crate::dynamic_filter::model::{Coefficients, RATE_HZ};
use crate::dynamic_filter::response::near_poles;

/// Number of steps of sample points over the half circle.
const ALL_OVER: u32 = 48;
/// Exponent that moves the sample points closer together towards 0 Hz.
const TOWARDS_ZERO: f64 = 1.7;
/// Number of sample points on either side of a loop's centre, up to two of its widths away.
const NEAR: i32 = 5;
/// Sharpness of the smooth maximum.
const SHARP: f64 = 200.0;

/// Sum of the loops' magnitudes, `Σ |γ_s B_s|`, at sample points that serve every filter.
pub(super) struct Circle<'a> {
    bands: &'a [BandPass],
    gains: &'a [f64],
    /// Sample points: ω in radians a sample, and the sum there.
    sums: Vec<(f64, f64)>,
}

impl<'a> Circle<'a> {
    /// Sample points for loops with centres and widths in Hz.
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

    /// Gain `|F| Σ |γ_s B_s|` at all sample points, then near the filter's own poles.
    pub(super) fn gains_round(&self, filter: &Coefficients) -> Vec<f64> {
        let squared = squared(filter);
        let own = near_poles(filter).map(|angular| (angular, self.sum(angular)));
        self.sums.iter().copied().chain(own).map(|(angular, sum)| squared(angular).sqrt() * sum).collect()
    }

    /// Smooth maximum of [`Self::gains_round`], at or a little above the maximum.
    pub(super) fn largest(&self, filter: &Coefficients) -> f64 {
        let all = self.gains_round(filter);
        let most = all.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
        let above: f64 = all.iter().map(|gain| (SHARP * (gain / most - 1.0)).exp()).sum();
        most * (1.0 + above.ln() / SHARP)
    }
}

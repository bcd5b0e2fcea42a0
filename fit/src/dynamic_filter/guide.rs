//! Power that a loop adds to the noise that feeds it.

use std::f64::consts::{PI, TAU};

use super::average_filter::average_of;
use super::delay::delay_s;
use super::lattice::Lattice;
use super::model::RATE_HZ;
use super::response::{NOISE_DENSITY, response};

/// A loop (banded waveguide) as the descent models it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Guide {
    /// Centre frequency f_c in Hz.
    pub(crate) frequency_hz: f64,
    /// Bandwidth Δf in Hz.
    pub(crate) bandwidth_hz: f64,
    /// Loop gain: γ_s times the largest `|F|` over time at f_c; below 1.
    pub(crate) loop_gain: f64,
}

impl Guide {
    /// Power that the loop adds to the noise at each of `times_s`, in a band that passes all of it.
    ///
    /// The band-pass's envelope y, in white noise e of density S, obeys `y' = -β(1 - q) y + β q e`
    /// with β = πΔf and q = γ F(ω_s, t) D_s. So `P = E|y|²` obeys
    /// `P' = -2β(1 - Re q) P + β²|q|² S`. The delay slows it by 1 + β Re q d. The output has the
    /// power `|F|²(P + β Re q S)`: the mode, and its correlation with the noise that feeds it.
    pub(crate) fn powers(&self, times_s: &[f64], filters: &[Lattice], end: Option<usize>) -> Vec<f64> {
        let angular = TAU * self.frequency_hz / RATE_HZ;
        let responses: Vec<_> = filters.iter().map(|filter| response(&filter.coefficients(), angular)).collect();
        let loudest = responses.iter().map(|response| response.norm()).fold(f64::MIN_POSITIVE, f64::max);
        let lasting = responses.windows(2).zip(times_s.windows(2)).map(|(pair, times)| (pair[0], times[1] - times[0]));
        // If the noise ends, the delay is tuned to the filter round which the mode rings freely.
        let tuned = end.and_then(|end| responses.get(end).copied()).unwrap_or_else(|| average_of(lasting));
        let back = tuned.conj() / tuned.norm().max(f64::MIN_POSITIVE) * (self.loop_gain / loudest);
        // By eq. 10 and 11 the width shrinks by sin ω/ω towards half the rate.
        let beta = PI * self.bandwidth_hz * angular.sin() / angular;
        let delay_s = delay_s(self.frequency_hz, tuned.arg());
        let (mut power, mut before) = (0.0, 0.0);
        let mut powers = Vec::with_capacity(times_s.len());
        for (time, (time_s, response)) in times_s.iter().zip(&responses).enumerate() {
            let density = if end.is_some_and(|end| time > end) { 0.0 } else { NOISE_DENSITY };
            let q = back * response;
            let slowed = beta / (1.0 + (beta * delay_s * q.re).max(0.0));
            let rate = 2.0 * slowed * (1.0 - q.re).max(1e-6);
            let steady = slowed * slowed * q.norm_sqr() * density / rate;
            power = steady + (power - steady) * f64::exp(-rate * (time_s - before));
            before = *time_s;
            powers.push(response.norm_sqr() * (power + (slowed * q.re * density).max(0.0)));
        }
        powers
    }
}

/// Gain `|F| Σ|B_s|` at the centre of each loop, which must stay below 1.
///
/// The skirts of its neighbours are those of narrow band-passes.
pub(crate) fn crowding(guides: &[Guide]) -> impl Iterator<Item = f64> + '_ {
    guides.iter().enumerate().map(|(index, guide)| {
        let skirt = |(other, neighbour): (usize, &Guide)| {
            let apart = 2.0 * (neighbour.frequency_hz - guide.frequency_hz) / neighbour.bandwidth_hz;
            if other == index { neighbour.loop_gain } else { neighbour.loop_gain / apart.hypot(1.0) }
        };
        guides.iter().enumerate().map(skirt).sum()
    })
}

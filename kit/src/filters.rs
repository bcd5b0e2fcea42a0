//! Filters of an object beside its modes: a dynamic filter with loops round it, and a biquad bank.
//!
//! They are plain owned values that mirror the keys of the text form.

use std::f64::consts::{PI, TAU};

/// Dynamic filter: its coefficients move after each strike (dynamic-filter eq. 5, 6, 17).
///
/// Noise goes through it, and the object's modes if [`ModesGo::Through`] is set. Banded waveguides
/// may loop round it (eq. 8 to 13).
#[derive(Clone, Debug, PartialEq)]
pub struct DynamicFilter {
    /// Seed of the noise. Each pad has a stream of its own.
    pub seed: u32,
    /// Way of the object's modes: beside the filter or through it.
    pub modes: ModesGo,
    /// Sample rate in Hz for which the coefficients are given.
    ///
    /// At another rate the bilinear transformation carries them over.
    pub rate_hz: f32,
    /// Band-pass between the noise and the filter, if any.
    pub exciter: Option<Exciter>,
    /// Order of the filter; in a filter of first order a2 and b2 of all breakpoints are 0.
    pub order: Order,
    /// 1 to 32 breakpoints, the first at 0 s, each later than the one before.
    ///
    /// Between two of them the coefficients and the level of the noise are linear. After the last
    /// one there is no noise.
    pub path: Vec<Breakpoint>,
    /// Banded waveguides round the filter, at most 16.
    pub loops: Vec<Loop>,
}

/// Way of an object's modes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ModesGo {
    /// To the output, beside the filter.
    #[default]
    Beside,
    /// Into the filter, with its noise.
    Through,
}

impl ModesGo {
    /// Word that stands for this way in the text form.
    pub const fn key(self) -> &'static str {
        match self {
            Self::Beside => "beside",
            Self::Through => "through",
        }
    }
}

/// Order of a dynamic filter.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Order {
    /// One pole, one zero.
    #[default]
    First,
    /// Two poles, two zeros.
    Second,
}

/// Exciter: a Butterworth band-pass of fourth order for the noise.
///
/// A strike multiplies both edges by `(peak force / reference force)^exponent`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Exciter {
    /// Lower edge (-3 dB) in Hz at the reference force.
    pub low_hz: f32,
    /// Upper edge (-3 dB) in Hz at the reference force.
    pub high_hz: f32,
    /// Exponent of the peak force with which both edges move.
    pub exponent: f32,
}

/// Coefficients at a time after the strike.
///
/// The filter is `s(n) = b0 e(n) + b1 e(n-1) + b2 e(n-2) - a1 s(n-1) - a2 s(n-2)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Breakpoint {
    /// Time after the strike in seconds.
    pub time_s: f32,
    /// Level of the noise that goes into the filter, 0 to 1.
    pub noise: f32,
    /// Coefficient a1.
    pub a1: f32,
    /// Coefficient a2; 0 in a filter of first order.
    pub a2: f32,
    /// Coefficient b0.
    pub b0: f32,
    /// Coefficient b1.
    pub b1: f32,
    /// Coefficient b2; 0 in a filter of first order.
    pub b2: f32,
}

impl Default for Breakpoint {
    /// Breakpoint at the strike with noise at its full level and a silent filter: all coefficients
    /// 0.
    fn default() -> Self {
        Self { time_s: 0.0, noise: 1.0, a1: 0.0, a2: 0.0, b0: 0.0, b1: 0.0, b2: 0.0 }
    }
}

/// Banded waveguide: a delay and a band-pass in a feedback loop round the dynamic filter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Loop {
    /// Centre frequency f_c of the band-pass in Hz.
    pub frequency_hz: f32,
    /// Width Δf of the band-pass at -3 dB in Hz, below `frequency_hz`.
    pub bandwidth_hz: f32,
    /// Gain γ_s at f_c.
    pub gain: f32,
    /// Delay d_s in seconds.
    pub delay_s: f32,
}

/// Biquad bank (diffmodal eq. 2, 3): parallel chains of biquads, driven by the contact force in
/// newtons.
#[derive(Clone, Debug, PartialEq)]
pub struct Biquads {
    /// Sample rate in Hz for which poles and zeros are given.
    pub rate_hz: f32,
    /// 1 to 64 chains; each has 1 to 4 biquads in series, and all have equally many.
    pub chains: Vec<Vec<Biquad>>,
}

/// Biquad `k (1 - 2 Re q z⁻¹ + |q|² z⁻²) / (1 - 2 Re p z⁻¹ + |p|² z⁻²)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Biquad {
    /// Pole p as real and imaginary part, within the unit circle.
    pub pole: [f32; 2],
    /// Zero q as real and imaginary part; (0, 0) for a biquad without zeros.
    pub zero: [f32; 2],
    /// Gain k.
    pub gain: f32,
}

impl Breakpoint {
    /// Magnitude `|F|` of the filter at a frequency in Hz; its coefficients are for `rate_hz`.
    pub fn magnitude(&self, hz: f64, rate_hz: f64) -> f64 {
        let [a1, a2, b0, b1, b2] = [self.a1, self.a2, self.b0, self.b1, self.b2].map(f64::from);
        let angle = TAU * hz / rate_hz;
        size([b0, b1, b2], angle) / size([1.0, a1, a2], angle)
    }

    /// T60 in seconds of the filter with these coefficients, from its outermost pole; 0 without
    /// poles.
    pub fn t60_s(&self, rate_hz: f64) -> f64 {
        let (a1, a2) = (f64::from(self.a1), f64::from(self.a2));
        let discriminant = a1 * a1 - 4.0 * a2;
        let radius = if discriminant < 0.0 { a2.sqrt() } else { (a1.abs() + discriminant.sqrt()) / 2.0 };
        t60_of_radius(radius, rate_hz)
    }
}

impl Loop {
    /// T60 of the loop in seconds, round a filter of magnitude `|F|` at the loop's frequency.
    ///
    /// It is `ln(1000) (d + 1/(π Δf)) / -ln(γ|F|)`, where `1/(π Δf)` is the delay of the band-pass,
    /// and infinite if the loop does not decay.
    pub fn t60_s(&self, filter_magnitude: f64) -> f64 {
        let round = f64::from(self.gain).abs() * filter_magnitude;
        let delay_s = f64::from(self.delay_s) + 1.0 / (PI * f64::from(self.bandwidth_hz));
        if round < 1.0 { 1000f64.ln() * delay_s / -round.ln() } else { f64::INFINITY }
    }
}

impl DynamicFilter {
    /// Duration of the sound after a strike in seconds: that of the path, and then the T60 of the
    /// loop or filter that rings longest.
    pub fn duration_s(&self) -> f64 {
        let Some(last) = self.path.last() else { return 0.0 };
        let rate_hz = f64::from(self.rate_hz);
        let of_loop = |own: &Loop| own.t60_s(last.magnitude(f64::from(own.frequency_hz), rate_hz));
        f64::from(last.time_s) + self.loops.iter().map(of_loop).fold(last.t60_s(rate_hz), f64::max)
    }
}

impl Biquads {
    /// Magnitude `|H|` of the bank at a frequency in Hz, output per newton.
    pub fn magnitude(&self, hz: f64) -> f64 {
        let angle = TAU * hz / f64::from(self.rate_hz);
        let (re, im) = self.chains.iter().fold((0.0, 0.0), |(re, im), chain| {
            let (own_re, own_im) = chain.iter().fold((1.0, 0.0), |(re, im), biquad| {
                let (over, under) = (polynomial(square(biquad.zero), angle), polynomial(square(biquad.pole), angle));
                let norm = (under.0 * under.0 + under.1 * under.1) / f64::from(biquad.gain);
                let own = ((over.0 * under.0 + over.1 * under.1) / norm, (over.1 * under.0 - over.0 * under.1) / norm);
                (re * own.0 - im * own.1, re * own.1 + im * own.0)
            });
            (re + own_re, im + own_im)
        });
        re.hypot(im)
    }

    /// Longest T60 of the bank's poles in seconds.
    pub fn t60_s(&self) -> f64 {
        let radius = |biquad: &Biquad| f64::from(biquad.pole[0]).hypot(f64::from(biquad.pole[1]));
        let largest = self.chains.iter().flatten().map(radius).fold(0.0, f64::max);
        t60_of_radius(largest, f64::from(self.rate_hz))
    }

    /// Number of biquads of all chains.
    pub fn count(&self) -> usize {
        self.chains.iter().map(Vec::len).sum()
    }
}

fn t60_of_radius(radius: f64, rate_hz: f64) -> f64 {
    if radius > 0.0 { 1000f64.ln() / (-radius.ln() * rate_hz) } else { 0.0 }
}

/// Coefficients of `1 - 2 Re q z⁻¹ + |q|² z⁻²`, which has the root q and its conjugate.
fn square([re, im]: [f32; 2]) -> [f64; 3] {
    let (re, im) = (f64::from(re), f64::from(im));
    [1.0, -2.0 * re, re * re + im * im]
}

/// Value of `c0 + c1 z⁻¹ + c2 z⁻²` at an angle on the unit circle, as real and imaginary part.
fn polynomial([c0, c1, c2]: [f64; 3], angle: f64) -> (f64, f64) {
    let (one, two) = (angle, 2.0 * angle);
    (c0 + c1 * one.cos() + c2 * two.cos(), -(c1 * one.sin() + c2 * two.sin()))
}

/// Magnitude of a polynomial in z⁻¹ at an angle on the unit circle.
fn size(coefficients: [f64; 3], angle: f64) -> f64 {
    let (re, im) = polynomial(coefficients, angle);
    re.hypot(im)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn magnitudes_and_ringing_times_follow_the_equations() {
        let point = Breakpoint { a1: -0.5, b0: 0.25, b1: 0.25, ..Breakpoint::default() };
        // (b0 + b1) / (1 + a1) at 0, (b0 - b1) / (1 - a1) at Nyquist.
        assert!((point.magnitude(0.0, 48_000.0) - 1.0).abs() < 1e-12);
        assert!(point.magnitude(24_000.0, 48_000.0) < 1e-12);
        assert!((point.t60_s(48_000.0) - 1000f64.ln() / (2f64.ln() * 48_000.0)).abs() < 1e-12);
        let conjugate = Breakpoint { a1: -1.0, a2: 0.81, b0: 1.0, ..Breakpoint::default() };
        assert!((conjugate.t60_s(1.0) - 1000f64.ln() / -0.9f64.ln()).abs() < 1e-6);

        let biquad = |gain| Biquad { pole: [0.0, 0.5], zero: [1.0, 0.0], gain };
        let bank = |chains| Biquads { rate_hz: 48_000.0, chains };
        // (1 - 2 + 1) at 0; at Nyquist 4 / 1.25.
        assert!(bank(vec![vec![biquad(3.0)]]).magnitude(0.0) < 1e-12);
        assert!((bank(vec![vec![biquad(1.0)]]).magnitude(24_000.0) - 3.2).abs() < 1e-12);
        assert!((bank(vec![vec![biquad(1.0); 2]]).magnitude(24_000.0) - 3.2f64.powi(2)).abs() < 1e-9);
        assert!(bank(vec![vec![biquad(1.0)], vec![biquad(-1.0)]]).magnitude(5_000.0) < 1e-12);
        assert_eq!(bank(vec![vec![biquad(1.0); 2]; 3]).count(), 6);

        let own = Loop { frequency_hz: 440.0, bandwidth_hz: 5.0, gain: 1.0, delay_s: 0.002 };
        assert_eq!(own.t60_s(1.0), f64::INFINITY);
        let expected = 1000f64.ln() * (0.002 + 1.0 / (PI * 5.0)) / -0.9f64.ln();
        assert!((own.t60_s(0.9) - expected).abs() < 1e-6);
    }
}

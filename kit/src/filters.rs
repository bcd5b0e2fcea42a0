//! What an object may have beside its modes: a dynamic filter with loops round it, and a biquad bank. Plain owned values that mirror the text's keys.

use std::f64::consts::{PI, TAU};

/// Noise, and the modes where they go through it, through a filter whose coefficients move after each strike (dynamic-filter eq. 5, 6, 17), with
/// banded waveguides round it (eq. 8 to 13).
#[derive(Clone, Debug, PartialEq)]
pub struct DynamicFilter {
    /// Seed of the noise; each pad has a stream of its own.
    pub seed: u32,
    /// Where the object's modes go.
    pub modes: ModesGo,
    /// The rate in Hz that the coefficients are for; at another one the bilinear transformation carries them over.
    pub rate_hz: f32,
    /// Band-pass of the filter's noise, if any.
    pub exciter: Option<Exciter>,
    /// Order of the filter; of the first order a2 and b2 of all breakpoints are 0.
    pub order: Order,
    /// 1 to 32 breakpoints, the first at 0 s, each later than the one before; linear between them (coefficients
    /// and level of the noise), no noise after the last.
    pub path: Vec<Breakpoint>,
    /// At most 16 banded waveguides round the filter.
    pub loops: Vec<Loop>,
}

/// Where an object's modes go.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ModesGo {
    /// To the output, beside the filter.
    #[default]
    Beside,
    /// Into the filter, with its noise.
    Through,
}

impl ModesGo {
    /// The word in the text form.
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

/// The exciter: a Butterworth band-pass of fourth order, both of whose edges are times `(peak force / reference force)^exponent`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Exciter {
    /// Lower edge (-3 dB) in Hz at the reference force.
    pub low_hz: f32,
    /// Upper edge (-3 dB) in Hz at the reference force.
    pub high_hz: f32,
    /// By which power of the peak force both edges move.
    pub exponent: f32,
}

/// The coefficients at a time after the strike: `s(n) = b0 e(n) + b1 e(n-1) + b2 e(n-2) - a1 s(n-1) - a2 s(n-2)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Breakpoint {
    /// Seconds after the strike.
    pub time_s: f32,
    /// Level of the noise, 0 to 1: it scales what goes into the filter, never the filter.
    pub noise: f32,
    /// a1.
    pub a1: f32,
    /// a2; 0 in a filter of first order.
    pub a2: f32,
    /// b0.
    pub b0: f32,
    /// b1.
    pub b1: f32,
    /// b2; 0 in a filter of first order.
    pub b2: f32,
}

impl Default for Breakpoint {
    /// At the strike, noise at its full level, the filter closed.
    fn default() -> Self {
        Self { time_s: 0.0, noise: 1.0, a1: 0.0, a2: 0.0, b0: 0.0, b1: 0.0, b2: 0.0 }
    }
}

/// A banded waveguide: a delay and a band-pass in a feedback loop round the filter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Loop {
    /// Middle f_c of the band-pass in Hz.
    pub frequency_hz: f32,
    /// Width Δf of the band-pass at -3 dB in Hz, below `frequency_hz`.
    pub bandwidth_hz: f32,
    /// Gain γ_s at f_c.
    pub gain: f32,
    /// Delay d_s in seconds.
    pub delay_s: f32,
}

/// A biquad bank (diffmodal eq. 2, 3): 1 to 64 chains side by side, driven by the contact force in newtons.
#[derive(Clone, Debug, PartialEq)]
pub struct Biquads {
    /// The rate in Hz that poles and zeros are for.
    pub rate_hz: f32,
    /// The chains, all of the same 1 to 4 biquads, one behind the other.
    pub chains: Vec<Vec<Biquad>>,
}

/// A biquad `k (1 - 2 Re q z⁻¹ + |q|² z⁻²) / (1 - 2 Re p z⁻¹ + |p|² z⁻²)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Biquad {
    /// p as real and imaginary part, within the unit circle.
    pub pole: [f32; 2],
    /// q as real and imaginary part; (0, 0) is none.
    pub zero: [f32; 2],
    /// k.
    pub gain: f32,
}

impl Breakpoint {
    /// `|F|` at a frequency in Hz, of coefficients for a rate in Hz.
    pub fn magnitude(&self, hz: f64, rate_hz: f64) -> f64 {
        let [a1, a2, b0, b1, b2] = [self.a1, self.a2, self.b0, self.b1, self.b2].map(f64::from);
        let angle = TAU * hz / rate_hz;
        size([b0, b1, b2], angle) / size([1.0, a1, a2], angle)
    }

    /// T60 in seconds of the filter as it is there, by the larger radius of its poles; 0 without poles.
    pub fn t60_s(&self, rate_hz: f64) -> f64 {
        let (a1, a2) = (f64::from(self.a1), f64::from(self.a2));
        let discriminant = a1 * a1 - 4.0 * a2;
        let radius = if discriminant < 0.0 { a2.sqrt() } else { (a1.abs() + discriminant.sqrt()) / 2.0 };
        t60_of_radius(radius, rate_hz)
    }
}

impl Loop {
    /// T60 in seconds round a filter of a magnitude at its frequency: `ln(1000) (d + 1/(π Δf)) / -ln(γ|F|)`, the second term being the delay of the band-pass. Infinite
    /// where it does not decay.
    pub fn t60_s(&self, filter_magnitude: f64) -> f64 {
        let round = f64::from(self.gain).abs() * filter_magnitude;
        let delay_s = f64::from(self.delay_s) + 1.0 / (PI * f64::from(self.bandwidth_hz));
        if round < 1.0 { 1000f64.ln() * delay_s / -round.ln() } else { f64::INFINITY }
    }
}

impl DynamicFilter {
    /// How long it sounds after a strike, in seconds: its path, then 60 dB of what rings longest.
    pub fn duration_s(&self) -> f64 {
        let Some(last) = self.path.last() else { return 0.0 };
        let rate_hz = f64::from(self.rate_hz);
        let of_loop = |own: &Loop| own.t60_s(last.magnitude(f64::from(own.frequency_hz), rate_hz));
        f64::from(last.time_s) + self.loops.iter().map(of_loop).fold(last.t60_s(rate_hz), f64::max)
    }
}

impl Biquads {
    /// `|H|` at a frequency in Hz, output per newton.
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

    /// The longest T60 of its poles in seconds.
    pub fn t60_s(&self) -> f64 {
        let radius = |biquad: &Biquad| f64::from(biquad.pole[0]).hypot(f64::from(biquad.pole[1]));
        let largest = self.chains.iter().flatten().map(radius).fold(0.0, f64::max);
        t60_of_radius(largest, f64::from(self.rate_hz))
    }

    /// Biquads in all.
    pub fn count(&self) -> usize {
        self.chains.iter().map(Vec::len).sum()
    }
}

fn t60_of_radius(radius: f64, rate_hz: f64) -> f64 {
    if radius > 0.0 { 1000f64.ln() / (-radius.ln() * rate_hz) } else { 0.0 }
}

/// `1 - 2 Re q z⁻¹ + |q|² z⁻²` of a root and its conjugate.
fn square([re, im]: [f32; 2]) -> [f64; 3] {
    let (re, im) = (f64::from(re), f64::from(im));
    [1.0, -2.0 * re, re * re + im * im]
}

/// `c0 + c1 z⁻¹ + c2 z⁻²` on the unit circle.
fn polynomial([c0, c1, c2]: [f64; 3], angle: f64) -> (f64, f64) {
    let (one, two) = (angle, 2.0 * angle);
    (c0 + c1 * one.cos() + c2 * two.cos(), -(c1 * one.sin() + c2 * two.sin()))
}

fn size(coefficients: [f64; 3], angle: f64) -> f64 {
    let (re, im) = polynomial(coefficients, angle);
    re.hypot(im)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn magnitudes_and_ringing_times_are_those_of_the_equations() {
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

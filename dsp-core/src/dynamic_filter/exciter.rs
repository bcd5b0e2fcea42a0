//! The exciter at work: a fourth-order Butterworth band-pass of the noise, whose edges follow the
//! strike's level.
//!
//! It has two state-variable sections ([`super::kernel::section`]) with `g = ω_i`, warped, and
//! `k = 1/Q_i`:
//!
//! ```text
//! m = g (g + k) / D,   p = g / D,   n = g² / D,   D = 1 + g (g + k)
//! ```
//!
//! v1 is the section's band-pass, v2 its low-pass, `x - k v1 - v2` its high-pass. A band narrower
//! than its middle frequency is made of two band-passes, a wider one of a high-pass and a low-pass.
//! So each section's gain stays near 1. The sections are stable at any g and k, so that the edges
//! may move while they ring.
//!
//! # Why nothing can wrap
//!
//! With words up to X, the output of either section is at most 3.3 X. States are at most 3.1 X in
//! narrow bands, and 35 X in wide ones up to 0.49 fs (sums over impulse responses). So X is 2^27 if
//! no strike can make the band a wide one. Otherwise X is 2^25; such a band passes more of the
//! noise.
//!
//! A strike derives the multipliers in `f32` on the FPU, with relative errors of some 2^-22. It
//! calls no library function but the exact square root, so that the bits are equal on every
//! machine.

use super::kernel;
use super::kernel::section::{Response, Section};
use crate::SampleRate;
use crate::biquad::butterworth::{BandError, Exciter};
use crate::fixed::{Log2, times_q31};
use crate::square_root::rounded_root;
use crate::{exponential, sine};

/// Band-pass of the exciter: two sections.
#[derive(Clone, Copy, Debug)]
pub(super) struct BandPass {
    /// Edges over fs at level 1.
    edges: [f32; 2],
    /// Exponent of the level, Q27.
    exponent_q27: i32,
    /// Sections of the higher pole and of the lower one.
    sections: [Section; 2],
    /// True if the band is wider than its middle frequency.
    wide: bool,
    loaded: bool,
    /// Exponent of two at which input and output have a level of 2.0.
    bits: i32,
}

impl BandPass {
    pub(super) const NONE: Self =
        Self { edges: [0.0; 2], exponent_q27: 0, sections: [Section::NONE; 2], wide: false, loaded: false, bits: 27 };

    /// Loads a band at a rate.
    pub(super) fn load(&mut self, exciter: &Exciter, rate: SampleRate) -> Result<(), BandError> {
        exciter.check(rate)?;
        *self = Self {
            edges: [exciter.low_hz, exciter.high_hz].map(|hz| (hz / rate.hz()) as f32),
            exponent_q27: libm::rint(exciter.exponent * 134_217_728.0) as i32,
            loaded: true,
            bits: input_bits(exciter, rate),
            ..Self::NONE
        };
        Ok(())
    }

    /// Exponent of two at which input and output have a level of 2.0.
    pub(super) fn bits(&self) -> i32 {
        self.bits
    }

    pub(super) fn is_loaded(&self) -> bool {
        self.loaded
    }

    pub(super) fn rest(&mut self) {
        for section in &mut self.sections {
            (section.c, section.left) = ([0; 2], [0; 2]);
        }
    }

    /// Multiplies the sound in the sections by `left` (Q31).
    pub(super) fn attenuate(&mut self, left: i32) {
        for section in &mut self.sections {
            section.c = section.c.map(|c| times_q31(c, left));
        }
    }

    /// Clears the states on a tick without noise, if all are below a few steps. Gives true if all
    /// are 0.
    pub(super) fn settle(&mut self) -> bool {
        if self.sections.iter().all(|section| section.c.iter().all(|c| c.unsigned_abs() < 16)) {
            self.rest();
        }
        self.sections.iter().all(|section| section.c == [0; 2])
    }

    /// Moves the edges for a strike of a level: to `level^exponent` times the edges at level 1, up
    /// to 0.49 fs.
    pub(super) fn strike(&mut self, level: f32) {
        if !self.loaded {
            return;
        }
        let factor = Log2::new(level).power(self.exponent_q27).value();
        let [low, high] = self.edges;
        let high = (high * factor).clamp(2.0 * Exciter::LEAST_EDGE as f32, Exciter::LARGEST_EDGE as f32);
        // The ratio of the edges stays at least as large as the table's check demands.
        let (low, lowest, highest) = (low * factor, Exciter::LEAST_EDGE as f32, high / Exciter::LEAST_RATIO as f32);
        // `clamp` would check the order of its bounds, and could panic.
        let low = if low < lowest {
            lowest
        } else if low > highest {
            highest
        } else {
            low
        };
        let (low, high) = (tangent(low), tangent(high));
        let (width, square) = (high - low, low * high);
        self.wide = width * width > square;
        // s = p ± √(p² - ω0²), p = (-1 + i) width / √8.
        let half = width * core::f32::consts::FRAC_1_SQRT_2 / 2.0;
        let (re, im) = root(-square, -2.0 * half * half);
        for (section, sign) in self.sections.iter_mut().zip([-1.0, 1.0]) {
            let (re, im) = (-half + sign * re, half + sign * im);
            // The high pole's real part is a sum of numbers of equal sign, in which nothing
            // cancels. The low pole is found from the product of both poles, ω0².
            let (re, im) =
                if sign > 0.0 { low_pole(square, half, root(-square, -2.0 * half * half)) } else { (re, im) };
            let g = rounded_root(re * re + im * im);
            let k = -2.0 * re / g;
            let below = 1.0 + g * (g + k);
            let gain = match (self.wide, sign > 0.0) {
                (false, _) => width / rounded_root(square),
                // The high-pass comes first, with gain 1. The low-pass' gain becomes width²/ω².
                (true, true) => 1.0,
                (true, false) => width * width / (g * g),
            };
            let (p, n) = (g / below, g * g / below);
            *section = Section {
                less_m: -fixed(g * (g + k) / below, 31),
                p: fixed(p, 31),
                less_p: -fixed(p, 31),
                less_n: -fixed(n, 31),
                input: [fixed(gain * p, 31), fixed(gain * n, 31)],
                k: fixed(k, 30),
                ..*section
            };
        }
    }

    /// Runs noise below 2.0 through the band, in place.
    pub(super) fn run(&mut self, buffer: &mut [i32]) {
        let [high, low] = &mut self.sections;
        let [first, second] =
            if self.wide { [Response::High, Response::Low] } else { [Response::Band, Response::Band] };
        kernel::section(low, first, buffer);
        kernel::section(high, second, buffer);
    }
}

/// Exponent of two that stands for 2.0. It is smaller if a strike may make the band a wide one.
///
/// The band is likeliest to be wide at its highest, unless level and noise are then so small that
/// everything fits anyway.
fn input_bits(exciter: &Exciter, rate: SampleRate) -> i32 {
    let [low, high] = [exciter.low_hz, exciter.high_hz].map(|hz| hz / rate.hz());
    let [loudest, softest] = [2.0, 0.4].map(|level| exponential::power(level, exciter.exponent));
    let factor = loudest.max(softest).min(Exciter::LARGEST_EDGE / high);
    let [low, high] = [low, high].map(|edge| sine::tan(core::f64::consts::PI * factor * edge));
    if (high - low) * (high - low) > 0.99 * low * high { 25 } else { 27 }
}

/// `value · 2^bits`, rounded to zero, saturating. Only its 24 leading bits come from the value.
fn fixed(value: f32, bits: u32) -> i32 {
    (value * (1u32 << bits) as f32) as i32
}

/// `tan π x` for x in 0 to 0.49.
fn tangent(x: f32) -> f32 {
    // Sine and cosine of an angle of less than a quarter turn, measured from the nearer end.
    let near = if x <= 0.25 { x } else { 0.5 - x };
    let angle = core::f32::consts::PI * near;
    let square = angle * angle;
    let sine = angle * (1.0 - square / 6.0 * (1.0 - square / 20.0 * (1.0 - square / 42.0 * (1.0 - square / 72.0))));
    let cosine = 1.0 - square / 2.0 * (1.0 - square / 12.0 * (1.0 - square / 30.0 * (1.0 - square / 56.0)));
    if x <= 0.25 { sine / cosine } else { cosine / sine }
}

/// Square root of a complex number: the root whose real part is positive.
fn root(re: f32, im: f32) -> (f32, f32) {
    let size = rounded_root(re * re + im * im);
    // The larger part is found without cancellation, the other one from the product of both.
    let larger = rounded_root((size + re.abs()) / 2.0);
    let other = im / (2.0 * larger);
    if re >= 0.0 { (larger, other) } else { (other.abs(), if im < 0.0 { -larger } else { larger }) }
}

/// Low pole, found from the high one: `s_low = ω0² / s_high` for `s_high = p - r`.
fn low_pole(square: f32, half: f32, (re, im): (f32, f32)) -> (f32, f32) {
    let (re, im) = (-half - re, half - im);
    let size = re * re + im * im;
    (square * re / size, -square * im / size)
}

#[cfg(test)]
mod tests {
    use std::vec::Vec;

    use super::*;

    /// The test feeds each state, and the output, with the noise that drives it furthest.
    #[test]
    fn the_worst_noise_wraps_nothing() {
        let rate = SampleRate::HZ_48000;
        for (low_hz, high_hz) in [
            (240.0, 23_520.0),
            (80.0, 9000.0),
            (20_700.0, 23_520.0),
            (6000.0, 15_500.0),
            (13_300.0, 16_700.0),
            (900.0, 1000.0),
        ] {
            let mut band = BandPass::NONE;
            band.load(&Exciter { low_hz, high_hz, exponent: 0.0 }, rate).unwrap();
            band.strike(1.99);
            let one = 1 << (band.bits() - 6);
            let places = |band: &BandPass, word: i32| [&band.sections[0].c[..], &band.sections[1].c, &[word]].concat();
            let response: Vec<Vec<i32>> = (0..4000)
                .scan(band, |band, n| {
                    let mut word = [if n == 0 { one } else { 0 }];
                    band.run(&mut word);
                    Some(places(band, word[0]))
                })
                .collect();
            for place in 0..5 {
                let sum: f64 = response.iter().map(|at| f64::from(at[place]).abs()).sum::<f64>() * 64.0;
                let mut worst = band;
                let mut last = [0];
                for at in response.iter().rev() {
                    last[0] = 64 * one * at[place].signum();
                    worst.run(&mut last);
                }
                let reached = f64::from(places(&worst, last[0])[place]);
                assert!((reached / sum - 1.0).abs() < 1e-2, "{low_hz} to {high_hz} Hz, {place}: {reached} of {sum}");
            }
        }
    }
}

//! A loop's band-pass at work: one driven mode in the modified coupled form.
//!
//! ```text
//! u -= δ u;   u -= e v;   v += e u;   u += g_u x;   v += g_v x;   y = v
//! δ = 1 - |p|²,   e² = |1 - p|²,   g_v = a,   g_u = (c / (1 - δ) + a) / e
//! ```
//!
//! Bands of e >= 1/2 shift instead, as the bank's modes do: `u -= (e²/2^k) v; v += 2^k u`, k = 1 to
//! 3.
//!
//! # Why nothing can wrap
//!
//! `v = y 2^(27 + E)`. The size of a state is `s = max(|u| 2^k, |v|)`. Within a tick everything is
//! linear, so that each intermediate result is at most `G s + N X`: G the largest growth of a state
//! of size 1, N the sum over the frames of the sizes that an input of 1 leaves, both found on load
//! by stepping the very section in `f64`; X the line's words, which a tick before they are read are
//! known where the delay is a tick or more, and below 2^30 always. `Resonance::settle` keeps E, on
//! ticks, such that `G s < 2^30` and `N X < 2^28`: because a narrow band's N is small, that leaves
//! the state nearly all its bits, and E rises while line and state decay.

use super::tuning::Tuned;
use crate::fixed::{rounding_shift_right, saturating_shift_left, smmlar, smmlsr, times_q31};
use crate::time::TICK_FRAMES;

/// Bits of a line's words: `|x| < 2^30`.
pub(super) const LINE_BITS: i32 = 30;
/// Bits of growth of states.
const STATE_BITS: i32 = 30;
/// Bits of what an input adds.
const INPUT_BITS: i32 = 28;
/// The largest E above the sum's scale, so that the sum's multiplier is one.
const LARGEST_ABOVE_SUM: i32 = 31;

/// Bits by which a coarse sum of loops is smaller than the filter's input, Q29: it holds 128
/// instead of 4.
pub const COARSE_BITS: u32 = 5;

/// E of a sum in the filter's input format, Q29, which has room for 4.
pub(super) const FINE: i32 = 2;
/// E of a sum that has room for 128.
pub(super) const COARSE: i32 = FINE - COARSE_BITS as i32;

/// A gain as `mantissa · 2^(exponent - 31)`, mantissa normalised.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
struct Gain {
    mantissa: i32,
    exponent: i32,
}

impl Gain {
    const ZERO: Self = Self { mantissa: 0, exponent: 0 };

    fn new(value: f64) -> Self {
        let (fraction, exponent) = libm::frexp(value);
        Self { mantissa: libm::rint(fraction * 2147483648.0) as i32, exponent }
    }

    /// The multiplier `gain · 2^shift` as Q32; settle sees to it that it is below 1/2.
    fn q32(self, shift: i32) -> i32 {
        rounding_shift_right(self.mantissa, (-1 - shift - self.exponent).clamp(0, 40) as u32)
    }
}

/// A band-pass. The first words are what the kernels read.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct Resonance {
    /// The component that does not sound.
    pub(super) u: i32,
    /// The component that sounds.
    pub(super) v: i32,
    /// e or e²/2^k, Q32.
    pub(super) turn: i32,
    /// δ, Q32.
    pub(super) damp: i32,
    /// Q32 of the input into u.
    pub(super) gain_u: i32,
    /// Q32 of the input into v.
    pub(super) gain_v: i32,
    /// Q32 of v into the sum.
    pub(super) scale: i32,
    /// k.
    pub(super) shift: u32,
    /// Whole frames of delay.
    pub(super) delay: usize,
    /// Leading zeros that a state's size must have for it to stay as it is scaled.
    pub(super) least_zeros: i32,
    pub(super) most_zeros: i32,
    /// E.
    exponent: i32,
    /// The largest E for the sum and the multipliers of the input, and with words of the line below
    /// 1.
    largest_exponent: i32,
    for_input: i32,
    /// The largest E for the line as it is.
    limit: i32,
    /// E of the line's and of the sum's words.
    line_scale: i32,
    sum_scale: i32,
    growth_bits: i32,
    gains: [Gain; 2],
}

impl Resonance {
    /// None.
    pub(super) const EMPTY: Self = Self {
        u: 0,
        v: 0,
        turn: 0,
        damp: 0,
        gain_u: 0,
        gain_v: 0,
        scale: 0,
        shift: 0,
        exponent: 0,
        largest_exponent: 0,
        for_input: 0,
        limit: 0,
        line_scale: 0,
        sum_scale: 0,
        growth_bits: 0,
        least_zeros: 0,
        most_zeros: 32,
        gains: [Gain::ZERO; 2],
        delay: 0,
    };

    /// Derives it at rest, for words of the line of `s 2^(27 + line_scale)`, and a sum of `y 2^(27
    /// + sum_scale)`.
    pub(super) fn new(tuned: &Tuned, line_scale: i32, sum_scale: i32) -> Self {
        let (_, distance) = tuned.pole();
        let delta = distance * (2.0 - distance);
        let squared = 1.0 - 2.0 * tuned.real + tuned.square;
        let (shift, turn) = match squared {
            e2 if e2 < 0.249 => (0, libm::sqrt(e2)),
            e2 if e2 < 0.99 => (1, e2 / 2.0),
            e2 if e2 < 1.99 => (2, e2 / 4.0),
            e2 => (3, e2 / 8.0),
        };
        let unit = f64::from(1u32 << shift);
        let q32 = |value: f64| libm::rint(value * 4294967296.0) as i32;
        let (damp_q32, turn_q32) = (q32(delta), q32(turn));
        // From here on with the pole as it was rounded.
        let (delta, turn) = (f64::from(damp_q32) / 4294967296.0, f64::from(turn_q32) / 4294967296.0);
        let step = if shift == 0 { turn } else { unit };
        let tuned = tuned.with_pole(1.0 - (delta + turn * step) / 2.0, 1.0 - delta);
        let gains = [(tuned.c / (1.0 - delta) + tuned.a) / step, tuned.a];
        // The largest size of an orbit over a tick, and the sum over its frames.
        let walk = |mut u: f64, mut v: f64| {
            let size = |u: f64, v: f64| (u.abs() * unit).max(v.abs());
            let (mut largest, mut sum) = (size(u, v), size(u, v));
            for _ in 0..TICK_FRAMES {
                u *= 1.0 - delta;
                u -= turn * v;
                v += step * u;
                largest = largest.max(size(u, v));
                sum += size(u, v);
            }
            (largest, sum)
        };
        let growth = walk(1.0 / unit, 1.0).0.max(walk(1.0 / unit, -1.0).0);
        let of_input = walk(gains[0], gains[1]).1;
        let bits_above = |value: f64| libm::frexp(value * (1.0 + 1e-6)).1.clamp(-100, 100);
        // Multipliers of the input stay below 1/2.
        let for_gains = line_scale - 1 - bits_above(gains[0].abs().max(gains[1].abs()));
        let mut resonance = Self {
            turn: turn_q32,
            damp: damp_q32,
            shift,
            largest_exponent: for_gains.min(sum_scale + LARGEST_ABOVE_SUM),
            for_input: line_scale + INPUT_BITS - bits_above(of_input),
            line_scale,
            sum_scale,
            growth_bits: bits_above(growth),
            gains: gains.map(Gain::new),
            delay: tuned.delay,
            ..Self::EMPTY
        };
        resonance.rest();
        resonance
    }

    /// Bound of |y| for a line of 2^30: over all frames, the amplitude of the impulse response
    /// over the distance from the circle.
    pub(super) fn largest(tuned: &Tuned, line_scale: i32) -> f64 {
        let (angle, distance) = tuned.pole();
        let radius = 1.0 - distance;
        let h1 = tuned.c + 2.0 * tuned.real * tuned.a;
        let sine = (h1 / radius - tuned.a * libm::cos(angle)) / libm::sin(angle);
        libm::hypot(tuned.a, sine) / distance * libm::scalbn(1.0, LINE_BITS - 27 - line_scale)
    }

    /// Clears it.
    pub(super) fn rest(&mut self) {
        (self.u, self.v) = (0, 0);
        self.expect(LINE_BITS);
        self.set(self.limit);
    }

    /// Scales for a line that is below 2^`line_bits` from now on; to be followed by
    /// [`settle`](Self::settle).
    pub(super) fn expect(&mut self, line_bits: i32) {
        self.limit = self.largest_exponent.min(self.for_input - line_bits);
        self.bound();
    }

    /// Leaves so much (Q31) of it.
    pub(super) fn attenuate(&mut self, left: i32) {
        (self.u, self.v) = (times_q31(self.u, left), times_q31(self.v, left));
    }

    #[inline(always)]
    fn zeros(&self) -> i32 {
        let size = (self.v ^ (self.v >> 31)) | ((self.u ^ (self.u >> 31)) << self.shift);
        size.leading_zeros() as i32
    }

    /// True if the state has left the bounds of its scaling.
    #[inline(always)]
    pub(super) fn changes(&self) -> bool {
        !(self.least_zeros..=self.most_zeros).contains(&self.zeros())
    }

    /// On a tick: scales the state anew where it has left its bounds.
    pub(super) fn settle(&mut self) {
        if self.changes() {
            // A bit is left for it to grow before it is looked at again.
            let free = self.zeros() - self.no_zeros_free();
            self.rescale((self.exponent + free - 1).min(self.limit));
        }
    }

    /// Leading zeros of a size that leaves no bit free.
    const fn no_zeros_free(&self) -> i32 {
        32 - STATE_BITS + self.growth_bits
    }

    /// Bounds of a size outside of which the state is to be scaled anew: it is moved up by three
    /// bits at least.
    fn bound(&mut self) {
        let none = self.no_zeros_free();
        self.least_zeros = if self.exponent > self.limit { 33 } else { none };
        self.most_zeros = if self.exponent + 2 < self.limit { none + 4 } else { 32 };
    }

    #[inline(never)]
    fn rescale(&mut self, exponent: i32) {
        let moved = |word: i32| match exponent - self.exponent {
            left @ 0.. => word.wrapping_shl(left.min(31) as u32),
            right => rounding_shift_right(word, right.unsigned_abs()),
        };
        (self.u, self.v) = (moved(self.u), moved(self.v));
        self.set(exponent);
    }

    fn set(&mut self, exponent: i32) {
        self.exponent = exponent;
        let shift = exponent - self.line_scale;
        [self.gain_u, self.gain_v] = self.gains.map(|gain| gain.q32(shift));
        let scale = 32 + self.sum_scale - exponent;
        self.scale = if (0..31).contains(&scale) { 1 << scale } else { 0 };
        self.bound();
    }

    /// The largest sum of [`weight`](Self::weight)s for which sums of all bands cannot wrap: their
    /// states, below 1.25 · 2^30, then give less than 2^30 together, and noise or an exciter at
    /// most 2^30.
    pub(super) const LARGEST_WEIGHT: u64 = 3 << 30;

    /// Share of a sum's headroom that the loop takes: its multiplier, if there is one.
    pub(super) fn weight(&self) -> u64 {
        if self.exponent < self.sum_scale + 2 { 1 << 32 } else { self.scale as u64 }
    }

    /// A frame for a word x of the line; gives the state that sounds.
    #[inline(always)]
    pub(super) fn step(&mut self, x: i32) -> i32 {
        self.u = smmlsr(self.u, self.damp, self.u);
        self.u = smmlsr(self.u, self.turn, self.v);
        match self.shift {
            0 => self.v = smmlar(self.v, self.turn, self.u),
            shift => self.v += self.u << shift,
        }
        self.u = smmlar(self.u, self.gain_u, x);
        self.v = smmlar(self.v, self.gain_v, x);
        self.v
    }

    /// Contribution of a sounding state to a sum, saturating, at any E.
    pub(super) fn of_sum(&self, v: i32) -> i32 {
        match self.exponent - self.sum_scale {
            right @ 0.. => rounding_shift_right(v, right.unsigned_abs()),
            left => saturating_shift_left(v, left.unsigned_abs()),
        }
    }
}

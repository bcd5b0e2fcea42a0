//! A loop's band-pass at work: one driven mode in the modified coupled form.
//!
//! ```text
//! u -= δ u;   u -= e v;   v += e u;   u += g_u x;   v += g_v x;   y = v
//! δ = 1 - |p|²,   e² = |1 - p|²,   g_v = a,   g_u = (c / (1 - δ) + a) / e
//! ```
//!
//! If e >= 1/2, the band-pass shifts by k bits instead, as the bank's modes do:
//! `u -= (e²/2^k) v; v += 2^k u`, k = 1 to 3.
//!
//! # Why nothing can wrap
//!
//! `v = y 2^(27 + E)`. The size of a state is `s = max(|u| 2^k, |v|)`. Within a tick everything is
//! linear, so that each intermediate result is at most `G s + N X`. G is the largest growth of a
//! state of size 1. N is the sum over the frames of the sizes that an input of 1 leaves. Both are
//! found on load, by stepping this very section in `f64`. X stands for the line's words, which are
//! always below 2^30. If the delay is a tick or more, they are known a tick before they are read.
//!
//! On ticks `Resonance::settle` keeps E such that `G s < 2^30` and `N X < 2^28`. A narrow band's N
//! is small, so that this leaves the state nearly all its bits. E rises while line and state decay.

use super::tuning::Tuned;
use crate::fixed::{rounding_shift_right, saturating_shift_left, smmlar, smmlsr, times_q31};
use crate::sine;
use crate::square_root::length;
use crate::time::TICK_FRAMES;

/// Number of bits of the line's words: `|x| < 2^30`.
pub(super) const LINE_BITS: i32 = 30;
/// Number of bits to which states may grow in a tick: `G s < 2^30`.
const STATE_BITS: i32 = 30;
/// Number of bits that the input may add in a tick: `N X < 2^28`.
const INPUT_BITS: i32 = 28;
/// Largest difference of E and the sum's scale, at which the sum's multiplier is still above 0.
const LARGEST_ABOVE_SUM: i32 = 31;

/// Number of bits by which a coarse sum of loops is smaller than the filter's input, Q29. A coarse
/// sum has room for 128 instead of 4.
pub const COARSE_BITS: u32 = 5;

/// E of a fine sum, in the filter's input format Q29, which has room for 4.
pub(super) const FINE: i32 = 2;
/// E of a coarse sum, which has room for 128.
pub(super) const COARSE: i32 = FINE - COARSE_BITS as i32;

/// A gain as `mantissa · 2^(exponent - 31)`, with a normalised mantissa.
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

    /// Multiplier `gain · 2^shift` as Q32. The limits of E keep it below 1/2.
    fn q32(self, shift: i32) -> i32 {
        rounding_shift_right(self.mantissa, (-1 - shift - self.exponent).clamp(0, 40) as u32)
    }
}

/// A loop's band-pass. The kernels read the first words, up to `most_zeros`.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct Resonance {
    /// Component that does not sound.
    pub(super) u: i32,
    /// Component that sounds.
    pub(super) v: i32,
    /// Multiplier e, or e²/2^k if k is above 0, Q32.
    pub(super) turn: i32,
    /// Multiplier δ, Q32.
    pub(super) damp: i32,
    /// Multiplier of the input into u, Q32.
    pub(super) gain_u: i32,
    /// Multiplier of the input into v, Q32.
    pub(super) gain_v: i32,
    /// Multiplier of v into the sum, Q32.
    pub(super) scale: i32,
    /// Shift k in bits; 0 if e multiplies.
    pub(super) shift: u32,
    /// Delay in whole frames.
    pub(super) delay: usize,
    /// Fewest leading zeros of the state's size at which its scaling stays.
    pub(super) least_zeros: i32,
    /// Most leading zeros of the state's size at which its scaling stays.
    pub(super) most_zeros: i32,
    /// Exponent E of the state.
    exponent: i32,
    /// Largest E for which the multipliers of the input and of the sum fit.
    largest_exponent: i32,
    /// Largest E for words of the line below 1.
    for_input: i32,
    /// Largest E for the line's present words.
    limit: i32,
    /// E of the line's words.
    line_scale: i32,
    /// E of the sum's words.
    sum_scale: i32,
    /// Number of bits by which a state may grow in a tick.
    growth_bits: i32,
    /// Gains of the input into u and v.
    gains: [Gain; 2],
}

impl Resonance {
    /// A band-pass that is not loaded.
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

    /// Derives a band-pass at rest. Words of the line are `s 2^(27 + line_scale)`, and words of the
    /// sum are `y 2^(27 + sum_scale)`.
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
        // From here on the pole is that of the rounded multipliers.
        let (delta, turn) = (f64::from(damp_q32) / 4294967296.0, f64::from(turn_q32) / 4294967296.0);
        let step = if shift == 0 { turn } else { unit };
        let tuned = tuned.with_pole(1.0 - (delta + turn * step) / 2.0, 1.0 - delta);
        let gains = [(tuned.c / (1.0 - delta) + tuned.a) / step, tuned.a];
        // Gives the largest size that a state without input reaches in a tick, and the sum of its
        // sizes.
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

    /// Upper bound of |y| for a line of 2^30. The impulse response's envelope, summed over all
    /// frames, is its amplitude over the pole's distance from the circle.
    pub(super) fn largest(tuned: &Tuned, line_scale: i32) -> f64 {
        let (angle, distance) = tuned.pole();
        let radius = 1.0 - distance;
        let h1 = tuned.c + 2.0 * tuned.real * tuned.a;
        let sine = (h1 / radius - tuned.a * sine::cos(angle)) / sine::sin(angle);
        length(tuned.a, sine) / distance * libm::scalbn(1.0, LINE_BITS - 27 - line_scale)
    }

    /// Clears the state.
    pub(super) fn rest(&mut self) {
        (self.u, self.v) = (0, 0);
        self.expect(LINE_BITS);
        self.set(self.limit);
    }

    /// Sets the largest E for a line that is below 2^`line_bits` from now on. Call
    /// [`settle`](Self::settle) next.
    pub(super) fn expect(&mut self, line_bits: i32) {
        self.limit = self.largest_exponent.min(self.for_input - line_bits);
        self.bound();
    }

    /// Multiplies the state by `left` (Q31).
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

    /// Scales the state anew on a tick, if it has left the bounds of its scaling.
    pub(super) fn settle(&mut self) {
        if self.changes() {
            // One bit is left free, so that the state may grow before it is scaled again.
            let free = self.zeros() - self.no_zeros_free();
            self.rescale((self.exponent + free - 1).min(self.limit));
        }
    }

    /// Number of leading zeros of a size that leaves no bit free.
    const fn no_zeros_free(&self) -> i32 {
        32 - STATE_BITS + self.growth_bits
    }

    /// Sets the bounds of the state's size, outside of which it is scaled anew. It is moved up by
    /// at least three bits.
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

    /// Largest total of [`weight`](Self::weight)s at which sums of all bands cannot wrap. The
    /// states, below 1.25 · 2^30, then give less than 2^30 together. Noise or an exciter gives at
    /// most 2^30.
    pub(super) const LARGEST_WEIGHT: u64 = 3 << 30;

    /// Share of a sum's headroom that the loop takes: its multiplier, or 2^32 if the state is too
    /// large for a multiplier.
    pub(super) fn weight(&self) -> u64 {
        if self.exponent < self.sum_scale + 2 { 1 << 32 } else { self.scale as u64 }
    }

    /// Renders a frame with a word x of the line as input. Gives the state that sounds.
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

    /// Contribution of a sounding state v to a sum, saturating, at any E.
    pub(super) fn of_sum(&self, v: i32) -> i32 {
        match self.exponent - self.sum_scale {
            right @ 0.. => rounding_shift_right(v, right.unsigned_abs()),
            left => saturating_shift_left(v, left.unsigned_abs()),
        }
    }
}

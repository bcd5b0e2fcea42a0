//! One section: its multipliers, its state, and the power of two by which that is scaled.
//!
//! # Why nothing can wrap
//!
//! The size of a state is `s = max(|u| 2^k, |v|)`. Between two calls of `Section::settle` (a tick at most) everything is linear, so that
//! each intermediate result is at most
//!
//! ```text
//! G s + N X         G: the largest growth of a state of size 1 over a tick's frames, from the two corners of the square s = 1 (those are
//!                      the extreme points of all starts);
//!                   N: the sum over a tick's frames of the sizes that an input of 1 leaves;  X: the bound of the input
//! ```
//!
//! both found on load by stepping the very section in `f64` (`extent`). With whole powers of two above each, settle chooses E such that
//! `G s < 2^30` and `max(N, |d|) X < 2^28`: states stay below `2^30 + 2^28`, outputs below `2^30 + 2^29`, and rounding (at most four halves of a
//! step a frame, each growing by G) adds less than 2^9.

use super::design::{Biquad, BiquadError, Form};
use crate::resonator::TICK_FRAMES;

/// What bounds a signal: `|word| < 2^bits`, and the word stands for `value · 2^exponent`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(C)]
pub struct Level {
    /// Power of two by which the words are larger than the values (values in steps of the bus, 2^-27).
    pub exponent: i32,
    /// Bits of the largest word; [`Level::SILENT`]'s for none.
    pub bits: i32,
}

impl Level {
    /// Nothing comes in.
    pub const SILENT: Self = Self { exponent: 0, bits: -1000 };
}

/// The largest exponent of a state: beyond it all is far below any bus.
const MAX_EXPONENT: i32 = 200;
/// Bits of growth of states.
const STATE_BITS: i32 = 30;
/// Bits of what an input adds.
const INPUT_BITS: i32 = 28;

/// A gain as `mantissa · 2^(exponent - 31)`, mantissa normalised.
#[derive(Clone, Copy, Debug, Default)]
#[repr(C)]
struct Gain {
    mantissa: i32,
    exponent: i32,
}

impl Gain {
    fn new(value: f64) -> Self {
        let (fraction, exponent) = libm::frexp(value);
        Self {
            mantissa: libm::rint(fraction * 2147483648.0) as i32,
            exponent: if value == 0.0 { -1000 } else { exponent },
        }
    }

    /// The multiplier `gain · 2^shift` as Q32; the caller sees to it that it is below 1/2.
    fn q32(self, shift: i32) -> i32 {
        crate::fixed::rounding_shift_right(self.mantissa, (-1 - shift - self.exponent).clamp(0, 40) as u32)
    }
}

/// A section. The first words are what the kernels read.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct Section {
    /// The component that does not sound.
    pub(super) u: i32,
    /// The component that sounds.
    pub(super) v: i32,
    /// e or e²/2^k, Q32.
    pub(super) turn: i32,
    /// δ as Q32; 1 - δ as Q31 for [`Form::Damped`].
    pub(super) damp: i32,
    /// Q32 of the input into u.
    pub(super) gain_u: i32,
    /// Q32 of the input into v.
    pub(super) gain_v: i32,
    /// Q32 of the input into the output, of a last section into the mix.
    pub(super) direct: i32,
    /// Q32 of v into the mix, of a last section.
    pub(super) scale: i32,
    /// States smaller than this ask to be settled.
    pub(super) low: u32,
    /// So do those that are as large as this above `low`.
    pub(super) span: u32,
    /// Which loop.
    pub(super) kind: u8,
    /// Where its input is: 0 the bank's, 1 that with alternating sign, 2 the chain's buffer.
    pub(super) source: u8,
    /// Where its output goes: 0 the mix, 1 that with alternating sign, 2 the chain's buffer.
    pub(super) target: u8,
    /// Whether every other frame of the chain's buffer changes its sign first.
    pub(super) flip: u8,
    exponent: i32,
    input: Level,
    gains: [Gain; 3],
    form: Form,
    role: Role,
    /// Bits of G.
    growth_bits: i8,
    /// Bits of max(N, |d|).
    input_bits: i8,
    /// Bits of the sum of its impulse response's sizes.
    reach_bits: i8,
}

/// Where a section stands in its chain; kinds are `form + 4 role`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Role {
    /// Its output goes to the next.
    Inner = 0,
    /// Its output goes to the mix.
    Last = 1,
    /// It is alone: what goes straight through, the bank adds for all chains at once.
    Only = 2,
}

/// The kind of a section that is not run.
pub const SKIPPED: u8 = 12;

impl Section {
    /// No section.
    pub const EMPTY: Self = Self {
        u: 0,
        v: 0,
        turn: 0,
        damp: 0,
        gain_u: 0,
        gain_v: 0,
        direct: 0,
        scale: 0,
        low: 0,
        span: 0,
        kind: SKIPPED,
        source: 0,
        target: 0,
        flip: 0,
        exponent: 0,
        gains: [Gain { mantissa: 0, exponent: 0 }; 3],
        input: Level::SILENT,
        form: Form::Coupled,
        role: Role::Inner,
        growth_bits: 0,
        input_bits: 0,
        reach_bits: 0,
    };

    /// Derives a section at rest, and whether it runs mirrored. `index` is for the message.
    ///
    /// # Errors
    /// [`BiquadError`].
    pub fn new(biquad: &Biquad, index: usize) -> Result<(Self, bool), BiquadError> {
        biquad.check(index)?;
        let mirrored = biquad.pole.real < 0.0;
        let radius_squared = biquad.pole.square();
        let real = biquad.pole.real.abs();
        // |1 - p|² without cancellation; 1 - |p|² from the radius, exact where it is near 1.
        let turn_squared = (1.0 - real) * (1.0 - real) + biquad.pole.imaginary * biquad.pole.imaginary;
        let radius = libm::sqrt(radius_squared);
        let delta = (1.0 - radius) * (1.0 + radius);
        let (form, turn) = match turn_squared {
            _ if delta >= 0.49 => (Form::Damped, turn_squared / 4.0),
            e2 if e2 < 0.249 => (Form::Coupled, libm::sqrt(e2)),
            e2 if e2 < 0.99 => (Form::Shifted1, e2 / 2.0),
            e2 => (Form::Shifted2, e2 / 4.0),
        };
        let (n1, n2) = biquad.proper();
        let n1 = if mirrored { -n1 } else { n1 };
        let scale = if form == Form::Coupled { turn } else { f64::from(1u32 << form.shift()) };
        let gains = [(n2 + (1.0 - delta) * n1) / scale, n1, biquad.numerator[0]];
        let (damp, kept) = match form {
            Form::Damped => (libm::rint((1.0 - delta) * 2147483648.0) as i32, 1.0 - delta),
            _ => (q32(delta), 1.0 - delta),
        };
        let extent = extent(form, turn, kept, gains);
        let size = (gains[0] * f64::from(1u32 << form.shift())).abs().max(gains[1].abs());
        let reach = gains[2].abs() + extent.growth * size / (1.0 - radius);
        if !(0.0..=Biquad::MAX_GAIN).contains(&reach) {
            return Err(BiquadError::UnboundedGain { biquad: index, gain: reach });
        }
        let section = Self {
            turn: q32(turn),
            damp,
            gains: gains.map(Gain::new),
            form,
            growth_bits: bits_above(extent.growth),
            input_bits: bits_above(extent.of_input.max(gains[2].abs())),
            reach_bits: bits_above(reach),
            exponent: MAX_EXPONENT,
            ..Self::EMPTY
        };
        Ok((section, mirrored))
    }

    /// Says where it stands in its chain.
    pub(super) fn place(&mut self, role: Role, source: u8, target: u8, flip: bool) {
        self.role = role;
        (self.source, self.target, self.flip) = (source, target, u8::from(flip));
    }

    /// Where it stands.
    pub(super) fn role(&self) -> Role {
        self.role
    }

    /// Bits of the sum of its impulse response's sizes.
    pub(super) fn reach_bits(&self) -> i32 {
        i32::from(self.reach_bits)
    }

    /// `max(|u| 2^k, |v|)`, rounded up to the next power of two less one.
    pub fn size(&self) -> u32 {
        let k = self.form.shift();
        ((self.v ^ (self.v >> 31)) | ((self.u ^ (self.u >> 31)) << k)) as u32
    }

    /// Bits of the state's value in steps of the bus; very negative at rest.
    pub(super) fn value_bits(&self) -> i32 {
        match (self.u, self.v) {
            (0, 0) => -1000,
            _ => 33 - self.size().leading_zeros() as i32 + i32::from(self.growth_bits) - self.exponent,
        }
    }

    /// Clears the state and leaves the section out.
    pub(super) fn rest(&mut self) {
        (self.u, self.v, self.kind) = (0, 0, SKIPPED);
    }

    /// Runs it from now on.
    pub(super) fn wake(&mut self) {
        self.kind = self.form as u8 + 4 * self.role as u8;
    }

    /// Chooses the state's exponent for an input, shifts the state and derives the multipliers; gives the level of the output.
    pub(super) fn settle(&mut self, input: Level) -> Level {
        let growth = i32::from(self.growth_bits);
        let at_rest = self.u == 0 && self.v == 0;
        let bits = if at_rest { -1000 } else { 32 - self.size().leading_zeros() as i32 };
        // The multipliers of the input must stay below 1/2, and what it adds below 2^28.
        let for_input = match input.bits {
            ..=-1000 => MAX_EXPONENT,
            bits => (input.exponent + (INPUT_BITS - bits).min(-1) - i32::from(self.input_bits)).min(MAX_EXPONENT),
        };
        // A bit is left for the state to grow before it asks again.
        let for_state = if at_rest { MAX_EXPONENT } else { self.exponent + STATE_BITS - growth - bits - 1 };
        let exponent = for_input.min(for_state);
        self.u = shifted(self.u, exponent - self.exponent);
        self.v = shifted(self.v, exponent - self.exponent);
        (self.exponent, self.input) = (exponent, input);
        let shift = exponent - input.exponent;
        let of_input = match input.bits {
            ..=-1000 => -1000,
            bits => bits + i32::from(self.input_bits) + shift,
        };
        let bits = if at_rest { -1000 } else { 32 - self.size().leading_zeros() as i32 };
        let high = (bits + 1).max(of_input + 1).clamp(1, STATE_BITS - growth);
        self.low = if !at_rest && for_input > exponent + 2 && exponent < MAX_EXPONENT && high > 4 {
            1 << (high - 4)
        } else {
            0
        };
        self.span = (1u32 << high) - self.low;
        if of_input <= -1000 {
            (self.gain_u, self.gain_v, self.direct) = (0, 0, 0);
        } else {
            let [u, v, direct] = self.gains;
            (self.gain_u, self.gain_v, self.direct) = (u.q32(shift), v.q32(shift), direct.q32(shift));
        }
        Level { exponent, bits: (high + growth).max(of_input + 1) + 1 }
    }

    /// Whether its state has left the bounds that [`settle`](Self::settle) chose.
    pub(super) fn asks(&self) -> bool {
        self.size().wrapping_sub(self.low) >= self.span
    }

    /// For a last section: the multipliers into a mix of `value · 2^-room`.
    pub(super) fn set_mix(&mut self, room: i32) {
        // 2^32 · 2^-(E + room).
        let shift = 32 - self.exponent - room;
        self.scale = if (0..31).contains(&shift) { 1 << shift } else { 0 };
        if self.role == Role::Last && self.input.bits > -1000 {
            let [.., direct] = self.gains;
            self.direct = direct.q32(-self.input.exponent - room);
        }
    }
}

/// A state moved by powers of two; settle sees to it that nothing is lost at the top.
fn shifted(word: i32, shift: i32) -> i32 {
    match shift {
        0.. => word.wrapping_shl(shift.min(31) as u32),
        right => crate::fixed::rounding_shift_right(word, right.unsigned_abs()),
    }
}

fn q32(value: f64) -> i32 {
    libm::rint(value * 4294967296.0) as i32
}

/// The whole power of two at or above, with a little to spare for the rounding of multipliers.
fn bits_above(value: f64) -> i8 {
    if value == 0.0 { -100 } else { libm::frexp(value * (1.0 + 1e-6)).1.clamp(-100, 100) as i8 }
}

/// G and N of the module's proof.
struct Extent {
    growth: f64,
    of_input: f64,
}

fn extent(form: Form, turn: f64, kept: f64, gains: [f64; 3]) -> Extent {
    let unit = f64::from(1u32 << form.shift());
    // The largest size of any intermediate of an orbit over a tick, and the sum over its frames.
    let walk = |mut u: f64, mut v: f64| {
        let size = |u: f64, v: f64| (u.abs() * unit).max(v.abs());
        let (mut largest, mut sum) = (size(u, v), size(u, v));
        for _ in 0..TICK_FRAMES {
            u -= turn * v;
            v += if form == Form::Coupled { turn * u } else { unit * u };
            let now = size(u, v);
            u *= kept;
            largest = largest.max(now);
            sum += now;
        }
        (largest, sum)
    };
    let (same, unlike) = (walk(1.0 / unit, 1.0).0, walk(1.0 / unit, -1.0).0);
    Extent { growth: same.max(unlike), of_input: walk(gains[0], gains[1]).1 }
}

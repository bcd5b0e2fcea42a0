//! The coefficients over time: the pieces between breakpoints, the checks of a path, and the choice
//! of the arithmetic.
//!
//! | order, poles | arithmetic | parameters, interpolated linearly |
//! | --- | --- | --- |
//! | 1 | `S -= (1 + a1) S; S += b0 e + b1 e'` in 64 bits | `-(1 + a1)`, b0, b1 |
//! | 2, conjugate | `z = p z + g e'` (complex), `s = Re z + d e` | Re p, Im p, Re g, Im g, d |
//! | 2, real | `z1 = p1 z1 + e'; z2 = p2 z2 + β z1'; s = d e + α z1 + z2` | p1, p2, α, β, d |
//!
//! A `'` marks a value of the frame before. All three forms contract, however the parameters move,
//! as long as each pole is inside the unit circle. A straight line between two points inside the
//! circle stays inside it.

use super::error::PathError;
use super::limits::{CARRIED, Limits, MAX_TIME_S, MIN_REAL_POLE, OF_TABLE};
use super::settings::Breakpoint;
use crate::SampleRate;
use crate::memory::{Memory, OutOfMemory, Region};
use crate::square_root::length;
use crate::table::range::BREAKPOINTS;

/// Exponent of two to which |e| is clipped: 2.0 in Q27.
pub(super) const MAX_INPUT_BITS: i32 = 28;

/// Kind of a filter's input, which decides the formats of its words.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Input {
    /// Noise alone, straight from the generator.
    Noise,
    /// Words in a buffer, clipped to 2.0.
    Words,
    /// Sums of noise and loops, in Q29.
    Sums,
}

/// Number of parameters of the largest form.
pub const PARAMETERS: usize = 5;

/// Arithmetic of a filter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Form {
    /// First order with b1 = b0 (eq. 17): two parameters.
    EqualZeros,
    /// First order: three parameters.
    OnePole,
    /// Second order, conjugate poles.
    Conjugate,
    /// Second order, real poles.
    Real,
}

impl Form {
    pub(super) const fn parameters(self) -> usize {
        match self {
            Self::EqualZeros => 2,
            Self::OnePole => 3,
            Self::Conjugate | Self::Real => PARAMETERS,
        }
    }

    /// Number of bits of s as the state's format holds it: `|s| 2^(27 + h) < 2^bits`.
    const fn state_bits(self) -> i32 {
        match self {
            Self::EqualZeros | Self::OnePole | Self::Real => 29,
            Self::Conjugate => 30,
        }
    }
}

/// A piece of the path: parameters at its first frame, and their change per frame.
#[derive(Clone, Copy, Debug)]
pub(super) struct Piece {
    /// First frame of the piece, counted from the strike.
    pub(super) start: u32,
    /// Parameters at the first frame, in the formats of the form.
    pub(super) value: [i32; PARAMETERS],
    /// Change of each parameter per frame, with 32 bits more.
    pub(super) slope: [i64; PARAMETERS],
    /// Level of the noise at the first frame, Q30.
    pub(super) noise: i32,
    /// Change of the noise's level per frame, with 32 bits more.
    pub(super) noise_slope: i64,
}

impl Piece {
    const NOTHING: Self = Self { start: 0, value: [0; PARAMETERS], slope: [0; PARAMETERS], noise: 0, noise_slope: 0 };
}

/// Level 1 in the format of [`Piece::noise`].
const NOISE_UNIT: f64 = 1073741824.0;

/// Coefficients over time at a sample rate.
#[derive(Debug)]
pub struct Path<'m> {
    pieces: &'m mut [Piece],
    count: usize,
    pub(super) form: Form,
    /// True if a breakpoint gives the noise a level other than 1.
    pub(super) has_levels: bool,
    /// True if damping multiplies all bits of a first-order state.
    pub(super) whole: bool,
    /// Scale h: the state's word is larger than the bus by 2^h.
    pub(super) scale: i32,
    /// Shift q: words of the input are Q(27 - q).
    pub(super) input_shift: i32,
    /// Scale h of the state z1, for real poles.
    pub(super) inner_scale: i32,
    /// Largest change of a first-order state's word by the input in a frame.
    pub(super) growth: u32,
    /// Largest gain on the path, summed over the impulse response.
    pub(super) gain: f64,
}

/// Parameters of a form, and bounds of its states for an input of 1.
#[derive(Clone, Copy)]
pub(super) struct Derived {
    pub(super) form: Form,
    pub(super) parameters: [f64; PARAMETERS],
    /// Gain from the input straight to s, past the states.
    pub(super) direct: f64,
    /// Bound of the states' part of s; for real poles it is to be multiplied by `inner`.
    pub(super) ring: f64,
    /// Bound of z1 for real poles; 1 in all other forms.
    pub(super) inner: f64,
}

impl Derived {
    /// Gain, summed over the impulse response.
    fn gain(&self) -> f64 {
        self.direct + self.inner * self.ring
    }

    /// Joins two bounds. The result bounds both, and any path that jumps between them.
    fn or(self, other: Self) -> Self {
        let mut both = self;
        both.parameters.iter_mut().zip(other.parameters).for_each(|(most, value)| *most = most.abs().max(value.abs()));
        (both.direct, both.ring) = (both.direct.max(other.direct), both.ring.max(other.ring));
        both.inner = both.inner.max(other.inner);
        both
    }
}

impl<'m> Path<'m> {
    /// Makes a path without pieces.
    pub const fn empty() -> Self {
        Self {
            pieces: &mut [],
            count: 0,
            form: Form::EqualZeros,
            has_levels: false,
            whole: false,
            scale: 0,
            input_shift: 0,
            inner_scale: 0,
            growth: 0,
            gain: 0.0,
        }
    }

    /// Takes memory for `count` breakpoints.
    pub(super) fn take(memory: &mut Memory<'m>, count: usize) -> Result<Self, OutOfMemory> {
        Ok(Self { pieces: memory.take(Region::Bulk, count, || Piece::NOTHING)?, ..Self::empty() })
    }

    /// Derives the path of a filter of order 1 or 2 for a rate. `ratio` is this rate over the rate
    /// that the coefficients are for.
    ///
    /// Breakpoints keep their time to a fraction of a frame. Without memory everything but the
    /// pieces is derived.
    ///
    /// # Errors
    /// [`PathError`].
    pub(super) fn load(
        &mut self,
        order: u8,
        breakpoints: impl Iterator<Item = Breakpoint> + Clone,
        rate: SampleRate,
        ratio: f64,
        input: Input,
    ) -> Result<(), PathError> {
        self.count = 0;
        let given = breakpoints.clone().count();
        if given == 0 || given > BREAKPOINTS {
            return Err(PathError::Count { given, room: BREAKPOINTS });
        }
        let form = check(order, breakpoints.clone())?;
        self.form = form;
        self.has_levels = breakpoints.clone().any(|point| point.noise != 1.0);
        let breakpoints = breakpoints.map(|point| point.carried(order, ratio));
        let nothing = Derived { form, parameters: [0.0; PARAMETERS], direct: 0.0, ring: 0.0, inner: 1.0 };
        let rounded = |point: Breakpoint| -point.a1 >= MIN_REAL_POLE;
        self.whole = order == 1 && !breakpoints.clone().all(rounded);
        let mut most = nothing;
        for (breakpoint, point) in breakpoints.clone().enumerate() {
            most = most.or(derive(order, &point, breakpoint, CARRIED)?);
            if most.gain() > CARRIED.gain {
                return Err(PathError::Gain { breakpoint, gain: most.gain() });
            }
        }
        let units = self.choose_scales(&most, input);
        self.gain = most.gain();
        let parameters = |point: &Breakpoint| derive(order, point, 0, CARRIED).unwrap_or(nothing).parameters;
        let mut following = breakpoints.clone().skip(1);
        for here in breakpoints {
            let next = following.next();
            let frame = here.time_s * rate.hz();
            let start = libm::ceil(frame);
            let end = next.map_or(f64::INFINITY, |next| next.time_s * rate.hz());
            // A piece without a frame would never be heard.
            if libm::ceil(end) <= start {
                continue;
            }
            let Some(piece) = self.pieces.get_mut(self.count) else { break };
            self.count += 1;
            piece.start = start as u32;
            let (from, to) = (parameters(&here), parameters(&next.unwrap_or(here)));
            let between = |from: f64, to: f64, unit: f64| {
                let change = (to - from) / (end - frame);
                let value = libm::rint((from + change * (start - frame)) * unit) as i32;
                // A piece of one frame never uses its change, which might not fit. In a longer
                // piece the change is at most the whole range.
                let slope = if end - start > 1.0 { libm::rint(change * unit * 4294967296.0) as i64 } else { 0 };
                (value, slope)
            };
            for ((((value, slope), from), to), unit) in
                piece.value.iter_mut().zip(&mut piece.slope).zip(from).zip(to).zip(units)
            {
                (*value, *slope) = between(from, to, unit);
            }
            let noise_after = next.map_or(here.noise, |next| next.noise);
            (piece.noise, piece.noise_slope) = between(here.noise, noise_after, NOISE_UNIT);
        }
        Ok(())
    }

    /// Chooses h and q. Gives the number that stands for 1 in each parameter's format.
    fn choose_scales(&mut self, most: &Derived, from: Input) -> [f64; PARAMETERS] {
        let largest = most.parameters;
        let exponent = |value: f64| libm::frexp(value * 1.001).1;
        let power = |bits: i32| libm::scalbn(1.0, bits);
        // gain · 2^(MAX_INPUT_BITS + h) <= 2^state_bits.
        let room = self.form.state_bits() - MAX_INPUT_BITS;
        self.scale = (room - exponent(most.gain())).clamp(-14, 12);
        if from != Input::Words && self.form.parameters() < PARAMETERS {
            // If the state fits the bus' own format, that format saves a shift. Bits below a step
            // of the bus are not heard.
            self.scale = match self.scale {
                0.. => 0,
                -2..0 if from == Input::Noise => -2,
                far => far,
            };
        }
        let of_input = match self.form {
            Form::EqualZeros | Form::OnePole => largest[1].max(largest[2]),
            Form::Conjugate => largest[2].max(largest[3]).max(largest[4]),
            Form::Real => largest[4],
        };
        // b · 2^(bits + q) < 2^31, with bits = 32 + h in the first order and 31 + h in the second.
        let bits = if self.form.parameters() < PARAMETERS { 32 } else { 31 } + self.scale;
        // Sums are Q29. Then b fits, because in the state's format the gain is below 2.
        let finest = if from == Input::Sums { -2 } else { 4 };
        self.input_shift = (31 - bits - exponent(of_input)).clamp(-2, finest);
        self.inner_scale = room - exponent(most.inner);
        let input = power(bits + self.input_shift);
        let inner = power(30 + self.scale - self.inner_scale);
        let pole = power(31);
        match self.form {
            Form::EqualZeros | Form::OnePole => {
                let all = (largest[1] + largest[2]) * power(MAX_INPUT_BITS + self.scale);
                self.growth = libm::ceil(all * 1.001) as u32;
                [power(30), input, input, 0.0, 0.0]
            }
            Form::Conjugate => [pole, pole, input, input, input],
            Form::Real => [pole, pole, inner, inner, input],
        }
    }

    /// Frame at which the last breakpoint is reached and noise ends.
    pub fn last_frame(&self) -> u32 {
        self.pieces().last().map_or(0, |piece| piece.start)
    }

    pub(super) fn pieces(&self) -> &[Piece] {
        self.pieces.get(..self.count).unwrap_or(&[])
    }
}

/// Checks a path before anything is derived, and gives its form.
fn check(order: u8, breakpoints: impl Iterator<Item = Breakpoint> + Clone) -> Result<Form, PathError> {
    let mut before = -1.0;
    let mut form = None;
    for (breakpoint, point) in breakpoints.clone().enumerate() {
        let time_s = point.time_s;
        let starts = breakpoint > 0 || time_s == 0.0;
        if !(time_s > before && time_s <= MAX_TIME_S && starts) {
            return Err(PathError::Order { breakpoint, time_s });
        }
        before = time_s;
        if !(0.0..=1.0).contains(&point.noise) {
            return Err(PathError::Noise { breakpoint, noise: point.noise });
        }
        let here = derive(order, &point, breakpoint, OF_TABLE)?.form;
        if form.is_some_and(|form| form != here) && order == 2 {
            return Err(PathError::PolesMeet { breakpoint });
        }
        // The form is eq. 17's only if all breakpoints have b1 = b0.
        if form != Some(Form::OnePole) {
            form = Some(here);
        }
    }
    form.ok_or(PathError::Count { given: 0, room: BREAKPOINTS })
}

/// Derives the parameters and bounds of a breakpoint.
pub(super) fn derive(order: u8, point: &Breakpoint, breakpoint: usize, limits: Limits) -> Result<Derived, PathError> {
    let Breakpoint { a1, a2, b0, b1, b2, .. } = *point;
    let Limits { poles: [min_pole, max_pole], least_real, .. } = limits;
    let stable = |pole: f64, least: f64| {
        if (least..=max_pole).contains(&pole) { Ok(()) } else { Err(PathError::Unstable { breakpoint, pole }) }
    };
    let derived = match order {
        1 => {
            stable(-a1, min_pole)?;
            let form = if b0 == b1 { Form::EqualZeros } else { Form::OnePole };
            let ring = (b0.abs() + b1.abs()) / (1.0 - a1.abs());
            Derived { form, parameters: [-(1.0 + a1), b0, b1, 0.0, 0.0], direct: 0.0, ring, inner: 1.0 }
        }
        2 => {
            // H = b0 + (n1 w + n2 w²) / (1 + a1 w + a2 w²).
            let (n1, n2) = (b1 - a1 * b0, b2 - a2 * b0);
            let (middle, rest) = (-a1 / 2.0, a1 * a1 / 4.0 - a2);
            if rest < 0.0 {
                let size = libm::sqrt(a2);
                stable(size, 0.0)?;
                let imaginary = libm::sqrt(-rest);
                // With the residue r: n1 = 2 Re r, n2 = -2 Re r p*, g = 2 r.
                let g = [n1, -(n2 + n1 * middle) / imaginary];
                let ring = length(g[0], g[1]) / (1.0 - size);
                let parameters = [middle, imaginary, g[0], g[1], b0];
                Derived { form: Form::Conjugate, parameters, direct: b0.abs(), ring, inner: 1.0 }
            } else {
                let root = libm::sqrt(rest);
                let (p1, p2) = (middle + root, middle - root);
                stable(p1, least_real)?;
                stable(p2, least_real)?;
                let (alpha, beta) = (n1, n2 + n1 * p2);
                let ring = alpha.abs() + beta.abs() / (1.0 - p2.abs());
                let parameters = [p1, p2, alpha, beta, b0];
                Derived { form: Form::Real, parameters, direct: b0.abs(), ring, inner: 1.0 / (1.0 - p1.abs()) }
            }
        }
        _ => return Err(PathError::FilterOrder { order }),
    };
    match derived.gain() {
        gain if (0.0..=limits.gain).contains(&gain) => Ok(derived),
        gain => Err(PathError::Gain { breakpoint, gain }),
    }
}

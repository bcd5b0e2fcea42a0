//! Register groups: modes of one form that share a block exponent.

mod guard;
mod plan;

pub use plan::{GROUP_MODES, Plan};

use super::coefficient::{Form, Orbit};
use super::headroom::GROWTH_OF_V;
use super::mode::{InputGain, Mode};
use crate::fixed;
use crate::square_root::rounded_root;

/// Smallest block exponent: a state of `LIMIT` then stands for 2^26 times full scale.
const MIN_EXPONENT: i32 = -24;
/// Largest interval in ticks between two guards of a group that rings freely: 43 ms at 48 kHz.
pub(super) const MAX_GUARD_TICKS: u32 = 64;
/// Largest exponent of a gain mantissa: from rest, the smallest block exponent then holds a tick of
/// the largest force (2^36 bus steps).
pub(super) const MAX_GAIN_EXPONENT: i32 = 29 - MIN_EXPONENT - 36 - 1;

/// A group of modes: their form, their block exponent and the bounds that go with it.
///
/// A state of value x stands for `x · 2^-exponent` bus steps. The states are kept just below
/// [`LIMIT`](super::headroom::LIMIT) by shifting them at guards, so that the damping term `δu`
/// never falls into its dead band, however far the sound has decayed.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct Group {
    /// Data for the kernels; kept up to date by [`Group::prepare`].
    plan: Plan,
    /// Size of the largest injection: max(|gain.u| · 2^k, |gain.v|) over the modes.
    gain_peak: u32,
    /// Bound of the state's size, input included, until the next guard.
    bound: u32,
    /// A gain mantissa g stands for `g · 2^(gain_exponent - 31)` bus steps a bus step of force.
    gain_exponent: i16,
    exponent: i8,
    /// [`MIRRORED`], [`RINGING`], [`REFUSING`].
    status: u8,
    /// `2 log2` of the largest state, in bus steps, that a bus step of force makes.
    gain_half_octaves: i8,
    /// `4 log2` of the first mode's 2π f/fs: the larger, the less of a long contact reaches it.
    angle_quarter_octaves: i8,
    /// Ticks between two guards while nothing drives the group: in that time its fastest mode
    /// decays by half a bit.
    guard_ticks: u8,
    /// Time of the next guard by the bank's clock (ticks without input, modulo 256).
    due_at: u8,
}

/// Bits of a status: the modes run at fs/2 - f; a mode may have a state other than zero; input must
/// be kept out until the next guard.
const MIRRORED: u8 = 1;
const RINGING: u8 = 2;
const REFUSING: u8 = 4;

impl Group {
    /// A group of no modes, which fills memory before a kit is loaded.
    pub const EMPTY: Self = Self {
        plan: Plan::EMPTY,
        gain_peak: 0,
        bound: 0,
        gain_exponent: 0,
        exponent: 0,
        status: 0,
        gain_half_octaves: 0,
        angle_quarter_octaves: 0,
        guard_ticks: 0,
        due_at: 0,
    };

    pub(super) fn new(form: Form, mirrored: bool, count: u8) -> Self {
        Self { plan: Plan::new(form, count), status: if mirrored { MIRRORED } else { 0 }, ..Self::EMPTY }
    }

    /// Number of modes.
    pub fn count(&self) -> usize {
        self.plan.count()
    }

    /// Arithmetic of its modes.
    pub fn form(&self) -> Form {
        self.plan.form()
    }

    pub(super) fn plan(&self) -> &Plan {
        &self.plan
    }

    /// True if its modes run at fs/2 - f.
    pub fn mirrored(&self) -> bool {
        self.status & MIRRORED != 0
    }

    /// Leaves the group out: its sound ends, and no input reaches it until [`Group::admit`].
    pub(super) fn shed(&mut self, modes: &mut [Mode]) {
        if self.ringing() {
            self.silence(modes);
        }
        self.plan.set_shed(true);
    }

    /// Lets input reach the group again.
    pub(super) fn admit(&mut self) {
        self.plan.set_shed(false);
    }

    /// True if the group is left out for want of time.
    pub(super) fn is_shed(&self) -> bool {
        self.plan.is_shed()
    }

    /// `2 log2` of a bound of a mode's amplitude until the next guard, in bus steps: its ringing
    /// and the guard's allowance.
    pub(super) fn ringing_half_octaves(&self) -> i32 {
        half_octaves(self.bound) - 2 * self.exponent()
    }

    /// `2 log2` of the largest state, in bus steps, that a bus step of force makes, rounded down;
    /// -64 octaves at least.
    pub(super) fn gain_half_octaves(&self) -> i32 {
        i32::from(self.gain_half_octaves)
    }

    /// `4 log2` of 2π f/fs of its first mode, to first order.
    pub(super) fn angle_quarter_octaves(&self) -> i32 {
        i32::from(self.angle_quarter_octaves)
    }

    /// True if its input is kept out at present.
    pub(super) fn refusing(&self) -> bool {
        self.status & REFUSING != 0
    }

    /// True if any of its modes may have a state other than zero.
    pub fn ringing(&self) -> bool {
        self.status & RINGING != 0
    }

    /// Block exponent: states count 2^-exponent bus steps.
    pub fn exponent(&self) -> i32 {
        i32::from(self.exponent)
    }

    /// Sets the input gains from the modes' injections (into u, into v), in bus steps of state a
    /// bus step of force, below 2^[`MAX_GAIN_EXPONENT`]. The mantissas may still grow by the factor
    /// `growth`, at most 2.
    pub(super) fn set_gains(&mut self, modes: &mut [Mode], growth: f32, injections: &[(f32, f32)]) {
        let scale = Self::gain_scale(self.form(), growth, injections);
        for (mode, &injection) in modes.iter_mut().zip(injections) {
            mode.gain = scale.mantissas(injection);
        }
        let mut gains = [InputGain::default(); GROUP_MODES];
        gains.iter_mut().zip(&*modes).for_each(|(gain, mode)| *gain = mode.gain);
        self.share_gains(scale, &mut gains, &mut [], growth);
        modes.iter_mut().zip(gains).for_each(|(mode, gain)| mode.gain = gain);
    }

    /// Scale on which the largest injection, times `growth`, is nearly 1.
    pub(super) fn gain_scale(form: Form, growth: f32, injections: &[(f32, f32)]) -> GainScale {
        let weight = (1u32 << form.shift()) as f32;
        let larger = |peak: f32, x: f32| if x > peak { x } else { peak };
        let peak = injections.iter().fold(0.0, |peak, (u, v)| larger(larger(peak, (u * weight).abs()), v.abs()));
        GainScale { exponent: libm::frexpf(peak * growth).1 }
    }

    /// Brings `new` gains on a scale, and `kept` ones on the present scale, to one that holds both.
    /// Either may drive the group then.
    pub(super) fn share_gains(&mut self, scale: GainScale, new: &mut [InputGain], kept: &mut [InputGain], growth: f32) {
        let form = self.form();
        let peak = |gains: &[InputGain]| gains.iter().map(|gain| size_of(form, gain.u, gain.v)).max().unwrap_or(0);
        let kept_peak = peak(kept);
        let mut exponent = scale.exponent;
        if kept_peak > 0 {
            let grown = kept_peak + if growth > 1.0 { kept_peak / 16 } else { 0 };
            // Bits of the peak's mantissa, beyond 31 if it may not grow yet.
            let bits = 64 - grown.leading_zeros() as i32;
            exponent = exponent.max(i32::from(self.gain_exponent) + bits - 31);
        }
        shift_gains(new, exponent - scale.exponent);
        shift_gains(kept, exponent - i32::from(self.gain_exponent));
        self.gain_exponent = exponent as i16;
        let gain_peak = peak(new).max(peak(kept));
        self.plan.set_phase(new.iter().chain(&*kept).any(|gain| gain.v != 0));
        self.gain_peak = gain_peak.min(u64::from(u32::MAX)) as u32;
        let half_octaves = half_octaves(self.gain_peak) + 2 * (i32::from(self.gain_exponent) - 31);
        self.gain_half_octaves = half_octaves.max(i8::MIN.into()) as i8; // gains are below 2^16
    }

    /// Brings the kernel's plan up to date, after the group's guard and once the bank's mix
    /// exponent is known.
    pub(super) fn prepare(&mut self, mix_exponent: i32, force_shift: u32) {
        let gain_shift = match self.refusing() {
            // No bit of a gain is left: the input is kept out.
            true => 31,
            false => (force_shift as i32 - (i32::from(self.gain_exponent) + 1 + self.exponent())).clamp(0, 31),
        };
        self.plan.set(self.ringing(), gain_shift as u32, mix_scale(self.exponent() + mix_exponent));
    }

    /// Derives from the poles the interval of guards while nothing drives the group. After load.
    pub(super) fn schedule_guards(&mut self, modes: &[Mode]) {
        let fastest = modes.iter().fold(0, |fastest, mode| mode.coefficients.delta.max(fastest));
        self.guard_ticks = ticks_to_half_a_bit(fastest);
        let epsilon = modes.first().map_or(1, |mode| mode.coefficients.epsilon.unsigned_abs());
        // e² = 4 sin²(θ/2), θ ≈ e; ε is Q32.
        let angle = match self.form() {
            _ if self.mirrored() => 3,
            Form::Coupled => 2 * (half_octaves(epsilon) - 64),
            form => half_octaves(epsilon) - 64 + 2 * form.shift() as i32,
        };
        self.angle_quarter_octaves = angle.max(i8::MIN.into()) as i8; // at most 4
    }

    /// Number of guards in [`MAX_GUARD_TICKS`] without input, rounded up.
    pub(super) fn guards_in_longest_interval(&self) -> u32 {
        MAX_GUARD_TICKS.div_ceil(u32::from(self.guard_ticks.max(1)))
    }

    /// Sets the multiplier that brings its states to a mix of this exponent, after the group's
    /// guard.
    pub(super) fn scale_mix(&mut self, mix_exponent: i32) {
        self.plan.set_mix_scale(mix_scale(self.exponent() + mix_exponent));
    }

    /// Sets the time of the next guard: the group's interval later, at most `longest` ticks, or, if
    /// input may still come, at once when it ends.
    pub(super) fn schedule(&mut self, clock: u8, has_input: bool, longest: u8) {
        self.due_at = clock.wrapping_add(if has_input { 0 } else { self.guard_ticks.min(longest) });
    }

    /// Brings the time of the next guard forward to at most `longest` ticks from now.
    pub(super) fn hasten(&mut self, clock: u8, longest: u8) {
        if self.due_ticks(clock) > longest as i8 {
            self.due_at = clock.wrapping_add(longest);
        }
    }

    /// Ticks until the next guard without input; below 0 if it is late.
    pub(super) fn due_ticks(&self, clock: u8) -> i8 {
        self.due_at.wrapping_sub(clock) as i8
    }

    /// Bound of the sum of the group's modes in bus steps, rounded up, saturating.
    pub(super) fn mix_bound(&self) -> u64 {
        // In eighths, so that it fits 32 bits: 2^29 states of growth 4 times six modes.
        let eighths = u64::from(self.bound / 8 + 1) * GROWTH_OF_V * self.count() as u64;
        match self.exponent() - 3 {
            shift @ 0..=31 => u64::from((eighths.min(u64::from(u32::MAX)) as u32) >> shift) + 1,
            shift @ 32.. => (eighths >> shift) + 1,
            shift => eighths << -shift, // at most 2^34 · 2^29
        }
    }

    /// Smallest mix exponent with which this group's mix scale fits.
    pub(super) fn smallest_mix_exponent(&self) -> i32 {
        2 - self.exponent()
    }

    /// Bus steps for a state of 1, 2^-exponent; exponents are small enough to be a float's.
    pub(super) fn unit(&self) -> f32 {
        f32::from_bits(((127 - self.exponent()) as u32) << 23)
    }

    /// Sum of the amplitudes of the group's modes in bus steps, exact to 1e-5. `None` if one is
    /// louder than `threshold`, which a state alone usually shows at once.
    pub(super) fn amplitudes_below(&self, modes: &[Mode], threshold: f32) -> Option<f32> {
        let unit = self.unit();
        let mut sum = 0.0;
        for mode in modes {
            let (u, v) = (mode.state.u as f32 * unit, mode.state.v as f32 * unit);
            if v.abs() > threshold {
                return None;
            }
            let (sine, cosine) = Orbit::new(self.form(), mode.coefficients).phases(u, v);
            let amplitude = rounded_root(sine * sine + cosine * cosine);
            if amplitude.is_nan() || amplitude > threshold {
                return None;
            }
            sum += amplitude;
        }
        Some(sum)
    }
}

/// Ticks in which a mode of this δ (Q32) decays by half a bit, 1 to [`MAX_GUARD_TICKS`].
pub(super) fn ticks_to_half_a_bit(delta: i32) -> u8 {
    // Half a bit: 32 samples of -log2(1 - δ)/2 bits each, δ in Q32, to first order.
    const HALF_BIT: u32 = 93_000_000;
    (HALF_BIT / delta.unsigned_abs().max(1)).clamp(1, MAX_GUARD_TICKS) as u8
}

/// Exponent of gain mantissas: a mantissa g stands for `g · 2^(exponent - 31)`.
#[derive(Clone, Copy, Debug)]
pub(super) struct GainScale {
    exponent: i32,
}

impl GainScale {
    /// Mantissas of an injection (into u, into v) on this scale.
    pub(super) fn mantissas(self, (u, v): (f32, f32)) -> InputGain {
        let mantissa = |gain: f32| libm::rintf(libm::scalbnf(gain, 31 - self.exponent)) as i32;
        InputGain { u: mantissa(u), v: mantissa(v) }
    }
}

/// Shifts mantissas right by `bits`, or left if negative, for which the new exponent leaves
/// headroom.
fn shift_gains(gains: &mut [InputGain], bits: i32) {
    if bits == 0 {
        return;
    }
    let shifted = |x: i32| match bits {
        1..=31 => fixed::rounding_shift_right(x, bits as u32),
        32.. => 0,
        _ => x.wrapping_shl(bits.unsigned_abs().min(31)),
    };
    for gain in gains {
        *gain = InputGain { u: shifted(gain.u), v: shifted(gain.v) };
    }
}

/// `max(|u| · 2^k, |v|)`: the size of a state or an injection.
fn size_of(form: Form, u: i32, v: i32) -> u64 {
    (u64::from(u.unsigned_abs()) << form.shift()).max(u64::from(v.unsigned_abs()))
}

/// 2^-(shift) as a Q32 multiplier, which brings a state to the mix. Nothing above 2^-1 can occur,
/// nothing below 2^-32 is heard.
fn mix_scale(shift: i32) -> i32 {
    match shift {
        2..=32 => 1 << (32 - shift),
        _ => 0,
    }
}

/// `2 log2(x)`, rounded down; 0 for 0.
fn half_octaves(x: u32) -> i32 {
    let zeros = x.leading_zeros().min(31);
    let normal = x << zeros;
    2 * (31 - zeros as i32) + (normal >> 30 & 1) as i32
}

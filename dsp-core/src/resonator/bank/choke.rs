//! Choke and release: a hand comes to lie on a bank and goes again.
//!
//! **Law.** A hand changes the recursion alone. A mode that it reaches decays by
//! `max(d, ln(1000)/T60)`. A ringing mode keeps its last two samples, as a body keeps its
//! displacement and velocity, and the injection of a force has the same two samples as without a
//! hand. So nothing of `v` changes, and with the radius r going to r' a mode's sine becomes
//! `ρ S + (1 - ρ) C cot θ`, ρ = r'/r. The coupled form's u is `(v[n] - v[n-1]) / e`: it, and the
//! gain into it, are multiplied by `e/e'`. The shifted forms' u is the difference itself, and
//! stays.
//!
//! **Spread.** A hand reaches [`MODES_PER_TICK`](super::HAND_MODES_PER_TICK) modes of a bank at
//! each tick after its event, in the order of the table, counted without modes at or above Nyquist.
//! An event that comes meanwhile begins anew with the first mode.
//!
//! **Headroom.** A guard bounds the orbits of the present poles ([`super::super::headroom`]), and
//! the bounds have a reserve. For the shifted forms it is 4 over the 3.31 that is measured, for v 3
//! over 2.54. A coupled form's orbit grows by at most sqrt(2.67) = 1.63, so that its reserve is 3
//! over 1.63. A change multiplies an amplitude by at most [`growth_of_change`]: a bank takes as
//! many passes of a hand between two guards as the reserves of all its modes hold, and must be
//! guarded before the next. A change is large for low modes, which are of the coupled form: a hand
//! of 100 ms reaches one of 20 Hz. A bank with a mode so low that not even one pass fits is guarded
//! around each step, with exponents lowered for the u that grows.

use super::super::coefficient::{Pole, change_of_u, decay_of_t60, delta_of_t60, growth_of_change, q32_change_of_u};
use super::super::group::{MAX_GUARD_TICKS, ticks_to_half_a_bit};
use super::super::mode::Mode;
use super::super::table::BankTable;
use super::exchange::LARGEST_SHARE;
use super::origin::Origin;
use crate::SampleRate;

/// Factor by which the changes between two guards may multiply an amplitude of a form. The reserves
/// are 1.18, and 1.83 of the coupled form; a gain may be [`GAIN_GROWTH`] times as large as the
/// guard believes.
const fn reserve(is_coupled: bool) -> f64 {
    if is_coupled { 1.76 } else { 1.13 }
}

/// Factor by which a gain may grow under a hand: `e/e'` is at most 1.033, where e = 1/2 and 1 - r'
/// = 1/8.
const GAIN_GROWTH: f32 = 1.04;

/// Factor by which the largest gain of a table may grow.
pub(super) fn gain_growth(table: &BankTable<'_>) -> f32 {
    if table.choke_t60_s > 0.0 { GAIN_GROWTH } else { 1.0 }
}

/// State of a bank's hand.
#[derive(Clone, Copy, Debug)]
pub(super) struct ChokeState {
    /// True from a choke to its release.
    pub(super) lies: bool,
    /// Number of modes that the hand, or its going, has reached since its last event.
    pub(super) reached: u16,
    /// Number of passes over the modes between two guards that the headroom holds.
    pub(super) passes_per_guard: u8,
    /// Number of passes since the last guard of all groups.
    pub(super) passes: u8,
    /// Ticks without input that are left until all groups have been guarded.
    pub(super) calm_ticks: u8,
    /// Maximum number of bits by which a release may make a u larger.
    pub(super) growth_bits: u8,
    /// Ticks in which a mode under the hand decays by half a bit; 0 if the pad cannot be choked.
    pub(super) guard_ticks: u8,
}

impl ChokeState {
    /// No hand, on a bank that cannot be choked.
    pub(super) const NONE: Self =
        Self { lies: false, reached: 0, passes_per_guard: 0, passes: 0, calm_ticks: 0, growth_bits: 0, guard_ticks: 0 };

    /// True if the pad can be choked.
    #[inline(always)]
    pub(super) fn is_possible(&self) -> bool {
        self.guard_ticks > 0
    }

    /// Longest interval between two guards of a group, in ticks without input.
    #[inline(always)]
    pub(super) fn longest_guard_ticks(&self) -> u8 {
        if self.lies { self.guard_ticks } else { MAX_GUARD_TICKS as u8 }
    }

    /// Notes a guard of all groups; a pass that goes on counts from now on.
    #[inline(always)]
    pub(super) fn meet_guard(&mut self, is_passing: bool) {
        self.passes = u8::from(is_passing);
    }

    /// Lets ticks without input pass.
    #[inline(always)]
    pub(super) fn pass(&mut self, ticks: u8) {
        if self.passes > 0 {
            self.calm_ticks = self.calm_ticks.saturating_sub(ticks);
            if self.calm_ticks == 0 {
                self.passes = 0;
            }
        }
    }
}

/// Decay under the hand of a table, while its bank is loaded.
pub(super) struct Choke {
    delta: i32,
    decay_per_s: f64,
    rate: SampleRate,
}

impl Choke {
    pub(super) fn new(table: &BankTable<'_>, rate: SampleRate) -> Self {
        if table.choke_t60_s <= 0.0 {
            return Self { delta: 0, decay_per_s: 0.0, rate };
        }
        let decay_per_s = decay_of_t60(table.choke_t60_s, rate);
        Self { delta: delta_of_t60(table.choke_t60_s, rate), decay_per_s, rate }
    }

    /// Origin that a bank keeps for a mode of the table.
    pub(super) fn origin(&self, pole: &Pole, index: u16) -> Origin {
        let choked = pole.coefficients.choked(pole.form, self.delta);
        let share = q32_change_of_u(pole.coefficients, choked, LARGEST_SHARE);
        Origin { share: share.unwrap_or(0), ..Origin::new(pole.form, choked, index) }
    }

    /// Initial state of the hand of a table's bank; `origins` are those of its modes.
    pub(super) fn state(&self, table: &BankTable<'_>, origins: &[Origin], modes: &[Mode]) -> ChokeState {
        if self.delta == 0 {
            return ChokeState::NONE;
        }
        let passes = origins.iter().filter_map(|origin| {
            let record = table.modes.get(origin.index())?;
            let (frequency_hz, decay_per_s) = (record.frequency_hz.get().into(), record.decay_per_s.get().into());
            let growth = growth_of_change(frequency_hz, decay_per_s, self.decay_per_s.max(decay_per_s), self.rate);
            Some(passes_per_guard(growth, origin.is_coupled()))
        });
        let coupled = origins.iter().zip(modes).filter(|(origin, _)| origin.is_coupled());
        let released = coupled.map(|(origin, mode)| 1.0 + change_of_u(origin.other, mode.coefficients));
        let largest = released.fold(1.0f32, f32::max);
        ChokeState {
            // All modes are reached before the first hand.
            reached: u16::MAX,
            passes_per_guard: passes.min().unwrap_or(u8::MAX),
            // One for the fraction of the logarithm, and two because the states' orbits may stand
            // four times above their guard.
            growth_bits: (libm::frexpf(largest).1 + 2).clamp(2, 30) as u8,
            guard_ticks: ticks_to_half_a_bit(self.delta),
            ..ChokeState::NONE
        }
    }
}

/// Number of changes of a factor `growth` each that the reserve of a mode's form holds.
fn passes_per_guard(growth: f64, is_coupled: bool) -> u8 {
    let (mut passes, mut product) = (0, growth);
    while product <= reserve(is_coupled) && passes < u8::MAX {
        (passes, product) = (passes + 1, product * growth);
    }
    passes
}

#[cfg(test)]
mod tests {
    use super::super::super::coefficient::{Coefficients, Form};
    use super::super::super::headroom::{GROWTH, GROWTH_OF_V};
    use super::*;

    /// Steps a state of a form without rounding; gives the size of the largest state on the way.
    fn step(form: Form, (delta, epsilon): (f64, f64), (u, v): &mut (f64, f64)) -> f64 {
        let scale = f64::from(1 << form.shift());
        *u -= delta * *u;
        *u -= epsilon * *v;
        *v += if form == Form::Coupled { epsilon * *u } else { *u * scale };
        (*u * scale).abs().max(v.abs())
    }

    fn reals(coefficients: Coefficients) -> (f64, f64) {
        let unit = 2f64.powi(32);
        (f64::from(coefficients.delta) / unit, f64::from(coefficients.epsilon) / unit)
    }

    #[test]
    fn hands_between_two_guards_stay_within_the_reserve() {
        let rate = SampleRate::HZ_48000;
        let mut random = 1u32;
        let mut next = |below: u32| {
            random = random.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (random >> 8) % below
        };
        let (mut worst, mut worst_v, mut flips) = (0.0f64, 0.0f64, 0);
        for _ in 0..20_000 {
            let frequency = 20.0 * 1_190f64.powf(f64::from(next(1 << 20)) / f64::from(1 << 20));
            let rest_t60 = 0.001 * 10_000f64.powf(f64::from(next(1000)) / 1000.0);
            let choke_t60 = 0.001 * 1_000f64.powf(f64::from(next(1000)) / 1000.0);
            let rest_decay = 1000f64.ln() / rest_t60;
            let choked_decay = decay_of_t60(choke_t60, rate).max(rest_decay);
            let Some(pole) = Pole::new(frequency, rest_decay, rate) else { continue };
            let growth = growth_of_change(frequency, rest_decay, choked_decay, rate);
            let passes = passes_per_guard(growth, pole.form == Form::Coupled);
            let choked = pole.coefficients.choked(pole.form, delta_of_t60(choke_t60, rate));
            for start in [1.0, -1.0] {
                let mut state = (1.0 / f64::from(1 << pole.form.shift()), start);
                let (mut now, mut other) = (pole.coefficients, choked);
                for _ in 0..passes.min(8) {
                    for _ in 0..next(40) {
                        worst = worst.max(step(pole.form, reals(now), &mut state));
                        worst_v = worst_v.max(state.1.abs());
                    }
                    if pole.form == Form::Coupled {
                        state.0 *= 1.0 + f64::from(change_of_u(now, other));
                    }
                    core::mem::swap(&mut now, &mut other);
                    flips += 1;
                }
                for _ in 0..300 {
                    worst = worst.max(step(pole.form, reals(now), &mut state));
                    worst_v = worst_v.max(state.1.abs());
                }
            }
        }
        std::println!("{flips} changes: growth {worst:.3} of the state, {worst_v:.3} of v");
        // A gain may be larger by its growth without the guard knowing.
        let (worst, worst_v) = (worst * f64::from(GAIN_GROWTH), worst_v * f64::from(GAIN_GROWTH));
        assert!(flips > 100_000 && worst < GROWTH as f64 && worst_v < GROWTH_OF_V as f64, "{worst} {worst_v}");
    }

    #[test]
    fn a_hand_of_100_ms_needs_no_guards_around_its_steps_from_20_hz_on() {
        let passes = |frequency| {
            let growth =
                growth_of_change(frequency, 1.0, decay_of_t60(0.1, SampleRate::HZ_48000), SampleRate::HZ_48000);
            passes_per_guard(growth, true)
        };
        assert_eq!((passes(20.0), passes(80.0)), (1, 4));
    }

    #[test]
    fn a_gain_under_a_hand_grows_by_less_than_its_bound() {
        let rate = SampleRate::HZ_44100;
        let mut largest = 0.0f32;
        for frequency in (1..=355).map(|n| f64::from(n) * 10.0) {
            for choke_t60 in (0..60).map(|n| 0.001 * 1.1f64.powi(n)) {
                let Some(pole) = Pole::new(frequency, 0.1, rate).filter(|pole| pole.form == Form::Coupled) else {
                    continue;
                };
                let choked = pole.coefficients.choked(pole.form, delta_of_t60(choke_t60, rate));
                largest = largest.max(1.0 + change_of_u(pole.coefficients, choked));
            }
        }
        assert!((1.02..GAIN_GROWTH).contains(&largest), "{largest}");
    }
}

//! A hand on a bank: choke and release.
//!
//! **Law.** A hand changes the recursion alone. A mode that it reaches decays by `max(d, ln(1000)/T60)`; what rings keeps its last
//! two samples, as displacement and velocity of a body do, and what a force injects has the two samples that it has without
//! a hand. So of `v` nothing changes, and with the radius r going to r' a mode's sine becomes `ρ S + (1 - ρ) C cot θ`, ρ = r'/r.
//! The coupled form's u is `(v[n] - v[n-1]) / e`: it, and the gain into it, are multiplied by `e/e'`. The shifted forms' u is the
//! difference itself, and stays.
//!
//! **Spread.** A hand reaches [`MODES_PER_TICK`] modes of a bank at each tick behind its event, in the order of the table, counted
//! without modes at or above Nyquist. An event that comes meanwhile begins anew with the first mode.
//!
//! **Headroom.** A guard bounds the orbits of the poles that it finds ([`super::super::headroom`]), and the bounds have a
//! reserve. For the shifted forms it is 4 over the 3.31 that is measured, for v 3 over 2.54. A coupled form's orbit grows by
//! at most sqrt(2.67) = 1.63, so that its reserve is 3 over 1.63. A change makes at most [`growth_of_change`] of an amplitude:
//! a bank takes as many passes of a hand between two guards as the reserves of all its modes hold, and must be guarded before
//! the next. A change is large for low modes, which are of the coupled form: a hand of 100 ms reaches one of 20 Hz.
//! A bank with a mode so low that not even one pass fits is guarded around each step, with room for the u that grows.

use core::ops::Range;

use super::super::coefficient::{
    Coefficients, Form, Pole, change_of_u, decay_of_t60, delta_of_t60, growth_of_change, q32_change_of_u,
};
use super::super::group::{MAX_GUARD_TICKS, ticks_to_half_a_bit};
use super::super::headroom::LIMIT;
use super::super::mode::Mode;
use super::{Bank, BankTable, Origin, for_each_group};
use crate::SampleRate;
use crate::fixed;

/// Modes of a bank that a hand reaches at each tick: what fits the margin of the smaller board's budget
/// (`cargo test -p host-tests --test on_chip hand`).
pub const MODES_PER_TICK: usize = 16;

/// Largest share of itself by which a u grows or shrinks for which [`inverse`] holds.
const LARGEST_SHARE: u32 = 1 << 24;

/// What the changes between two guards may make of an amplitude of this form. The reserves are 1.18, and 1.83 of the coupled
/// form; a gain may be [`GAIN_ROOM`] times as large as the guard believes.
const fn reserve(is_coupled: bool) -> f64 {
    if is_coupled { 1.76 } else { 1.13 }
}

/// What a gain may grow by under a hand: `e/e'` is at most 1.033, where e = 1/2 and 1 - r' = 1/8.
const GAIN_ROOM: f32 = 1.04;

/// Ticks without input after which all groups have been guarded: the longest interval, and what one may be late.
const CALM_TICKS: u8 = 96;

/// What a bank knows of its hand.
#[derive(Clone, Copy, Debug)]
pub(super) struct HandState {
    /// True from a choke to its release.
    pub(super) lies: bool,
    /// Number of modes that the hand, or its going, has reached since its last event.
    reached: u16,
    /// Number of passes over the modes between two guards that the headroom holds.
    passes_per_guard: u8,
    /// Number of passes since the last guard of all groups.
    passes: u8,
    /// Ticks without input that are left until all groups have been guarded.
    calm_ticks: u8,
    /// Most bits by which a release may make a u larger.
    room_bits: u8,
    /// Ticks in which a mode under the hand decays by half a bit; 0 if the pad cannot be choked.
    guard_ticks: u8,
}

impl HandState {
    /// No hand, and none that can come.
    pub(super) const NONE: Self =
        Self { lies: false, reached: 0, passes_per_guard: 0, passes: 0, calm_ticks: 0, room_bits: 0, guard_ticks: 0 };

    /// True if the pad can be choked.
    #[inline(always)]
    fn is_possible(&self) -> bool {
        self.guard_ticks > 0
    }

    /// Longest interval between two guards of a group, in ticks without input.
    #[inline(always)]
    pub(super) fn longest_guard_ticks(&self) -> u8 {
        if self.lies { self.guard_ticks } else { MAX_GUARD_TICKS as u8 }
    }

    /// All groups have been guarded; a pass that goes on counts from now on.
    #[inline(always)]
    pub(super) fn meet_guard(&mut self, is_passing: bool) {
        self.passes = u8::from(is_passing);
    }

    /// Ticks without input have passed.
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

/// The hand of a table, while its bank is loaded.
pub(super) struct Hand {
    delta: i32,
    decay_per_s: f64,
    rate: SampleRate,
}

impl Hand {
    pub(super) fn new(table: &BankTable<'_>, rate: SampleRate) -> Self {
        if table.choke_t60_s <= 0.0 {
            return Self { delta: 0, decay_per_s: 0.0, rate };
        }
        let decay_per_s = decay_of_t60(table.choke_t60_s, rate);
        Self { delta: delta_of_t60(table.choke_t60_s, rate), decay_per_s, rate }
    }

    /// What a bank keeps of a pole.
    pub(super) fn origin(&self, pole: &Pole, index: u16) -> Origin {
        let choked = pole.coefficients.choked(pole.form, self.delta);
        let share = q32_change_of_u(pole.coefficients, choked, LARGEST_SHARE);
        Origin { share: share.unwrap_or(0), ..Origin::new(pole.form, choked, index) }
    }

    /// What the largest gain may grow by.
    pub(super) fn gain_room(&self) -> f32 {
        if self.delta > 0 { GAIN_ROOM } else { 1.0 }
    }

    /// What the bank of a table knows of it; `origins` are those of its modes.
    pub(super) fn of(&self, table: &BankTable<'_>, origins: &[Origin], modes: &[Mode]) -> HandState {
        if self.delta == 0 {
            return HandState::NONE;
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
        HandState {
            // Nothing is left to reach before the first hand.
            reached: u16::MAX,
            passes_per_guard: passes.min().unwrap_or(u8::MAX),
            // One for the fraction of the logarithm, and two as the states' orbits may stand four times above their guard.
            room_bits: (libm::frexpf(largest).1 + 2).clamp(2, 30) as u8,
            guard_ticks: ticks_to_half_a_bit(self.delta),
            ..HandState::NONE
        }
    }
}

/// Number of changes that a mode's reserve holds, each of which makes at most so much of its amplitude.
fn passes_per_guard(growth: f64, is_coupled: bool) -> u8 {
    let (mut passes, mut product) = (0, growth);
    while product <= reserve(is_coupled) && passes < u8::MAX {
        (passes, product) = (passes + 1, product * growth);
    }
    passes
}

/// Puts the slots of the modes into the origins, in the order of the table.
pub(super) fn set_order(origins: &mut [Origin]) {
    for slot in 0..origins.len() {
        let Some(index) = origins.get(slot).map(Origin::index) else { return };
        let place = origins.iter().filter(|origin| origin.index() < index).count();
        if let Some(origin) = origins.get_mut(place) {
            origin.slot = slot as u16; // banks count in 16 bits
        }
    }
}

impl Origin {
    /// The mode is under a hand.
    const HELD: u16 = 1 << 15;
    /// The mode is of the coupled form.
    const COUPLED: u16 = 1 << 14;

    pub(super) fn new(form: Form, choked: Coefficients, index: u16) -> Self {
        let coupled = if form == Form::Coupled { Self::COUPLED } else { 0 };
        const { assert!(crate::table::range::MODES_PER_BANK <= Self::COUPLED as usize) };
        Self { other: choked, share: 0, index_and_flags: index | coupled, slot: 0 }
    }

    /// The mode's index in the table.
    pub(super) fn index(&self) -> usize {
        usize::from(self.index_and_flags & (Self::COUPLED - 1))
    }

    fn is_coupled(&self) -> bool {
        self.index_and_flags & Self::COUPLED != 0
    }

    fn is_held(&self) -> bool {
        self.index_and_flags & Self::HELD != 0
    }

    /// The coefficients without a hand of a mode that has `present` ones.
    pub(super) fn at_rest(&self, present: Coefficients) -> Coefficients {
        if self.is_held() { self.other } else { present }
    }

    /// What the hand makes of a gain into u that was derived without it.
    pub(super) fn held_gain(&self, present: Coefficients, gain: i32) -> i32 {
        let change = if self.is_held() && self.is_coupled() { change_of_u(self.other, present) } else { 0.0 };
        grown(gain, change)
    }
}

/// A number that grows by a share of itself, rounded towards what it was.
#[inline(always)]
fn grown(number: i32, share: f32) -> i32 {
    number.saturating_add((number as f32 * share) as i32)
}

/// Both numbers of a mode that belong to u grow by a share of themselves.
fn grow(mode: &mut Mode, share: f32) {
    mode.gain.u = grown(mode.gain.u, share);
    mode.state.u = grown(mode.state.u, share);
}

/// Gives the modes at these places of the table's order the coefficients that they have with a hand (`LIES`) or without, and calls
/// `scale` with the slot of each of the coupled form, the mode, its share and the coefficients that it had.
#[inline(always)]
fn exchange<const LIES: bool>(
    modes: &mut [Mode],
    origins: &mut [Origin],
    places: Range<usize>,
    mut scale: impl FnMut(usize, &mut Mode, i32, Coefficients),
) {
    // One length for both: one check a mode.
    let count = modes.len().min(origins.len());
    let (Some(modes), Some(origins)) = (modes.get_mut(..count), origins.get_mut(..count)) else { return };
    for place in places {
        let Some(slot) = origins.get(place).map(|origin| usize::from(origin.slot)) else { return };
        let (Some(mode), Some(origin)) = (modes.get_mut(slot), origins.get_mut(slot)) else { return };
        let flags = origin.index_and_flags;
        if (flags & Origin::HELD != 0) == LIES {
            continue;
        }
        origin.index_and_flags = flags ^ Origin::HELD;
        let from = core::mem::replace(&mut mode.coefficients, origin.other);
        origin.other = from;
        if flags & Origin::COUPLED != 0 {
            scale(slot, mode, origin.share, from);
        }
    }
}

/// What the hand makes of a mode's u and of the gain into it, both of which its share is of.
#[inline(always)]
fn exchange_quickly<const LIES: bool>(modes: &mut [Mode], origins: &mut [Origin], places: Range<usize>) {
    exchange::<LIES>(modes, origins, places, |_, mode, share, from| {
        if share == 0 {
            return grow_much(mode, from);
        }
        let share = if LIES { share } else { inverse(share) };
        // A gain has room, and a state stays within the headroom.
        mode.gain.u = mode.gain.u.wrapping_add(fixed::smmulr(mode.gain.u, share));
        mode.state.u = mode.state.u.wrapping_add(fixed::smmulr(mode.state.u, share));
    });
}

/// A change of a low mode, for which [`inverse`] is not precise enough.
#[cold]
#[inline(never)]
fn grow_much(mode: &mut Mode, from: Coefficients) {
    grow(mode, change_of_u(from, mode.coefficients));
}

/// `1/(1 + s) - 1` in Q32 for an s below [`LARGEST_SHARE`]: what s makes larger becomes what it was. Within 2^-31.
#[inline(always)]
fn inverse(share: i32) -> i32 {
    let square = fixed::smmulr(share, share);
    square - share - fixed::smmulr(square, share)
}

impl Bank<'_> {
    /// A hand comes or goes: it reaches the modes by [`Bank::reach`]. Gives how many groups were guarded before.
    pub fn lay_hand(&mut self, lies: bool) -> u32 {
        if !self.hand.is_possible() || lies == self.hand.lies {
            return 0;
        }
        let needs_guard = self.ringing_modes > 0 && self.hand.passes >= self.hand.passes_per_guard;
        if needs_guard {
            self.settle();
        }
        (self.hand.lies, self.hand.reached) = (lies, 0);
        self.hand.passes = self.hand.passes.saturating_add(1);
        // Under a hand guards come more often.
        self.due_ticks = self.due_ticks.min(self.hand.longest_guard_ticks());
        if needs_guard { self.group_count() } else { 0 }
    }

    /// True if each of a hand's steps needs a guard of all ringing groups.
    pub fn hand_is_guarded(&self) -> bool {
        self.ringing_modes > 0 && self.hand.passes_per_guard == 0
    }

    /// True if a hand comes or goes that has not reached all modes yet.
    #[inline(always)]
    pub fn is_being_reached(&self) -> bool {
        self.hand.is_possible() && usize::from(self.hand.reached) < self.modes.len()
    }

    /// Number of modes that the next [`Bank::reach`] looks at.
    pub fn modes_to_reach(&self) -> usize {
        if !self.is_being_reached() {
            return 0;
        }
        (self.modes.len() - usize::from(self.hand.reached)).min(MODES_PER_TICK)
    }

    /// A hand that comes or goes reaches the next modes, at each tick. It costs [`crate::engine::Part::ChokedMode`] a mode.
    #[inline(never)]
    pub fn reach(&mut self) {
        let first = usize::from(self.hand.reached);
        let places = first..first + self.modes_to_reach();
        self.hand.reached = places.end as u16; // banks count in 16 bits
        self.hand.calm_ticks = CALM_TICKS;
        if self.hand_is_guarded() || self.second.is_set {
            return self.reach_with_care(places);
        }
        let (modes, origins) = (&mut *self.modes, &mut *self.origins);
        if self.hand.lies {
            exchange_quickly::<true>(modes, origins, places);
        } else {
            exchange_quickly::<false>(modes, origins, places);
        }
    }

    /// [`Bank::reach`] where there are gains of a second position, or states that may be clipped.
    #[inline(never)] // few banks need it
    fn reach_with_care(&mut self, places: Range<usize>) {
        let is_guarded = self.hand_is_guarded();
        if is_guarded {
            let bits = self.hand.room_bits;
            for_each_group(self.modes, self.groups, |group, modes| {
                group.make_room(modes, bits);
            });
        }
        let (modes, origins) = (&mut *self.modes, &mut *self.origins);
        let seconds = if self.second.is_set { &mut *self.second.gains } else { &mut [] };
        let change = |slot: usize, mode: &mut Mode, _, from| {
            let share = change_of_u(from, mode.coefficients);
            grow(mode, share);
            if let Some(second) = seconds.get_mut(slot) {
                second.u = grown(second.u, share);
            }
            if is_guarded {
                // Where no exponent is small enough for the room, which only a fault can bring about.
                mode.state.u = mode.state.u.clamp(-(LIMIT as i32), LIMIT as i32);
            }
        };
        if self.hand.lies {
            exchange::<true>(modes, origins, places, change);
        } else {
            exchange::<false>(modes, origins, places, change);
        }
        if is_guarded {
            self.settle();
        }
    }

    /// Guards all ringing groups for what their input may still bring.
    fn settle(&mut self) {
        if self.allowance == 0 {
            self.guard_all_at_rest();
        } else {
            self.guard(self.allowance, false);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::super::headroom::{GROWTH, GROWTH_OF_V};
    use super::*;

    /// Steps a state of a form without rounding; gives the size of what it comes by.
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
        // A gain that the guard does not know of is larger by its room.
        let (worst, worst_v) = (worst * f64::from(GAIN_ROOM), worst_v * f64::from(GAIN_ROOM));
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
    fn a_gain_under_a_hand_grows_by_less_than_its_room() {
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
        assert!((1.02..GAIN_ROOM).contains(&largest), "{largest}");
    }
}

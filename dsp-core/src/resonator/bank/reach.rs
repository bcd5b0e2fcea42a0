//! A hand on a bank: it comes or goes, and reaches the modes tick by tick.

use core::ops::Range;

use super::super::coefficient::change_of_u;
use super::super::headroom::LIMIT;
use super::super::mode::Mode;
use super::exchange::{exchange, exchange_quickly, grow};
use super::origin::grown;
use super::state::{Bank, for_each_group};

/// Number of modes of a bank that a hand reaches at each tick: as many as fit the smaller board's
/// budget (`cargo test -p host-tests --test on_chip hand`).
pub const MODES_PER_TICK: usize = 16;

/// Ticks without input after which all groups have been guarded: the longest interval, and the
/// largest delay.
const CALM_TICKS: u8 = 96;

impl Bank<'_> {
    /// Begins a hand's coming or going; [`Bank::reach`] then takes it to the modes. Gives the
    /// number of groups that were guarded before.
    pub fn lay_hand(&mut self, lies: bool) -> u32 {
        if !self.choke.is_possible() || lies == self.choke.lies {
            return 0;
        }
        let needs_guard = self.ringing_modes > 0 && self.choke.passes >= self.choke.passes_per_guard;
        if needs_guard {
            self.settle();
        }
        (self.choke.lies, self.choke.reached) = (lies, 0);
        self.choke.passes = self.choke.passes.saturating_add(1);
        // Under a hand guards come more often.
        self.due_ticks = self.due_ticks.min(self.choke.longest_guard_ticks());
        if needs_guard { self.group_count() } else { 0 }
    }

    /// True if each of a hand's steps needs a guard of all ringing groups.
    pub fn hand_is_guarded(&self) -> bool {
        self.ringing_modes > 0 && self.choke.passes_per_guard == 0
    }

    /// True if a hand comes or goes that has not reached all modes yet.
    #[inline(always)]
    pub fn is_being_reached(&self) -> bool {
        self.choke.is_possible() && usize::from(self.choke.reached) < self.modes.len()
    }

    /// Number of modes that the next [`Bank::reach`] looks at.
    pub fn modes_to_reach(&self) -> usize {
        if !self.is_being_reached() {
            return 0;
        }
        (self.modes.len() - usize::from(self.choke.reached)).min(MODES_PER_TICK)
    }

    /// Number of modes that a hand which comes or goes reaches within some ticks.
    pub fn modes_of_hand(&self, ticks: u8) -> usize {
        if !self.choke.is_possible() {
            return 0;
        }
        self.modes.len().min(usize::from(ticks) * MODES_PER_TICK)
    }

    /// Takes a hand that comes or goes to the next modes; called at each tick. It costs
    /// [`crate::engine::CostItem::ChokedMode`] a mode.
    #[inline(never)]
    pub fn reach(&mut self) {
        let first = usize::from(self.choke.reached);
        let places = first..first + self.modes_to_reach();
        self.choke.reached = places.end as u16; // banks count in 16 bits
        self.choke.calm_ticks = CALM_TICKS;
        if self.hand_is_guarded() || self.second.is_set {
            return self.reach_with_care(places);
        }
        let (modes, origins) = (&mut *self.modes, &mut *self.origins);
        if self.choke.lies {
            exchange_quickly::<true>(modes, origins, places);
        } else {
            exchange_quickly::<false>(modes, origins, places);
        }
    }

    /// Reaches modes of a bank with gains of a second position, or with states that may be clipped.
    #[inline(never)] // few banks need it
    fn reach_with_care(&mut self, places: Range<usize>) {
        let is_guarded = self.hand_is_guarded();
        if is_guarded {
            let bits = self.choke.growth_bits;
            for_each_group(self.modes, self.groups, |group, modes| {
                group.lower_for_growth(modes, bits);
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
                // Only a fault can make states so large that no exponent is small enough.
                mode.state.u = mode.state.u.clamp(-(LIMIT as i32), LIMIT as i32);
            }
        };
        if self.choke.lies {
            exchange::<true>(modes, origins, places, change);
        } else {
            exchange::<false>(modes, origins, places, change);
        }
        if is_guarded {
            self.settle();
        }
    }

    /// Guards all ringing groups for the rest of their allowance.
    fn settle(&mut self) {
        if self.allowance == 0 {
            self.guard_all_at_rest();
        } else {
            self.guard(self.allowance, false);
        }
    }
}

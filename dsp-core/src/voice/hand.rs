//! A hand on a pad: it chokes the pad, or lets it ring again.

use super::residual::Residual;
use super::state::Voice;
use crate::frames::FrameBank;
use crate::resonator::Bank;

impl Voice<'_, '_> {
    /// Asks for the pad to be choked, or released.
    pub fn want_choke(&mut self, is_choked: bool) {
        (self.is_choke_wanted, self.choke_late_ticks) = (is_choked, 0);
    }

    /// True if a choke or a release was asked for that has not been carried out.
    pub fn is_choke_due(&self) -> bool {
        self.is_choke_wanted != self.is_choked
    }

    /// True if a choke or a release that is due may wait: nothing sounds that it would change.
    pub(crate) fn can_choke_later(&self) -> bool {
        let has_noise = self.residual.as_deref().is_some_and(Residual::is_active);
        self.frames.is_none() && !self.is_ringing() && !self.filters_join_in(false) && !has_noise
    }

    /// Lets a choke or a release that is due wait for a tick.
    pub(crate) fn choke_later(&mut self) {
        self.choke_late_ticks = self.choke_late_ticks.saturating_add(1);
    }

    /// True if a choke or a release has waited.
    pub(crate) fn is_choke_late(&self) -> bool {
        self.choke_late_ticks > 0
    }

    /// Number of modes that [`Voice::change_choke`] reaches at once, because it is late.
    pub(crate) fn late_choke_modes(&self) -> u32 {
        if !self.is_choke_late() {
            return 0;
        }
        self.banks.iter().map(|bank| bank.modes_of_hand(self.choke_late_ticks) as u32).sum()
    }

    /// True if the pad is choked.
    pub fn is_choked(&self) -> bool {
        self.is_choked
    }

    /// Chokes or releases the pad as was asked for; each [`Voice::tick`] that follows reaches some
    /// modes. Gives the number of groups that were guarded.
    pub fn change_choke(&mut self) -> u32 {
        self.is_choked = self.is_choke_wanted;
        self.wake_banks();
        let is_choked = self.is_choked;
        self.frames.iter_mut().for_each(|frames| frames.lay_hand(is_choked));
        let (mut guards, late_ticks) = (0, core::mem::take(&mut self.choke_late_ticks));
        for bank in &mut *self.banks {
            guards += bank.lay_hand(is_choked);
            for _ in 0..late_ticks {
                if !bank.is_being_reached() {
                    break;
                }
                bank.reach();
            }
        }
        guards
    }

    /// True if a choke or a release has not reached all modes yet.
    pub fn is_being_reached(&self) -> bool {
        self.banks.iter().any(Bank::is_being_reached) || self.frames.as_deref().is_some_and(FrameBank::is_hand_moving)
    }
}

//! Positions: each contact drives the gains of the place that it strikes.
//!
//! A bank plays force at two positions at a time, its **slots**. The modes hold the gains of slot
//! 0. Those of slot 1 lie in a slice of their own, if there is memory for it:
//! [`Bank::take_second`]. In each frame the force in slot 1 is injected behind that in slot 0
//! ([`kernel::driven_twice`](super::super::kernel::driven_twice)). A copy of the modes, driven over
//! a run and added at its end, would round differently wherever a caller cuts a block. While slot 1
//! has no force, none of this takes any time.
//!
//! A strike takes the slot of its position; else one that no contact drives, slot 0 first; else,
//! merged, the slot whose position is nearer.

use super::super::coefficient::Pole;
use super::super::gain::GainLaw;
use super::super::group::{GROUP_MODES, Group};
use super::super::mode::InputGain;
use super::super::table::BankTable;
use super::choke::gain_growth;
use super::slot::Place;
use super::state::{Bank, for_each_group};
use crate::SampleRate;
use crate::memory::{Memory, OutOfMemory, Region};

impl<'m> Bank<'m> {
    /// Takes memory for the gains of a second position.
    ///
    /// # Errors
    /// [`OutOfMemory`]; the bank then has one slot, in which contacts of other positions merge.
    pub fn take_second(&mut self, memory: &mut Memory<'m>, modes: usize) -> Result<(), OutOfMemory> {
        self.second.gains = memory.take(Region::Fast, modes, InputGain::default)?;
        Ok(())
    }

    /// True if the table has several positions.
    pub fn has_positions(&self) -> bool {
        self.second.has_positions
    }

    /// True if slot 1 may have a force.
    #[inline(always)]
    pub fn has_second_gains(&self) -> bool {
        self.second.is_set
    }

    /// True if contacts of a second position need not merge.
    pub fn can_take_second(&self) -> bool {
        !self.second.gains.is_empty()
    }

    /// Slot for a strike at a position; `is_driven` says which slots contacts drive.
    pub fn place(&self, position: f32, is_driven: impl Fn(u8) -> bool) -> Place {
        let has = |slot_position: f32| slot_position == position;
        if !self.second.has_positions || has(self.position) {
            return Place::FIRST;
        }
        if self.second.is_set && has(self.second.position) {
            return Place { slot: 1, ..Place::FIRST };
        }
        if !is_driven(0) {
            return Place { moves: true, ..Place::FIRST };
        }
        if self.can_take_second() && !is_driven(1) {
            return Place { slot: 1, moves: true, is_merged: false };
        }
        let distance = |slot_position: f32| (slot_position - position).abs();
        let is_nearer = self.second.is_set && distance(self.second.position) < distance(self.position);
        Place { slot: u8::from(is_nearer), moves: false, is_merged: true }
    }

    /// Moves a slot for the contacts that follow: gains are interpolated between the table's
    /// positions. [`Bank::expect`] must follow before any force.
    ///
    /// It costs [`crate::engine::CostItem::MovedMode`] a mode and
    /// [`crate::engine::CostItem::MovedGroup`] a group.
    pub fn set_position(&mut self, slot: u8, position: f32, table: &BankTable<'_>, rate: SampleRate) {
        if !self.second.has_positions || slot == 1 && !self.can_take_second() {
            return;
        }
        let is_second = slot == 1;
        if is_second {
            (self.second.position, self.second.is_set) = (position, true);
        } else {
            self.position = position;
        }
        let mut seconds = if self.second.is_set { &mut *self.second.gains } else { &mut [] };
        let law = GainLaw::new(table, rate, position);
        let growth = gain_growth(table);
        let (mut rest, mut taken) = (&*self.origins, 0.0);
        for_each_group(self.modes, self.groups, |group, modes| {
            let (origins, later) = rest.split_at_checked(modes.len()).unwrap_or((rest, &[]));
            rest = later;
            let all = core::mem::take(&mut seconds);
            let count = modes.len().min(all.len());
            let (second, later) = all.split_at_mut_checked(count).unwrap_or((&mut [], &mut []));
            seconds = later;
            let mut injections = [(0.0, 0.0); GROUP_MODES];
            for ((injection, mode), origin) in injections.iter_mut().zip(&*modes).zip(origins) {
                let coefficients = origin.at_rest(mode.coefficients);
                let pole = Pole { form: group.form(), mirrored: group.mirrored(), coefficients };
                let gain = law.of(pole, origin.index());
                taken += gain.taken;
                *injection = gain.injection;
            }
            let scale = Group::gain_scale(group.form(), growth, &injections);
            let mut moved = [InputGain::default(); GROUP_MODES];
            let moved = moved.get_mut(..modes.len()).unwrap_or(&mut []);
            for (((gain, mode), origin), &injection) in moved.iter_mut().zip(&*modes).zip(origins).zip(&injections) {
                *gain = scale.mantissas(injection);
                gain.u = origin.held_gain(mode.coefficients, gain.u);
            }
            // Gains of the other slot stay; slot 1 has none before it is set.
            let mut kept = [InputGain::default(); GROUP_MODES];
            let kept = kept.get_mut(..second.len()).unwrap_or(&mut []);
            match is_second {
                true => kept.iter_mut().zip(&*modes).for_each(|(gain, mode)| *gain = mode.gain),
                false => kept.iter_mut().zip(&*second).for_each(|(gain, second)| *gain = *second),
            }
            group.share_gains(scale, moved, kept, growth);
            let (of_first, of_second) = if is_second { (kept, moved) } else { (moved, kept) };
            modes.iter_mut().zip(of_first).for_each(|(mode, gain)| mode.gain = *gain);
            second.iter_mut().zip(of_second).for_each(|(second, gain)| *second = *gain);
        });
        self.costs.count(self.groups);
        let onset = law.onset(taken);
        if is_second {
            self.second.onset = onset;
        } else {
            self.onset = onset;
        }
    }
}

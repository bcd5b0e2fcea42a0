//! From a table to a bank.

use super::super::gain::{GainLaw, check_gains};
use super::super::group::{GROUP_MODES, Group};
use super::super::mode::Mode;
use super::super::order::{order_key, order_modes, pole_of, rendered};
use super::super::table::{BankError, BankTable};
use super::choke::{Choke, gain_growth};
use super::origin::{Origin, set_order};
use super::state::Bank;
use crate::SampleRate;
use crate::memory::{Memory, OutOfMemory, Region};

/// Sizes of the slices that a bank takes from lent memory.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct BankSize {
    /// Number of modes below Nyquist.
    pub modes: usize,
    /// Number of register groups: a sixth of the modes, and up to six more.
    pub groups: usize,
    /// Number of modes with an [`Origin`]: all modes of a bank that can be choked or has several
    /// positions, else 0.
    pub origins: usize,
}

impl<'m> Bank<'m> {
    /// Size of the bank of a table at a sample rate, without modes at or above Nyquist.
    ///
    /// # Errors
    /// A [`BankError`] for a table that no bank can hold.
    pub fn size(table: &BankTable<'_>, rate: SampleRate) -> Result<BankSize, BankError> {
        check_gains(table, rate)?;
        let mut of_form = [0usize; 8];
        for mode in rendered(table, rate) {
            if let Some(count) = of_form.get_mut(mode?.key() as usize) {
                *count += 1;
            }
        }
        let modes = of_form.iter().sum();
        let keeps_origins = table.positions > 1 || table.choke_t60_s > 0.0;
        Ok(BankSize {
            modes,
            groups: of_form.iter().map(|count| count.div_ceil(GROUP_MODES)).sum(),
            origins: if keeps_origins { modes } else { 0 },
        })
    }

    /// Takes the memory of a bank, at rest and without modes.
    ///
    /// # Errors
    /// [`OutOfMemory`].
    pub fn take(memory: &mut Memory<'m>, size: BankSize) -> Result<Self, OutOfMemory> {
        Ok(Self {
            modes: memory.take(Region::Fast, size.modes, || Mode::SILENT)?,
            groups: memory.take(Region::Fast, size.groups, || Group::EMPTY)?,
            origins: memory.take(Region::Fast, size.origins, || Origin::NONE)?,
            ..Self::empty()
        })
    }

    /// Derives the bank of a table in the memory that was taken for its [`size`](Self::size).
    ///
    /// Modes are ordered by side (mirrored or not) and form and, within a form, by the time for
    /// which a typical strike keeps them audible, so that modes that end together share a group.
    ///
    /// # Errors
    /// A [`BankError`]; the bank is then not to be played.
    pub fn load(&mut self, table: &BankTable<'_>, rate: SampleRate) -> Result<(), BankError> {
        check_gains(table, rate)?;
        order_modes(table, rate, self.modes)?;
        let mut taken = 0.0;
        let choke = Choke::new(table, rate);
        let law = GainLaw::new(table, rate, 0.0);
        let mut start = 0;
        let mut group_slots = self.groups.iter_mut();
        while let Some(first) = self.modes.get(start) {
            let key = order_key(first);
            let same = self.modes.get(start..).unwrap_or(&[]).iter().take(GROUP_MODES);
            let count = same.take_while(|mode| order_key(mode) == key).count();
            let Some(group_slot) = group_slots.next() else { break };
            let group_modes = self.modes.get_mut(start..start + count).unwrap_or(&mut []);
            let mut injections = [(0.0, 0.0); GROUP_MODES];
            for (slot, (mode, injection)) in group_modes.iter_mut().zip(&mut injections).enumerate() {
                let index = mode.state.u as usize;
                let Some(pole) = table.modes.get(index).and_then(|record| pole_of(record, rate)) else { continue };
                *mode = Mode { coefficients: pole.coefficients, ..Mode::SILENT };
                let gain = law.of(pole, index);
                taken += gain.taken;
                *injection = gain.injection;
                if slot == 0 {
                    *group_slot = Group::new(pole.form, pole.mirrored, count as u8);
                    if !pole.mirrored {
                        self.plain_modes += count as u16; // at most GROUP_MODES each
                        self.plain_groups += 1;
                    }
                }
                if let Some(origin) = self.origins.get_mut(start + slot) {
                    *origin = choke.origin(&pole, index as u16);
                }
            }
            group_slot.set_gains(group_modes, gain_growth(table), &injections);
            group_slot.schedule_guards(group_modes);
            start += count;
        }
        self.count_guards();
        self.second.has_positions = table.positions > 1;
        self.choke = choke.state(table, self.origins, self.modes);
        set_order(self.origins);
        self.onset = law.onset(taken);
        self.costs.count(self.groups);
        Ok(())
    }
}

//! From a table to a bank.

use super::super::gain::{check_gains, gain_law, onset, orbit_gains, taken_at_once};
use super::super::group::{GROUP_MODES, Group};
use super::super::mode::Mode;
use super::super::order::{order_key, order_modes, pole_of};
use super::hand::{Hand, set_order};
use super::{Bank, BankError, BankTable, Memory, Span, Used};
use crate::SampleRate;

impl Bank {
    /// Derives a bank from a table for a sample rate and puts it behind what is `used`.
    ///
    /// Modes at or above Nyquist are left out. The others are ordered by side (mirrored or not) and form and, within a form, by how long a typical
    /// strike keeps them audible, so that modes that end together share a group.
    ///
    /// # Errors
    /// A [`BankError`]; the memory behind `used` is then unspecified, `used` unchanged.
    pub fn load(
        table: &BankTable<'_>,
        rate: SampleRate,
        memory: &mut Memory<'_>,
        used: &mut Used,
    ) -> Result<Self, BankError> {
        check_gains(table, rate)?;
        let keeps_origins = table.positions > 1 || table.choke_t60_s > 0.0;
        let modes = order_modes(table, rate, memory.modes, used.modes)?;
        let origins = used.origins..used.origins + if keeps_origins { modes.len() } else { 0 };
        if origins.end > memory.origins.len() {
            return Err(BankError::TooManyOrigins);
        }
        let mut bank = Self {
            modes: Span::new(modes.clone()).ok_or(BankError::TooManyModes)?,
            origins: Span::new(origins.clone()).ok_or(BankError::TooManyOrigins)?,
            ..Self::EMPTY
        };
        let mut group_end = used.groups;
        let mut taken = 0.0;
        let hand = Hand::new(table, rate);
        let mut start = modes.start;
        while let Some(first) = memory.modes.get(start).filter(|_| start < modes.end) {
            let key = order_key(first);
            let same = memory.modes.get(start..modes.end).unwrap_or(&[]).iter().take(GROUP_MODES);
            let count = same.take_while(|mode| order_key(mode) == key).count();
            let group_slot = memory.groups.get_mut(group_end).ok_or(BankError::TooManyGroups)?;
            let group_modes = memory.modes.get_mut(start..start + count).unwrap_or(&mut []);
            let mut indices = [0usize; GROUP_MODES];
            for (slot, (mode, index)) in group_modes.iter_mut().zip(&mut indices).enumerate() {
                *index = mode.state.u as usize;
                let pole =
                    table.modes.get(*index).and_then(|record| pole_of(record, rate)).ok_or(BankError::TooManyModes)?;
                *mode = Mode { coefficients: pole.coefficients, ..Mode::SILENT };
                taken += taken_at_once(table, pole, *index, 0.0);
                if slot == 0 {
                    *group_slot = Group::new(pole.form, pole.mirrored, count as u8);
                    if !pole.mirrored {
                        bank.plain_modes += count as u16; // at most GROUP_MODES each
                        bank.plain_groups += 1;
                    }
                }
                if keeps_origins {
                    let origin = origins.start + start - modes.start + slot;
                    if let Some(origin) = memory.origins.get_mut(origin) {
                        *origin = hand.origin(&pole, *index as u16);
                    }
                }
            }
            let gain = gain_law(table, rate, 0.0);
            let gains = orbit_gains(group_slot, |slot| gain(indices.get(slot).copied()), |_, mode| mode.coefficients);
            group_slot.set_gains(group_modes, hand.gain_room(), gains);
            group_slot.schedule_guards(group_modes);
            start += count;
            group_end += 1;
        }
        bank.groups = Span::new(used.groups..group_end).ok_or(BankError::TooManyGroups)?;
        bank.count_guards(memory);
        let own_origins = memory.origins.get_mut(bank.origins.range()).unwrap_or(&mut []);
        bank.second.has_positions = table.positions > 1;
        bank.hand = hand.of(table, own_origins, memory.modes.get(bank.modes.range()).unwrap_or(&[]));
        set_order(own_origins);
        bank.onset = onset(taken, table, rate);
        *used = Used { modes: modes.end, groups: group_end, origins: origins.end, ..*used };
        Ok(bank)
    }
}

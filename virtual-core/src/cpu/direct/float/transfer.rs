//! Moves between registers, loads and stores of the FPU (DDI 0403 A7.7, VMOV, VMRS, VLDR, VLDM).

use rsemu::cpu::arm::v7m::fp::fpscr;
use rsemu::cpu::arm::v7m::xpsr;

use super::{Direct, SINGLES};

/// Number of FPSCR in VMRS and VMSR.
const FPSCR: u8 = 1;

impl Direct {
    #[inline]
    pub(super) fn move_core(&mut self, to_float: bool, rt: u8, n: u8) -> Option<()> {
        if to_float {
            self.floats.set(n, self.get(rt));
        } else {
            self.set(rt, self.floats.get(n));
        }
        Some(())
    }

    #[inline]
    pub(super) fn move_core_pair(&mut self, to_float: bool, core: [u8; 2], m: u8) -> Option<()> {
        for (register, single) in core.into_iter().zip(m..) {
            self.move_core(to_float, register, single)?;
        }
        Some(())
    }

    /// Moves FPSCR from or to a core register, or its condition flags to those of the program.
    #[inline]
    pub(super) fn move_status(&mut self, to_core: bool, rt: u8, register: u8) -> Option<()> {
        if register != FPSCR {
            return None;
        }
        let status = self.floats.status;
        if !to_core {
            self.floats.status = self.get(rt) & fpscr::WRITABLE;
        } else if rt == 15 {
            const CONDITIONS: u32 = xpsr::N | xpsr::Z | xpsr::C | xpsr::V;
            self.registers.xpsr = self.registers.xpsr & !CONDITIONS | status & fpscr::FLAGS;
        } else {
            self.set(rt, status);
        }
        Some(())
    }

    /// Loads or stores `count` registers from `first` on. If a word lies outside the memory nothing
    /// changes, and the instruction is left to `rsemu`.
    #[inline]
    pub(super) fn transfer_singles(&mut self, load: bool, address: u32, first: u8, count: u8) -> Option<()> {
        let addresses = (0..u32::from(count)).map(|word| address.wrapping_add(4 * word));
        if count == 1 {
            if load {
                self.floats.set(first, self.load(address, 4)?);
            } else {
                self.store(address, 4, self.floats.get(first))?;
            }
            return Some(());
        }
        // Reading proves that all words are in memory, so that only the first store can be refused.
        let mut words = [0; SINGLES];
        for (word, address) in words.iter_mut().zip(addresses.clone()) {
            *word = self.load(address, 4)?;
        }
        for ((single, word), address) in (first..).zip(words).zip(addresses) {
            if load {
                self.floats.set(single, word);
            } else {
                self.store(address, 4, self.floats.get(single))?;
            }
        }
        Some(())
    }

    /// Loads or stores a list of `count` registers from `first` on at the address in a base
    /// register, or below it unless `upwards`.
    #[inline]
    pub(super) fn transfer_list(
        &mut self,
        load: bool,
        [first, count, rn]: [u8; 3],
        upwards: bool,
        writes_back: bool,
    ) -> Option<()> {
        let (base, bytes) = (self.get(rn), 4 * u32::from(count));
        let moved = if upwards { base.wrapping_add(bytes) } else { base.wrapping_sub(bytes) };
        self.transfer_singles(load, if upwards { base } else { moved }, first, count)?;
        if writes_back {
            self.set(rn, moved);
        }
        Some(())
    }
}

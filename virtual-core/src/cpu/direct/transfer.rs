//! Loads and stores of core registers in flash, RAM and CCM (DDI 0403 A7.7).
//!
//! Accesses of devices, to addresses that are not aligned, within a region of the protection unit,
//! or of nothing at all are left to `rsemu`.

use rsemu::cpu::arm::v7m::isa::{MemOffset, Size};

use super::Direct;

/// Registers of a block at most.
const BLOCK: usize = 16;

impl Direct {
    /// Returns the address of a literal, an offset from the instruction.
    #[inline]
    pub(super) fn literal(&self, offset: u32, add: bool) -> u32 {
        let base = self.get(15) & !3;
        if add { base.wrapping_add(offset) } else { base.wrapping_sub(offset) }
    }

    /// Returns the address of an access, and what a write-back sets the base to.
    #[inline]
    pub(super) fn address(&self, rn: u8, offset: MemOffset, index: bool, add: bool) -> [u32; 2] {
        let base = self.get(rn);
        let offset = match offset {
            MemOffset::Imm(bytes) => bytes,
            MemOffset::Reg { rm, lsl } => self.get(rm) << lsl,
        };
        let moved = if add { base.wrapping_add(offset) } else { base.wrapping_sub(offset) };
        [if index { moved } else { base }, moved]
    }

    #[inline]
    pub(super) fn load(&self, address: u32, bytes: u32) -> Option<u32> {
        if address & (bytes - 1) != 0 || self.protection.covers(address) {
            return None;
        }
        self.memory.load(address, bytes)
    }

    #[inline]
    pub(super) fn store(&self, address: u32, bytes: u32, value: u32) -> Option<()> {
        if address & (bytes - 1) != 0 || self.protection.covers(address) {
            return None;
        }
        self.memory.store(address, bytes, value)
    }

    /// Returns true if a load that jumps to `target` stays in the program. Returns from exceptions
    /// and jumps without the Thumb bit are left to `rsemu`.
    #[inline]
    pub(super) fn is_jump(&self, target: u32) -> bool {
        target & 1 != 0 && target >> 28 != 0xf
    }

    #[inline]
    pub(super) fn transfer(
        &mut self,
        load: bool,
        size: Size,
        signed: bool,
        [rt, rn]: [u8; 2],
        [address, moved]: [u32; 2],
        writes_back: bool,
    ) -> Option<()> {
        if load {
            if rt == 15 {
                return None;
            }
            let value = extended(self.load(address, size.bytes())?, size, signed);
            if writes_back {
                self.set(rn, moved);
            }
            self.set(rt, value);
        } else {
            self.store(address, size.bytes(), self.get(rt))?;
            if writes_back {
                self.set(rn, moved);
            }
        }
        Some(())
    }

    #[inline]
    pub(super) fn load_literal(&mut self, size: Size, signed: bool, rt: u8, offset: u32, add: bool) -> Option<()> {
        if rt == 15 {
            return None;
        }
        let value = self.load(self.literal(offset, add), size.bytes())?;
        self.set(rt, extended(value, size, signed));
        Some(())
    }

    pub(super) fn transfer_pair(
        &mut self,
        load: bool,
        [rt, rt2, rn]: [u8; 3],
        offset: u32,
        [index, add, writes_back]: [bool; 3],
    ) -> Option<()> {
        if rn == 15 {
            return None;
        }
        let [address, moved] = self.address(rn, MemOffset::Imm(offset), index, add);
        let second = address.wrapping_add(4);
        if load {
            let values = [self.load(address, 4)?, self.load(second, 4)?];
            self.set(rt, values[0]);
            self.set(rt2, values[1]);
        } else {
            // Both can be stored, or neither is.
            self.load(second, 4)?;
            self.store(address, 4, self.get(rt))?;
            self.store(second, 4, self.get(rt2))?;
        }
        if writes_back {
            self.set(rn, moved);
        }
        Some(())
    }

    pub(super) fn transfer_block(
        &mut self,
        load: bool,
        rn: u8,
        list: u16,
        writes_back: bool,
        before: bool,
    ) -> Option<()> {
        let bytes = 4 * list.count_ones();
        let base = self.get(rn);
        let moved = if before { base.wrapping_sub(bytes) } else { base.wrapping_add(bytes) };
        let start = if before { moved } else { base };
        let registers = (0..BLOCK as u8).filter(|register| list >> register & 1 != 0);
        let addresses = (0..).map(|word: u32| start.wrapping_add(4 * word));
        // All words are read first: what cannot be read or written is left to `rsemu` whole.
        let mut words = [0; BLOCK];
        for (word, address) in words.iter_mut().zip(addresses.clone()).take(list.count_ones() as usize) {
            *word = self.load(address, 4)?;
        }
        let jump = if load && list >> 15 != 0 { Some(words[list.count_ones() as usize - 1]) } else { None };
        if list == 0 || jump.is_some_and(|target| !self.is_jump(target)) {
            return None;
        }
        if load {
            if writes_back {
                self.set(rn, moved);
            }
            for (register, word) in registers.zip(words) {
                self.set(register, word);
            }
        } else {
            self.store(start, 4, self.get(list.trailing_zeros() as u8))?;
            for (register, address) in registers.zip(addresses).skip(1) {
                self.store(address, 4, self.get(register))?;
            }
            if writes_back {
                self.set(rn, moved);
            }
        }
        if let Some(target) = jump {
            self.jump(target);
        }
        Some(())
    }
}

/// Extends a value that was loaded to a word.
#[inline]
fn extended(value: u32, size: Size, signed: bool) -> u32 {
    match (size, signed) {
        (Size::Byte, true) => i32::from(value as i8).cast_unsigned(),
        (Size::Half, true) => i32::from(value as i16).cast_unsigned(),
        _ => value,
    }
}

//! Branches, table branches and IT (DDI 0403 A7.7).

use rsemu::cpu::arm::v7m::isa::Cond;
use rsemu::cpu::arm::v7m::xpsr;

use super::Direct;

impl Direct {
    /// Lets the program go on at `target`, whose Thumb bit is left out.
    #[inline]
    pub(super) fn jump(&mut self, target: u32) {
        self.next = target & !1;
    }

    #[inline]
    pub(super) fn branch(&mut self, condition: Option<Cond>, offset: i32) -> Option<()> {
        let taken = condition.is_none_or(|condition| condition.passes(self.registers.xpsr));
        if taken {
            self.jump(self.get(15).wrapping_add_signed(offset));
        }
        Some(())
    }

    pub(super) fn branch_link(&mut self, offset: i32) -> Option<()> {
        self.set(14, self.next | 1);
        self.jump(self.get(15).wrapping_add_signed(offset));
        Some(())
    }

    /// Jumps to the address in a register. The link register keeps the address to return to if
    /// `links`.
    pub(super) fn branch_exchange(&mut self, rm: u8, links: bool) -> Option<()> {
        let target = self.get(rm);
        if !self.is_jump(target) {
            return None;
        }
        if links {
            self.set(14, self.next | 1);
        }
        self.jump(target);
        Some(())
    }

    #[inline]
    pub(super) fn branch_zero(&mut self, nonzero: bool, rn: u8, offset: u32) -> Option<()> {
        let taken = (self.get(rn) != 0) == nonzero;
        if taken {
            self.jump(self.get(15).wrapping_add(offset));
        }
        Some(())
    }

    pub(super) fn branch_table(&mut self, rn: u8, rm: u8, half: bool) -> Option<()> {
        let (shift, bytes) = if half { (1, 2) } else { (0, 1) };
        let address = self.get(rn).wrapping_add(self.get(rm) << shift);
        let words = self.load(address, bytes)?;
        self.jump(self.get(15).wrapping_add(2 * words));
        Some(())
    }

    pub(super) fn begin_block(&mut self, condition: Cond, mask: u8) -> Option<()> {
        let state = u32::from(condition.0) << 4 | u32::from(mask);
        let bits = (state & 0xfc) << 8 | (state & 3) << 25;
        self.registers.xpsr = self.registers.xpsr & !xpsr::IT_MASK | bits;
        Some(())
    }
}

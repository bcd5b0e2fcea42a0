//! Products of words and of halves, their sums, and quotients (DDI 0403 A7.7).

use rsemu::cpu::arm::v7m::isa::{DualMulOp, HalfMulOp};
use rsemu::cpu::arm::v7m::xpsr;

use super::Direct;

/// Low or high half of a word, with its sign.
#[inline]
fn half(word: u32, high: bool) -> i64 {
    i64::from(if high { (word >> 16) as i16 } else { word as i16 })
}

impl Direct {
    #[inline]
    fn signed(&self, register: u8) -> i64 {
        i64::from(self.get(register).cast_signed())
    }

    #[inline]
    fn long(&self, low: u8, high: u8) -> u64 {
        u64::from(self.get(high)) << 32 | u64::from(self.get(low))
    }

    #[inline]
    fn set_long(&mut self, low: u8, high: u8, value: u64) {
        self.set(low, value as u32);
        self.set(high, (value >> 32) as u32);
    }

    /// Sets a register to the low word of a sum, and Q if the sum is longer.
    fn set_wrapped(&mut self, register: u8, sum: i64) {
        if i32::try_from(sum).is_err() {
            self.registers.xpsr |= xpsr::Q;
        }
        self.set(register, sum as u32);
    }

    /// Divides two words. A divisor of 0, which may be a fault, is left to `rsemu`.
    #[inline]
    pub(super) fn divide(&mut self, signed: bool, [rd, rn, rm]: [u8; 3]) -> Option<()> {
        let [n, m] = [rn, rm].map(|register| self.get(register));
        let quotient = if signed && m != 0 {
            // The smallest integer divided by -1 is itself.
            n.cast_signed().wrapping_div(m.cast_signed()).cast_unsigned()
        } else {
            n.checked_div(m)?
        };
        self.set(rd, quotient);
        Some(())
    }

    #[inline]
    pub(super) fn multiply(
        &mut self,
        [rd, rn, rm]: [u8; 3],
        ra: Option<u8>,
        subtracts: bool,
        sets_flags: bool,
    ) -> Option<()> {
        let product = self.get(rn).wrapping_mul(self.get(rm));
        let result = match ra {
            None => product,
            Some(ra) if subtracts => self.get(ra).wrapping_sub(product),
            Some(ra) => self.get(ra).wrapping_add(product),
        };
        self.set(rd, result);
        if sets_flags {
            self.set_negative_zero(result);
        }
        Some(())
    }

    #[inline]
    pub(super) fn multiply_long(
        &mut self,
        [low, high, rn, rm]: [u8; 4],
        signed: bool,
        accumulates: bool,
        umaal: bool,
    ) -> Option<()> {
        let product = if signed {
            (self.signed(rn) * self.signed(rm)).cast_unsigned()
        } else {
            u64::from(self.get(rn)) * u64::from(self.get(rm))
        };
        let addend = match (umaal, accumulates) {
            (true, _) => u64::from(self.get(low)) + u64::from(self.get(high)),
            (false, true) => self.long(low, high),
            (false, false) => 0,
        };
        self.set_long(low, high, product.wrapping_add(addend));
        Some(())
    }

    pub(super) fn multiply_halves(
        &mut self,
        op: HalfMulOp,
        [rd, rn, rm, ra]: [u8; 4],
        [x, y]: [bool; 2],
    ) -> Option<()> {
        let factor = half(self.get(rm), y);
        let product = half(self.get(rn), x) * factor;
        let product_of_word = (self.signed(rn) * factor) >> 16;
        match op {
            HalfMulOp::Smul => self.set(rd, product as u32),
            HalfMulOp::Smla => self.set_wrapped(rd, product + self.signed(ra)),
            HalfMulOp::Smulw => self.set(rd, product_of_word as u32),
            HalfMulOp::Smlaw => self.set_wrapped(rd, product_of_word + self.signed(ra)),
            HalfMulOp::Smlal => {
                let sum = self.long(ra, rd).wrapping_add(product.cast_unsigned());
                self.set_long(ra, rd, sum);
            }
        }
        Some(())
    }

    #[inline]
    pub(super) fn multiply_dual(&mut self, op: DualMulOp, [rd, rn, rm, ra]: [u8; 4], x: bool) -> Option<()> {
        if op.bit_is_round() {
            let product = self.signed(rn) * self.signed(rm);
            let round = if x { 1 << 31 } else { 0 };
            let sum = match op {
                DualMulOp::Smmul => product,
                DualMulOp::Smmla => (self.signed(ra) << 32).wrapping_add(product),
                _ => (self.signed(ra) << 32).wrapping_sub(product),
            };
            self.set(rd, (sum.wrapping_add(round) >> 32) as u32);
            return Some(());
        }
        let n = self.get(rn);
        let m = if x { self.get(rm).rotate_right(16) } else { self.get(rm) };
        let (low, high) = (half(n, false) * half(m, false), half(n, true) * half(m, true));
        match op {
            DualMulOp::Smuad => self.set_wrapped(rd, low + high),
            DualMulOp::Smlad => self.set_wrapped(rd, low + high + self.signed(ra)),
            DualMulOp::Smusd => self.set_wrapped(rd, low - high),
            DualMulOp::Smlsd => self.set_wrapped(rd, low - high + self.signed(ra)),
            DualMulOp::Smlald | DualMulOp::Smlsld => {
                let products = if op == DualMulOp::Smlald { low + high } else { low - high };
                let sum = self.long(ra, rd).wrapping_add(products.cast_unsigned());
                self.set_long(ra, rd, sum);
            }
            _ => return None,
        }
        Some(())
    }
}

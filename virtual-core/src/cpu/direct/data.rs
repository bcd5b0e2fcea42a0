//! Moves, sums, logic, shifts, bit fields, extension and saturation (DDI 0403 A7.4, A7.7).

use rsemu::cpu::arm::v7m::isa::{BitfieldOp, DpOp, ExtendOp, MiscOp, Operand, SatQOp, Shift, ShiftType};
use rsemu::cpu::arm::v7m::xpsr;

use super::Direct;

/// Result of a shift and the carry that it leaves (Shift_C, DDI 0403 A2.2.1).
fn shifted(kind: ShiftType, value: u32, amount: u32, carry: bool) -> (u32, bool) {
    // 64 bits hold what leaves the word, so that no amount is a case of its own.
    let by = amount.min(33);
    match kind {
        ShiftType::Rrx => (u32::from(carry) << 31 | value >> 1, value & 1 != 0),
        _ if amount == 0 => (value, carry),
        ShiftType::Lsl => {
            let wide = u64::from(value) << by;
            (wide as u32, wide >> 32 & 1 != 0)
        }
        ShiftType::Lsr => {
            let wide = u64::from(value) << 32 >> by;
            ((wide >> 32) as u32, wide >> 31 & 1 != 0)
        }
        ShiftType::Asr => {
            let wide = i64::from(value.cast_signed()) << 32 >> by;
            ((wide >> 32) as u32, wide >> 31 & 1 != 0)
        }
        ShiftType::Ror => {
            let result = value.rotate_right(amount & 31);
            (result, result >> 31 != 0)
        }
    }
}

/// Sum of two words and a carry, with the flags C and V as bits of the status word
/// (AddWithCarry, DDI 0403 A2.2.1).
#[inline]
fn sum(a: u32, b: u32, carry: bool) -> (u32, u32) {
    let (partial, first) = a.overflowing_add(b);
    let (result, second) = partial.overflowing_add(u32::from(carry));
    let carried = if first | second { xpsr::C } else { 0 };
    (result, carried | ((a ^ result) & (b ^ result)) >> 31 << 28)
}

impl Direct {
    #[inline]
    fn operand(&self, operand: Operand) -> (u32, bool) {
        let carry = self.has_flag(xpsr::C);
        match operand {
            Operand::Imm { value, carry: left } => (value, left.unwrap_or(carry)),
            Operand::Reg { rm, shift } if shift.is_none() => (self.get(rm), carry),
            Operand::Reg { rm, shift: Shift { ty, amount } } => shifted(ty, self.get(rm), u32::from(amount), carry),
        }
    }

    #[inline]
    pub(super) fn process(&mut self, op: DpOp, sets_flags: bool, rd: u8, rn: u8, operand: Operand) -> Option<()> {
        let (b, carry) = self.operand(operand);
        let a = self.get(rn);
        let carry_in = self.has_flag(xpsr::C);
        let logic = |result: u32| {
            let carried = if carry { xpsr::C } else { 0 };
            (result, self.registers.xpsr & xpsr::V | carried)
        };
        let (result, flags) = match op {
            DpOp::And | DpOp::Tst => logic(a & b),
            DpOp::Bic => logic(a & !b),
            DpOp::Orr => logic(a | b),
            DpOp::Orn => logic(a | !b),
            DpOp::Eor | DpOp::Teq => logic(a ^ b),
            DpOp::Mov => logic(b),
            DpOp::Mvn => logic(!b),
            DpOp::Add | DpOp::Cmn => sum(a, b, false),
            DpOp::Adc => sum(a, b, carry_in),
            DpOp::Sbc => sum(a, !b, carry_in),
            DpOp::Sub | DpOp::Cmp => sum(a, !b, true),
            DpOp::Rsb => sum(!a, b, true),
        };
        if sets_flags {
            self.set_negative_zero(result);
            self.registers.xpsr = self.registers.xpsr & !(xpsr::C | xpsr::V) | flags;
        }
        if op.is_test() {
            return Some(());
        }
        if rd == 15 {
            self.jump(result);
            return Some(());
        }
        self.set(rd, result);
        Some(())
    }

    pub(super) fn shift(&mut self, kind: ShiftType, sets_flags: bool, [rd, rn, rm]: [u8; 3]) -> Option<()> {
        let (result, carry) = shifted(kind, self.get(rn), self.get(rm) & 0xff, self.has_flag(xpsr::C));
        if sets_flags {
            self.set_negative_zero(result);
            self.registers.xpsr = self.registers.xpsr & !xpsr::C | if carry { xpsr::C } else { 0 };
        }
        self.set(rd, result);
        Some(())
    }

    pub(super) fn move_half(&mut self, top: bool, rd: u8, half: u16) -> Option<()> {
        let half = u32::from(half);
        self.set(rd, if top { self.get(rd) & 0xffff | half << 16 } else { half });
        Some(())
    }

    pub(super) fn address_of(&mut self, rd: u8, offset: u32, add: bool) -> Option<()> {
        self.set(rd, self.literal(offset, add));
        Some(())
    }

    pub(super) fn bit_field(&mut self, op: BitfieldOp, [rd, rn]: [u8; 2], [lsb, width]: [u8; 2]) -> Option<()> {
        let (lsb, width) = (u32::from(lsb), u32::from(width));
        if lsb + width > 32 || width == 0 {
            return None;
        }
        let ones = u32::MAX >> (32 - width);
        let (source, old) = (self.get(rn), self.get(rd));
        let result = match op {
            BitfieldOp::Ubfx => source >> lsb & ones,
            BitfieldOp::Sbfx => ((source << (32 - width - lsb)).cast_signed() >> (32 - width)).cast_unsigned(),
            BitfieldOp::Bfi => old & !(ones << lsb) | (source & ones) << lsb,
            BitfieldOp::Bfc => old & !(ones << lsb),
        };
        self.set(rd, result);
        Some(())
    }

    pub(super) fn extend(&mut self, op: ExtendOp, [rd, rn, rm]: [u8; 3], rotate: u8) -> Option<()> {
        let turned = self.get(rm).rotate_right(u32::from(rotate));
        let value = match op {
            ExtendOp::Sxtb => i32::from(turned as i8).cast_unsigned(),
            ExtendOp::Sxth => i32::from(turned as i16).cast_unsigned(),
            ExtendOp::Uxtb => turned & 0xff,
            ExtendOp::Uxth => turned & 0xffff,
            ExtendOp::Sxtb16 | ExtendOp::Uxtb16 => return None,
        };
        self.set(rd, if rn == 15 { value } else { self.get(rn).wrapping_add(value) });
        Some(())
    }

    pub(super) fn rearrange(&mut self, op: MiscOp, [rd, rm]: [u8; 2]) -> Option<()> {
        let value = self.get(rm);
        let result = match op {
            MiscOp::Clz => value.leading_zeros(),
            MiscOp::Rbit => value.reverse_bits(),
            MiscOp::Rev => value.swap_bytes(),
            MiscOp::Rev16 => value.swap_bytes().rotate_right(16),
            MiscOp::Revsh => i32::from((value as u16).swap_bytes().cast_signed()).cast_unsigned(),
        };
        self.set(rd, result);
        Some(())
    }

    pub(super) fn saturate(&mut self, unsigned: bool, [rd, rn]: [u8; 2], bits: u8, shift: Shift) -> Option<()> {
        let (value, _) = shifted(shift.ty, self.get(rn), u32::from(shift.amount), self.has_flag(xpsr::C));
        let value = i64::from(value.cast_signed());
        let limits = if unsigned { (0, (1 << bits) - 1) } else { (-(1 << (bits - 1)), (1 << (bits - 1)) - 1) };
        let result = value.clamp(limits.0, limits.1);
        if result != value {
            self.registers.xpsr |= xpsr::Q;
        }
        self.set(rd, result as u32);
        Some(())
    }

    pub(super) fn saturating_sum(&mut self, op: SatQOp, [rd, rn, rm]: [u8; 3]) -> Option<()> {
        let mut n = self.get(rn).cast_signed();
        let m = self.get(rm).cast_signed();
        let mut has_saturated = false;
        let mut saturated = |sum: i64| {
            let result = sum.clamp(i64::from(i32::MIN), i64::from(i32::MAX));
            has_saturated |= result != sum;
            result as i32
        };
        if matches!(op, SatQOp::Qdadd | SatQOp::Qdsub) {
            n = saturated(2 * i64::from(n));
        }
        let (m, n) = (i64::from(m), i64::from(n));
        let result = saturated(if matches!(op, SatQOp::Qadd | SatQOp::Qdadd) { m + n } else { m - n });
        if has_saturated {
            self.registers.xpsr |= xpsr::Q;
        }
        self.set(rd, result.cast_unsigned());
        Some(())
    }

    pub(super) fn pack(&mut self, tb: bool, [rd, rn, rm]: [u8; 3], shift: Shift) -> Option<()> {
        let (b, _) = shifted(shift.ty, self.get(rm), u32::from(shift.amount), self.has_flag(xpsr::C));
        let a = self.get(rn);
        self.set(rd, if tb { a & 0xffff_0000 | b & 0xffff } else { a & 0xffff | b & 0xffff_0000 });
        Some(())
    }
}

//! Definitions of the instructions of `tests/program/src/instructions.rs`, written for the PC from
//! the architecture manual (Arm DDI 0403, A7.7), independently of the emulator.

mod lanes;

use lanes::{Keep, Sign, bytes, difference, each_byte, halves, pair};

/// Integer instruction: a function of three words, or of two words and a 64-bit number.
pub(crate) enum Integers {
    One(fn(u32, u32, u32) -> u32),
    Long(fn(u32, u32, u64) -> u64),
}

/// Float instruction: a function of three floats, or of the bits of two.
pub(crate) enum Floats {
    Float(fn(f32, f32, f32) -> f32),
    Bits(fn(u32, u32) -> u32),
}

/// Half of the last bit that SMMULR, SMMLAR and SMMLSR keep.
const HALF: u64 = 1 << 31;

const Q27: f64 = (1_u32 << 27) as f64;

fn bits(value: i32) -> u32 {
    value.cast_unsigned()
}

fn low(word: u32) -> i32 {
    i32::from(word as u16 as i16)
}

fn high(word: u32) -> i32 {
    low(word >> 16)
}

fn long(value: i32) -> u64 {
    i64::from(value).cast_unsigned()
}

fn signed(a: u32, b: u32) -> u64 {
    (i64::from(a.cast_signed()) * i64::from(b.cast_signed())).cast_unsigned()
}

/// Returns bits 47 to 16 of the product of a word and a half.
fn wide(a: u32, half: i32) -> u32 {
    ((i64::from(a.cast_signed()) * i64::from(half)) >> 16) as u32
}

fn sat_add(a: u32, b: u32) -> u32 {
    bits(a.cast_signed().saturating_add(b.cast_signed()))
}

fn sat_sub(a: u32, b: u32) -> u32 {
    bits(a.cast_signed().saturating_sub(b.cast_signed()))
}

fn sign_extend(value: u32, width: u32) -> u32 {
    bits((value << (32 - width)).cast_signed() >> (32 - width))
}

/// Returns N Z C V as MRS shows them.
fn flags(result: u32, carry: bool, overflow: bool) -> u32 {
    result & 0x8000_0000 | u32::from(result == 0) << 30 | u32::from(carry) << 29 | u32::from(overflow) << 28
}

/// Returns N Z C V after VCMP and VMRS.
fn compared(x: f32, y: f32) -> u32 {
    match x.partial_cmp(&y) {
        Some(std::cmp::Ordering::Less) => 0x8000_0000,
        Some(std::cmp::Ordering::Equal) => 0x6000_0000,
        Some(std::cmp::Ordering::Greater) => 0x2000_0000,
        None => 0x3000_0000,
    }
}

fn float_of_half(half: u32) -> f32 {
    let (sign, exponent, fraction) = (half >> 15 & 1, half >> 10 & 31, half & 0x3ff);
    let magnitude = match exponent {
        31 if fraction != 0 => f32::NAN,
        31 => f32::INFINITY,
        0 => fraction as f32 * 2.0_f32.powi(-24),
        _ => (1024 + fraction) as f32 * 2.0_f32.powi(exponent.cast_signed() - 25),
    };
    if sign == 1 { -magnitude } else { magnitude }
}

/// Rounds a float to the nearest half, ties to even.
///
/// A NaN becomes the quiet half NaN with the top bits of its payload.
fn half_of_float(x: f32) -> u32 {
    let sign = x.to_bits() >> 16 & 0x8000;
    if x.is_nan() {
        return sign | 0x7e00 | x.to_bits() >> 13 & 0x1ff;
    }
    let magnitude = f64::from(x.abs());
    if magnitude >= 65_536.0 {
        return sign | 0x7c00;
    }
    // The distance of neighbouring halves is never below that of the subnormal ones.
    let exponent = (magnitude.log2().floor() as i32).max(-14);
    let step = 2.0_f64.powi(exponent - 10);
    let steps = (magnitude / step).round_ties_even();
    // Counting upwards from the subnormals carries into the exponent by itself, up to infinity.
    let coded = (f64::from(exponent + 14) * 1024.0 + steps) as u32;
    sign | if magnitude == 0.0 { 0 } else { coded }
}

#[rustfmt::skip]
pub(crate) const INTEGERS: &[(&str, Integers)] = &[
    ("op_add", Integers::One(|a, b, _| a.wrapping_add(b))),
    ("op_sub", Integers::One(|a, b, _| a.wrapping_sub(b))),
    ("op_and", Integers::One(|a, b, _| a & b)),
    ("op_orr", Integers::One(|a, b, _| a | b)),
    ("op_eor", Integers::One(|a, b, _| a ^ b)),
    ("op_bic", Integers::One(|a, b, _| a & !b)),
    ("op_orn", Integers::One(|a, b, _| a | !b)),
    ("op_rsb", Integers::One(|a, b, _| b.wrapping_sub(a))),
    ("op_mvn", Integers::One(|a, _, _| !a)),
    ("op_lsl", Integers::One(|a, b, _| a.checked_shl(b & 0xff).unwrap_or(0))),
    ("op_lsr", Integers::One(|a, b, _| a.checked_shr(b & 0xff).unwrap_or(0))),
    ("op_asr", Integers::One(|a, b, _| (a.cast_signed() >> (b & 0xff).min(31)).cast_unsigned())),
    ("op_ror", Integers::One(|a, b, _| a.rotate_right(b & 31))),
    ("op_add_lsl", Integers::One(|a, b, _| a.wrapping_add(b << 3))),
    ("op_sub_asr", Integers::One(|a, b, _| a.wrapping_sub((b.cast_signed() >> 7).cast_unsigned()))),
    ("op_eor_ror", Integers::One(|a, b, _| a ^ b.rotate_right(11))),
    ("op_rrx", Integers::One(|a, b, _| (b & 1) << 31 | a >> 1)),
    ("op_adc", Integers::One(|a, b, c| a.wrapping_add(b).wrapping_add(c & 1))),
    ("op_sbc", Integers::One(|a, b, c| a.wrapping_sub(b).wrapping_sub(1 - (c & 1)))),
    ("op_flags_add", Integers::One(|a, b, _| flags(a.wrapping_add(b), a.checked_add(b).is_none(), a.cast_signed().checked_add(b.cast_signed()).is_none()))),
    ("op_flags_sub", Integers::One(|a, b, _| flags(a.wrapping_sub(b), a >= b, a.cast_signed().checked_sub(b.cast_signed()).is_none()))),
    ("op_mul", Integers::One(|a, b, _| a.wrapping_mul(b))),
    ("op_mla", Integers::One(|a, b, c| c.wrapping_add(a.wrapping_mul(b)))),
    ("op_mls", Integers::One(|a, b, c| c.wrapping_sub(a.wrapping_mul(b)))),
    ("op_smull", Integers::Long(|a, b, _| signed(a, b))),
    ("op_umull", Integers::Long(|a, b, _| u64::from(a) * u64::from(b))),
    ("op_smlal", Integers::Long(|a, b, s| s.wrapping_add(signed(a, b)))),
    ("op_umlal", Integers::Long(|a, b, s| s.wrapping_add(u64::from(a) * u64::from(b)))),
    ("op_umaal", Integers::Long(|a, b, s| u64::from(a) * u64::from(b) + (s & 0xffff_ffff) + (s >> 32))),
    ("op_sdiv", Integers::One(|a, b, _| if b == 0 { 0 } else { a.cast_signed().wrapping_div(b.cast_signed()).cast_unsigned() })),
    ("op_udiv", Integers::One(|a, b, _| a.checked_div(b).unwrap_or(0))),
    ("op_smmul", Integers::One(|a, b, _| (signed(a, b) >> 32) as u32)),
    ("op_smmulr", Integers::One(|a, b, _| (signed(a, b).wrapping_add(HALF) >> 32) as u32)),
    ("op_smmla", Integers::One(|a, b, c| ((u64::from(c) << 32).wrapping_add(signed(a, b)) >> 32) as u32)),
    ("op_smmlar", Integers::One(|a, b, c| ((u64::from(c) << 32).wrapping_add(signed(a, b)).wrapping_add(HALF) >> 32) as u32)),
    ("op_smmls", Integers::One(|a, b, c| ((u64::from(c) << 32).wrapping_sub(signed(a, b)) >> 32) as u32)),
    ("op_smmlsr", Integers::One(|a, b, c| ((u64::from(c) << 32).wrapping_sub(signed(a, b)).wrapping_add(HALF) >> 32) as u32)),
    ("op_smulbb", Integers::One(|a, b, _| bits(low(a) * low(b)))),
    ("op_smlabb", Integers::One(|a, b, c| c.wrapping_add(bits(low(a) * low(b))))),
    ("op_smulbt", Integers::One(|a, b, _| bits(low(a) * high(b)))),
    ("op_smlabt", Integers::One(|a, b, c| c.wrapping_add(bits(low(a) * high(b))))),
    ("op_smultb", Integers::One(|a, b, _| bits(high(a) * low(b)))),
    ("op_smlatb", Integers::One(|a, b, c| c.wrapping_add(bits(high(a) * low(b))))),
    ("op_smultt", Integers::One(|a, b, _| bits(high(a) * high(b)))),
    ("op_smlatt", Integers::One(|a, b, c| c.wrapping_add(bits(high(a) * high(b))))),
    ("op_smulwb", Integers::One(|a, b, _| wide(a, low(b)))),
    ("op_smlawb", Integers::One(|a, b, c| c.wrapping_add(wide(a, low(b))))),
    ("op_smulwt", Integers::One(|a, b, _| wide(a, high(b)))),
    ("op_smlawt", Integers::One(|a, b, c| c.wrapping_add(wide(a, high(b))))),
    ("op_smuad", Integers::One(|a, b, _| bits(low(a) * low(b)).wrapping_add(bits(high(a) * high(b))))),
    ("op_smuadx", Integers::One(|a, b, _| bits(low(a) * high(b)).wrapping_add(bits(high(a) * low(b))))),
    ("op_smusd", Integers::One(|a, b, _| bits(low(a) * low(b) - high(a) * high(b)))),
    ("op_smusdx", Integers::One(|a, b, _| bits(low(a) * high(b) - high(a) * low(b)))),
    ("op_smlad", Integers::One(|a, b, c| c.wrapping_add(bits(low(a) * low(b))).wrapping_add(bits(high(a) * high(b))))),
    ("op_smladx", Integers::One(|a, b, c| c.wrapping_add(bits(low(a) * high(b))).wrapping_add(bits(high(a) * low(b))))),
    ("op_smlsd", Integers::One(|a, b, c| c.wrapping_add(bits(low(a) * low(b) - high(a) * high(b))))),
    ("op_smlsdx", Integers::One(|a, b, c| c.wrapping_add(bits(low(a) * high(b) - high(a) * low(b))))),
    ("op_smlalbb", Integers::Long(|a, b, s| s.wrapping_add(long(low(a) * low(b))))),
    ("op_smlaltt", Integers::Long(|a, b, s| s.wrapping_add(long(high(a) * high(b))))),
    ("op_smlald", Integers::Long(|a, b, s| s.wrapping_add(long(low(a) * low(b))).wrapping_add(long(high(a) * high(b))))),
    ("op_smlaldx", Integers::Long(|a, b, s| s.wrapping_add(long(low(a) * high(b))).wrapping_add(long(high(a) * low(b))))),
    ("op_smlsld", Integers::Long(|a, b, s| s.wrapping_add(long(low(a) * low(b) - high(a) * high(b))))),
    ("op_smlsldx", Integers::Long(|a, b, s| s.wrapping_add(long(low(a) * high(b) - high(a) * low(b))))),
    ("op_qadd", Integers::One(|a, b, _| sat_add(a, b))),
    ("op_qsub", Integers::One(|a, b, _| sat_sub(a, b))),
    ("op_qdadd", Integers::One(|a, b, _| sat_add(a, sat_add(b, b)))),
    ("op_qdsub", Integers::One(|a, b, _| sat_sub(a, sat_add(b, b)))),
    ("op_sadd8", Integers::One(|a, b, _| bytes(Sign::Signed, Keep::Wrap, a, b, 1))),
    ("op_ssub8", Integers::One(|a, b, _| bytes(Sign::Signed, Keep::Wrap, a, b, -1))),
    ("op_sadd16", Integers::One(|a, b, _| halves(Sign::Signed, Keep::Wrap, a, b, [1, 1]))),
    ("op_ssub16", Integers::One(|a, b, _| halves(Sign::Signed, Keep::Wrap, a, b, [-1, -1]))),
    ("op_sasx", Integers::One(|a, b, _| halves(Sign::Signed, Keep::Wrap, a, b.rotate_left(16), [-1, 1]))),
    ("op_ssax", Integers::One(|a, b, _| halves(Sign::Signed, Keep::Wrap, a, b.rotate_left(16), [1, -1]))),
    ("op_qadd8", Integers::One(|a, b, _| bytes(Sign::Signed, Keep::Saturate, a, b, 1))),
    ("op_qsub8", Integers::One(|a, b, _| bytes(Sign::Signed, Keep::Saturate, a, b, -1))),
    ("op_qadd16", Integers::One(|a, b, _| halves(Sign::Signed, Keep::Saturate, a, b, [1, 1]))),
    ("op_qsub16", Integers::One(|a, b, _| halves(Sign::Signed, Keep::Saturate, a, b, [-1, -1]))),
    ("op_qasx", Integers::One(|a, b, _| halves(Sign::Signed, Keep::Saturate, a, b.rotate_left(16), [-1, 1]))),
    ("op_qsax", Integers::One(|a, b, _| halves(Sign::Signed, Keep::Saturate, a, b.rotate_left(16), [1, -1]))),
    ("op_shadd8", Integers::One(|a, b, _| bytes(Sign::Signed, Keep::Halve, a, b, 1))),
    ("op_shsub8", Integers::One(|a, b, _| bytes(Sign::Signed, Keep::Halve, a, b, -1))),
    ("op_shadd16", Integers::One(|a, b, _| halves(Sign::Signed, Keep::Halve, a, b, [1, 1]))),
    ("op_shsub16", Integers::One(|a, b, _| halves(Sign::Signed, Keep::Halve, a, b, [-1, -1]))),
    ("op_shasx", Integers::One(|a, b, _| halves(Sign::Signed, Keep::Halve, a, b.rotate_left(16), [-1, 1]))),
    ("op_shsax", Integers::One(|a, b, _| halves(Sign::Signed, Keep::Halve, a, b.rotate_left(16), [1, -1]))),
    ("op_uadd8", Integers::One(|a, b, _| bytes(Sign::Unsigned, Keep::Wrap, a, b, 1))),
    ("op_usub8", Integers::One(|a, b, _| bytes(Sign::Unsigned, Keep::Wrap, a, b, -1))),
    ("op_uadd16", Integers::One(|a, b, _| halves(Sign::Unsigned, Keep::Wrap, a, b, [1, 1]))),
    ("op_usub16", Integers::One(|a, b, _| halves(Sign::Unsigned, Keep::Wrap, a, b, [-1, -1]))),
    ("op_uasx", Integers::One(|a, b, _| halves(Sign::Unsigned, Keep::Wrap, a, b.rotate_left(16), [-1, 1]))),
    ("op_usax", Integers::One(|a, b, _| halves(Sign::Unsigned, Keep::Wrap, a, b.rotate_left(16), [1, -1]))),
    ("op_uqadd8", Integers::One(|a, b, _| bytes(Sign::Unsigned, Keep::Saturate, a, b, 1))),
    ("op_uqsub8", Integers::One(|a, b, _| bytes(Sign::Unsigned, Keep::Saturate, a, b, -1))),
    ("op_uqadd16", Integers::One(|a, b, _| halves(Sign::Unsigned, Keep::Saturate, a, b, [1, 1]))),
    ("op_uqsub16", Integers::One(|a, b, _| halves(Sign::Unsigned, Keep::Saturate, a, b, [-1, -1]))),
    ("op_uqasx", Integers::One(|a, b, _| halves(Sign::Unsigned, Keep::Saturate, a, b.rotate_left(16), [-1, 1]))),
    ("op_uqsax", Integers::One(|a, b, _| halves(Sign::Unsigned, Keep::Saturate, a, b.rotate_left(16), [1, -1]))),
    ("op_uhadd8", Integers::One(|a, b, _| bytes(Sign::Unsigned, Keep::Halve, a, b, 1))),
    ("op_uhsub8", Integers::One(|a, b, _| bytes(Sign::Unsigned, Keep::Halve, a, b, -1))),
    ("op_uhadd16", Integers::One(|a, b, _| halves(Sign::Unsigned, Keep::Halve, a, b, [1, 1]))),
    ("op_uhsub16", Integers::One(|a, b, _| halves(Sign::Unsigned, Keep::Halve, a, b, [-1, -1]))),
    ("op_uhasx", Integers::One(|a, b, _| halves(Sign::Unsigned, Keep::Halve, a, b.rotate_left(16), [-1, 1]))),
    ("op_uhsax", Integers::One(|a, b, _| halves(Sign::Unsigned, Keep::Halve, a, b.rotate_left(16), [1, -1]))),
    ("op_sel", Integers::One(|a, b, _| each_byte(a, b, |x, y| if x + y > 0xff { x } else { y }))),
    ("op_usad8", Integers::One(|a, b, _| difference(a, b))),
    ("op_usada8", Integers::One(|a, b, c| c.wrapping_add(difference(a, b)))),
    ("op_pkhbt", Integers::One(|a, b, _| (b << 5) & 0xffff_0000 | a & 0xffff)),
    ("op_pkhtb", Integers::One(|a, b, _| a & 0xffff_0000 | (b.cast_signed() >> 9).cast_unsigned() & 0xffff)),
    ("op_sxtb", Integers::One(|a, _, _| sign_extend(a.rotate_right(8), 8))),
    ("op_sxtab", Integers::One(|a, b, _| a.wrapping_add(sign_extend(b.rotate_right(16), 8)))),
    ("op_sxth", Integers::One(|a, _, _| sign_extend(a.rotate_right(8), 16))),
    ("op_sxtah", Integers::One(|a, b, _| a.wrapping_add(sign_extend(b.rotate_right(16), 16)))),
    ("op_uxtb", Integers::One(|a, _, _| a.rotate_right(8) & 0xff)),
    ("op_uxtab", Integers::One(|a, b, _| a.wrapping_add(b.rotate_right(16) & 0xff))),
    ("op_uxth", Integers::One(|a, _, _| a.rotate_right(8) & 0xffff)),
    ("op_uxtah", Integers::One(|a, b, _| a.wrapping_add(b.rotate_right(16) & 0xffff))),
    ("op_sxtb16", Integers::One(|a, _, _| pair(sign_extend(a.rotate_right(8), 8), sign_extend(a.rotate_right(8) >> 16, 8)))),
    ("op_uxtb16", Integers::One(|a, _, _| a.rotate_right(8) & 0x00ff_00ff)),
    ("op_sxtab16", Integers::One(|a, b, _| pair(a.wrapping_add(sign_extend(b.rotate_right(16), 8)), (a >> 16).wrapping_add(sign_extend(b.rotate_right(16) >> 16, 8))))),
    ("op_uxtab16", Integers::One(|a, b, _| pair(a.wrapping_add(b.rotate_right(16) & 0xff), (a >> 16).wrapping_add(b.rotate_right(16) >> 16 & 0xff)))),
    ("op_clz", Integers::One(|a, _, _| a.leading_zeros())),
    ("op_rbit", Integers::One(|a, _, _| a.reverse_bits())),
    ("op_rev", Integers::One(|a, _, _| a.swap_bytes())),
    ("op_rev16", Integers::One(|a, _, _| a.swap_bytes().rotate_left(16))),
    ("op_revsh", Integers::One(|a, _, _| sign_extend(u32::from((a as u16).swap_bytes()), 16))),
    ("op_ssat", Integers::One(|a, _, _| bits((a.cast_signed() >> 3).clamp(-0x1000, 0xfff)))),
    ("op_usat", Integers::One(|a, _, _| bits((a << 2).cast_signed().clamp(0, 0x1_ffff)))),
    ("op_ssat16", Integers::One(|a, _, _| pair(bits(low(a).clamp(-256, 255)), bits(high(a).clamp(-256, 255))))),
    ("op_usat16", Integers::One(|a, _, _| pair(bits(low(a).clamp(0, 511)), bits(high(a).clamp(0, 511))))),
    ("op_bfi", Integers::One(|a, b, _| a & !(0x1fff << 7) | (b & 0x1fff) << 7)),
    ("op_bfc", Integers::One(|a, _, _| a & !(0xf_ffff << 5))),
    ("op_sbfx", Integers::One(|a, _, _| sign_extend(a >> 9, 15))),
    ("op_ubfx", Integers::One(|a, _, _| a >> 9 & 0x7fff)),
    ("op_saturated", Integers::One(|a, b, _| u32::from(a.cast_signed().checked_add(b.cast_signed()).is_none()) << 27)),
    ("op_vmov_pair", Integers::Long(|a, b, _| u64::from(a) << 32 | u64::from(b))),
];

#[rustfmt::skip]
pub(crate) const FLOATS: &[(&str, Floats)] = &[
    ("op_vadd", Floats::Float(|x, y, _| x + y)),
    ("op_vsub", Floats::Float(|x, y, _| x - y)),
    ("op_vmul", Floats::Float(|x, y, _| x * y)),
    ("op_vnmul", Floats::Float(|x, y, _| -(x * y))),
    ("op_vdiv", Floats::Float(|x, y, _| x / y)),
    ("op_vmla", Floats::Float(|x, y, z| x + y * z)),
    ("op_vmls", Floats::Float(|x, y, z| x - y * z)),
    ("op_vnmla", Floats::Float(|x, y, z| -x - y * z)),
    ("op_vnmls", Floats::Float(|x, y, z| y * z - x)),
    ("op_vfma", Floats::Float(|x, y, z| y.mul_add(z, x))),
    ("op_vfms", Floats::Float(|x, y, z| (-y).mul_add(z, x))),
    ("op_vfnma", Floats::Float(|x, y, z| (-y).mul_add(z, -x))),
    ("op_vfnms", Floats::Float(|x, y, z| y.mul_add(z, -x))),
    ("op_vsqrt", Floats::Float(|x, _, _| x.sqrt())),
    ("op_vneg", Floats::Bits(|a, _| a ^ 0x8000_0000)),
    ("op_vabs", Floats::Bits(|a, _| a & 0x7fff_ffff)),
    ("op_vcvt_f32_s32", Floats::Bits(|a, _| (a.cast_signed() as f32).to_bits())),
    ("op_vcvt_f32_u32", Floats::Bits(|a, _| (a as f32).to_bits())),
    ("op_vcvt_s32_f32", Floats::Bits(|a, _| bits(f32::from_bits(a) as i32))),
    ("op_vcvt_u32_f32", Floats::Bits(|a, _| f32::from_bits(a) as u32)),
    ("op_vcvtr_s32_f32", Floats::Bits(|a, _| bits(f32::from_bits(a).round_ties_even() as i32))),
    ("op_vcvt_f32_q27", Floats::Bits(|a, _| ((f64::from(a.cast_signed()) / Q27) as f32).to_bits())),
    ("op_vcvt_q27_f32", Floats::Bits(|a, _| bits((f64::from(f32::from_bits(a)) * Q27) as i32))),
    ("op_vcvtb_f16_f32", Floats::Bits(|_, b| b & 0xffff_0000 | half_of_float(f32::from_bits(b)))),
    ("op_vcvtb_f32_f16", Floats::Float(|x, _, _| float_of_half(x.to_bits()))),
    ("op_vcvtt_f32_f16", Floats::Float(|x, _, _| float_of_half(x.to_bits() >> 16))),
    ("op_vcmp", Floats::Bits(|a, b| compared(f32::from_bits(a), f32::from_bits(b)))),
];

//! Both cores on random FPU instructions, with operands at the edges, in all modes of FPSCR.

use std::collections::BTreeMap;

use rsemu::cpu::arm::v7m::fp::fpscr;
use rsemu::cpu::arm::v7m::xpsr;

use super::super::tests::{Pair, Random};
use super::{MODES, SINGLES};
use crate::cpu::{Core, Stepped};
use crate::decode::{self, Instruction};

/// Singles at which results and flags change, without their signs: zeros, subnormals, the smallest
/// and greatest normal numbers, infinities, NaNs, and numbers at the ends of integers.
const EDGES: [u32; 32] = [
    0,
    1,
    2,
    0x0040_0000,
    0x007f_ffff,
    0x0080_0000,
    0x0080_0001,
    0x00ff_ffff,
    0x0100_0000,
    0x0100_0001,
    0x3380_0000,
    0x337f_ffff,
    0x3eff_ffff,
    0x3f00_0000,
    0x3f7f_ffff,
    0x3f80_0000,
    0x3f80_0001,
    0x4000_0000,
    0x46ff_ffff,
    0x4700_0000,
    0x477f_ff80,
    0x4780_0000,
    0x4eff_ffff,
    0x4f00_0000,
    0x4f7f_ffff,
    0x4f80_0000,
    0x7f7f_ffff,
    0x7f80_0000,
    0x7f80_0001,
    0x7fbf_ffff,
    0x7fc0_0000,
    0x7fc1_2345,
];

/// Flags of FPSCR that exceptions set.
const EXCEPTIONS: u32 = fpscr::CUMULATIVE;

/// Bits of a single.
fn single(random: &mut Random) -> u32 {
    let sign = random.word() & 1 << 31;
    match random.below(8) {
        0 | 1 => sign | EDGES[random.below(32) as usize],
        2 => random.word(),
        // Half a unit or two from a single of few bits, so that many results are ties or exact.
        3 => sign | (((0x3f80_0000 + random.below(0x100_0000)) & 0xffff_0000) + random.below(3)),
        // Integers, and halves in both half-words.
        4 => random.word() & 0x8000_ffff | random.word() & 0x7fff << (16 * random.below(2)),
        // Numbers next to the subnormals.
        5 => sign | random.below(0x0400_0000),
        // Numbers near 1.
        _ => sign | (0x3d00_0000 + random.below(0x0500_0000)),
    }
}

/// Half-words of an opcode of the FPU.
fn opcode(random: &mut Random) -> [u16; 2] {
    let [first, second] = [(); 2].map(|()| random.word() as u16);
    let registers = second & 0xf0ef;
    match random.below(16) {
        // Data processing, of which half is that of one operand.
        0..=5 => [0xee00 | first & 0xff, registers & !0x10 | 0xa00],
        6..=9 => [0xeeb0 | first & 0x4f, registers & !0x10 | 0xa40],
        // Moves from and to core registers, one or two, and FPSCR.
        10 => [0xee00 | first & 0x1f, second & 0xf080 | 0xa10],
        11 => [0xeee1 | first & 0x10, second & 0xf000 | 0xa10],
        12 => [0xec40 | first & 0x1f, second & 0xf02f | 0xa10 | second >> 4 & 0x100],
        // Loads and stores with a short offset, and of short lists.
        13 => [0xed00 | first & 0xdf, second & 0xf10f | 0xa00],
        _ => [0xec00 | first & 0x1ff, second & 0xf10f | 0xa00],
    }
}

/// Puts both cores in the state in which a program has switched the FPU on.
fn switch_on(pair: &mut Pair) {
    pair.direct.protection.is_float_plain = true;
    pair.rsemu.switch_float_on();
}

/// Sets all FPU registers and FPSCR of both cores. The modes of FPSCR are mostly those of reset.
fn fill(pair: &mut Pair, random: &mut Random) {
    for register in 0..SINGLES as u8 {
        let bits = single(random);
        pair.direct.floats.set(register, bits);
        pair.rsemu.set_float_register(register, bits);
    }
    let modes = if random.below(4) == 0 { random.word() & MODES } else { 0 };
    let status =
        random.word() & fpscr::FLAGS | modes | if random.below(2) == 0 { EXCEPTIONS & random.word() } else { 0 };
    pair.direct.floats.status = status;
    pair.rsemu.set_float_status(status);
}

/// Name of an FPU instruction, with the parts that tell its forms apart.
fn name(instruction: &Instruction) -> String {
    let text = format!("{:?}", instruction.operation);
    let text = text.trim_start_matches("Fp(");
    let forms = text
        .split(['{', ',', '}'])
        .skip(1)
        .filter(|field| ["op:", "true", "false"].iter().any(|form| field.contains(form)));
    let kind = text.split(' ').next().unwrap_or("");
    format!("{kind}{}", forms.collect::<String>())
}

#[test]
fn direct_execution_of_random_float_instructions_leaves_what_rsemu_leaves() {
    let mut random = Random(0x0123_4567_89ab_cdef);
    let mut pair = Pair::new(&mut random);
    switch_on(&mut pair);
    let mut seen: BTreeMap<String, u32> = BTreeMap::new();
    let mut raised: BTreeMap<u32, u32> = BTreeMap::new();
    for turn in 0..500_000_u32 {
        if turn % 8 == 0 {
            fill(&mut pair, &mut random);
        }
        let [first, second] = opcode(&mut random);
        let before = random.registers();
        let pc = before.r[15];
        let instruction = decode::decode(pc, first, second);
        pair.write(pc, &[first.to_le_bytes(), second.to_le_bytes()].concat());
        pair.direct.registers = before;
        let floats = pair.direct.floats.clone();
        let in_block = before.xpsr & xpsr::IT_MASK != 0;
        let is_done = pair.direct.execute(&instruction, in_block).is_some();
        let what =
            format!("turn {turn}: {first:04x} {second:04x} {:?} from {before:x?} {floats:x?}", instruction.operation);
        if !is_done {
            assert_eq!(pair.direct.registers, before, "{what}");
            assert_eq!(pair.direct.floats, floats, "{what}");
            continue;
        }
        if !in_block {
            *seen.entry(name(&instruction)).or_default() += 1;
        }
        pair.rsemu.set_registers(before);
        assert_eq!(pair.rsemu.step(in_block), Stepped::Instruction, "{what}");
        let after = pair.rsemu.registers();
        assert_eq!(pair.direct.registers.r, after.r, "{what}");
        assert_eq!(pair.direct.registers.xpsr, after.xpsr, "{what}");
        assert_eq!(pair.direct.registers.control, after.control, "{what}");
        let status = pair.direct.floats.status;
        assert_eq!(status, pair.rsemu.float_status(), "{what}");
        for register in 0..SINGLES as u8 {
            let bits = [pair.direct.floats.get(register), pair.rsemu.float_register(register)];
            assert_eq!(bits[0], bits[1], "s{register}, {:08x} by rsemu: {what}", bits[1]);
        }
        for flag in (0..8).filter(|flag| (status & !floats.status & EXCEPTIONS) >> flag & 1 != 0) {
            *raised.entry(flag).or_default() += 1;
        }
        if turn % 4096 == 0 {
            pair.assert_same_ram(&what);
        }
    }
    pair.assert_same_ram("at the end");
    let least = seen.iter().min_by_key(|(_, count)| **count).unwrap();
    assert!(seen.len() >= 68 && *least.1 >= 60, "{} forms, the rarest {least:?}", seen.len());
    let least = raised.iter().min_by_key(|(_, count)| **count).unwrap();
    assert!(raised.len() == 6 && *least.1 >= 100, "{} flags raised, the rarest {least:?}", raised.len());
}

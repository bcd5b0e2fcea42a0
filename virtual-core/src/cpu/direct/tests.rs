//! Both cores on random instructions, registers, flags and IT states. [`super::float`] has the
//! tests of FPU instructions.

use std::collections::BTreeMap;
use std::sync::Arc;

use rsemu::cpu::arm::v7m::{Regs, xpsr};

use super::Direct;
use crate::cpu::Stepped;
use crate::cpu::rsemu::Rsemu;
use crate::decode::{self, Instruction};
use crate::memory::{FLASH_ADDRESS, Memory, RAM_ADDRESS, RAM_BYTES};

/// Addresses round which the instructions run, and about which base registers point.
const CODE: u32 = RAM_ADDRESS + 0x100;
const DATA: u32 = RAM_ADDRESS + 0x8000;

/// Words at which results and flags change.
const EDGES: [u32; 10] = [0, 1, 0x7f, 0x8000, 0xffff, 0x7fff_ffff, 0x8000_0000, 0x8000_0001, 0xffff_fffe, 0xffff_ffff];

/// First half-words of opcodes that are rare at random: MOVW, MOVT, SBFX, BFI and BFC, UBFX.
const RARE: [u16; 5] = [0xf240, 0xf2c0, 0xf340, 0xf360, 0xf3c0];

/// Random sequence of a fixed seed (xorshift).
pub(super) struct Random(pub(super) u64);

impl Random {
    pub(super) fn word(&mut self) -> u32 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 16) as u32
    }

    pub(super) fn below(&mut self, end: u32) -> u32 {
        self.word() % end
    }

    fn register(&mut self) -> u32 {
        match self.below(8) {
            0 => EDGES[self.below(10) as usize],
            1 => self.word(),
            2 => self.below(64),
            3 => FLASH_ADDRESS + self.below(0x400),
            // The Thumb bit, for jumps.
            4 => (DATA + self.below(0x200)) | 1,
            _ => DATA + 4 * self.below(0x80),
        }
    }

    /// Half-words of an opcode. Half of all have two, of which there are more, and some those forms
    /// that few opcodes have.
    fn opcode(&mut self) -> [u16; 2] {
        let [first, second] = [(); 2].map(|()| self.word() as u16);
        match self.below(8) {
            0..=2 => [first, second],
            3..=5 => [first | 0xe800, second],
            6 => [RARE[self.below(5) as usize] | first & 0xf, second & 0x7fff],
            _ => [0xfa80 | first & 0x3f, second | 0xf080],
        }
    }

    pub(super) fn registers(&mut self) -> Regs {
        let mut registers = Regs { xpsr: xpsr::T | self.word() & (xpsr::FLAGS | xpsr::GE), ..Regs::new() };
        registers.r.fill_with(|| self.register());
        registers.r[13] &= !3;
        registers.msp = registers.r[13];
        registers.r[15] = CODE + 2 * self.below(8);
        if self.below(4) == 0 {
            // A state within a block has an instruction left.
            registers.xpsr |= self.word() & xpsr::IT_MASK | 1 << 26;
        }
        registers
    }
}

/// Both cores, each with a memory of its own.
pub(super) struct Pair {
    pub(super) direct: Direct,
    pub(super) rsemu: Rsemu,
    memories: [Memory; 2],
}

impl Pair {
    /// Makes two cores whose RAM and first 4 KB of flash hold the same random bytes.
    pub(super) fn new(random: &mut Random) -> Pair {
        let [first, second] = [(); 2].map(|()| Memory::new().unwrap());
        let direct = Direct::new(Arc::new(first.1), first.0.clone(), FLASH_ADDRESS);
        let mut rsemu = Rsemu::new(Arc::new(second.1), FLASH_ADDRESS);
        // The next step would be the reset without a program.
        rsemu.set_registers(Regs::new());
        let pair = Pair { direct, rsemu, memories: [first.0, second.0] };
        let mut filling = vec![0; RAM_BYTES as usize];
        filling.fill_with(|| random.word() as u8);
        pair.write(RAM_ADDRESS, &filling);
        pair.write(FLASH_ADDRESS, &filling[..0x1000]);
        pair
    }

    pub(super) fn write(&self, address: u32, bytes: &[u8]) {
        self.memories.iter().for_each(|memory| memory.write(address, bytes).unwrap());
    }

    /// Asserts that both cores have left the same in RAM.
    pub(super) fn assert_same_ram(&self, what: &str) {
        let [direct, rsemu] = [0, 1].map(|of| {
            let mut bytes = vec![0; RAM_BYTES as usize];
            self.memories[of].read(RAM_ADDRESS, &mut bytes).unwrap();
            bytes
        });
        assert!(direct == rsemu, "{what}: memory differs");
    }
}

/// Name of an operation, with the part that tells its forms apart.
fn name(instruction: &Instruction) -> String {
    let text = format!("{:?}", instruction.operation);
    let form = text.split_once("op: ").map_or("", |(_, rest)| rest.split([',', ' ']).next().unwrap_or(""));
    format!("{} {form}", text.split([' ', '{']).next().unwrap_or(""))
}

#[test]
fn direct_execution_of_random_instructions_leaves_what_rsemu_leaves() {
    let mut random = Random(0x9e37_79b9_7f4a_7c15);
    let mut pair = Pair::new(&mut random);
    let mut seen: BTreeMap<String, u32> = BTreeMap::new();
    for turn in 0..2_000_000_u32 {
        let [first, second] = random.opcode();
        let before = random.registers();
        let pc = before.r[15];
        let instruction = decode::decode(pc, first, second);
        pair.write(pc, &[first.to_le_bytes(), second.to_le_bytes()].concat());
        pair.direct.registers = before;
        let in_block = before.xpsr & xpsr::IT_MASK != 0;
        let is_done = pair.direct.execute(&instruction, in_block).is_some();
        let what = format!("turn {turn}: {first:04x} {second:04x} {:?} from {before:x?}", instruction.operation);
        if is_done {
            if !in_block {
                *seen.entry(name(&instruction)).or_default() += 1;
            }
            pair.rsemu.set_registers(before);
            assert_eq!(pair.rsemu.step(in_block), Stepped::Instruction, "{what}");
            let after = pair.rsemu.registers();
            assert_eq!(pair.direct.registers.r, after.r, "{what}");
            assert_eq!(pair.direct.registers.xpsr, after.xpsr, "{what}");
        } else {
            assert_eq!(pair.direct.registers, before, "{what}");
        }
        if turn % 4096 == 0 {
            pair.assert_same_ram(&what);
        }
    }
    pair.assert_same_ram("at the end");
    let least = seen.iter().min_by_key(|(_, count)| **count).unwrap();
    assert!(seen.len() >= 60 && *least.1 >= 30, "{} forms, the rarest {least:?}", seen.len());
}

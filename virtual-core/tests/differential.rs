//! Every arithmetic, DSP and FPU instruction on the emulated core against its definition, computed
//! on the PC, for operands at the edges and at random.

mod common;
mod reference;

use virtual_core::{Core, Image, Machine};

use reference::{Floats, Integers};

/// Operands at which integer instructions change: signs, carries, halves, bytes.
const EDGES: [u32; 14] = [
    0,
    1,
    2,
    0x7f,
    0x80,
    0x7fff,
    0x8000,
    0xffff,
    0x1_0000,
    0x7fff_ffff,
    0x8000_0000,
    0x8000_0001,
    0xffff_fffe,
    0xffff_ffff,
];

/// Operands at which float instructions change: zeros, subnormals, one, halves, the ends of the
/// integers, infinities, NaN.
const FLOAT_EDGES: [f32; 18] = [
    0.0,
    -0.0,
    1e-45,
    -1e-40,
    f32::MIN_POSITIVE,
    0.5,
    -1.0,
    1.5,
    2.5,
    -3.5,
    16_777_215.0,
    2_147_483_648.0,
    -2_147_483_648.0,
    4_294_967_296.0,
    f32::MAX,
    f32::INFINITY,
    f32::NEG_INFINITY,
    f32::NAN,
];

const RANDOM_OPERANDS: usize = 1000;

/// Random sequence of a fixed seed (xorshift).
struct Random(u64);

impl Random {
    fn word(&mut self) -> u32 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 32) as u32
    }
}

/// Returns pairs of edges, then random words of random sizes.
fn operands(edges: &[u32]) -> Vec<[u32; 4]> {
    let mut random = Random(0x9e37_79b9_7f4a_7c15);
    let mut all = Vec::new();
    for (n, &a) in edges.iter().enumerate() {
        for (m, &b) in edges.iter().enumerate() {
            all.push([a, b, edges[(3 * n + 5 * m) % edges.len()], random.word()]);
        }
    }
    for _ in 0..RANDOM_OPERANDS {
        let word = |random: &mut Random| random.word() >> (random.word() % 24) ^ (random.word() & 1).wrapping_neg();
        all.push(std::array::from_fn(|_| word(&mut random)));
    }
    all
}

/// Returns floats at the edges, then random floats of similar size, whose sums cancel and whose
/// products stay in range.
fn float_operands() -> Vec<[u32; 4]> {
    let mut all = operands(&FLOAT_EDGES.map(f32::to_bits));
    let mut random = Random(0x0123_4567_89ab_cdef);
    let float = |random: &mut Random| {
        let exponent = 118 + random.word() % 20;
        (random.word() & 0x8000_0000) | exponent << 23 | random.word() >> 9
    };
    all.extend((0..RANDOM_OPERANDS).map(|_| std::array::from_fn(|_| float(&mut random))));
    all
}

fn address(machine: &Machine, name: &str) -> u32 {
    machine.symbol(name).unwrap_or_else(|| panic!("the program has no {name}")).address
}

#[test]
fn integer_instructions_agree_with_the_pc() {
    let mut machine = common::machine();
    let operands = operands(&EDGES);
    for (name, expected) in reference::INTEGERS {
        let code = address(&machine, name);
        for &[a, b, c, d] in &operands {
            let call = machine.call_at(code, &[a, b, c, d]).unwrap();
            match expected {
                Integers::One(f) => assert_eq!(call.value, f(a, b, c), "{name}({a:#x}, {b:#x}, {c:#x})"),
                Integers::Long(f) => {
                    let sum = u64::from(d) << 32 | u64::from(c);
                    let value = u64::from(call.high) << 32 | u64::from(call.value);
                    assert_eq!(value, f(a, b, sum), "{name}({a:#x}, {b:#x}, {sum:#x})");
                }
            }
        }
    }
}

#[test]
fn float_instructions_agree_with_the_pc() {
    let mut machine = common::machine();
    let operands = float_operands();
    for (name, expected) in reference::FLOATS {
        let code = address(&machine, name);
        for &[a, b, c, _] in &operands {
            let value = machine.call_at(code, &[a, b, c]).unwrap().value;
            let [x, y, z] = [a, b, c].map(f32::from_bits);
            match expected {
                Floats::Float(f) => {
                    let (value, expected) = (f32::from_bits(value), f(x, y, z));
                    // A NaN's sign and payload are not compared.
                    let same = value.to_bits() == expected.to_bits() || value.is_nan() && expected.is_nan();
                    assert!(same, "{name}({x:e}, {y:e}, {z:e}) = {value:e}, not {expected:e}");
                }
                Floats::Bits(f) => assert_eq!(value, f(a, b), "{name}({x:e} = {a:#x}, {y:e} = {b:#x})"),
            }
        }
    }
}

#[test]
fn every_single_instruction_of_the_program_is_compared() {
    let image = Image::from_elf(&common::elf()).unwrap();
    let compared = |name: &str| {
        reference::INTEGERS.iter().any(|(known, _)| *known == name)
            || reference::FLOATS.iter().any(|(known, _)| *known == name)
    };
    // Tests of their own compare these, in this file and in machine.rs.
    let elsewhere = [
        "op_memory",
        "op_exclusive",
        "op_choose",
        "op_max_clamped",
        "op_branch_in_block",
        "op_table",
        "op_supervisor",
        "op_vmov_imm",
    ];
    for symbol in image.symbols().iter().filter(|symbol| symbol.name.starts_with("op_")) {
        let name = symbol.name.as_str();
        assert!(compared(name) || elsewhere.contains(&name), "{name} has no counterpart on the PC");
    }
}

#[test]
fn loads_and_stores_of_every_width_keep_their_bytes() {
    let mut machine = common::machine();
    for [a, b, c, d] in operands(&EDGES) {
        let value = machine.call("op_memory", &[a, b, c, d]).unwrap().value;
        // The stm of r0 to r3 overwrites the strd of r0, r1. The ldrd at 4 loads b to r4 and c to
        // r5.
        let byte = i32::from(b as u8 as i8).cast_unsigned();
        let half = i32::from(c as u16 as i16).cast_unsigned();
        assert_eq!(value, (byte.wrapping_add(half) ^ c).wrapping_add(b), "{a:#x} {b:#x} {c:#x} {d:#x}");
    }
}

#[test]
fn exclusive_accesses_of_one_core_succeed() {
    let mut machine = common::machine();
    assert_eq!(machine.call("op_exclusive", &[40, 2]).unwrap().value, 42);
}

#[test]
fn conditional_instructions_follow_the_flags() {
    let mut machine = common::machine();
    for [a, b, c, d] in operands(&EDGES) {
        let chosen = if a > b { c } else { d }.wrapping_add(u32::from(a == b));
        assert_eq!(machine.call("op_choose", &[a, b, c, d]).unwrap().value, chosen, "{a:#x} {b:#x}");
        let less = a.cast_signed() < b.cast_signed();
        let branched = if less { d } else { c };
        assert_eq!(machine.call("op_branch_in_block", &[a, b, c, d]).unwrap().value, branched, "{a:#x} {b:#x}");
        let clamped = if less { b.wrapping_add(5) } else { a }.wrapping_add(if c == 0 { 0 } else { 2 });
        assert_eq!(machine.call("op_max_clamped", &[a, b, c]).unwrap().value, clamped, "{a:#x} {b:#x}");
    }
}

#[test]
fn table_branches_reach_their_places() {
    let mut machine = common::machine();
    for index in 0..4 {
        assert_eq!(machine.call("op_table", &[index]).unwrap().value, 10 * (index + 1));
    }
}

#[test]
fn a_float_constant_is_expanded() {
    let mut machine = common::machine();
    assert_eq!(f32::from_bits(machine.call("op_vmov_imm", &[]).unwrap().value), -3.5);
    assert_eq!(f32::from_bits(machine.core().float_register(0)), -3.5);
}

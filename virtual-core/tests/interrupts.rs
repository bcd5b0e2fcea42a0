//! Interrupts before any instruction leave the interrupted program's state as it was.

mod common;

use virtual_core::{Core, Machine, RunError, Stop};

const SCRATCH: u32 = 0x2000_2000;
const SCRATCH_BYTES: usize = 64;
/// Number of the breakpoint at the end of the routine.
const END: u8 = 9;

/// State that the routine leaves behind.
#[derive(Debug, PartialEq, Eq)]
struct Left {
    registers: Vec<u32>,
    float_registers: Vec<u32>,
    flags: u32,
    memory: Vec<u8>,
}

fn left(machine: &mut Machine) -> Left {
    let mut memory = vec![0; SCRATCH_BYTES];
    machine.read(SCRATCH, &mut memory).unwrap();
    let core = machine.core();
    Left {
        registers: (0..15).map(|register| core.register(register)).collect(),
        float_registers: (0..32).map(|register| core.float_register(register)).collect(),
        flags: core.status() & 0xf80f_0000,
        memory,
    }
}

/// Returns a machine that takes interrupts 0 to 2 and has not begun the routine.
fn machine() -> Machine {
    let mut machine = common::machine();
    machine.call("store", &[0xe000_e100, 7]).unwrap();
    machine.write(SCRATCH, &[0; SCRATCH_BYTES]).unwrap();
    for register in 0..32 {
        machine.core().set_float_register(register, 0x3f80_0000 + u32::from(register));
    }
    machine
}

fn begin(machine: &mut Machine, instructions: u64) {
    machine.limit_calls(instructions);
    assert!(matches!(machine.call("fragile", &[SCRATCH]), Err(RunError::Limit { .. })));
}

fn end(machine: &mut Machine) -> Left {
    assert_eq!(machine.resume(10_000).unwrap(), Stop::Breakpoint(END));
    left(machine)
}

/// Returns the number of the routine's instructions, and the state that it leaves without an
/// interrupt.
fn quiet() -> (u64, Left) {
    let mut machine = machine();
    let before = machine.cost().instructions;
    assert!(matches!(machine.call("fragile", &[SCRATCH]), Err(RunError::Breakpoint { number: END, .. })));
    (machine.cost().instructions - before, left(&mut machine))
}

#[test]
fn the_routine_takes_each_branch_that_its_flags_select() {
    let (instructions, left) = quiet();
    assert!(instructions > 70, "{instructions}");
    // 1 + 10 + 20: no other addition may have been executed.
    assert_eq!((left.registers[6], left.registers[7]), (31, 1));
    assert_eq!(left.registers[4], 0u32.wrapping_add(3 + 1).wrapping_sub(2));
    assert_eq!(f32::from_bits(left.float_registers[21]), 1.5 * 3.0 + 3.0);
}

#[test]
fn an_interrupt_before_any_instruction_leaves_registers_and_memory_unchanged() {
    let (instructions, quiet) = quiet();
    for lines in [[1].as_slice(), &[2], &[1, 2]] {
        for at in 1..instructions {
            let mut machine = machine();
            begin(&mut machine, at);
            lines.iter().for_each(|&line| machine.set_interrupt(line, true));
            // The first handler begins. Then the lines fall; the second interrupt stays pending,
            // and follows without a return between.
            machine.resume(1).unwrap();
            lines.iter().for_each(|&line| machine.set_interrupt(line, false));
            assert_eq!(end(&mut machine), quiet, "lines {lines:?} before instruction {at}");
        }
    }
}

#[test]
fn an_interrupt_inside_an_interrupt_leaves_registers_and_memory_unchanged() {
    let (instructions, quiet) = quiet();
    for at in 1..instructions {
        for deep in 1..12 {
            let mut machine = machine();
            // Line 2 preempts line 1: its priority number is smaller.
            machine.call("store", &[0xe000_e400, 0x0020_4000]).unwrap();
            begin(&mut machine, at);
            machine.set_interrupt(1, true);
            machine.resume(1).unwrap();
            machine.set_interrupt(1, false);
            machine.resume(deep).unwrap();
            machine.set_interrupt(2, true);
            machine.resume(1).unwrap();
            machine.set_interrupt(2, false);
            assert_eq!(end(&mut machine), quiet, "before instruction {at}, and after {deep} of the handler");
        }
    }
}

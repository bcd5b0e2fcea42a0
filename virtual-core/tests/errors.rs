//! Errors: an instruction, address or image that the machine does not know is named.

mod common;

use virtual_core::{Access, Image, ImageError, RunError};

#[test]
fn an_undefined_instruction_is_named() {
    let mut machine = common::machine();
    let expected = machine.symbol("undefined").unwrap().address;
    let error = machine.call("undefined", &[]).unwrap_err();
    assert!(matches!(error, RunError::Undefined { pc, opcode: 0xde07_0000, .. } if pc == expected), "{error:?}");
    let text = error.to_string();
    assert!(text.contains("0xde070000") && text.contains("in undefined"), "{text}");
}

#[test]
fn an_opcode_of_another_processor_is_named() {
    let mut machine = common::machine();
    // VADD.F64, which an FPv4-SP unit does not have, then VRINTZ of the Cortex-M7.
    for opcode in [0xee30_0b00_u32, 0xfeb6_0ac0] {
        let code = 0x2000_3000;
        let halves = [(opcode >> 16) as u16, opcode as u16].map(u16::to_le_bytes).concat();
        machine.write(code, &halves).unwrap();
        let error = machine.call_at(code, &[]).unwrap_err();
        assert!(
            matches!(error, RunError::Undefined { pc, opcode: found, .. } if pc == code && found == opcode),
            "{error:?}"
        );
    }
}

#[test]
fn an_address_where_nothing_answers_is_named_with_the_kind_of_access() {
    let mut machine = common::machine();
    for (function, argument, expected) in [
        ("load", 0x4000_0000, Access::Read),
        ("store", 0x4002_3800, Access::Write),
        ("store", 0x0800_0000, Access::Write),
        ("jump", 0x0900_0001, Access::Fetch),
        ("jump", 0x1000_0001, Access::Fetch),
    ] {
        let start = machine.symbol(function).unwrap().address;
        match machine.call(function, &[argument]).unwrap_err() {
            RunError::Address { access, address, pc, function: named } => {
                assert_eq!((access, address, pc, named.as_str()), (expected, argument & !1, start, function));
            }
            other => panic!("{other:?}"),
        }
    }
}

#[test]
fn an_unaligned_multiple_load_is_a_named_fault() {
    let mut machine = common::machine();
    let error = machine.call("rule_ldm", &[0x2000_0001]).unwrap_err();
    assert!(error.to_string().contains("UNALIGNED"), "{error}");
    assert!(error.to_string().contains("rule_ldm"), "{error}");
}

#[test]
fn a_jump_without_the_thumb_bit_is_a_named_fault() {
    let error = common::machine().call("jump", &[0x2000_0000]).unwrap_err();
    assert!(error.to_string().contains("INVSTATE"), "{error}");
}

#[test]
fn an_endless_loop_ends_at_the_limit() {
    let mut machine = common::machine();
    machine.limit_calls(10_000);
    let error = machine.call("endless", &[]).unwrap_err();
    assert!(matches!(&error, RunError::Limit { limit: 10_000, function, .. } if function == "endless"), "{error:?}");
}

#[test]
fn a_breakpoint_inside_a_call_is_named() {
    let error = common::machine().call("breakpoint", &[]).unwrap_err();
    assert!(matches!(error, RunError::Breakpoint { number: 3, .. }), "{error:?}");
}

#[test]
fn sleep_that_nothing_ends_is_named() {
    let error = common::machine().call("sleep", &[]).unwrap_err();
    assert!(matches!(&error, RunError::Asleep { function, .. } if function == "sleep"), "{error:?}");
}

#[test]
fn a_machine_can_be_used_after_an_error() {
    let mut machine = common::machine();
    for broken in ["undefined", "breakpoint", "load", "sleep"] {
        machine.call(broken, &[0x4000_0000]).unwrap_err();
        assert_eq!(machine.call("six", &[1, 0, 0, 0, 0, 0]).unwrap().value, 1, "after {broken}");
    }
}

#[test]
fn a_missing_function_is_named() {
    let error = common::machine().call("no_such_thing", &[]).unwrap_err();
    assert!(matches!(&error, RunError::NoFunction { name } if name == "no_such_thing"), "{error:?}");
}

#[test]
fn memory_outside_the_board_cannot_be_written() {
    let mut machine = common::machine();
    for address in [0, 0x0810_0000, 0x2002_0000, 0x2001_fffd] {
        assert!(matches!(machine.write(address, &[0; 4]), Err(RunError::NoMemory { .. })), "{address:#x}");
    }
    machine.write(0x2001_fffc, &[0; 4]).unwrap();
}

#[test]
fn an_image_for_another_processor_is_refused() {
    assert!(matches!(Image::from_elf(b"not an ELF file"), Err(ImageError::NotElf(_))));
    let this_program = std::fs::read(std::env::current_exe().unwrap()).unwrap();
    assert!(matches!(Image::from_elf(&this_program), Err(ImageError::WrongProcessor { .. } | ImageError::NotElf(_))));
    let mut elf = common::elf();
    elf[18] = 243; // e_machine: RISC-V
    assert!(matches!(Image::from_elf(&elf), Err(ImageError::WrongProcessor { .. })));
    let cut = &common::elf()[..100];
    assert!(Image::from_elf(cut).is_err());
}

#[test]
fn an_image_outside_the_memory_is_refused() {
    let mut elf = common::elf();
    // The first program header follows the 52 bytes of the file header, and p_vaddr is its third
    // word.
    elf[52 + 8..52 + 12].copy_from_slice(&0x0900_0000_u32.to_le_bytes());
    let error = Image::from_elf(&elf).unwrap_err();
    assert!(matches!(error, ImageError::OutsideMemory { address: 0x0900_0000, .. }), "{error:?}");
}

#[test]
fn an_image_without_a_vector_table_does_not_run() {
    let mut machine = common::machine();
    machine.write(0x0800_0004, &0x2000_0000_u32.to_le_bytes()).unwrap();
    let error = machine.run_image(1000).unwrap_err();
    assert!(matches!(error, RunError::NoVectorTable { reset: 0x2000_0000, .. }), "{error:?}");
}

//! Examples of the cycle rules, run as code: the cost of a function beyond one that only returns.

mod common;

use virtual_core::{Cost, Machine};

/// Address of a word in RAM that code may read and write.
const SCRATCH: u32 = 0x2000_2000;
/// Address of another word in RAM that code may read and write.
const OTHER: u32 = 0x2000_2040;

/// Returns the best, nominal and worst cycles of a function of `tests/program/src/rules.rs` without
/// its return.
fn cost(machine: &mut Machine, function: &str) -> (u64, u64, u64) {
    // The loaded value is used as an address, so it must be one.
    machine.write(SCRATCH, &SCRATCH.to_le_bytes()).unwrap();
    let arguments = [SCRATCH, OTHER, 0, 0];
    let whole = machine.call(function, &arguments).unwrap().cost;
    let Cost { best, nominal, worst, .. } = whole - machine.call("nothing", &arguments).unwrap().cost;
    (best, nominal, worst)
}

macro_rules! rules {
    ($($behaviour:ident: $($function:literal => $cost:expr),+;)*) => {
        $(#[test]
        fn $behaviour() {
            let mut machine = common::machine();
            $(assert_eq!(cost(&mut machine, $function), $cost, $function);)+
        })*
    };
}

rules! {
    arithmetic_and_long_multiplications_take_one_cycle: "rule_alu" => (3, 3, 3);
    a_multiply_accumulate_takes_one_or_two_cycles: "rule_mla" => (1, 1, 2);
    a_load_takes_two_cycles: "rule_load" => (2, 2, 2), "rule_load_after_store" => (3, 3, 3);
    loads_in_a_row_are_pipelined: "rule_loads" => (4, 4, 4), "rule_vldr" => (3, 3, 3), "rule_load_after_ldm" => (4, 4, 4);
    a_load_waits_for_the_load_of_its_address: "rule_load_of_loaded" => (5, 5, 5);
    an_address_made_by_the_previous_instruction_costs_a_cycle:
        "rule_load_after_alu_address" => (4, 4, 4), "rule_load_after_alu_index" => (4, 4, 4);
    an_address_made_earlier_costs_nothing: "rule_load_after_other" => (4, 4, 4);
    an_updated_base_costs_a_cycle_at_worst: "rule_loads_of_updated_base" => (3, 3, 4);
    a_store_takes_one_cycle: "rule_store" => (1, 1, 1), "rule_vstr" => (1, 1, 2);
    a_store_with_a_register_offset_takes_two_unless_pipelined:
        "rule_store_indexed" => (2, 2, 2), "rule_store_indexed_after_load" => (3, 4, 4);
    a_multiple_transfer_takes_one_cycle_and_one_a_word:
        "rule_ldm" => (4, 4, 4), "rule_ldrd" => (3, 3, 3), "rule_strd" => (3, 3, 3), "rule_push_pop" => (9, 9, 10),
        "rule_vldm" => (6, 6, 6);
    a_float_result_can_be_used_a_cycle_later:
        "rule_float_apart" => (3, 3, 3), "rule_float_used" => (3, 3, 3), "rule_float_used_later" => (3, 3, 3),
        "rule_float_stored" => (3, 3, 4);
    a_float_multiply_accumulate_takes_three_cycles: "rule_vmla" => (3, 3, 3), "rule_vfma_addend" => (4, 5, 5);
    a_float_division_or_root_takes_fourteen_cycles: "rule_vdiv" => (28, 28, 28);
    a_float_move_takes_a_cycle_and_a_pair_two: "rule_vmov" => (6, 6, 6);
    a_taken_branch_refills_the_pipeline:
        "rule_branch" => (2, 3, 4), "rule_cbz" => (2, 3, 4), "rule_call" => (5, 7, 9), "rule_table" => (5, 6, 7);
    a_branch_not_taken_takes_a_cycle: "rule_not_taken" => (2, 2, 2);
    a_skipped_instruction_takes_a_cycle_and_it_none_at_best: "rule_skipped" => (3, 4, 4);
    a_special_register_takes_two_cycles: "rule_special" => (2, 2, 2);
    a_division_ends_early: "rule_divide" => (4, 6, 14);
}

#[test]
fn instructions_are_counted_exactly() {
    let mut machine = common::machine();
    for passes in [1, 2, 1000] {
        let cost = machine.call("mac_loop", &[passes, 3]).unwrap().cost;
        assert_eq!(cost.instructions, 6 * u64::from(passes) + 4);
    }
}

#[test]
fn a_division_is_charged_by_the_size_of_its_quotient() {
    let mut machine = common::machine();
    let mut nominal = |dividend: i32, divisor: i32| {
        let arguments = [dividend.cast_unsigned(), divisor.cast_unsigned()];
        let cost = machine.call("divide_by", &arguments).unwrap().cost;
        (cost - machine.call("nothing", &[]).unwrap().cost).nominal
    };
    assert_eq!(nominal(3, 1000), 2);
    assert_eq!(nominal(3, 0), 2);
    assert_eq!(nominal(-15, 1), 3);
    assert_eq!(nominal(i32::MAX, -3), 10);
    assert_eq!(nominal(i32::MIN, 1), 10);
}

#[test]
fn a_loop_in_the_flash_cache_waits_only_for_its_first_pass() {
    let mut machine = common::machine();
    let once = machine.call("mac_loop", &[1, 3]).unwrap().cost;
    machine.clear_flash_cache();
    let often = machine.call("mac_loop", &[1000, 3]).unwrap().cost;
    assert_eq!(once.flash_waits, often.flash_waits);
    assert!(often.flash_waits >= 2 * 6 && often.flash_waits.is_multiple_of(6), "{}", often.flash_waits);
    // A third call finds the whole loop in the cache.
    assert_eq!(machine.call("mac_loop", &[10, 3]).unwrap().cost.flash_waits, 0);
}

#[test]
fn a_branch_of_an_it_block_refills_only_when_its_condition_holds() {
    let mut machine = common::machine();
    let mut nominal = |a, b| machine.call("op_branch_in_block", &[a, b, 0, 0]).unwrap().cost.nominal;
    // The terms are cmp, it, b, mov and bx.
    assert_eq!(nominal(1, 2), 1 + 1 + 3 + 1 + 3);
    assert_eq!(nominal(2, 1), 1 + 1 + 1 + 1 + 3);
}

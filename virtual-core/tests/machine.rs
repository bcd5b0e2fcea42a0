//! Calls, whole images, interrupts, devices, and the account of their cost.

mod common;

use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};

use virtual_core::{Core, FLASH_ADDRESS, Image, Peripheral, RunError, Stop};

const SCRATCH: u32 = 0x2000_2000;

fn write_words(machine: &mut virtual_core::Machine, address: u32, words: &[u32]) {
    let bytes: Vec<u8> = words.iter().flat_map(|word| word.to_le_bytes()).collect();
    machine.write(address, &bytes).unwrap();
}

#[test]
fn arguments_beyond_four_go_to_the_stack() {
    let value = common::machine().call("six", &[1, 2, 3, 4, 5, 6]).unwrap().value;
    let expected = (1..7_u32).zip(0..).fold(0, |all, (argument, turn)| all ^ argument.rotate_left(turn));
    assert_eq!(value, expected);
}

#[test]
fn a_function_reads_and_writes_memory_and_returns_64_bits() {
    let mut machine = common::machine();
    let (a, b): (Vec<i32>, Vec<i32>) =
        (0..50).map(|k: i32| (k * 37_777_777 - 12_345, 7_000_000 * k - 100_000_000)).unzip();
    let bits = |values: &[i32]| values.iter().map(|value| value.cast_unsigned()).collect::<Vec<_>>();
    write_words(&mut machine, SCRATCH, &bits(&a));
    write_words(&mut machine, SCRATCH + 400, &bits(&b));
    let call = machine.call("dot", &[SCRATCH, SCRATCH + 400, 50]).unwrap();
    let expected: i64 = a.iter().zip(&b).map(|(&a, &b)| i64::from(a) * i64::from(b)).sum();
    assert_eq!(u64::from(call.high) << 32 | u64::from(call.value), expected.cast_unsigned());
}

#[test]
fn compiled_code_returns_the_values_that_it_returns_on_the_pc() {
    let mut machine = common::machine();
    let mut values: Vec<u32> = (0..301_u32).map(|k| k.wrapping_mul(2_654_435_761)).collect();
    write_words(&mut machine, SCRATCH, &values);
    let median = machine.call("median", &[SCRATCH, 301]).unwrap().value;
    values.sort_unstable();
    assert_eq!(median, values[150]);

    for number in [1.5e-3_f32, -7.25e20, 0.1, f32::MAX, f32::MIN_POSITIVE / 8.0] {
        let length = machine.call("format", &[number.to_bits(), SCRATCH, 64]).unwrap().value;
        let mut text = vec![0; length as usize];
        machine.read(SCRATCH, &mut text).unwrap();
        assert_eq!(String::from_utf8(text).unwrap(), format!("{number:e}"));
    }

    let expected = |which, a: u32, b: u32| match which {
        0 => a.wrapping_add(b),
        1 => a.wrapping_sub(b),
        2 => a.wrapping_mul(b),
        3 => a.checked_div(b).unwrap_or(0),
        4 => a & b,
        5 => a | b,
        6 => a.count_ones(),
        _ => a ^ b,
    };
    for which in 0..9 {
        let value = machine.call("choose", &[which, 0xfedc_ba98, 0x7654]).unwrap().value;
        assert_eq!(value, expected(which, 0xfedc_ba98, 0x7654), "{which}");
    }
}

#[test]
fn floats_are_passed_and_returned_in_the_fpu() {
    let mut machine = common::machine();
    machine.core().set_float_register(0, 0.75_f32.to_bits());
    machine.core().set_float_register(1, 2.5_f32.to_bits());
    let float = f32::from_bits(machine.call("polynomial", &[]).unwrap().float);
    let expected = (1..8).fold(1.0_f32, |sum, k| sum * 0.75 + 2.5 / k as f32);
    assert_eq!(float, expected);
}

#[test]
fn the_stack_that_a_recursion_needs_is_measured() {
    let mut machine = common::machine();
    let shallow = machine.call("ackermann", &[1, 1]).unwrap();
    let deep = machine.call("ackermann", &[2, 20]).unwrap();
    assert_eq!(deep.value, 43);
    assert!(deep.stack_bytes >= 20 * 8 && deep.stack_bytes > shallow.stack_bytes, "{}", deep.stack_bytes);
    assert_eq!(machine.call("nothing", &[]).unwrap().stack_bytes, 0);
}

#[test]
fn code_in_ram_runs_and_may_change() {
    let mut machine = common::machine();
    assert_eq!(machine.call("in_ram", &[]).unwrap().value, 0x1234_5678);
    let code = 0x2000_4000;
    for (immediate, expected) in [(7_u8, 7), (9, 9)] {
        machine.write(code, &[immediate, 0x20, 0x70, 0x47]).unwrap(); // movs r0, #n; bx lr
        assert_eq!(machine.call_at(code, &[]).unwrap().value, expected);
    }
}

#[test]
fn flash_that_is_overwritten_is_decoded_again() {
    let mut machine = common::machine();
    let code = machine.symbol("breakpoint").unwrap().address;
    machine.call("breakpoint", &[]).unwrap_err();
    machine.write(code, &[5, 0x20, 0x70, 0x47]).unwrap(); // movs r0, #5; bx lr
    assert_eq!(machine.call("breakpoint", &[]).unwrap().value, 5);
}

#[test]
fn a_whole_image_copies_its_data_and_ends_at_a_breakpoint() {
    let run = common::machine().run_image(10_000).unwrap();
    assert_eq!((run.breakpoint, run.value), (0, 42));
    assert!(run.cost.instructions > 10 && run.cost.best < run.cost.worst);
}

#[test]
fn a_run_pauses_after_the_allowed_number_of_instructions() {
    let mut machine = common::machine();
    machine.reset().unwrap();
    let mut pauses: u64 = 0;
    while machine.resume(3).unwrap() == Stop::Limit {
        pauses += 1;
    }
    let in_pieces = machine.cost();
    assert_eq!(pauses, in_pieces.instructions / 3);
    assert_eq!(common::machine().run_image(10_000).unwrap().cost, in_pieces);
    assert!(matches!(common::machine().run_image(5), Err(RunError::Limit { limit: 5, .. })));
}

#[test]
fn timer_interrupts_wake_a_sleeping_core() {
    let mut machine = common::machine();
    assert_eq!(machine.call("sleep_for_ticks", &[1000, 5]).unwrap().value, 5);
}

#[test]
fn a_supervisor_call_returns_to_the_next_instruction() {
    let mut machine = common::machine();
    let call = machine.call("op_supervisor", &[40]).unwrap();
    assert_eq!(call.value, 42);
    assert_eq!(call.cost.instructions, 5);
    // The entry costs 12, and the return 10 more than a branch.
    assert_eq!(call.cost.nominal, 1 + 1 + 12 + 3 + 10 + 1 + 3);
    assert_eq!(call.stack_bytes, 32);
}

#[test]
fn an_interrupt_line_enters_its_handler_between_instructions() {
    let mut machine = common::machine();
    let quiet = machine.call("mac_loop", &[100, 3]).unwrap();
    let enable_interrupt_0 = machine.call("store", &[0xe000_e100, 1]).unwrap();
    assert_eq!(enable_interrupt_0.cost.instructions, 2);
    machine.set_interrupt(0, true);
    machine.limit_calls(1000);
    // The line is level-sensitive and never cleared, so the handler runs again and again.
    assert!(matches!(machine.call("mac_loop", &[100, 3]), Err(RunError::Limit { .. })));
    machine.set_interrupt(0, false);
    assert_eq!(machine.call("mac_loop", &[100, 3]).unwrap().value, quiet.value);
    assert!(machine.profile().iter().any(|function| function.name == "first_interrupt"));
}

#[test]
fn time_follows_a_column_of_the_cost_and_sleep_and_pauses_when_due() {
    use virtual_core::{CycleCase, Pace};
    let mut machine = common::machine();
    machine.call("mac_loop", &[100, 3]).unwrap();
    let cost = machine.cost();
    assert_eq!(machine.now(), cost.nominal);
    machine.set_pace(Pace { case: CycleCase::Worst, flash_waits: true });
    assert_eq!(machine.now(), cost.nominal, "a new pace changes nothing that has passed");
    machine.sleep_until(1_000_000);
    machine.sleep_until(10);
    machine.call("mac_loop", &[100, 3]).unwrap();
    let more = machine.cost() - cost;
    assert_eq!(machine.now(), 1_000_000 + more.worst + more.flash_waits);

    let clock = machine.clock();
    let start = machine.symbol("mac_loop").unwrap().address;
    machine.core().set_register(0, 1_000_000);
    machine.core().set_pc(start);
    let due = machine.now() + 5000;
    clock.set_due(due);
    assert_eq!(machine.resume_until_due().unwrap(), Stop::Due);
    assert!((due..due + 100).contains(&machine.now()), "{} {due}", machine.now());
}

#[test]
fn a_sleeping_core_that_is_resumed_sleeps_on_until_an_interrupt() {
    let mut machine = common::machine();
    let start = machine.symbol("sleep").unwrap().address;
    machine.core().set_pc(start);
    for resumption in 0..3 {
        assert_eq!(machine.resume(1000).unwrap(), Stop::Asleep, "resumption {resumption}");
        assert_eq!(machine.core().pc(), start + 2, "resumption {resumption}");
    }
}

#[test]
fn the_trace_unit_counts_the_cycles_of_the_model() {
    let mut machine = common::machine();
    // DEMCR.TRCENA and DWT_CTRL.CYCCNTENA start the counter.
    machine.call("store", &[0xe000_edfc, 1 << 24]).unwrap();
    machine.call("store", &[0xe000_1000, 1]).unwrap();
    let first = machine.call("load", &[0xe000_1004]).unwrap().value;
    let before = machine.now();
    machine.call("mac_loop", &[1000, 3]).unwrap();
    machine.sleep_until(machine.now() + 777);
    let passed = machine.now() - before;
    let second = machine.call("load", &[0xe000_1004]).unwrap().value;
    let overhead = 10;
    let counted = u64::from(second.wrapping_sub(first));
    assert!((passed..passed + overhead).contains(&counted), "{counted} {passed}");
}

#[test]
fn exceptions_are_recorded_from_the_first_request_on() {
    let mut machine = common::machine();
    machine.call("op_supervisor", &[40]).unwrap();
    assert!(machine.take_exception_changes().is_empty(), "the first call starts the record");
    machine.call("op_supervisor", &[40]).unwrap();
    let changes = machine.take_exception_changes();
    let numbers: Vec<(u16, u32)> = changes.iter().map(|change| (change.running, change.depth)).collect();
    assert_eq!(numbers, [(11, 1), (0, 0)]);
    assert!(changes[0].cycle < changes[1].cycle);
}

/// Device that adds up the values written to it, and reads as their sum.
#[derive(Debug, Default)]
struct Counter(AtomicU32);

impl Peripheral for Counter {
    fn read(&self, offset: u32, bytes: u32) -> Option<u32> {
        (offset == 4 && bytes == 4).then(|| self.0.load(Ordering::Relaxed))
    }

    fn write(&self, offset: u32, bytes: u32, value: u32) -> Option<()> {
        (offset == 0 && bytes == 4).then(|| {
            self.0.fetch_add(value, Ordering::Relaxed);
        })
    }
}

#[test]
fn a_device_answers_at_its_addresses_and_refuses_the_others() {
    let mut machine = common::machine();
    let counter = Arc::new(Counter::default());
    machine.map(0x4000_0000, 0x400, Arc::<Counter>::clone(&counter)).unwrap();
    for value in [5, 6] {
        machine.call("store", &[0x4000_0000, value]).unwrap();
    }
    assert_eq!(counter.0.load(Ordering::Relaxed), 11);
    assert_eq!(machine.call("load", &[0x4000_0004]).unwrap().value, 11);
    let error = machine.call("load", &[0x4000_0008]).unwrap_err();
    assert!(matches!(error, RunError::Address { address: 0x4000_0008, .. }), "{error:?}");
}

#[test]
fn the_profile_adds_up_to_the_whole() {
    let mut machine = common::machine();
    machine.call("format", &[0.1_f32.to_bits(), SCRATCH, 64]).unwrap();
    machine.call("ackermann", &[2, 3]).unwrap();
    let profile = machine.profile();
    let sum = profile.iter().fold(virtual_core::Cost::default(), |sum, function| sum + function.cost);
    assert_eq!(sum, machine.cost());
    assert!(profile.is_sorted_by(|a, b| a.cost.nominal >= b.cost.nominal));
    assert!(profile.iter().any(|function| function.name.starts_with("core::num::flt2dec")), "names are demangled");

    machine.clear_counts();
    assert!(machine.profile().is_empty() && machine.loops().is_empty());
    let cost = machine.call("mac_loop", &[10, 3]).unwrap().cost;
    let profile = machine.profile();
    assert_eq!((profile.len(), profile[0].name.as_str(), profile[0].cost), (1, "mac_loop", cost));
}

#[test]
fn a_recursion_is_no_loop() {
    let mut machine = common::machine();
    machine.call("ackermann", &[2, 3]).unwrap();
    let calls = machine.symbol("ackermann").unwrap().address;
    assert!(machine.loops().iter().all(|found| found.start != calls), "{:?}", machine.loops());
}

#[test]
fn a_machine_can_move_to_another_thread() {
    let mut machine = common::machine();
    let thread = std::thread::spawn(move || machine.call("nothing", &[7]).unwrap().value);
    assert_eq!(thread.join().unwrap(), 7);
}

#[test]
fn loops_are_found_with_their_length_and_passes() {
    let mut machine = common::machine();
    machine.call("mac_loop", &[500, 3]).unwrap();
    machine.call("mac_loop", &[500, 3]).unwrap();
    let loops = machine.loops();
    assert_eq!(loops.len(), 1, "{loops:?}");
    // smlal, smmla, mla and add.w have 4 bytes each, subs and bne 2.
    assert_eq!(loops[0].start, machine.symbol("mac_loop").unwrap().address + 8);
    assert_eq!((loops[0].bytes, loops[0].iterations, loops[0].instructions), (20, 2 * 499, 2 * 500 * 6));
}

#[test]
fn an_image_knows_its_sizes_and_symbols() {
    let image = Image::from_elf(&common::elf()).unwrap();
    // The RAM holds an initialised word, a function with its literal, and the counter of ticks.
    assert_eq!(image.static_ram_bytes(), 4 + 8 + 4);
    assert!(image.flash_bytes() > 10_000, "{}", image.flash_bytes());
    let symbol = image.symbol("mac_loop").unwrap();
    assert!(symbol.is_function && symbol.bytes == 32 && symbol.address & 1 == 0, "{symbol:?}");
    assert_eq!(image.entry(), image.symbol("reset").unwrap().address);
}

/// Between computed jumps the machine follows the program counter by itself. A stop after every
/// instruction makes it read that of the core, so that a difference shows.
#[test]
fn a_run_in_single_steps_costs_as_much_as_a_run_in_one_piece() {
    let cases: [(&str, [u32; 4]); 6] = [
        ("format", [0.1_f32.to_bits(), SCRATCH, 64, 0]),
        ("median", [SCRATCH, 90, 0, 0]),
        ("ackermann", [2, 4, 0, 0]),
        ("choose", [4, 99, 7, 0]),
        ("op_choose", [1, 1, 2, 3]),
        ("op_max_clamped", [1, 5, 0, 0]),
    ];
    for (function, arguments) in cases {
        let mut whole = common::machine();
        let words: Vec<u32> = (0..90_u32).map(|k| k.wrapping_mul(2_654_435_761)).collect();
        write_words(&mut whole, SCRATCH, &words);
        let expected = whole.call(function, &arguments).unwrap();

        let mut stepped = common::machine();
        write_words(&mut stepped, SCRATCH, &words);
        // A call leaves the stack and the FPU in the state in which the next call finds them.
        let before = stepped.call("nothing", &[]).unwrap().cost;
        stepped.clear_flash_cache();
        let [start, end] = [function, "breakpoint"].map(|name| stepped.symbol(name).unwrap().address);
        let core = stepped.core();
        for (register, argument) in (0..).zip(arguments) {
            core.set_register(register, argument);
        }
        core.set_register(14, end | 1);
        core.set_pc(start);
        while stepped.resume(1).unwrap() == Stop::Limit {}
        assert_eq!(stepped.core().register(0), expected.value, "{function}");
        assert_eq!(stepped.cost() - before, expected.cost, "{function}");
    }
}

/// Device that keeps the last value that was written to it, and refuses all reads.
#[derive(Debug, Default)]
struct Stores(AtomicU32);

impl Peripheral for Stores {
    fn read(&self, _: u32, _: u32) -> Option<u32> {
        None
    }

    fn write(&self, offset: u32, _: u32, value: u32) -> Option<()> {
        (offset == 0x8_0000).then(|| self.0.store(value, Ordering::Relaxed))
    }
}

#[test]
fn stores_to_flash_go_to_their_device_and_loads_to_the_memory() {
    const ADDRESS: u32 = FLASH_ADDRESS + 0x8_0000;
    let mut machine = common::machine();
    assert!(machine.call("store", &[ADDRESS, 5]).is_err(), "no device takes it");
    let stores = Arc::new(Stores::default());
    machine.map_flash_stores(Arc::<Stores>::clone(&stores)).unwrap();
    machine.call("store", &[ADDRESS, 5]).unwrap();
    assert_eq!(stores.0.load(Ordering::Relaxed), 5);
    assert_eq!(machine.call("load", &[ADDRESS]).unwrap().value, 0xffff_ffff);
    let error = machine.call("store", &[ADDRESS + 4, 5]).unwrap_err();
    assert!(matches!(error, RunError::Address { address, .. } if address == ADDRESS + 4), "{error:?}");
}

#[test]
fn trapped_reads_are_refused_until_the_trap_ends() {
    const ADDRESS: u32 = FLASH_ADDRESS + 0x8_0000;
    let mut machine = common::machine();
    let trap = machine.trap_reads(ADDRESS, 0x4000, Arc::new(Stores::default())).unwrap();
    let error = machine.call("load", &[ADDRESS + 0x100]).unwrap_err();
    assert!(matches!(error, RunError::Address { address, .. } if address == ADDRESS + 0x100), "{error:?}");
    assert_eq!(machine.call("load", &[ADDRESS + 0x4000]).unwrap().value, 0xffff_ffff);
    machine.untrap_reads(trap);
    assert_eq!(machine.call("load", &[ADDRESS + 0x100]).unwrap().value, 0xffff_ffff);
}

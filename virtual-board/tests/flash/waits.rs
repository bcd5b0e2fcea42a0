//! The core waits for flash, and nothing else does.

use script::{ACR, CR, CYCLES, Line, RCC, SR, START_CYCLES, UNLOCK, erase, program, read, run};
use virtual_board::{Board, BoardError, Fault, FlashTimes, Setup};

use crate::script;
use Line::{Read, Until, Write, Write8, Write16, WriteFromRam};

/// Address in sector 6.
const ADDRESS: u32 = 0x0804_0000;

fn joined(parts: &[&[Line]]) -> Vec<Line> {
    parts.concat()
}

fn refusal(lines: &[Line]) -> String {
    run(lines, &Setup::default(), 3.0).unwrap_err().to_string()
}

#[test]
fn core_waits_for_each_word_and_each_erase_and_both_are_there_then() {
    let lines = joined(&[
        &START_CYCLES,
        &UNLOCK,
        &[CYCLES],
        &program(ADDRESS, 0xcafe_f00d),
        &[CYCLES, Read(ADDRESS), Read(SR), CYCLES],
        &erase(6),
        &[CYCLES, Read(ADDRESS), Read(SR)],
    ]);
    for (flash_times, word_us, erase_ms) in [(FlashTimes::Typical, 16, 1000), (FlashTimes::Maximum, 100, 2000)] {
        let running = run(&lines, &Setup { flash_times, ..Setup::default() }, 2.5).unwrap();
        let [a, b, word, free, c, d, erased, freed] = read(&running)[..] else { panic!("{:x?}", read(&running)) };
        // 16 MHz, and some hundred cycles for the script.
        assert!((0..200).contains(&((b - a) as i32 - 16 * word_us)), "{} cycles for a word", b - a);
        assert!((0..200).contains(&((d - c) as i32 - 16_000 * erase_ms)), "{} cycles for a sector", d - c);
        assert_eq!([word, free, erased, freed], [0xcafe_f00d, 0, u32::MAX, 0]);
        let report = running.report().unwrap();
        assert_eq!((report.flash.erases[6], report.flash.programmed), (1, 1));
        assert!(report.warnings.is_empty(), "{:?}", report.warnings);
    }
}

#[test]
fn adc_and_dma_go_on_while_the_core_waits() {
    let (adc, dma, timer) = (0x4001_2000, 0x4002_6400, 0x4000_0400);
    let lines = joined(&[
        // A scan of two inputs each 1/8000 s into a ring of 16 frames.
        &[Write(RCC + 0x30, 0x0040_0003), Write(RCC + 0x40, 2), Write(RCC + 0x44, 0x100)],
        &[Write(0x4002_0000, 0xa800_003c), Write(adc + 0x04, 1 << 8), Write(adc + 0x2c, 1 << 20)],
        &[Write(adc + 0x34, 1 | 2 << 5), Write(adc + 8, 1), Write(dma + 0x14, 32), Write(dma + 0x18, adc + 0x4c)],
        &[Write(dma + 0x1c, 0x2000_1000), Write(dma + 0x10, 1 << 13 | 1 << 11 | 1 << 10 | 1 << 8 | 1)],
        &[Write(adc + 8, 1 | 1 << 8 | 1 << 9 | 8 << 24 | 1 << 28), Write(timer + 0x2c, 1999)],
        &[Write(timer + 4, 2 << 4), Write(timer, 1)],
        &UNLOCK,
        &erase(1),
        &[Read(adc), Read(dma + 0x14)],
    ]);
    let running = run(&lines, &Setup::default(), 0.26).unwrap();
    let report = running.report().unwrap();
    assert!((2070..2080).contains(&report.adc.sequences), "{} scans in 0.26 s", report.adc.sequences);
    let [status, left] = read(&running)[..] else { panic!() };
    assert_eq!((status & 1 << 5, report.adc.lost_triggers), (0, 0), "an overrun");
    // 2000 scans of two items went through the ring of 32.
    assert!((1..=32).contains(&left));
}

#[test]
fn core_that_waits_is_awake_and_its_watchdog_goes_on() {
    // The watchdog is due after 100 ms, in the midst of an erase.
    let watchdog = [Write(0x4000_3000, 0x5555), Write(0x4000_3004, 1), Write(0x4000_3008, 399)];
    let lines = joined(&[&UNLOCK, &program(0x0800_4000, 0), &watchdog, &[Write(0x4000_3000, 0xcccc)], &erase(1)]);
    let running = run(&lines, &Setup::default(), 0.15).unwrap();
    let report = running.report().unwrap();
    let [reset] = &report.resets[..] else { panic!("{:?}", report.resets) };
    assert!(reset.cause == "watchdog" && (0.1..0.1002).contains(&reset.at_s), "{reset:?}");
    assert_eq!((report.flash.torn, report.flash.erases[1]), (1, 1), "the second erase goes on");
    assert!(report.idle_share < 0.001, "{}", report.idle_share);
}

#[test]
fn erased_sector_is_not_read_through_a_data_cache_that_was_not_reset() {
    let erased = joined(&[&[Write(ACR, 1 << 10)], &UNLOCK, &program(ADDRESS, 5), &[Read(ADDRESS)], &erase(6)]);
    let refused = refusal(&joined(&[&erased, &[Read(ADDRESS + 0x1_0000)]]));
    assert!(refused.contains("FLASH_ACR.DCRST") && refused.contains("0x08050000"), "{refused}");
    // The cache is off, or another sector is read, or the cache was reset.
    for mend in [
        vec![Write(ACR, 0)],
        vec![Read(ADDRESS - 4)],
        vec![Write(ACR, 0), Write(ACR, 1 << 12), Write(ACR, 0), Write(ACR, 1 << 10)],
    ] {
        let is_other = matches!(mend[0], Read(_));
        let last = if is_other { vec![] } else { vec![Read(ADDRESS)] };
        let running = run(&joined(&[&erased, &mend, &last]), &Setup::default(), 1.5).unwrap();
        assert_eq!(read(&running), [5, u32::MAX]);
    }
    let never_reset = joined(&[&erased, &[Write(ACR, 0), Write(ACR, 1 << 10), Read(ADDRESS)]]);
    assert!(refusal(&never_reset).contains("FLASH_ACR.DCRST"), "a cache keeps its lines while it is off");
}

#[test]
fn stores_of_wrong_width_or_at_wrong_times_are_flags_or_end_the_run() {
    let lines = joined(&[
        &UNLOCK,
        &[Write(CR, 2 << 8 | 1), Write8(ADDRESS, 1), Read(SR), Write(SR, 0xf3)],
        &[Write16(ADDRESS, 1), Read(SR), Write(SR, 0xf3), Write(CR, 1 << 8 | 1), Write16(ADDRESS, 0x1234)],
        &[Read(SR), Read(ADDRESS)],
    ]);
    let running = run(&lines, &Setup::default(), 0.01).unwrap();
    assert_eq!(read(&running), [1 << 6, 1 << 6, 0, 0xffff_1234]);

    let locked = refusal(&[Write(ADDRESS, 0)]);
    assert!(locked.contains("write of 0x0 to flash (0x08040000)") && locked.contains("locked"), "{locked}");
    let own = refusal(&joined(&[&UNLOCK, &program(0x0800_0004, 0)]));
    assert!(own.contains("the program overwrites itself"), "{own}");
    let ram = joined(&[&UNLOCK, &[Write(CR, 2 << 8 | 1), WriteFromRam(ADDRESS, 0)]]);
    assert!(refusal(&ram).contains("while the program runs from RAM"), "{}", refusal(&ram));
}

#[test]
fn failed_operation_leaves_its_flag_and_the_program_may_try_again() {
    let lines = joined(&[
        &UNLOCK,
        &program(ADDRESS, 1),
        &[Read(SR), Read(ADDRESS), Write(SR, 1 << 4)],
        &program(ADDRESS, 1),
        &[Read(SR), Read(ADDRESS)],
    ]);
    let faults = vec![Fault::FlashError { nth: 0 }];
    let running = run(&lines, &Setup { faults, ..Setup::default() }, 0.01).unwrap();
    assert_eq!(read(&running), [1 << 4, u32::MAX, 0, 1]);
    assert_eq!((running.report().unwrap().flash.failed, running.flash_history().operations.len()), (1, 2));
}

#[test]
fn end_of_operation_sets_its_flag_at_a_wait_by_polling() {
    let lines = joined(&[
        &UNLOCK,
        &[Write(CR, 1 << 24 | 2 << 8 | 1), Write(ADDRESS, 3), Until(SR, 1), Write(SR, 1), Read(SR), Read(ADDRESS)],
    ]);
    assert_eq!(read(&run(&lines, &Setup::default(), 0.01).unwrap()), [0, 3]);
}

#[test]
fn flash_of_another_chip_is_refused() {
    let flash = Some(script::flash(Board::BlackpillF411, &[]));
    let refused = script::board(Board::Stm32f407gDisc1, &Setup { flash, ..Setup::default() }).unwrap_err();
    assert!(matches!(refused, BoardError::OtherFlash { .. }), "{refused}");
}

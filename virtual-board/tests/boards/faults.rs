//! Faults: each is named in the log, mutes or heals, and never makes a full-scale noise.

use crate::common;
use crate::hits::signal;
use crate::played::{events, heard_and_rendered, rate};
use dsp_core::event::Action;
use dsp_core::table::Kit;
use virtual_board::{Board, Fault, Press, Report, Setup, VirtualBoard};

/// Runs the F407 board with faults for `seconds` seconds.
fn run(faults: &[Fault], seconds: f64) -> (VirtualBoard, Report) {
    // One strike comes before the fault at about 0.4 s, and one after it.
    let piezos = vec![signal(0, seconds, &[(0.3, 0.3), (0.6, 0.3)])];
    let setup = Setup { piezos, faults: faults.to_vec(), ..Setup::default() };
    let running = common::run(Board::Stm32f407gDisc1, &setup, seconds);
    let report = running.report().unwrap();
    (running, report)
}

fn says(report: &Report, words: &str) -> bool {
    report.log.iter().any(|line| line.message.contains(words))
}

fn strikes(report: &Report) -> usize {
    report.log.iter().filter(|line| line.message.starts_with("event ") && line.message.ends_with("strike")).count()
}

/// Returns the magnitude of the loudest sample that left the I2S, 1.0 being full scale.
fn peak(running: &VirtualBoard) -> f64 {
    let streams = running.streams();
    let slots = streams.iter().flat_map(|stream| &stream.frames).flatten();
    slots.map(|slot| f64::from(slot.unsigned_abs()) / f64::from(1u32 << 31)).fold(0.0, f64::max)
}

#[test]
fn an_adc_overrun_is_logged_and_sampling_goes_on() {
    let (running, report) = run(&[Fault::AdcOverrun { at_s: 0.45 }], 0.75);
    assert!(says(&report, "ADC: overrun or DMA error, sampling started anew"), "{:#?}", report.log);
    assert_eq!(strikes(&report), 2, "{:#?}", report.log);
    assert!(report.resets.is_empty() && peak(&running) < 0.7);
}

#[test]
fn an_adc_dma_error_is_logged_and_sampling_goes_on() {
    let (_, report) = run(&[Fault::AdcDmaError { at_s: 0.45 }], 0.75);
    assert!(says(&report, "ADC: overrun or DMA error, sampling started anew"), "{:#?}", report.log);
    assert_eq!(strikes(&report), 2, "{:#?}", report.log);
}

#[test]
fn an_audio_dma_error_is_logged_and_sound_is_back_within_two_blocks() {
    let (running, report) = run(&[Fault::AudioDmaError { at_s: 0.35 }], 0.75);
    assert!(says(&report, "I2S: DMA transfer error, stream started anew"), "{:#?}", report.log);
    assert_eq!(strikes(&report), 2);
    assert!(peak(&running) < 0.7);
    let streams = running.streams();
    let [before, after] = streams.as_slice() else { panic!("{} streams", streams.len()) };
    let ended = before.start_s + before.frames.len() as f64 / before.rate.as_f64();
    let back = after.frames.iter().position(|frame| *frame != [0; 2]).unwrap();
    let gap_s = after.start_s - ended + back as f64 / after.rate.as_f64();
    println!("{gap_s} s");
    assert!(gap_s < 2.0 * 64.0 / 48_000.0, "{gap_s} s");
}

#[test]
fn a_codec_that_does_not_answer_is_logged_and_all_else_runs() {
    let (_, report) = run(&[Fault::CodecSilent], 0.75);
    assert!(says(&report, "codec: NotAnswering"), "{:#?}", report.log);
    assert_eq!(strikes(&report), 2);
    assert!(report.leds.iter().any(|led| led.led == "blue" && led.lit), "no blink code");
}

/// While the interrupt is lost the DMA goes round, so the last two halves are heard again and
/// again. Then the sound goes on where it was left, bit for bit.
#[test]
fn missed_halves_are_counted_and_sound_is_back_in_place_within_two_blocks() {
    const BLOCK: usize = 32;
    let (at_s, for_s, board) = (0.4, 0.02, Board::Stm32f407gDisc1);
    let (running, report) = run(&[Fault::AudioInterruptLost { at_s, for_s }], 0.75);
    let missed: usize = (report.log.iter())
        .filter_map(|line| line.message.strip_prefix("audio: ")?.strip_suffix(" halves missed")?.parse::<usize>().ok())
        .sum();
    let kit = kit::open("demo").unwrap().binary;
    let [heard, rendered] = heard_and_rendered(&running, board, &kit);
    let left = heard.iter().zip(&rendered).take_while(|(a, b)| a == b).count();
    // The heard frames end now, so times are counted back from the end.
    let frame = |at_s: f64| heard.len() - ((running.now_s() - at_s) * rate(board).hz()) as usize;
    println!("{missed} halves missed; of {} frames {left} before the fault", heard.len());
    assert!(left.abs_diff(frame(at_s)) <= 2 * BLOCK, "{left} {}", frame(at_s));
    assert!(missed.abs_diff((for_s * rate(board).hz()) as usize / BLOCK) <= 1, "{missed}");
    // Until the interrupts come again, the 64 frames of the buffer go round.
    let lost = left..frame(at_s + for_s) - BLOCK;
    assert!(lost.clone().all(|frame| heard[frame] == heard[frame - 2 * BLOCK]), "the stream has lost its place");
    // Two blocks later the sound is the rendered one, delayed by the missed halves.
    let back = frame(at_s + for_s) + 2 * BLOCK;
    let events = events(&running, &Kit::parse(&kit).unwrap(), rate(board));
    let end = heard.len() - (0.01 * rate(board).hz()) as usize;
    // A half that was written too late is counted too, but its sound is not delayed.
    let is_back = |lost: usize| (back..end).all(|frame| heard[frame] == rendered[frame - lost * BLOCK]);
    assert!(is_back(missed) || is_back(missed - 1), "the sound has not come back");
    assert!(heard[back..back + BLOCK].iter().any(|frame| *frame != [0; 2]), "nothing rings that could come back");
    assert_eq!(events.iter().filter(|event| event.action == Action::Strike).count(), 2);
    assert!(report.resets.is_empty() && peak(&running) < 0.7);
}

#[test]
fn a_stalled_core_is_restarted_by_the_watchdog_and_plays_again() {
    let lost = Fault::AudioInterruptLost { at_s: 0.35, for_s: 10.0 };
    let (running, report) = run(&[lost], 0.9);
    assert!(report.resets.iter().any(|reset| reset.cause == "watchdog"), "{:#?}", report.resets);
    assert!(says(&report, "started by Watchdog"), "{:#?}", report.log);
    assert!(peak(&running) < 0.7);
}

#[test]
fn a_board_that_goes_on_to_miss_halves_plays_the_others_and_is_not_restarted() {
    // One half in 15 is missed for longer than the watchdog's time.
    let lost = |n: u32| Fault::AudioInterruptLost { at_s: 0.35 + 0.01 * f64::from(n), for_s: 1.4e-3 };
    let (running, report) = run(&(0..60).map(lost).collect::<Vec<_>>(), 1.0);
    let lines = report.log.iter().filter(|line| line.message.contains("halves missed")).count();
    assert!(report.resets.is_empty(), "{:#?}", report.resets);
    assert!(lines >= 50, "{lines} lines");
    assert_eq!(strikes(&report), 2);
    assert!(peak(&running) < 0.7);
}

#[test]
fn a_debugger_may_halt_the_core_for_a_second_and_the_board_plays_on() {
    let (running, report) = run(&[Fault::Halted { at_s: 0.4, for_s: 1.0 }], 2.0);
    assert!(report.resets.is_empty(), "{:#?}", report.resets);
    assert!(says(&report, "halves missed"), "{:#?}", report.log);
    assert!(peak(&running) < 0.7);
}

/// Something takes half of the core's time, as a storm of interrupts would: each half has less
/// time than the budget was made for. It begins 0.37 of a half behind the half's interrupt, so that
/// 0.3 of the time are left in one piece, wherever the stream begins.
#[test]
fn a_board_whose_halves_are_late_leaves_more_modes_out_until_they_are_in_time() {
    let half_s = 32.0 * 1792.0 / 86e6;
    let started = common::run(Board::Stm32f407gDisc1, &Setup::default(), 0.25);
    let start_s = started.streams()[0].start_s;
    let (from_s, halves) = (start_s + half_s * (((0.4 - start_s) / half_s).floor() + 0.37), 1500);
    let stall = |n: u32| Fault::CoreStalled { at_s: from_s + half_s * f64::from(n), for_s: 0.7 * half_s };
    let hits =
        |piezo: usize| (0..30).map(|n| (0.38 + 0.035 * f64::from(n) + 0.003 * piezo as f64, 0.9)).collect::<Vec<_>>();
    let piezos = (0..4).map(|piezo| signal(piezo, 1.5, &hits(piezo))).collect();
    let setup = Setup { piezos, faults: (0..halves).map(stall).collect(), ..Setup::default() };
    let report = common::run(Board::Stm32f407gDisc1, &setup, 1.4).report().unwrap();
    let missed = |from_s: f64, to_s: f64| {
        let lines = report.log.iter().filter(|line| (from_s..to_s).contains(&line.at_s));
        lines.filter(|line| line.message.contains("halves missed")).count()
    };
    let (first, later) = (missed(0.4, 0.6), missed(1.2, 1.4));
    println!("{first} halves missed in the first 0.2 s, {later} in the last");
    assert!(report.resets.is_empty(), "{:#?}", report.resets);
    // 6 and 2 as measured: a budget that is in time for a second rises again, and is late anew.
    assert!(first > 0 && later * 2 <= first, "{first} and {later}");
}

#[test]
fn a_panic_is_told_again_at_the_next_start_with_version_and_revision() {
    for (fault, words) in
        [(Fault::Panic { at_s: 0.4 }, "virtual-board.rs:1:1"), (Fault::HardFault { at_s: 0.4 }, "hard fault at 0x")]
    {
        let (_, report) = run(&[fault], 0.8);
        let starts: Vec<_> = report.log.iter().filter(|line| line.message.starts_with("malleus ")).collect();
        assert!(starts.len() == 2 && starts[0].message.starts_with("malleus 0.1.0 ("), "{starts:#?}");
        let told = |boot| {
            report.log.iter().any(|line| {
                line.boot == boot && line.message.starts_with("last time: ") && line.message.contains(words)
            })
        };
        assert!(!told(0) && told(1), "{:#?}", report.log);
    }
    // The words are told once.
    let (_, report) = run(&[Fault::Panic { at_s: 0.4 }, Fault::CoreStalled { at_s: 0.9, for_s: 0.6 }], 1.8);
    let told = report.log.iter().filter(|line| line.message.starts_with("last time: ")).count();
    assert_eq!((report.resets.len(), told), (2, 1), "{:#?}", report.log);
}

#[test]
fn a_panic_and_a_hard_fault_mute_and_restart() {
    for (fault, name) in [(Fault::Panic { at_s: 0.4 }, "panic: "), (Fault::HardFault { at_s: 0.4 }, "hard fault at ")] {
        let (running, report) = run(&[fault], 0.8);
        let told = report.log.iter().find(|line| line.message.starts_with(name));
        assert!(told.is_some_and(|line| line.message.ends_with("muted, starting again")), "{:#?}", report.log);
        assert!(says(&report, "started by Program"), "{:#?}", report.log);
        assert!(report.resets.iter().any(|reset| reset.cause == "software"));
        assert!(report.mutes.iter().any(|mute| mute.mute && mute.at_s >= 0.4));
        assert!(peak(&running) < 0.7);
        assert_eq!(strikes(&report), 2);
    }
}

/// `probe-rs run` halts the core where it enters a hard fault. The DMA would play its last frames
/// round and round, while a pad rings.
#[test]
fn a_hard_fault_under_a_probe_that_catches_it_mutes_and_restarts() {
    let piezos = vec![signal(0, 1.0, &[(0.35, 0.8)])];
    let faults = vec![Fault::HardFault { at_s: 0.4 }];
    let setup = Setup { piezos, faults, probe_catches_faults: true, ..Setup::default() };
    for board in Board::ALL {
        let report = common::run(board, &setup, 0.7).report().unwrap();
        assert!(report.mutes.iter().any(|mute| mute.mute && (0.4..0.401).contains(&mute.at_s)), "{:#?}", report.mutes);
        assert!(report.resets.iter().map(|reset| reset.cause).eq(["software"]), "{:#?}", report.resets);
        assert!(says(&report, "last time: hard fault at 0x"), "{:#?}", report.log);
    }
}

/// The stack pointer is moved near the end of the stack while the board is silent and while pads
/// ring: an interrupt's frame does not fit any more, or what its handler calls does not.
#[test]
fn a_stack_overflow_is_told_mutes_and_restarts_before_other_memory_is_written() {
    for (board, left_bytes, at_s) in [
        (Board::Stm32f407gDisc1, 8, 0.4),
        (Board::Stm32f407gDisc1, 240, 0.62),
        (Board::BlackpillF411, 120, 0.4),
        (Board::BlackpillF411, 700, 0.62),
    ] {
        let seconds = 1.1;
        let setup = Setup {
            piezos: vec![signal(0, seconds, &[(0.6, 0.8), (1.0, 0.3)])],
            faults: vec![Fault::StackUsedUp { at_s, left_bytes }],
            ..Setup::default()
        };
        let running = common::run(board, &setup, seconds);
        let report = running.report().unwrap();
        let case = format!("{}, {left_bytes} bytes left", board.name());
        let told = report.log.iter().find(|line| line.boot == 1 && line.message.starts_with("last time: "));
        assert!(told.is_some_and(|line| line.message.contains("stack overflow")), "{case}: {:#?}", report.log);
        assert!(report.resets.iter().map(|reset| reset.cause).eq(["software"]), "{case}: {:#?}", report.resets);
        assert!(report.mutes.iter().any(|mute| mute.mute && mute.at_s >= at_s && mute.at_s < at_s + 2e-3), "{case}");
        assert!(peak(&running) < 0.7, "{case}");
        let last = report.log.iter().rfind(|line| line.message.ends_with("strike"));
        assert!(last.is_some_and(|line| line.boot == 1 && line.at_s > 1.0), "{case}: {:#?}", report.log);
    }
}

#[test]
fn a_board_whose_crystal_is_dead_plays_by_the_chips_oscillator_and_says_so() {
    for board in Board::ALL {
        let presses = vec![Press { at_s: 0.5, for_s: 0.05, bounce_s: 0.0 }];
        let setup = Setup { presses, faults: vec![Fault::CrystalDead], ..Setup::default() };
        let running = common::run(board, &setup, 1.0);
        let report = running.report().unwrap();
        assert!(says(&report, "crystal: does not start"), "{}: {:#?}", board.name(), report.log);
        assert!(report.resets.is_empty() && report.warnings.is_empty(), "{report:#?}");
        assert_eq!(strikes(&report), 1, "{}: {:#?}", board.name(), report.log);
        // By its name the oscillator has the frequency that the crystal would make.
        assert!((running.streams()[0].rate.as_f64() / rate(board).hz() - 1.0).abs() < 1e-9);
        assert!(peak(&running) > 0.01);
        let flashes = report.leds.iter().filter(|led| led.led == "blue" && led.lit && led.at_s > 0.3).count();
        assert!(flashes >= 1, "{}: {:#?}", board.name(), report.leds);
    }
}

#[test]
fn a_chip_without_brown_out_reset_is_told_at_the_start() {
    for board in Board::ALL {
        let report = common::run(board, &Setup::default(), 0.3).report().unwrap();
        assert!(says(&report, "brown-out reset: off"), "{:#?}", report.log);
    }
}

/// Four pads are struck faster than the log's memory holds while no probe fetches it.
#[test]
fn lines_that_nobody_fetches_are_dropped_whole_and_counted() {
    let seconds = 2.3;
    let hits =
        |piezo: usize| (0..50).map(|n| (0.42 + 0.03 * f64::from(n) + 0.005 * piezo as f64, 0.5)).collect::<Vec<_>>();
    let setup = Setup {
        piezos: (0..4).map(|piezo| signal(piezo, seconds, &hits(piezo))).collect(),
        faults: vec![Fault::ProbeAway { at_s: 0.5, for_s: 0.7 }],
        ..Setup::default()
    };
    let report = common::run(Board::Stm32f407gDisc1, &setup, seconds).report().unwrap();
    assert!(!says(&report, "(a frame that cannot be decoded"), "{:#?}", report.log);
    let number = |begin: &str, name: &str| -> usize {
        let line = report.log.iter().rfind(|line| line.message.starts_with(begin));
        let (_, rest) = line.and_then(|line| line.message.split_once(name)).unwrap_or_else(|| panic!("no {name}"));
        rest.split(|c: char| !c.is_ascii_digit()).next().unwrap().parse().unwrap()
    };
    let last_s = report.log.iter().rfind(|line| line.message.starts_with("second: ")).unwrap().at_s;
    let is_counted = |line: &&virtual_board::LogLine| {
        line.at_s < last_s && line.message.starts_with("event ") && line.message.ends_with("strike")
    };
    let told = report.log.iter().filter(is_counted).count();
    let (played, missing) = (number("second: ", "strikes "), number("faults: ", "unlogged lines "));
    println!("{played} strikes, {told} told, {missing} lines are missing");
    assert!(missing > 20, "{missing}");
    // Lines of other kinds may be missing too, and the last strikes may wait in the queue.
    assert!(played <= told + missing + 4, "{played} {told} {missing}");
}

#[test]
fn a_piezo_at_the_rail_is_logged_and_neither_hangs_nor_plays() {
    let (_, report) = run(&[Fault::PiezoAtRail { piezo: 2, at_s: 0.4 }], 0.75);
    assert!(says(&report, "piezo 2: stuck at the upper rail"), "{:#?}", report.log);
    // The step onto the rail may be taken for a strike.
    assert!((2..=3).contains(&strikes(&report)), "{:#?}", report.log);
}

#[test]
fn a_piezo_that_is_well_again_leaves_the_fault_of_another_on_the_led() {
    let (seconds, rail) = (1.6, 4.0);
    let mut at_rail = signal(1, seconds, &[]);
    let [from, to] = [0.35, 0.6].map(|at_s| (at_s * at_rail.rate_hz) as usize);
    at_rail.samples[from..to].fill(rail);
    let faults = vec![Fault::PiezoAtRail { piezo: 2, at_s: 0.35 }];
    let setup = Setup { piezos: vec![at_rail], faults, ..Setup::default() };
    let report = common::run(Board::Stm32f407gDisc1, &setup, seconds).report().unwrap();
    let well = report.log.iter().find(|line| line.message == "piezo 1: well again");
    let well_s = well.unwrap_or_else(|| panic!("{:#?}", report.log)).at_s;
    assert!(says(&report, "piezo 2: stuck at the upper rail") && !says(&report, "piezo 2: well again"));
    let flashes = report.leds.iter().filter(|led| led.led == "blue" && led.lit && led.at_s > well_s + 0.1).count();
    println!("{flashes} flashes after {well_s:.2} s");
    assert!(flashes >= 1, "{:#?}", report.leds);
}

#[test]
fn a_button_that_bounces_five_milliseconds_strikes_once() {
    let presses = vec![Press { at_s: 0.3, for_s: 0.1, bounce_s: 5e-3 }];
    let running = common::run(Board::BlackpillF411, &Setup { presses, ..Setup::default() }, 0.6);
    assert_eq!(strikes(&running.report().unwrap()), 1);
}

#[test]
fn a_bad_kit_is_refused_by_name_and_the_built_in_kit_plays() {
    let good = kit::open("demo").unwrap().binary;
    let mut corrupt = good.clone();
    corrupt[200] ^= 0x10;
    let mut half_written = good.clone();
    half_written[4000..].fill(0xFF);
    let mut too_new = good.clone();
    too_new[4] = 9;
    for (kit, words) in [
        (corrupt, "slot 0: Table(WrongCrc {"),
        (half_written, "slot 0: Table(WrongCrc {"),
        (too_new, "slot 0: Table(NewerVersion { found: 9 })"),
        (vec![0; 64], "slot 0: Table(WrongMagic {"),
        (Vec::new(), "slot 0: empty"),
    ] {
        let presses = vec![Press { at_s: 0.3, for_s: 0.05, bounce_s: 0.0 }];
        let is_refused = !kit.is_empty();
        let running = common::run(Board::Stm32f407gDisc1, &Setup { kit, presses, ..Setup::default() }, 0.35);
        let report = running.report().unwrap();
        assert!(says(&report, words) && says(&report, "built-in kit plays"), "{:#?}", report.log);
        assert_eq!(strikes(&report), 1, "{words}");
        assert_eq!(report.leds.iter().any(|led| led.led == "blue" && led.at_s < 0.3 && led.lit), is_refused, "{words}");
    }
}

#[test]
fn a_good_kit_in_the_sector_plays() {
    let kit = kit::open("demo").unwrap().binary;
    let running = common::run(Board::BlackpillF411, &Setup { kit, ..Setup::default() }, 0.3);
    assert!(says(&running.report().unwrap(), "slot 0: demo plays"));
}

#[test]
fn each_stage_that_a_board_leaves_out_of_a_kit_is_logged() {
    let mut demo = kit::open("demo").unwrap().kit;
    demo.room = vec![kit::RoomBand::new(0.0, 0.6, -12.0)];
    demo.objects[2].dynamic_filter = kit::open("filters").unwrap().kit.objects[2].dynamic_filter.clone();
    let kit = kit::binary::build(&demo).unwrap();
    let running = common::run(Board::BlackpillF411, &Setup { kit, ..Setup::default() }, 0.4);
    let report = running.report().unwrap();
    assert!(says(&report, "slot 0: demo plays"), "{:#?}", report.log);
    for reason in ["NotBuilt { stage: Room }", "TooDear { stage: DynamicFilter(2), cycles: "] {
        assert!(says(&report, &format!("left out: Load({reason}")), "{:#?}", report.log);
    }
    // The kit plays, and no LED shows a fault.
    assert!(!report.leds.iter().any(|led| led.at_s > 0.05 && led.lit), "{:#?}", report.leds);
}

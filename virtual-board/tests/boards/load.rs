//! Load: deadlines in the worst case, memory, and the absence of panics in the audio path.

use crate::common;
use std::collections::{BTreeMap, BTreeSet};
use std::process::Command;

use crate::hits::{SIGNAL_HZ, signal};
use virtual_board::{Board, CycleCase, PiezoSignal, Report, Setup};

#[test]
fn no_half_is_missed_with_the_worst_cycles_and_the_waits_of_flash() {
    let loads = Board::ALL.map(|board| {
        let piezos = (0..4).map(|piezo| {
            let strokes = (0..20).map(|n| (0.3 + 0.035 * f64::from(n) + 0.003 * piezo as f64, 0.9));
            signal(piezo, 1.1, &strokes.collect::<Vec<_>>())
        });
        let setup = Setup { cycles: CycleCase::Worst, flash_waits: true, piezos: piezos.collect(), ..Setup::default() };
        let report = common::run(board, &setup, 1.2).report().unwrap();
        let load = report.audio.worst_load.unwrap() / deadline(board);
        println!(
            "{}: the dearest half took {:.1} % of the time to its deadline, idle {:.1} %",
            board.name(),
            100.0 * load,
            100.0 * report.idle_share
        );
        assert!(
            !report.log.iter().any(|line| line.message.contains("missed") && line.level == "warn"),
            "{:#?}",
            report.log
        );
        assert_eq!(report.audio.late_halves, 0, "{}", board.name());
        load
    });
    // The F407 board takes 79.0 %, the BlackPill 86.7 %; both move by one or two percent with the
    // order of the code in flash.
    assert!(loads.iter().all(|&load| load <= 0.9), "{loads:?} of the time to the deadline");
}

/// Returns the time from an interrupt to the first frame that it renders, as a share of a half
/// (`LEAD_FRAMES` in `boards/src`).
pub(crate) fn deadline(board: Board) -> f64 {
    let lead_frames = match board {
        Board::Stm32f407gDisc1 => 28.0,
        Board::BlackpillF411 => 30.0,
    };
    lead_frames / 32.0
}

/// Returns the share of time in which the core is awake, from 0.5 to 1 s after the start.
pub(crate) fn busy(board: Board, setup: &Setup) -> f64 {
    let mut running = common::run(board, setup, 0.5);
    let before = running.report().unwrap();
    running.run_until(1.0).unwrap();
    let after = running.report().unwrap();
    assert!(after.log.iter().all(|line| !line.message.starts_with("event ")), "{:#?}", after.log);
    let spent = |report: &Report, name: &str| {
        report.functions.iter().find(|function| function.name == name).map_or(0, |function| function.nominal_cycles)
    };
    let cycles = (after.cycles - before.cycles) as f64;
    let mut functions: Vec<(&str, u64)> = (after.functions.iter())
        .map(|function| (function.name.as_str(), function.nominal_cycles - spent(&before, &function.name)))
        .collect();
    functions.sort_by_key(|&(_, cycles)| std::cmp::Reverse(cycles));
    for (name, spent) in functions.iter().take(6) {
        println!("  {:6.3} % {name}", 100.0 * *spent as f64 / cycles);
    }
    1.0 - (after.idle_cycles - before.idle_cycles) as f64 / cycles
}

#[test]
fn a_silent_board_with_armed_triggers_is_busy_for_a_twentieth_of_time() {
    // The noise has half a count rms, as the sum of twelve uniform numbers; the hum has 2 counts.
    let mut random = 1u32;
    let mut noise = || {
        random = random.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        f64::from(random >> 8) / f64::from(1 << 24) - 0.5
    };
    let mut at_rest = |piezo| {
        let counts = (0..48_000).map(|n| {
            let hum = 2.0 * (std::f64::consts::TAU * 50.0 * f64::from(n) / SIGNAL_HZ).sin();
            ((hum + 0.5 * (0..12).map(|_| noise()).sum::<f64>()) / 2048.0) as f32
        });
        PiezoSignal { piezo, start_s: 0.0, rate_hz: SIGNAL_HZ, samples: counts.collect() }
    };
    let quiet = Setup { piezos: (0..4).map(&mut at_rest).collect(), ..Setup::default() };
    for board in Board::ALL {
        let (silent, quiet) = (busy(board, &Setup::default()), busy(board, &quiet));
        println!(
            "{}: busy for {:.2} % of its time in silence, {:.2} % with noise of 0.5 counts rms and hum of 2 counts",
            board.name(),
            100.0 * silent,
            100.0 * quiet
        );
        assert!(silent <= 0.052 && quiet <= 0.052, "{}: {silent}, {quiet}", board.name());
    }
}

/// Number of bytes of the stack that every run must leave free.
pub(crate) const STACK_RESERVE: u32 = 4096;

#[test]
fn images_leave_flash_and_stack_free() {
    for board in Board::ALL {
        let report = common::run(board, &Setup::default(), 0.2).report().unwrap();
        let (used, room) = (report.stack_bytes.unwrap(), report.stack_room_bytes.unwrap());
        println!(
            "{}: {} bytes of flash, {} of RAM, and {used} of the {room} that are left for the stack",
            board.name(),
            report.flash_bytes,
            report.static_ram_bytes
        );
        assert!(used + STACK_RESERVE <= room, "{}: {used} of {room} bytes of stack", board.name());
        // The images take 387 700 and 326 800 bytes with USB, slots and settings. The BlackPill has
        // 352 KB for its program, vectors and built-in kit.
        let most = if board == Board::Stm32f407gDisc1 { 384 << 10 } else { 320 << 10 };
        assert!(report.flash_bytes <= most, "{}: {} bytes of flash", board.name(), report.flash_bytes);
    }
}

/// Every call from the interrupts of sound and button is followed. Calls through pointers would
/// hide; there are none but those of formatting, which is not reached, and those to the kernels of
/// the dynamic filter.
#[test]
fn nothing_in_the_audio_and_trigger_paths_can_panic() {
    for (board, interrupt) in [(Board::Stm32f407gDisc1, "DMA1_STREAM5"), (Board::BlackpillF411, "DMA1_STREAM4")] {
        let calls = calls(&common::application(board));
        let from_main = reached(&calls, "main");
        assert!(from_main.iter().any(|function| panics(function)), "the list of panics is out of date");
        for root in [interrupt, "EXTI0", "OTG_FS"] {
            let reached = reached(&calls, root);
            let panicking: Vec<_> = reached.iter().filter(|function| panics(function)).collect();
            println!("{}: {root} reaches {} functions", board.name(), reached.len());
            assert!(panicking.is_empty(), "{}: {root}: {panicking:?}", board.name());
            // The dynamic filter chooses its kernel by a pointer, so all its kernels are followed.
            // No other function may call through a pointer.
            let by_pointer = |function: &&String| calls.get(*function).is_some_and(|calls| calls.contains("(pointer)"));
            let others: Vec<_> =
                reached.iter().filter(by_pointer).filter(|name| !name.contains("dynamic_filter")).collect();
            assert!(others.is_empty(), "{}: {root} calls through a pointer: {others:?}", board.name());
            let kernels =
                calls.keys().filter(|name| name.starts_with("malleus_") || name.contains("dynamic_filter::kernel"));
            for kernel in kernels.filter(|_| reached.contains("(pointer)")) {
                let panicking: Vec<_> = self::reached(&calls, kernel).into_iter().filter(|name| panics(name)).collect();
                assert!(panicking.is_empty(), "{}: {kernel}: {panicking:?}", board.name());
            }
        }
        assert!(reached(&calls, interrupt).len() > 50, "the disassembly is read wrongly");
    }
}

/// Returns true if a function's name is that of a panic.
fn panics(function: &str) -> bool {
    ["panicking::", "unwrap_failed", "expect_failed", "_defmt_panic", "slice_index_fail"]
        .iter()
        .any(|word| function.contains(word))
}

/// Returns the functions that each function calls, by the toolchain's disassembler.
fn calls(elf: &[u8]) -> BTreeMap<String, BTreeSet<String>> {
    let path = std::env::temp_dir().join(format!("malleus-calls-{}-{}.elf", std::process::id(), elf.len()));
    std::fs::write(&path, elf).unwrap();
    let sysroot = Command::new("rustc").args(["--print", "sysroot"]).output().unwrap().stdout;
    let sysroot = String::from_utf8(sysroot).unwrap();
    let tools = std::path::Path::new(sysroot.trim()).join("lib/rustlib");
    let host = std::fs::read_dir(tools).unwrap().map(|entry| entry.unwrap().path().join("bin/llvm-objdump"));
    let objdump =
        host.into_iter().find(|path| path.exists()).expect("llvm-tools is a component of rust-toolchain.toml");
    let listing = Command::new(objdump).args(["-d", "-C", "--no-show-raw-insn"]).arg(&path).output().unwrap().stdout;
    std::fs::remove_file(&path).unwrap();
    let listing = String::from_utf8(listing).unwrap();
    let mut calls: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
    let mut function = String::new();
    for line in listing.lines() {
        if let Some(name) = line.strip_suffix(">:").and_then(|line| line.split_once(" <")) {
            function = name.1.to_owned();
            continue;
        }
        let mut parts = line.split('\t').skip(1);
        let (Some(mnemonic), Some(operands)) = (parts.next(), parts.next()) else { continue };
        // The linker fills the gaps between functions with 0xd4d4, which reads as this branch.
        if mnemonic == "bmi" && operands.ends_with("#-0x58") {
            continue;
        }
        let is_branch = mnemonic.starts_with('b') && !mnemonic.starts_with("bi") && !mnemonic.starts_with("bf");
        if mnemonic == "blx" && operands.starts_with('r') {
            calls.entry(function.clone()).or_default().insert("(pointer)".to_owned());
        } else if let (true, Some((_, target))) = (is_branch || mnemonic.starts_with("cb"), operands.split_once('<')) {
            let target = target.rsplit_once('>').map_or(target, |(target, _)| target);
            let name = target.rsplit_once("+0x").map_or(target, |(name, _)| name);
            calls.entry(function.clone()).or_default().insert(name.to_owned());
        }
    }
    calls
}

/// Returns all functions that calls reach from `root`.
fn reached(calls: &BTreeMap<String, BTreeSet<String>>, root: &str) -> BTreeSet<String> {
    let mut reached = BTreeSet::new();
    let mut open = vec![root.to_owned()];
    while let Some(function) = open.pop() {
        if reached.insert(function.clone()) {
            open.extend(calls.get(&function).into_iter().flatten().cloned());
        }
    }
    reached
}

//! Costs of the code on the virtual core: exact instruction counts of the kernels, their cycles,
//! and the engine's footprint.

use dsp_core::resonator::TICK_FRAMES;
use dsp_core::table::layout::{GainRecord, ModeRecord};
use host_tests::lent;
use host_tests::on_chip::scenes::{measure, pads, strikes};
use host_tests::on_chip::{BankOnChip, EngineOnChip};
use virtual_core::Cost;

/// Cost of the assembly in a call: the kernels and the walk between them, without the Rust around
/// it.
fn kernels(chip: &mut BankOnChip) -> Cost {
    let assembly = ["free_", "driven_", "short_", "next_", "after_", "leftover_", "finish", "malleus_kernel_"];
    let own = |name: &str| assembly.iter().any(|start| name.starts_with(start));
    let profile = chip.machine().profile();
    profile.iter().filter(|function| own(&function.name)).fold(Cost::default(), |sum, function| sum + function.cost)
}

/// Cost of the assembly for one run of a bank of 240 modes of one form, driven or ringing.
fn run(chip: &mut BankOnChip, hz: f32, cosine: f32, driven: bool, frames: usize) -> Cost {
    let (modes, gains): (Vec<_>, Vec<_>) = (0..240)
        .map(|n| {
            let mode = ModeRecord { frequency_hz: (hz + n as f32 * 0.1).into(), decay_per_s: 2.0.into() };
            (mode, GainRecord { sine: 3e5.into(), cosine: (cosine * 1e5).into() })
        })
        .unzip();
    chip.load(&modes, &gains, 48_000).unwrap();
    let force = [1 << 20; TICK_FRAMES];
    chip.tick(true).unwrap();
    chip.render(Some(&force), TICK_FRAMES).unwrap();
    for _ in 0..3 {
        chip.tick(true).unwrap();
        chip.render(driven.then_some(&force[..]), TICK_FRAMES).unwrap();
    }
    chip.machine().clear_counts();
    chip.render(driven.then_some(&force[..frames]), frames).unwrap();
    kernels(chip)
}

#[test]
fn the_kernels_execute_exactly_as_many_instructions_as_written_here() {
    // Columns: name, Hz, gain into v, driven, frames, instructions of 240 modes. A loop that
    // changes must change this table, on purpose.
    let table = [
        ("free, coupled", 1000.0, 0.0, false, 32, 38_631),
        ("free, shifted by 1", 6700.0, 0.0, false, 32, 38_631),
        ("free, shifted by 2", 10_000.0, 0.0, false, 32, 38_631),
        ("free, mirrored", 14_000.0, 0.0, false, 32, 38_678),
        ("free, coupled, half a tick", 1000.0, 0.0, false, 16, 26_371),
        ("one gain, coupled", 1000.0, 0.0, true, 32, 52_749),
        ("one gain, shifted by 1", 6700.0, 0.0, true, 32, 52_749),
        ("gain and phase, coupled", 1000.0, 1.0, true, 32, 60_789),
        ("gain and phase, shifted by 2", 10_000.0, 1.0, true, 32, 60_789),
        ("gain and phase, coupled, half a tick", 1000.0, 1.0, true, 16, 39_739),
    ];
    let mut chip = BankOnChip::new().unwrap();
    let mut changed = Vec::new();
    for (what, hz, cosine, driven, frames, expected) in table {
        let cost = run(&mut chip, hz, cosine, driven, frames);
        let per = cost.nominal as f64 / (240 * frames) as f64;
        println!("{what}: {} instructions, {per:.3} cycles a mode and sample", cost.instructions);
        if cost.instructions != expected {
            changed.push(format!("{what}: {} instructions, {expected} expected", cost.instructions));
        }
    }
    assert!(changed.is_empty(), "\n{}", changed.join("\n"));
}

#[test]
fn the_kernels_keep_their_cycles_and_their_loops_fit_the_flash_cache() {
    let mut chip = BankOnChip::new().unwrap();
    // These are limits of the bank alone with all its Rust, in nominal cycles a mode and sample.
    for (what, cosine, driven, at_most) in
        [("free", 0.0, false, 5.5), ("one gain", 0.0, true, 7.8), ("gain and phase", 1.0, true, 9.3)]
    {
        let cost = run(&mut chip, 1000.0, cosine, driven, TICK_FRAMES);
        let per = cost.nominal as f64 / f64::from(240 * 32);
        let with_flash = cost.with_flash() as f64 / cost.nominal as f64;
        // The inner loop runs most instructions. The outer one, which brings the next modes, is
        // left out.
        let inner = chip.machine().loops().into_iter().filter(|found| found.iterations > 1).map(|found| found.bytes);
        let inner = inner.filter(|&bytes| bytes > 600).min().unwrap_or(0);
        println!("{what}: {per:.3} cycles, with flash x {with_flash:.3}, inner loop {inner} bytes");
        assert!(per <= at_most && with_flash <= 1.03 && inner <= 900, "{what}");
    }
}

#[test]
fn a_silent_engine_and_its_memory_stay_small() {
    let mut chip = EngineOnChip::new().unwrap();
    let silent = measure(&mut chip, &pads(8).binary, &[], None, (8, 40)).unwrap();
    let per_frame = silent.total.nominal as f64 / f64::from(32 * 32);
    let ringing = measure(&mut chip, &pads(8).binary, &strikes(8, 5, 0.8), None, (0, 40)).unwrap();
    let footprint = chip.footprint().unwrap();
    let kit = kit::open("demo").unwrap().binary.len();
    println!(
        "silent: {per_frame:.1} cycles a frame; stack {} bytes; {footprint:?}, kit {kit} bytes",
        ringing.stack_bytes
    );
    assert!(per_frame <= 20.5, "0.6 % of 168 MHz at 48 kHz are 20.5 cycles a frame: {per_frame}");
    assert!(ringing.stack_bytes <= 2048, "{} bytes of stack", ringing.stack_bytes);
    // The engine has every stage. Without noise, filters and room an engine took 78 582 bytes while
    // it had type parameters for them. The path of the build stands in the messages of panics, and
    // adds some bytes. Frames take 24 KB, contacts that go on some 41 KB: a table of tanh takes
    // 4 KB, which spares 18 cycles a frame.
    assert!(footprint.flash <= 320 * 1024, "the engine without its kit: {} bytes", footprint.flash);
    // 42 contacts, as all engines have, take 2 KB of the RAM.
    assert!(footprint.ram <= 19_600, "{} bytes", footprint.ram);
}

/// This is the kit for whose engine the limit of memory above holds: 512 modes on eight pads.
#[test]
fn the_kit_of_eight_pads_has_512_modes() {
    let binary = pads(8).binary;
    let kit = dsp_core::table::Kit::parse(&binary).unwrap();
    let engine = lent::engine(&kit, dsp_core::SampleRate::HZ_48000, dsp_core::engine::Skipping::On).unwrap();
    assert_eq!((0..8).map(|pad| engine.mode_count(pad)).sum::<usize>(), 512);
}

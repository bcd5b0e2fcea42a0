//! Banks in frames on the virtual core: bits equal to the PC's, and their cost.

use dsp_core::SampleRate;
use dsp_core::frames::BLOCK_FRAMES;
use dsp_core::resonator::TICK_FRAMES;
use host_tests::frames::{FramesOnPc, contact, prior};
use host_tests::on_chip::FramesOnChip;
use host_tests::snr::Random;
use virtual_core::FunctionCost;

const RATE: SampleRate = SampleRate::HZ_44100;

#[test]
fn the_chip_gives_the_bits_of_the_pc_for_any_run_length() {
    let mut chip = FramesOnChip::new().unwrap();
    for (count, t60_s) in [(3, [0.002, 0.02]), (64, [0.003, 0.3]), (300, [0.01, 5.0])] {
        let modes = prior(count, t60_s);
        chip.load(&modes, RATE).unwrap();
        let mut pc = FramesOnPc::new(&modes, RATE, true);
        let mut random = Random::new(7);
        let mut frame = 0;
        while frame < 12 * BLOCK_FRAMES {
            let frames = (random.between(1.0, 33.0) as usize).min(TICK_FRAMES - frame % TICK_FRAMES);
            let force: Vec<i32> = match frame / 300 % 3 {
                0 => (0..frames).map(|_| random.between(-1e7, 1e7) as i32).collect(),
                _ => vec![0; frames],
            };
            let driven = force.iter().any(|&x| x != 0);
            let (on_chip, _) = chip.render(driven.then_some(&force), frames).unwrap();
            assert_eq!(on_chip, pc.render(&force, 32), "{count} modes, frame {frame}");
            frame += frames;
        }
    }
}

/// Nominal cycles a frame of a pad over ticks: mean and dearest tick.
fn cycles(
    chip: &mut FramesOnChip,
    force: impl Fn(usize) -> Option<Vec<i32>>,
    ticks: std::ops::Range<usize>,
) -> (f64, f64) {
    let (mut sum, mut dearest) = (0.0, 0.0f64);
    for tick in 0..ticks.end {
        let force = force(tick);
        let (_, cost) = chip.render(force.as_deref(), TICK_FRAMES).unwrap();
        let cycles = cost.nominal as f64 / TICK_FRAMES as f64;
        if ticks.contains(&tick) {
            (sum, dearest) = (sum + cycles, dearest.max(cycles));
        }
    }
    (sum / ticks.len() as f64, dearest)
}

/// Prints the functions that take most of a number of ticks.
fn print_functions(profile: &[FunctionCost], ticks: usize) {
    for FunctionCost { name, cost, .. } in profile {
        let cycles = cost.nominal as f64 / (ticks * TICK_FRAMES) as f64;
        if cycles >= 5.0 {
            println!("{cycles:7.1} cycles a frame in {name}");
        }
    }
}

#[test]
fn thousand_modes_ring_and_are_struck_within_the_cycles_of_the_page() {
    let mut chip = FramesOnChip::new().unwrap();
    // Number of modes; cycles a frame ringing, of the dearest tick of a strike, under a direct
    // force in the mean and at most.
    let page = [
        (64, [364.0, 818.0, 1595.0, 1772.0]),
        (256, [450.0, 1003.0, 1762.0, 1920.0]),
        (1025, [757.0, 1621.0, 2348.0, 2502.0]),
    ];
    let mut ringing = Vec::new();
    for (count, stated) in page {
        let modes = prior(count, [3.0, 20.0]);
        let load = chip.load(&modes, RATE).unwrap();
        let contact = contact(44);
        let once = |tick: usize| {
            let mut force: Vec<i32> = contact.iter().copied().skip(tick * TICK_FRAMES).take(TICK_FRAMES).collect();
            force.resize(TICK_FRAMES, 0);
            (tick < 2).then_some(force)
        };
        cycles(&mut chip, once, 0..40);
        chip.machine().clear_counts();
        let (free, _) = cycles(&mut chip, |_| None, 0..16);
        print_functions(&chip.machine().profile(), 16);
        assert!(chip.ringing().unwrap() as usize >= count * 99 / 100, "too few modes ring for the figure");
        chip.load(&modes, RATE).unwrap();
        let (_, struck) = cycles(&mut chip, once, 0..40);
        chip.load(&modes, RATE).unwrap();
        let direct = |tick: usize| Some((0..TICK_FRAMES).map(|n| (n * 9999 + tick * 77) as i32 * 50 + 1).collect());
        chip.machine().clear_counts();
        let (driven, dearest) = cycles(&mut chip, direct, 24..56);
        print_functions(&chip.machine().profile(), 56);
        println!(
            "{count} modes: ringing {free:.0} cycles a frame, dearest tick of a strike {struck:.0}, direct force \
             {driven:.0}, dearest {dearest:.0}; {} bytes; load {} cycles a mode",
            chip.bytes().unwrap(),
            load.nominal / count as u64
        );
        for (measured, stated) in [free, struck, driven, dearest].into_iter().zip(stated) {
            assert!(measured <= stated * 1.02, "{count} modes: {measured:.0} cycles a frame, not {stated}");
        }
        ringing.push(free);
    }
    let of_mode = (ringing[2] - ringing[0]) / (1025.0 - 64.0);
    let off = ringing[1] / (ringing[0] + of_mode * (256.0 - 64.0)) - 1.0;
    println!("{of_mode:.3} cycles a mode and frame; 256 modes {:+.1} % off the line", 100.0 * off);
    assert!(of_mode <= 0.42 && off.abs() <= 0.03);
}

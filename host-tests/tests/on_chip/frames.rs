//! Banks in frames on the virtual core: bits equal to the PC's, and their cost.

use dsp_core::SampleRate;
use dsp_core::event::{Event, Time};
use dsp_core::frames::{BLOCK_FRAMES, FrameBankSize};
use dsp_core::resonator::TICK_FRAMES;
use host_tests::frames::{FramesOnPc, prior};
use host_tests::on_chip::lone_pad::{SCENES, direct_force, kit_of, play_engine, play_stage, struck_once};
use host_tests::on_chip::{EngineOnChip, FramesOnChip};
use host_tests::scene::load;
use host_tests::snr::Random;
use virtual_core::FunctionCost;
use virtual_core::cycle::flash::Switches;

const RATE: SampleRate = SampleRate::HZ_44100;

/// Largest difference of the dearest ticks with the waits of flash and without, in cycles a frame:
/// 5 % above the figure of docs/frames.md.
const MOST_WAITS: f64 = 318.0;

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
        (64, [244.0, 643.0, 1233.0, 1312.0]),
        (256, [332.0, 770.0, 1336.0, 1445.0]),
        (1025, [637.0, 1339.0, 1796.0, 1872.0]),
    ];
    let mut ringing = Vec::new();
    for (count, stated) in page {
        let modes = prior(count, [3.0, 20.0]);
        let load = chip.load(&modes, RATE).unwrap();
        play_stage(&mut chip, struck_once, 0..40).unwrap();
        chip.machine().clear_counts();
        let free = play_stage(&mut chip, |_| None, 0..16).unwrap().mean();
        print_functions(&chip.machine().profile(), 16);
        assert!(chip.ringing().unwrap() as usize >= count * 99 / 100, "too few modes ring for the figure");
        chip.load(&modes, RATE).unwrap();
        let struck = play_stage(&mut chip, struck_once, 0..40).unwrap().dearest();
        chip.load(&modes, RATE).unwrap();
        chip.machine().clear_counts();
        let direct = play_stage(&mut chip, |tick| Some(direct_force(tick)), 24..56).unwrap();
        let (driven, dearest) = (direct.mean(), direct.dearest());
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

#[test]
fn the_engine_keeps_the_cycles_of_the_page_with_a_thousand_modes_and_bands() {
    let mut chip = EngineOnChip::new().unwrap();
    let mut wrong = Vec::new();
    // Mean of each scene, and dearest tick, on docs/frames.md.
    let stated = [
        (256, 0, [413, 377, 1586, 1465], [455, 805, 1727, 1544]),
        (1025, 0, [715, 626, 2039, 1917], [764, 1371, 2226, 2029]),
        (1025, 100, [1027, 883, 2360, 1928], [1132, 1464, 2583, 2040]),
    ];
    for (modes, bands, means, dearest) in stated {
        let kit = load(kit_of(modes, bands)).binary;
        for (((what, drive, ticks), mean), most) in SCENES.into_iter().zip(means).zip(dearest) {
            let played = play_engine(&mut chip, &kit, drive, None, ticks).unwrap();
            println!("{modes} modes, {bands} bands, {what}: {played:.0?}");
            let (mean, most) = (f64::from(mean), f64::from(most));
            let is_as_stated = (played.mean / mean - 1.0).abs() <= 0.03
                && (played.dearest / most - 1.0).abs() <= 0.03
                && played.dearest_with_flash <= played.dearest + MOST_WAITS;
            if !is_as_stated {
                wrong.push(format!("{modes} modes, {bands} bands, {what}: {played:.0?}, not {mean} and {most}"));
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn the_cost_of_a_pad_in_frames_is_predicted_within_six_percent() {
    let mut chip = EngineOnChip::new().unwrap();
    for modes in [256, 1025] {
        let mut kit = kit_of(modes, 0);
        // A mode in the bank, which a budget could shed.
        kit.strikers[0].modes = vec![host_tests::scene::mode(500.0, 0.1, 1.0, 0.0)];
        let kit = load(kit).binary;
        for (what, drive, ticks) in SCENES {
            let played = play_engine(&mut chip, &kit, drive, Some(u32::MAX), ticks).unwrap();
            let error = played.predicted / played.mean - 1.0;
            println!(
                "{modes} modes, {what}: predicted {:.0}, modelled {:.0}, {:+.1} %",
                played.predicted,
                played.mean,
                100.0 * error
            );
            assert!(error.abs() <= 0.06, "{modes} modes, {what}: {error}");
        }
    }
}

#[test]
fn engine_of_a_thousand_modes_takes_fewest_cycles_with_the_caches_alone() {
    let kit = load(kit_of(1025, 100)).binary;
    let (what, drive, ticks) = SCENES[2].clone();
    let [alone, prefetch] = [false, true].map(|prefetch| {
        let mut chip = EngineOnChip::new().unwrap();
        chip.machine().accelerator().switch(Switches { prefetch, ..Switches::AT_168_MHZ });
        play_engine(&mut chip, &kit, drive, None, ticks.clone()).unwrap()
    });
    println!("{what}: caches alone {alone:.0?}, and prefetch by the model {prefetch:.0?}");
    let limit = 1.08 * 2700.0;
    assert!(alone.dearest_with_flash <= limit, "{alone:.0?}");
    assert!(prefetch.dearest_with_flash > limit, "{prefetch:.0?}");
}

#[test]
fn long_contacts_take_the_cycles_that_the_load_counts() {
    let mut chip = EngineOnChip::new().unwrap();
    let mut wrong = Vec::new();
    for (modes, contact_s) in [(250, 3e-4), (250, 1.2e-3), (250, 3e-3), (250, 6e-3), (1025, 1.2e-3), (1025, 6e-3)] {
        let mut kit = kit_of(modes, 0);
        (kit.strikers[0].contact_time_s, kit.strikers[0].contact_exponent) = (contact_s, 0.0);
        let kit = load(kit).binary;
        // Contacts that lie within a block, or cross from one to the next.
        let ticks = [130, 250].map(|offset| struck_in_block(&mut chip, &kit, offset));
        let dearest = ticks.into_iter().fold(0.0, f64::max);
        let contact_frames = (f64::from(contact_s) * RATE.hz()) as u32;
        let counted = FrameBankSize { modes, positions: 1, contact_frames, has_hand: false }.cycles(false);
        println!("{modes} modes, contact {contact_frames} frames: dearest tick {dearest:.0}, counted {counted}");
        if !(0.97..1.04).contains(&(f64::from(counted) / dearest)) {
            wrong.push((modes, contact_s, dearest, counted));
        }
    }
    assert!(wrong.is_empty(), "{wrong:?}");
}

/// Cycles a frame of the dearest tick of a strike at a frame of the second block.
fn struck_in_block(chip: &mut EngineOnChip, kit: &[u8], frame: usize) -> f64 {
    chip.load(kit, RATE).unwrap();
    let at = BLOCK_FRAMES + frame;
    let ticks = (0..4 * BLOCK_FRAMES / TICK_FRAMES).map(|tick| {
        let event = Event { time: Time::at_frame(at as u64), velocity: 0.8, ..Event::default() };
        let events: &[Event] = if at / TICK_FRAMES == tick { &[event] } else { &[] };
        chip.render(events, None, TICK_FRAMES).unwrap().1.cost.nominal as f64 / TICK_FRAMES as f64
    });
    ticks.fold(0.0, f64::max)
}

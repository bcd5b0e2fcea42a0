//! Banks in frames on the virtual core: bits equal to the PC's, and their cost.

use dsp_core::SampleRate;
use dsp_core::frames::BLOCK_FRAMES;
use dsp_core::resonator::TICK_FRAMES;
use host_tests::frames::{FramesOnPc, contact, prior};
use dsp_core::engine::Direct;
use dsp_core::event::{Event, Time};
use host_tests::on_chip::{EngineOnChip, FramesOnChip};
use host_tests::scene::{load, one_pad};
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
        (64, [367.0, 845.0, 1399.0, 1648.0]),
        (256, [453.0, 1048.0, 1562.0, 1769.0]),
        (1025, [761.0, 1604.0, 2020.0, 2147.0]),
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

/// Kit of one pad with a prior's modes, and with noise in bands if there are any.
fn thing(modes: usize, bands: usize) -> Vec<u8> {
    let records = prior(modes, [3.0, 20.0]);
    let mode = |heard: &host_tests::frames::HeardMode| {
        host_tests::scene::mode(heard.frequency_hz, heard.t60_s, RATE.hz() * heard.sine, RATE.hz() * heard.cosine)
    };
    let mut kit = one_pad(records.iter().map(mode).collect());
    kit.objects[0].reference_force = 1.0;
    kit.pads[0].level_db = -20.0;
    let edge = |band: usize| (40.0 * (20_000f64 / 40.0).powf(band as f64 / bands as f64)) as f32;
    if bands > 0 {
        kit.objects[0].residual = Some(kit::Residual {
            seed: 1,
            edges_hz: (0..=bands).map(edge).collect(),
            weight: vec![0.001; bands],
            decay_db_per_s: vec![30.0; bands],
        });
    }
    load(kit).binary
}

/// Mean and dearest tick in cycles a frame, nominal and with the waits of flash, over a range of
/// ticks of a kit.
fn played(
    chip: &mut EngineOnChip,
    kit: &[u8],
    every: Option<u64>,
    (direct, budget): (bool, bool),
    ticks: std::ops::Range<usize>,
) -> [f64; 4] {
    chip.load(kit, RATE).unwrap();
    if budget {
        chip.set_budget(u32::MAX).unwrap();
    }
    let mut predicted = 0.0;
    let mut played = [0.0, 0.0f64, 0.0, 0.0f64];
    let end = (ticks.end * TICK_FRAMES) as u64;
    let strikes: Vec<u64> = every.map_or(vec![300], |every| (300..end).step_by(every as usize).collect());
    for tick in 0..ticks.end {
        if tick == ticks.start {
            chip.machine().clear_counts();
        }
        let frames = (tick * TICK_FRAMES) as u64..((tick + 1) * TICK_FRAMES) as u64;
        let events: Vec<Event> = strikes
            .iter()
            .filter(|&at| frames.contains(at))
            .map(|&frame| Event { time: Time::at_frame(frame), velocity: 0.8, ..Event::default() })
            .collect();
        let force: Vec<i32> = (0..TICK_FRAMES).map(|n| (n * 9999 + tick * 77) as i32 * 50 + 1).collect();
        let direct = direct.then_some(Direct { pad: 0, force: &force });
        let (_, call) = chip.render(&events, direct, TICK_FRAMES).unwrap();
        if ticks.contains(&tick) {
            predicted += f64::from(chip.told().unwrap().predicted_cycles) / (ticks.len() * TICK_FRAMES) as f64;
            let [nominal, with_flash] =
                [call.cost.nominal, call.cost.flash_168].map(|cycles| cycles as f64 / TICK_FRAMES as f64);
            played = [
                played[0] + nominal / ticks.len() as f64,
                played[1].max(nominal),
                played[2] + with_flash / ticks.len() as f64,
                played[3].max(with_flash),
            ];
        }
    }
    if budget {
        println!("predicted {predicted:.0}, modelled {:.0}", played[0]);
    }
    played
}

#[test]
fn the_engine_plays_a_thousand_modes_and_a_hundred_bands_within_the_cycles_of_the_page() {
    let mut chip = EngineOnChip::new().unwrap();
    // Ringing, struck each millisecond and its dearest tick, direct force and its dearest tick.
    let page = [(256, [577.0, 1907.0, 2198.0, 1770.0, 1975.0]), (1025, [886.0, 2363.0, 2604.0, 2228.0, 2382.0])];
    for ((modes, stated), bands) in page.into_iter().zip([0, 0]) {
        let kit = thing(modes, bands);
        let ringing = played(&mut chip, &kit, None, (false, false), 60..92);
        print_functions(&chip.machine().profile(), 32);
        let struck = played(&mut chip, &kit, None, (false, false), 0..60);
        let each_ms = played(&mut chip, &kit, Some(44), (false, false), 24..88);
        let direct = played(&mut chip, &kit, None, (true, false), 24..56);
        played(&mut chip, &kit, Some(44), (false, true), 24..88);
        print_functions(&chip.machine().profile(), 64);
        played(&mut chip, &kit, None, (false, true), 24..88);
        played(&mut chip, &kit, None, (true, true), 24..88);
        println!("{modes} modes, {bands} bands: ringing {ringing:.0?}, struck {struck:.0?}, each ms {each_ms:.0?}, direct {direct:.0?}");
        for (measured, stated) in [ringing[0], each_ms[0], each_ms[1], direct[0], direct[1]].into_iter().zip(stated) {
            assert!(measured <= stated * 1.02, "{modes} modes: {measured:.0} cycles a frame, not {stated}");
        }
    }
}

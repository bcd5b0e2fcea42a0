//! Banks in frames on the virtual core: bits equal to the PC's, and their cost.

use dsp_core::SampleRate;
use dsp_core::engine::Direct;
use dsp_core::event::{Event, Time};
use dsp_core::frames::BLOCK_FRAMES;
use dsp_core::resonator::TICK_FRAMES;
use host_tests::frames::{FramesOnPc, contact, prior};
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
        (64, [264.0, 715.0, 1375.0, 1615.0]),
        (256, [352.0, 873.0, 1452.0, 1555.0]),
        (1025, [656.0, 1459.0, 1913.0, 2017.0]),
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

/// Kit of a pad with a prior's modes, and with noise in bands if there are any.
pub(crate) fn thing(modes: usize, bands: usize) -> kit::Kit {
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
    kit
}

/// Drive of a pad.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Drive {
    Strike,
    /// A strike each so many frames.
    Strikes(u64),
    Direct,
}

/// Cycles a frame of some ticks of a kit.
#[derive(Debug, Default)]
struct Played {
    mean: f64,
    dearest: f64,
    mean_with_flash: f64,
    dearest_with_flash: f64,
    predicted: f64,
}

/// Plays a range of ticks of a kit, without a budget or with one that is never reached.
fn played(
    chip: &mut EngineOnChip,
    kit: &[u8],
    drive: Drive,
    budget: Option<u32>,
    ticks: std::ops::Range<usize>,
) -> Played {
    chip.load(kit, RATE).unwrap();
    if let Some(budget) = budget {
        chip.set_budget(budget).unwrap();
    }
    let end = (ticks.end * TICK_FRAMES) as u64;
    let strikes: Vec<u64> = match drive {
        Drive::Strike => vec![300],
        Drive::Strikes(every) => (300..end).step_by(every as usize).collect(),
        Drive::Direct => vec![],
    };
    let mut played = Played::default();
    for tick in 0..ticks.end {
        let frames = (tick * TICK_FRAMES) as u64..((tick + 1) * TICK_FRAMES) as u64;
        let events: Vec<Event> = (strikes.iter().filter(|&at| frames.contains(at)))
            .map(|&frame| Event { time: Time::at_frame(frame), velocity: 0.8, ..Event::default() })
            .collect();
        let force: Vec<i32> = (0..TICK_FRAMES).map(|n| (n * 9999 + tick * 77) as i32 * 50 + 1).collect();
        let direct = (drive == Drive::Direct).then_some(Direct { pad: 0, force: &force });
        let (_, call) = chip.render(&events, direct, TICK_FRAMES).unwrap();
        if ticks.contains(&tick) {
            let [nominal, with_flash] =
                [call.cost.nominal, call.cost.flash_168].map(|cycles| cycles as f64 / TICK_FRAMES as f64);
            let predicted = f64::from(chip.told().unwrap().predicted_cycles) / TICK_FRAMES as f64;
            for (sum, one) in [
                (&mut played.mean, nominal),
                (&mut played.mean_with_flash, with_flash),
                (&mut played.predicted, predicted),
            ] {
                *sum += one / ticks.len() as f64;
            }
            played.dearest = played.dearest.max(nominal);
            played.dearest_with_flash = played.dearest_with_flash.max(with_flash);
        }
    }
    played
}

/// Ringing, a strike, strikes each millisecond, a direct force.
const SCENES: [(&str, Drive, std::ops::Range<usize>); 4] = [
    ("ringing", Drive::Strike, 60..92),
    ("a strike", Drive::Strike, 0..60),
    ("a strike each ms", Drive::Strikes(44), 24..88),
    ("direct force", Drive::Direct, 24..56),
];

#[test]
fn the_engine_keeps_the_cycles_of_the_page_with_a_thousand_modes_and_bands() {
    let mut chip = EngineOnChip::new().unwrap();
    let mut wrong = Vec::new();
    // Mean of each scene, and dearest tick, on docs/frames.md.
    let stated = [
        (256, 0, [443, 417, 1762, 1626], [484, 946, 1908, 1699]),
        (1025, 0, [749, 679, 2221, 2086], [798, 1495, 2494, 2267]),
        (1025, 100, [1071, 1033, 2601, 2443], [1210, 1947, 2945, 2763]),
    ];
    for (modes, bands, means, dearest) in stated {
        let kit = load(thing(modes, bands)).binary;
        for (((what, drive, ticks), mean), most) in SCENES.into_iter().zip(means).zip(dearest) {
            let played = played(&mut chip, &kit, drive, None, ticks);
            println!("{modes} modes, {bands} bands, {what}: {played:.0?}");
            let (mean, most) = (f64::from(mean), f64::from(most));
            let is_as_stated = (played.mean / mean - 1.0).abs() <= 0.03
                && (played.dearest / most - 1.0).abs() <= 0.03
                && played.dearest_with_flash <= 1.16 * played.dearest;
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
        let mut kit = thing(modes, 0);
        // A mode in the bank, which a budget could shed.
        kit.strikers[0].modes = vec![host_tests::scene::mode(500.0, 0.1, 1.0, 0.0)];
        let kit = load(kit).binary;
        for (what, drive, ticks) in SCENES {
            let played = played(&mut chip, &kit, drive, Some(u32::MAX), ticks);
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

//! The budget on the virtual core: what a tick is expected to cost, and what happens where that is too much.

use dsp_core::SampleRate;
use dsp_core::engine::{Direct, Skipping};
use dsp_core::event::{Action, Event};
use dsp_core::resonator::TICK_FRAMES;
use dsp_core::table::Kit;
use host_tests::on_chip::EngineOnChip;
use host_tests::on_chip::scenes::{pads, pads_of, strikes};
use host_tests::scene::TestEngine;

const RATE: SampleRate = SampleRate::HZ_48000;

/// Plays ticks on the chip and gives (predicted, modelled) cycles of each.
fn predictions(kit: &[u8], events: &[Event], direct: Option<&[i32]>, ticks: usize) -> Vec<(f64, f64)> {
    let mut chip = EngineOnChip::new().unwrap();
    chip.load(kit, RATE).unwrap();
    chip.set_budget(u32::MAX).unwrap();
    (0..ticks)
        .map(|tick| {
            let frames = (tick * TICK_FRAMES) as u64..((tick + 1) * TICK_FRAMES) as u64;
            let now: Vec<Event> = events.iter().filter(|e| frames.contains(&e.time.first_frame())).copied().collect();
            let direct = direct.map(|force| Direct { pad: 0, force: &force[tick * TICK_FRAMES..][..TICK_FRAMES] });
            let (_, call) = chip.render(&now, direct, TICK_FRAMES).unwrap();
            (f64::from(chip.told().unwrap().predicted_cycles), call.cost.nominal as f64)
        })
        .collect()
}

#[test]
fn the_cost_of_the_scenes_is_predicted_within_three_percent() {
    let demo = kit::open("demo").unwrap();
    let all = demo.kit.pads.len();
    let force: Vec<i32> = (0..80 * 32).map(|n| ((f64::from(n) * 0.37).sin() * 2e6) as i32).collect();
    let eight = pads(8);
    let four = pads(4);
    let scenes: [(&str, &[u8], Vec<Event>, Option<&[i32]>, usize); 6] = [
        ("one strike of the demo kit", &demo.binary, strikes(1, 5, 0.8), None, 120),
        ("every pad of the demo kit", &demo.binary, strikes(all, 5, 0.8), None, 120),
        ("direct drive", &demo.binary, Vec::new(), Some(&force), 80),
        ("four pads of 64 modes", &four.binary, strikes(4, 5, 0.8), None, 100),
        ("eight pads of 64 modes", &eight.binary, strikes(8, 5, 0.8), None, 100),
        ("eight pads of 64 modes, struck thrice", &eight.binary, storm(8, 3), None, 60),
    ];
    let mut within = true;
    for (name, kit, events, direct, ticks) in scenes {
        let costs = predictions(kit, &events, direct, ticks);
        let (predicted, modelled) = costs.iter().fold((0.0, 0.0), |sum, cost| (sum.0 + cost.0, sum.1 + cost.1));
        println!("{name}: predicted {predicted:.0}, modelled {modelled:.0}: {:+.2} %", (predicted / modelled - 1.0) * 100.0);
        if std::env::var_os("TICKS").is_some() {
            for (tick, (predicted, modelled)) in costs.iter().enumerate().take(24) {
                println!("  {tick}: {predicted} {modelled} {:+.1} %", (predicted / modelled - 1.0) * 100.0);
            }
        }
        within &= (predicted / modelled - 1.0).abs() < 0.03;
    }
    assert!(within, "see above");
}

/// Every pad at full velocity, again every 5 ms.
fn storm(pads: usize, times: u64) -> Vec<Event> {
    (0..times).flat_map(|n| strikes(pads, n * 240, 1.0)).collect()
}

/// 80 % of 168 MHz at 48 kHz, cycles a tick.
const BUDGET: u32 = 89_600;

#[test]
fn a_storm_never_exceeds_its_budget_and_replays_to_the_same_bits() {
    let kit = pads_of(8, 2);
    let events = storm(8, 12);
    let mut chip = EngineOnChip::new().unwrap();
    chip.load(&kit.binary, RATE).unwrap();
    chip.set_budget(BUDGET).unwrap();
    let (mut sound, mut played, mut lost, mut dearest) = (Vec::new(), Vec::new(), Vec::new(), 0);
    for tick in 0..100 {
        let frames = (tick * TICK_FRAMES) as u64..((tick + 1) * TICK_FRAMES) as u64;
        let now: Vec<Event> = events.iter().filter(|e| frames.contains(&e.time.first_frame())).copied().collect();
        let (block, call) = chip.render(&now, None, TICK_FRAMES).unwrap();
        let told = chip.told().unwrap();
        dearest = dearest.max(call.cost.nominal);
        if std::env::var_os("TICKS").is_some() {
            println!("{tick}: {} cycles, predicted {}, shed {}", call.cost.nominal, told.predicted_cycles, told.shed_groups);
        }
        sound.extend(block);
        played.extend(now);
        played.extend(told.decisions);
        // A decision stands behind the events of its frame.
        played.sort_by_key(|event| (event.time.first_frame(), matches!(event.action, Action::Shed(_))));
        lost.push(f64::from(told.shed_amplitude));
    }
    let decisions = played.iter().filter(|event| matches!(event.action, Action::Shed(_))).count();
    println!("dearest tick {dearest} of {BUDGET} cycles, {decisions} decisions");
    assert!(dearest <= u64::from(BUDGET), "dearest tick: {dearest} of {BUDGET}");
    assert!(decisions > 0);

    // The same bits on the PC, without a budget, in other blocks.
    let view = Kit::parse(&kit.binary).unwrap();
    let replay = |events: &[Event]| {
        let mut engine = Box::new(TestEngine::new());
        engine.load(&view, RATE, Skipping::On).unwrap();
        let mut out = vec![[0; 2]; sound.len()];
        engine.render(events, None, &mut out).unwrap();
        out
    };
    assert!(replay(&played) == sound, "the replay differs");

    // At most what was reported is missing.
    let whole = replay(&events);
    let mut missing_at_most = 0.0;
    for ((got, whole), lost) in sound.chunks(TICK_FRAMES).zip(whole.chunks(TICK_FRAMES)).zip(lost) {
        missing_at_most += lost;
        for (got, whole) in got.iter().flatten().zip(whole.iter().flatten()) {
            let missing = f64::from((got - whole).abs()) / f64::from(1 << 23);
            assert!(missing <= missing_at_most + 3e-7, "{missing} of {missing_at_most}");
        }
    }
}

//! The budget on the virtual core: predicted costs of ticks, and ticks that would exceed the
//! budget.

use dsp_core::SampleRate;
use dsp_core::engine::{Direct, Skipping};
use dsp_core::event::{Action, Event, Time};
use dsp_core::resonator::TICK_FRAMES;
use dsp_core::table::Kit;
use host_tests::lent;
use host_tests::on_chip::EngineOnChip;
use host_tests::on_chip::budget_scenes::{BudgetScene, STORM_BUDGET, playing_scene, storm_scene, unlimited};
use host_tests::on_chip::scenes::{pads, strikes};

const RATE: SampleRate = SampleRate::HZ_48000;

#[test]
fn the_cost_of_the_scenes_is_predicted_within_three_percent() {
    let mut within = true;
    for scene in unlimited() {
        let mut chip = EngineOnChip::new().unwrap();
        chip.load(&scene.kit, RATE).unwrap();
        chip.set_budget(scene.budget).unwrap();
        let (mut predicted, mut modelled) = (0.0, 0.0);
        for tick in 0..scene.ticks {
            let (events, force) = scene.tick(tick);
            let direct = force.map(|force| Direct { pad: 0, force });
            let (_, call) = chip.render(&events, direct, TICK_FRAMES).unwrap();
            predicted += f64::from(chip.told().unwrap().predicted_cycles);
            modelled += call.cost.nominal as f64;
            if std::env::var_os("TICKS").is_some() {
                println!("{tick}: {} {}", call.cost.nominal, chip.told().unwrap().predicted_cycles);
            }
        }
        let error = predicted / modelled - 1.0;
        println!("{}: predicted {predicted:.0}, modelled {modelled:.0}: {:+.2} %", scene.name, error * 100.0);
        within &= error.abs() < 0.03;
    }
    assert!(within, "see the list: cargo bench -p host-tests --bench budget_costs fits the constants anew");
}

/// Sound and costs of a scene on the chip under its budget.
struct Played {
    sound: Vec<[i32; 2]>,
    /// Events of the scene, with the engine's decisions at their places.
    events: Vec<Event>,
    dearest_tick: u64,
    stack_bytes: u32,
}

fn play(scene: &BudgetScene) -> Played {
    let mut chip = EngineOnChip::new().unwrap();
    chip.load(&scene.kit, RATE).unwrap();
    chip.set_budget(scene.budget).unwrap();
    let mut played = Played { sound: Vec::new(), events: Vec::new(), dearest_tick: 0, stack_bytes: 0 };
    for tick in 0..scene.ticks {
        let (now, _) = scene.tick(tick);
        let (block, call) = chip.render(&now, None, TICK_FRAMES).unwrap();
        let told = chip.told().unwrap();
        played.dearest_tick = played.dearest_tick.max(call.cost.nominal);
        played.stack_bytes = played.stack_bytes.max(call.stack_bytes);
        played.sound.extend(block);
        played.events.extend(now);
        played.events.extend(told.decisions);
        if std::env::var_os("TICKS").is_some() {
            println!("{tick}: {} {} {}", call.cost.nominal, told.predicted_cycles, told.shed_groups);
        }
    }
    // A decision takes effect after the events of its frame.
    played.events.sort_by_key(|event| (event.time.first_frame(), matches!(event.action, Action::Shed(_))));
    played
}

/// Plays events on the PC, without a budget and in one block. Returns the sound, and the amplitude
/// that each tick reports as left out, 1.0 = full scale.
fn replay(kit: &[u8], events: &[Event], frames: usize) -> (Vec<[i32; 2]>, Vec<f64>) {
    let view = Kit::parse(kit).unwrap();
    let mut engine = lent::engine(&view, RATE, Skipping::On).unwrap();
    let (mut out, mut lost) = (vec![[0; 2]; frames], Vec::new());
    engine.render_observed(events, None, &mut out, |report| lost.push(f64::from(report.shed.amplitude))).unwrap();
    (out, lost)
}

#[test]
fn a_storm_never_exceeds_its_budget_and_replays_to_the_same_bits() {
    for pads in [4, 8] {
        let scene = storm_scene(pads);
        let played = play(&scene);
        let decisions = played.events.iter().filter(|event| matches!(event.action, Action::Shed(_))).count();
        println!(
            "{pads} pads: dearest tick {} of {STORM_BUDGET} cycles, {decisions} decisions, {} bytes of stack",
            played.dearest_tick, played.stack_bytes
        );
        assert!(played.dearest_tick <= u64::from(STORM_BUDGET), "dearest tick: {}", played.dearest_tick);
        assert!(decisions > 0 && played.stack_bytes <= 2048, "{} bytes of stack", played.stack_bytes);

        // The PC gives equal bits from the logged decisions, without a budget, in one block.
        let (again, lost) = replay(&scene.kit, &played.events, played.sound.len());
        assert!(again == played.sound, "the replay differs");

        // The sound lacks at most the reported amplitude.
        let (whole, _) = replay(&scene.kit, &scene.events, played.sound.len());
        let mut reported = 0.0;
        let ticks = played.sound.chunks(TICK_FRAMES).zip(whole.chunks(TICK_FRAMES)).zip(lost);
        for ((got, whole), lost) in ticks {
            reported += lost;
            for (got, whole) in got.iter().flatten().zip(whole.iter().flatten()) {
                let missing = f64::from((got - whole).abs()) / f64::from(1 << 23);
                assert!(missing <= reported + 3e-7, "{missing} is missing, {reported} was reported");
            }
        }
    }
}

#[test]
fn what_is_quietest_goes_first() {
    // One pad is loud, the other 46 dB below it. The PC plays them, because the engine decides
    // alike everywhere.
    let kit = pads(2).binary;
    let view = Kit::parse(&kit).unwrap();
    let mut events = strikes(2, 0, 1.0);
    events[1].velocity = 0.012;
    let play = |budget: Option<u32>| {
        let mut engine = lent::engine(&view, RATE, Skipping::On).unwrap();
        let mut out = vec![[0; 2]; 300 * TICK_FRAMES];
        let (contact, ringing) = out.split_at_mut(8 * TICK_FRAMES);
        engine.render(&events, None, contact).unwrap();
        engine.set_budget(budget);
        let mut shed_modes = 0;
        engine.render_observed(&[], None, ringing, |report| shed_modes += report.shed.modes).unwrap();
        (out, shed_modes)
    };
    let (whole, none) = play(None);
    // Both pads cost up to 31 800 cycles a tick. The choice itself takes 8000 in the tick in which
    // it is made.
    let (got, shed_modes) = play(Some(32_300));
    assert!(none == 0 && (30..128).contains(&shed_modes), "{shed_modes} of 128 modes");
    let peak = |frames: &[[i32; 2]]| frames.iter().flatten().map(|x| x.abs()).max().unwrap_or(0);
    let missing: Vec<[i32; 2]> =
        whole.iter().zip(&got).map(|(whole, got)| [whole[0] - got[0], whole[1] - got[1]]).collect();
    println!("{shed_modes} modes left out, peak {} of {} missing", peak(&missing), peak(&whole));
    assert!(peak(&missing) > 0 && peak(&missing) < peak(&whole) / 50, "{} of {}", peak(&missing), peak(&whole));
}

#[test]
fn strikes_anywhere_in_a_tick_replay_to_the_same_bits_under_any_budget() {
    // The PC plays the scenes, because the engine decides alike everywhere.
    for budget in (20_000..80_000).step_by(5_000) {
        let scene = playing_scene(budget);
        let kit = Kit::parse(&scene.kit).unwrap();
        let mut engine = lent::engine(&kit, RATE, Skipping::On).unwrap();
        engine.set_budget(Some(budget));
        let (mut sound, mut played) = (Vec::new(), Vec::new());
        for tick in 0..scene.ticks {
            let (now, _) = scene.tick(tick);
            let mut block = [[0; 2]; TICK_FRAMES];
            let mut decisions = Vec::new();
            engine.render_logged(&now, None, &mut block, |_| {}, |event| decisions.push(*event)).unwrap();
            sound.extend(block);
            played.extend(now);
            played.extend(decisions);
        }
        played.sort_by_key(|event| (event.time.first_frame(), matches!(event.action, Action::Shed(_))));
        let (again, _) = replay(&scene.kit, &played, sound.len());
        let differs = again.iter().zip(&sound).position(|(again, sound)| again != sound);
        assert!(differs.is_none(), "budget {budget}: frame {differs:?} differs");
    }
}

#[test]
fn strikes_anywhere_in_a_tick_sound_alike_on_the_chip_and_the_pc() {
    let scene = playing_scene(50_000);
    let played = play(&scene);
    let (again, _) = replay(&scene.kit, &played.events, played.sound.len());
    let differs = again.iter().zip(&played.sound).position(|(again, sound)| again != sound);
    assert!(differs.is_none(), "frame {differs:?} differs");
}

/// Cycles of a tick with the second strike of a pad of the demo kit at a position, modelled and
/// predicted. The first one is at position 0.
fn second_strike(kit: &[u8], pad: u8, position: f32) -> (f64, f64) {
    let mut chip = EngineOnChip::new().unwrap();
    chip.load(kit, RATE).unwrap();
    chip.set_budget(u32::MAX).unwrap();
    let mut cost = (0.0, 0.0);
    for (strike, position) in [(0, 0.0), (50, position)] {
        for tick in strike..strike + 50 {
            let time = Time::at_frame(tick * TICK_FRAMES as u64 + 3);
            let event = Event { time, pad, velocity: 0.8, position, action: Action::Strike, ..Event::NOTHING };
            let events = if tick == strike { vec![event] } else { vec![] };
            let (_, call) = chip.render(&events, None, TICK_FRAMES).unwrap();
            if tick == strike {
                cost = (call.cost.nominal as f64, f64::from(chip.told().unwrap().predicted_cycles));
            }
        }
    }
    cost
}

#[test]
fn a_move_to_another_position_is_predicted_within_five_percent_of_its_own_cycles() {
    let demo = kit::open("demo").unwrap();
    for name in ["marimba", "glockenspiel", "drum"] {
        let pad = demo.kit.pads.iter().position(|pad| pad.name == name).unwrap() as u8;
        let [stays, moves] = [0.0, 0.5].map(|position| second_strike(&demo.binary, pad, position));
        let (modelled, predicted) = (moves.0 - stays.0, moves.1 - stays.1);
        println!("{name}: a move takes {modelled} cycles, predicted {predicted}");
        assert!((predicted / modelled - 1.0).abs() < 0.05, "{name}");
    }
}

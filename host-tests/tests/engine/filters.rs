//! The engine with dynamic filters and biquads: idle cost, strikes, hands, block sizes, stress,
//! refusals.

use dsp_core::SampleRate;
use dsp_core::engine::{Direct, LoadError, Plan, Setup, Skipping, TickReport};
use dsp_core::event::{Action, Event};
use dsp_core::fixed::ONE_Q27;
use dsp_core::resonator::TICK_FRAMES;
use dsp_core::table::Kit as KitView;
use host_tests::lent;
use host_tests::scene::{hand, load, mode, one_pad, strike};
use kit::{Biquad, Biquads, Breakpoint, DynamicFilter, Exciter, Kit, Loaded, Loop, ModesGo, Order};

const RATE: SampleRate = SampleRate::HZ_48000;

fn breakpoint(time_s: f32, a1: f32, b: f32) -> Breakpoint {
    Breakpoint { time_s, noise: 1.0, a1, a2: 0.0, b0: b, b1: b, b2: 0.0 }
}

/// Dynamic filter whose noise falls within a quarter of a second.
pub(crate) fn filter(modes: ModesGo) -> DynamicFilter {
    DynamicFilter {
        seed: 3,
        modes,
        rate_hz: 48_000.0,
        exciter: None,
        order: Order::First,
        path: vec![breakpoint(0.0, -0.5, 0.25), breakpoint(0.1, -0.9, 0.02), breakpoint(0.25, -0.95, 0.0)],
        loops: Vec::new(),
    }
}

/// Band-pass loop round the filter, with the frequency of its delay.
pub(crate) fn round(gain: f32) -> Loop {
    Loop { frequency_hz: 500.0, bandwidth_hz: 5.0, gain, delay_s: 0.004 }
}

pub(crate) fn biquads() -> Biquads {
    let biquad = |pole, gain| Biquad { pole, zero: [0.9, 0.0], gain };
    let chain = |re, im| vec![biquad([re, im], 0.01), biquad([re, -0.9 * im], 0.1)];
    Biquads { rate_hz: 48_000.0, chains: vec![chain(0.995, 0.06), chain(0.9, 0.4)] }
}

/// Kit of one pad with a mode and filters.
pub(crate) fn filtered(filter: Option<DynamicFilter>, biquads: Option<Biquads>) -> Kit {
    let mut kit = one_pad(vec![mode(440.0, 0.05, 300.0, 0.0)]);
    (kit.objects[0].dynamic_filter, kit.objects[0].biquads) = (filter, biquads);
    kit
}

fn all() -> Kit {
    filtered(Some(DynamicFilter { loops: vec![round(0.2)], ..filter(ModesGo::Through) }), Some(biquads()))
}

/// Sound and reports in blocks of `block` frames, under events and a force.
fn play_force(
    loaded: &Loaded,
    events: &[Event],
    force: Option<&[i32]>,
    frames: usize,
    block: usize,
) -> (Vec<[i32; 2]>, Vec<TickReport>) {
    let kit = KitView::parse(&loaded.binary).expect("a right kit");
    let mut engine = lent::engine(&kit, RATE, Skipping::On).expect("it can be played");
    let (mut out, mut reports, mut events) = (vec![[0; 2]; frames], Vec::new(), events);
    for chunk in out.chunks_mut(block) {
        let start = engine.now() as usize;
        let end = (start + chunk.len()) as u64;
        let due = events.iter().take_while(|event| event.time.first_frame() < end).count();
        let direct = force.map(|force| Direct { pad: 0, force: &force[start..start + chunk.len()] });
        engine.render_bus(&events[..due], direct, chunk, |report| reports.push(*report)).expect("right events");
        events = &events[due..];
    }
    (out, reports)
}

pub(crate) fn play(loaded: &Loaded, events: &[Event], frames: usize, block: usize) -> (Vec<[i32; 2]>, Vec<TickReport>) {
    play_force(loaded, events, None, frames, block)
}

fn power(sound: &[[i32; 2]]) -> f64 {
    sound.iter().flatten().map(|&x| (f64::from(x) / f64::from(ONE_Q27)).powi(2)).sum::<f64>() / sound.len() as f64
}

fn db(power: f64) -> f64 {
    10.0 * power.log10()
}

pub(crate) fn is_idle(report: &TickReport) -> bool {
    (report.filter_frames, report.loop_frames, report.biquad_frames, report.filters, report.ringing_pads)
        == (0, 0, 0, 0, 0)
}

#[test]
fn nothing_is_computed_before_the_first_strike_nor_after_the_last_tail() {
    let (sound, reports) = play(&load(all()), &[strike(4_800, 1.0)], 96_000, 128);
    assert!(reports[..150].iter().all(is_idle) && sound[..4_800].iter().all(|frame| *frame == [0, 0]));
    let tick = TICK_FRAMES as u32;
    assert!(reports[150..300].iter().all(|report| (report.filter_frames, report.loop_frames) == (tick, tick)));
    assert!(reports[150..160].iter().all(|report| report.biquad_frames == 4 * tick));
    assert!(power(&sound[4_800..9_600]) > 1e-6);
    let end = 2_000;
    assert!(reports[end..].iter().all(is_idle), "it still sounds after 1.2 s");
    assert!(sound[end * 32..].iter().all(|frame| *frame == [0, 0]));
}

#[test]
fn the_parts_of_a_pad_add_up() {
    // The pads have the dynamic filter alone, the biquads alone, the mode alone, and all of them.
    let sound = |modes: bool, filter: Option<DynamicFilter>, biquads: Option<Biquads>| {
        let mut kit = filtered(filter, biquads);
        if !modes {
            kit.objects[0].modes.clear();
        }
        play(&load(kit), &[strike(17, 0.7)], 9_600, 128).0
    };
    let whole = sound(true, Some(filter(ModesGo::Beside)), Some(biquads()));
    let parts = [
        sound(true, None, None),
        sound(false, Some(filter(ModesGo::Beside)), None),
        sound(false, None, Some(biquads())),
    ];
    assert!(parts.iter().all(|part| power(part) > 1e-8));
    for (frame, whole) in whole.iter().enumerate() {
        let sum: i32 = parts.iter().map(|part| part[frame][0]).sum();
        // Each part is rounded once on its way to the stereo bus.
        assert!((whole[0] - sum).abs() <= 3, "frame {frame}: {} and {sum}", whole[0]);
    }
}

#[test]
fn modes_go_through_the_filter_where_the_table_says_so() {
    // This filter has no noise and no pole, and only halves: b0 = 0.5.
    let half = |modes| DynamicFilter { path: vec![Breakpoint { b0: 0.5, ..Breakpoint::default() }], ..filter(modes) };
    let events = [strike(5, 1.0)];
    let plain = play(&load(filtered(None, None)), &events, 9_600, 128).0;
    let beside = play(&load(filtered(Some(half(ModesGo::Beside)), None)), &events, 9_600, 128).0;
    let through = play(&load(filtered(Some(half(ModesGo::Through)), None)), &events, 9_600, 128).0;
    assert!(plain == beside && power(&plain) > 1e-6);
    for (frame, (plain, through)) in plain.iter().zip(&through).enumerate() {
        assert!((plain[0] / 2 - through[0]).abs() <= 2, "frame {frame}: {} and {}", plain[0], through[0]);
    }
}

#[test]
fn the_noise_follows_the_strikes_peak_force() {
    // A strike may exceed the reference force, too: v^1.2 of 5 N over 2 N.
    let rms = |velocity: f32, reference_force: f32| {
        let mut kit = filtered(Some(filter(ModesGo::Beside)), None);
        kit.objects[0].modes.clear();
        kit.objects[0].reference_force = reference_force;
        kit.strikers[0].peak_force = 5.0;
        play(&load(kit), &[strike(0, velocity)], 9_600, 128).0
    };
    let loud = power(&rms(1.0, 5.0));
    for (velocity, reference_force) in [(0.5f32, 5.0f32), (0.1, 5.0), (1.0, 2.0), (0.2, 2.0), (1.0, 0.5), (1.0, 50.0)] {
        let level = f64::from(5.0 * velocity.powf(1.2) / reference_force);
        let found = db(power(&rms(velocity, reference_force)) / loud) - 20.0 * level.log10();
        assert!(found.abs() < 0.05, "velocity {velocity}, reference {reference_force} N: {found:.3} dB");
    }
    // Uniform noise of rms 1/√3 goes through b0 = 1, which is the filter alone.
    let mut kit = filtered(
        Some(DynamicFilter {
            path: vec![
                Breakpoint { b0: 1.0, ..Breakpoint::default() },
                Breakpoint { time_s: 1.0, b0: 1.0, ..Breakpoint::default() },
            ],
            ..filter(ModesGo::Beside)
        }),
        None,
    );
    kit.objects[0].modes.clear();
    let found = db(3.0 * power(&play(&load(kit), &[strike(0, 1.0)], 48_000, 128).0));
    assert!(found.abs() < 0.1, "{found:.3} dB");
}

#[test]
fn the_exciters_band_moves_with_the_force_whatever_the_reference_is() {
    // Equal peak force over reference force gives equal bits, but for the bits that a louder filter
    // takes.
    let sound = |peak_force: f32, velocity: f32| {
        let exciter = Some(Exciter { low_hz: 500.0, high_hz: 4_000.0, exponent: 0.5 });
        let mut kit = filtered(Some(DynamicFilter { exciter, ..filter(ModesGo::Beside) }), None);
        kit.objects[0].modes.clear();
        (kit.strikers[0].peak_force, kit.strikers[0].peak_exponent) = (peak_force, 1.0);
        play(&load(kit), &[strike(0, velocity)], 9_600, 128).0
    };
    let (plain, louder) = (sound(0.5, 1.0), sound(4.0, 0.125));
    let error: Vec<[i32; 2]> = plain.iter().zip(&louder).map(|(a, b)| [a[0] - b[0], a[1] - b[1]]).collect();
    let snr = db(power(&plain) / power(&error));
    assert!(snr > 60.0, "{snr:.1} dB");
}

#[test]
fn a_strike_starts_the_path_anew_and_what_rings_rings_on() {
    let kit = filtered(Some(filter(ModesGo::Beside)), Some(biquads()));
    let loaded = load(kit);
    let (once, _) = play(&loaded, &[strike(0, 1.0)], 24_000, 128);
    let (twice, reports) = play(&loaded, &[strike(0, 1.0), strike(6_000, 1.0)], 24_000, 128);
    assert!(once[..6_000] == twice[..6_000] && once[6_000..] != twice[6_000..]);
    // The second strike is as loud as the first.
    let again = db(power(&twice[6_000..7_200]) / power(&once[..1_200]));
    assert!(again.abs() < 1.0, "{again:.2} dB");
    assert_eq!(reports.iter().map(|report| report.strikes).sum::<u32>(), 2);
}

#[test]
fn a_hand_takes_60_db_in_its_t60_and_a_strike_after_it_sounds_as_ever() {
    let long = DynamicFilter {
        path: vec![breakpoint(0.0, -0.5, 0.25), breakpoint(10.0, -0.5, 0.25)],
        ..filter(ModesGo::Beside)
    };
    let mut kit = filtered(Some(long), None);
    kit.objects[0].modes.clear();
    kit.pads[0].choke_t60_s = 0.1;
    let loaded = load(kit);
    let ringing = play(&loaded, &[strike(0, 1.0)], 48_000, 128).0;
    let (choked, reports) = play(&loaded, &[strike(0, 1.0), hand(9_599, Action::Choke)], 48_000, 128);
    assert!(ringing[..9_600] == choked[..9_600]);
    let fallen = |from: usize| db(power(&choked[from..from + 480]) / power(&ringing[from..from + 480]));
    let (early, late) = (fallen(9_600 + 2_160), fallen(9_600 + 4_560));
    assert!((early + 30.0).abs() < 0.5 && (late + 60.0).abs() < 0.5, "{early:.2} dB, {late:.2} dB");
    // After 120 dB the filter rests, though its path goes on.
    assert!(reports[(9_600 + 9_700) / 32..].iter().all(is_idle));
    let events = [strike(0, 1.0), hand(9_599, Action::Choke), hand(23_999, Action::Release), strike(24_000, 1.0)];
    let again = play(&loaded, &events, 48_000, 128).0;
    let found = db(power(&again[24_000..28_800]) / power(&ringing[..4_800]));
    assert!(found.abs() < 0.5, "{found:.2} dB");
    // A sound that is struck under the hand falls from the strike on.
    let under = play(&loaded, &[hand(0, Action::Choke), strike(9_600, 1.0)], 24_000, 128).0;
    let (start, end) = (power(&under[9_600..9_648]), power(&under[14_376..14_424]));
    assert!((db(end / start) + 60.0).abs() < 3.0, "{:.2} dB", db(end / start));
}

#[test]
fn the_block_size_cannot_change_a_bit() {
    let mut kit = all();
    kit.pads[0].choke_t60_s = 0.05;
    let exciter = Some(Exciter { low_hz: 200.0, high_hz: 8_000.0, exponent: 0.3 });
    kit.objects[0].dynamic_filter =
        kit.objects[0].dynamic_filter.take().map(|filter| DynamicFilter { exciter, ..filter });
    let loaded = load(kit);
    let events = [
        strike(3, 1.0),
        strike(40, 0.3),
        strike(1_999, 0.8),
        hand(5_000, Action::Choke),
        strike(5_400, 0.7),
        hand(5_555, Action::Release),
        strike(5_600, 0.5),
        strike(40_011, 0.5),
    ];
    let force: Vec<i32> = (0..48_000)
        .map(|frame: i32| if (20_000..20_100).contains(&frame) { (frame - 20_050) * (ONE_Q27 / 100) } else { 0 })
        .collect();
    let (whole, _) = play_force(&loaded, &events, Some(&force), 48_000, 48_000);
    for block in [1, 7, 32, 100, 1_024] {
        let (sound, _) = play_force(&loaded, &events, Some(&force), 48_000, block);
        assert!(sound == whole, "blocks of {block}");
    }
}

#[test]
fn biquads_answer_a_direct_force_and_sleep_without_one() {
    let loaded = load(filtered(Some(filter(ModesGo::Beside)), Some(biquads())));
    let mut force = vec![0; 48_000];
    force[3_210] = ONE_Q27;
    let (sound, reports) = play_force(&loaded, &[], Some(&force), 48_000, 128);
    assert!(sound[..3_210].iter().all(|frame| *frame == [0, 0]) && power(&sound[3_210..6_000]) > 1e-9);
    assert!(reports[..100].iter().all(is_idle) && reports[1_000..].iter().all(is_idle));
    // Only a strike makes noise.
    assert!(reports.iter().all(|report| report.filter_frames == 0));
}

#[test]
fn biquads_are_driven_by_newtons() {
    let sound = |reference_force: f32| {
        let mut kit = filtered(None, Some(biquads()));
        kit.objects[0].modes.clear();
        (kit.objects[0].reference_force, kit.strikers[0].peak_force) = (reference_force, 2.0);
        play(&load(kit), &[strike(0, 1.0)], 4_800, 128).0
    };
    let (one, other) = (sound(2.0), sound(8.0));
    let error: Vec<[i32; 2]> = one.iter().zip(&other).map(|(a, b)| [a[0] - b[0], a[1] - b[1]]).collect();
    let snr = db(power(&one) / power(&error));
    assert!(snr > 80.0, "{snr:.1} dB");
}

#[test]
fn an_engine_counts_what_filters_cost_before_it_runs_them() {
    let loaded = load(all());
    let kit = KitView::parse(&loaded.binary).expect("a right kit");
    let predicted = |events: &[Event]| {
        let mut engine = lent::engine(&kit, RATE, Skipping::On).expect("it can be played");
        engine.set_budget(Some(1_000_000));
        let mut cycles = Vec::new();
        let mut out = vec![[0; 2]; 96_000];
        engine
            .render_bus(events, None, &mut out, |report| cycles.push(report.predicted_cycles()))
            .expect("right events");
        cycles
    };
    let plain = load(filtered(None, None));
    let without = {
        let kit = KitView::parse(&plain.binary).expect("a right kit");
        let mut engine = lent::engine(&kit, RATE, Skipping::On).expect("it can be played");
        engine.set_budget(Some(1_000_000));
        let (mut cycles, mut out) = (Vec::new(), vec![[0; 2]; 96_000]);
        let observe = |report: &TickReport| cycles.push(report.predicted_cycles());
        engine.render_bus(&[strike(64, 1.0)], None, &mut out, observe).expect("right events");
        cycles
    };
    let with = predicted(&[strike(64, 1.0)]);
    // Tick 2 has the strike, tick 40 only rings.
    for tick in [2, 40] {
        assert!(with[tick] > without[tick] + 1_000, "tick {tick}: {} and {}", with[tick], without[tick]);
    }
    assert_eq!(with[..2], without[..2]);
    assert_eq!(with[2_900], without[2_900]);
}

#[test]
fn a_filter_that_cannot_be_played_is_refused_by_name() {
    let refusal = |kit: Kit| {
        let loaded = load(kit);
        let view = KitView::parse(&loaded.binary).expect("a right kit");
        let planned = Plan::of::<i16>(&view, Setup::new(RATE)).expect_err("it cannot be");
        let error = lent::engine(&view, RATE, Skipping::On).expect_err("it cannot be");
        assert_eq!(planned, error);
        error
    };
    let looped = |own: Loop| filtered(Some(DynamicFilter { loops: vec![own], ..filter(ModesGo::Beside) }), None);
    let error = refusal(looped(round(40.0)));
    assert!(matches!(error, LoadError::DynamicFilter { pad: 0, .. }), "{error}");
    assert!(error.to_string().starts_with("pad 0, dynamic filter of its object: "), "{error}");
    assert!(error.to_string().contains("gain round the loops"), "{error}");
    let error = refusal(looped(Loop { delay_s: 0.5, ..round(0.1) }));
    assert!(matches!(error, LoadError::DynamicFilter { pad: 0, .. }), "{error}");
    let error = refusal(looped(Loop { frequency_hz: 24_500.0, ..round(0.1) }));
    assert!(matches!(error, LoadError::DynamicFilter { pad: 0, .. }), "{error}");
}

#[test]
fn a_kit_without_filters_takes_no_memory_for_them() {
    let bytes = |kit: Kit| {
        let loaded = load(kit);
        let view = KitView::parse(&loaded.binary).expect("a right kit");
        Plan::of::<i16>(&view, Setup::new(RATE)).expect("it can be played").words.bytes()
    };
    let without = bytes(filtered(None, None));
    let (dynamic, looped) = (bytes(filtered(Some(filter(ModesGo::Beside)), None)) - without, bytes(all()) - without);
    println!("a dynamic filter takes {dynamic} bytes, with a loop and biquads {looped}");
    assert!((1..4_096).contains(&dynamic) && (dynamic..8_192).contains(&looped), "{dynamic} {looped}");
}

//! Work that a scene does not need is not done. The engine's reports prove it.

use dsp_core::SampleRate;
use dsp_core::engine::{Direct, Skipping, TickReport};
use dsp_core::event::{Event, Time};
use dsp_core::resonator::TICK_FRAMES;
use dsp_core::table::Kit;
use host_tests::lent;
use host_tests::scene::{load, mode, one_pad, play, strike};
use kit::Gain;

const RATE: SampleRate = SampleRate::HZ_48000;

fn is_idle(report: &TickReport) -> bool {
    report.run_mode_frames() == 0
        && report.striker_mode_frames == 0
        && report.force_frames == 0
        && report.contact_frames == 0
        && report.acceleration_frames == 0
        && report.direct_frames == 0
        && report.extra_guards == 0
        && report.ringing_pads == 0
}

#[test]
fn a_silent_engine_does_no_work_before_the_first_strike_nor_after_the_last_tail() {
    let mut kit = one_pad(vec![mode(440.0, 0.1, 300.0, 30.0), mode(9_000.0, 0.1, 300.0, 0.0)]);
    kit.objects[0].acceleration = kit::Acceleration::Factor(0.1);
    kit.strikers[0].modes = vec![mode(700.0, 0.05, 100.0, 0.0)];
    let loaded = load(kit);
    let (sound, reports) = play(&loaded, RATE, Skipping::On, &[strike(4_800, 1.0)], None, (48_000, &[128]));
    let (before, after) = (4_800 / TICK_FRAMES, 24_000 / TICK_FRAMES);
    assert!(reports[..before].iter().all(|report| is_idle(report) && report.unstruck_mode_frames == 96));
    assert!(reports[after..].iter().all(|report| is_idle(report) && report.decayed_mode_frames == 96));
    assert!(reports[before..after].iter().any(|report| report.acceleration_frames > 0));
    assert!(sound[24_000..].iter().all(|frame| *frame == [0, 0]));
    // A direct force of exact zeros is no work either.
    let (_, reports) = play(&loaded, RATE, Skipping::On, &[], Some(&[0; 9_600]), (9_600, &[128]));
    assert!(reports.iter().all(is_idle));
}

#[test]
fn stages_that_a_table_does_not_have_cost_nothing() {
    let loaded = load(one_pad(vec![mode(440.0, 0.5, 300.0, 0.0)]));
    let (_, reports) = play(&loaded, RATE, Skipping::On, &[strike(10, 1.0)], None, (9_600, &[128]));
    assert!(reports.iter().any(|report| report.run_mode_frames() > 0));
    for report in &reports {
        assert_eq!((report.striker_mode_frames, report.acceleration_frames, report.direct_frames), (0, 0, 0));
    }
}

#[test]
fn a_striker_with_weight_zero_is_not_built() {
    let mut kit = one_pad(vec![mode(440.0, 0.5, 300.0, 0.0)]);
    kit.strikers[0].modes = vec![mode(700.0, 0.05, 100.0, 0.0); 5];
    kit.pads[0].striker_weight = 0.0;
    let (_, reports) = play(&load(kit), RATE, Skipping::On, &[], None, (64, &[64]));
    assert!(reports.iter().all(|report| report.unstruck_mode_frames == 32));
}

#[test]
fn when_the_contact_is_over_the_bank_drops_its_input_work() {
    let loaded = load(one_pad(vec![mode(440.0, 2.0, 300.0, 0.0)]));
    let (_, reports) = play(&loaded, RATE, Skipping::On, &[strike(0, 1.0)], None, (9_600, &[128]));
    // The contact of 0.5 ms takes 24 frames. The first tick is driven, all later ones ring freely.
    assert!(reports[0].driven_mode_frames > 0);
    assert!(reports[1..].iter().all(|report| report.driven_mode_frames == 0 && report.free_mode_frames == 32));
    let (_, reports) = play(&loaded, RATE, Skipping::Off, &[strike(0, 1.0)], None, (9_600, &[128]));
    assert!(reports.iter().all(|report| report.run_mode_frames() == 32));
}

#[test]
fn modes_at_or_above_nyquist_are_not_built_and_change_no_bit() {
    let audible = vec![mode(440.0, 0.5, 300.0, 20.0), mode(23_900.0, 0.2, 300.0, 0.0)];
    let mut all = audible.clone();
    all.extend([24_000.0, 24_001.0, 90_000.0].map(|frequency| mode(frequency, 0.5, 1e6, 0.0)));
    let [audible, all] = [audible, all]
        .map(|modes| play(&load(one_pad(modes)), RATE, Skipping::On, &[strike(5, 0.7)], None, (9_600, &[128])));
    assert_eq!(audible.0, all.0);
    assert_eq!(audible.1, all.1);
}

#[test]
fn modes_that_the_position_does_not_reach_are_not_run() {
    let mut first = mode(440.0, 1.0, 300.0, 0.0);
    first.gains.push(Gain::default());
    let mut second = mode(5_000.0, 1.0, 0.0, 0.0);
    second.gains.push(Gain { sine: 300.0, cosine: 0.0 });
    let loaded = load(one_pad(vec![first, second]));
    for position in [0.0, 1.0] {
        let mut event = strike(0, 1.0);
        event.position = position;
        let (_, reports) = play(&loaded, RATE, Skipping::On, &[event], None, (3_200, &[128]));
        assert!(reports[1..].iter().all(|report| report.run_mode_frames() == 32 && report.decayed_mode_frames == 32));
    }
}

#[test]
fn the_loudest_pad_level_decides_when_a_mode_retires() {
    let lifetime = |level_db| {
        let mut kit = one_pad(vec![mode(440.0, 0.1, 300.0, 0.0)]);
        kit.pads[0].level_db = level_db;
        let (_, reports) = play(&load(kit), RATE, Skipping::On, &[strike(0, 1.0)], None, (96_000, &[128]));
        reports.iter().filter(|report| report.run_mode_frames() > 0).count()
    };
    // A level of 20 dB is worth a third of a T60 of 0.1 s: 50 ticks. A group is looked at when it
    // has decayed by half a bit, here every 7 ticks.
    let ticks = lifetime(20.0) - lifetime(0.0);
    assert!((43..=57).contains(&ticks), "{ticks}");
}

#[test]
fn balanced_pads_have_the_same_bits_by_the_quick_path_and_by_the_whole_one() {
    // With skipping off no run takes the quick path to the stereo bus, and nothing retires. From
    // the sixth tick on bits may differ.
    let loaded = kit::open("demo").unwrap();
    let view = Kit::parse(&loaded.binary).unwrap();
    let force: Vec<i32> = (0..4 * 32).map(|n| ((f64::from(n) * 0.37).sin() * 2e6) as i32).collect();
    for velocity in [0.01, 0.3, 1.0] {
        let play = |skipping| {
            let mut engine = lent::engine(&view, RATE, skipping).unwrap();
            let strike = |pad| Event { time: Time::at_frame(5), pad, velocity, ..Event::default() };
            let events: Vec<Event> = (0..loaded.kit.pads.len() as u8).map(strike).collect();
            let mut out = vec![[0; 2]; force.len()];
            engine.render(&events, Some(Direct { pad: 0, force: &force }), &mut out).unwrap();
            out
        };
        let (quick, whole) = (play(Skipping::On), play(Skipping::Off));
        let differs = quick.iter().zip(&whole).position(|(quick, whole)| quick != whole);
        assert!(differs.is_none(), "velocity {velocity}: frame {differs:?} differs");
    }
}

//! Abuse: resonance, storms, extremes, a very long run.

use dsp_core::SampleRate;
use dsp_core::engine::{Skipping, TickReport};
use dsp_core::event::Action;
use dsp_core::fixed::ONE_Q27;
use dsp_core::resonator::TICK_FRAMES;
use host_tests::performance::{law, snr_db};
use host_tests::scene::{hand, load, mode, one_pad, play, strike};
use malleus::render::Performance;

const RATE: SampleRate = SampleRate::HZ_48000;

fn real(bus: &[[i32; 2]]) -> Vec<[f64; 2]> {
    bus.iter().map(|frame| frame.map(|x| f64::from(x) / f64::from(ONE_Q27))).collect()
}

fn performance(events: Vec<dsp_core::event::Event>, force: Option<Vec<i32>>, frames: usize) -> Performance {
    Performance { events, direct: force.map(|force| (0, force)), frames }
}

#[test]
fn a_full_scale_sine_on_a_mode_of_60_s_for_30_s_saturates_cleanly_and_then_decays_by_its_law() {
    for (frequency_hz, gain) in [(440.0, 500.0), (7_000.0, 48_000.0), (20_000.0, 5.0)] {
        let loaded = load(one_pad(vec![mode(frequency_hz, 60.0, gain, 0.0)]));
        let driven = 30 * 48_000;
        let force: Vec<i32> = (0..driven)
            .map(|n| {
                let turns = (frequency_hz * f64::from(n) / 48_000.0).fract();
                ((std::f64::consts::TAU * turns).sin() * f64::from(ONE_Q27 - 1)) as i32
            })
            .collect();
        let frames = (driven + 10 * 48_000) as usize;
        let (bus, reports) = play(&loaded, RATE, Skipping::On, &[], Some(&force), (frames, &[128]));
        assert!(reports.iter().all(|report| report.refused_inputs == 0));
        let expected = law(&loaded, &performance(Vec::new(), Some(force), frames), RATE);
        // The bus clips at 16; the law does not. Differences count relative to the amplitude, which grows for half a minute.
        let mut amplitude = 1.0f64;
        for (index, ([got, _], [expected, _])) in real(&bus).iter().zip(&expected).enumerate() {
            let clipped = expected.clamp(-16.0, 16.0);
            amplitude = (amplitude * 0.999).max(expected.abs()).max(1.0);
            let allowed = 1e-3 * amplitude;
            assert!((got - clipped).abs() <= allowed, "{frequency_hz} Hz, frame {index}: {got}, not {clipped}");
        }
    }
}

#[test]
fn an_amplitude_beyond_all_headroom_is_refused_without_a_wrap() {
    // The largest gain, and a force of 16 times the reference force in resonance, would reach +220 dBFS.
    let kit = one_pad(vec![mode(1_000.0, 600.0, 7e8, 0.0)]);
    let force: Vec<i32> = (0..20 * 48_000).map(|n| if n % 48 < 24 { i32::MAX } else { i32::MIN }).collect();
    let (bus, reports) = play(&load(kit), RATE, Skipping::On, &[], Some(&force), (20 * 48_000, &[128]));
    assert!(reports.iter().any(|report| report.refused_inputs > 0));
    // Clipped hard, the sign still follows the mode: half the frames of each period either way.
    let last = &bus[19 * 48_000..];
    let positive = last.iter().filter(|frame| frame[0] > 0).count();
    assert!((23_000..25_000).contains(&positive), "{positive}");
}

#[test]
fn a_thousand_strikes_a_second_on_every_pad_for_a_minute_stay_bounded_and_end_in_silence() {
    let kit = kit::open("demo").expect("the shipped kit is valid").kit;
    let (pads, loaded) = (kit.pads.len(), load(kit));
    let mut events = Vec::new();
    for step in 0..60_000u64 {
        for pad in 0..pads {
            let mut event = strike(step * 48, 1.0);
            event.pad = pad as u8;
            event.position = (step % 101) as f32 / 100.0;
            events.push(event);
        }
    }
    let mut driven = 0;
    let (bus, reports) = play(&loaded, RATE, Skipping::On, &events, None, (100 * 48_000, &[128]));
    reports.iter().for_each(|report| driven += u64::from(report.driven_mode_frames));
    assert!(driven > 1_000_000 && reports.iter().all(|report| report.refused_inputs == 0));
    // Clipping is clean: full scale of the bus is reached without a jump from end to end within a frame.
    let wraps = bus.windows(2).filter(|pair| pair[0][0].abs_diff(pair[1][0]) > 3 << 30).count();
    assert_eq!(wraps, 0);
    assert!(bus.last() == Some(&[0, 0]) && reports.last().is_some_and(|report| report.ringing_pads == 0));
}

#[test]
fn modes_in_phase_by_the_hundred_sum_up_without_a_wrap() {
    let loaded = load(one_pad(vec![mode(300.0, 1.0, 0.0, 4_000.0); 512]));
    let (bus, _) = play(&loaded, RATE, Skipping::On, &[strike(0, 1.0)], None, (24_000, &[128]));
    let expected = law(&loaded, &performance(vec![strike(0, 1.0)], None, 24_000), RATE);
    assert!(expected.iter().any(|frame| frame[0].abs() > 100.0));
    for ([got, _], [expected, _]) in real(&bus).iter().zip(&expected) {
        // 512 amplitudes of 1.27 sum up to 650.
        assert!((got - expected.clamp(-16.0, 16.0)).abs() <= 650.0 * 1e-6, "{got} {expected}");
    }
}

#[test]
fn the_edges_of_frequency_and_decay_follow_the_law() {
    for frequency_hz in [1.0, 5.0, 0.25 * 48_000.0, 0.499 * 48_000.0] {
        for t60_s in [0.001, 0.01, 1.0, 120.0] {
            let loaded = load(one_pad(vec![mode(frequency_hz, t60_s, 200.0, 100.0)]));
            let events = vec![strike(3, 1.0), strike(20_000, 0.3)];
            let (bus, _) = play(&loaded, RATE, Skipping::Off, &events, None, (48_000, &[128]));
            let expected = law(&loaded, &performance(events, None, 48_000), RATE);
            let snr = snr_db(&expected, &real(&bus));
            println!("{frequency_hz} Hz, {t60_s} s: {snr:.1} dB");
            // At exactly fs/4 the orbit repeats every four samples, and so do its roundings: they add up
            // instead of averaging. At 0.499 fs a smooth pulse excites next to nothing, and what is left
            // of the cancellation is compared: 54.8 dB at worst, with samples that are means.
            let least = if frequency_hz > 0.49 * 48_000.0 { 52.0 } else { 70.0 };
            assert!(snr > least, "{frequency_hz} Hz, {t60_s} s: {snr:.1} dB");
        }
    }
}

#[test]
fn choke_and_release_while_ringing_follow_the_law_without_a_step() {
    let modes = vec![
        mode(60.0, 4.0, 400.0, 50.0),
        mode(440.0, 8.0, 300.0, 100.0),
        mode(5_000.0, 3.0, 200.0, -60.0),
        mode(11_500.0, 0.02, 200.0, 0.0),
        mode(19_000.0, 2.0, 200.0, 70.0),
    ];
    for choke_t60_s in [0.005, 0.1, 1.0] {
        let mut kit = one_pad(modes.clone());
        kit.pads[0].choke_t60_s = choke_t60_s;
        let loaded = load(kit);
        let mut events = vec![strike(0, 1.0), hand(10_007, Action::Choke), hand(12_001, Action::Release)];
        events.extend([
            hand(14_000, Action::Choke),
            strike(14_100, 1.0),
            hand(16_003, Action::Release),
            strike(20_000, 0.5),
        ]);
        let (bus, _) = play(&loaded, RATE, Skipping::Off, &events, None, (48_000, &[33]));
        let expected = law(&loaded, &performance(events, None, 48_000), RATE);
        let snr = snr_db(&expected, &real(&bus));
        println!("choke T60 {choke_t60_s} s: {snr:.1} dB");
        assert!(snr > 90.0, "{choke_t60_s}: {snr:.1} dB");
    }
}

#[test]
fn a_thousand_million_mode_samples_bring_no_drift() {
    // 500 modes of T60 60 s for 2 million frames; one of them is heard, the others weigh in at -60 dB of it.
    let mut modes: Vec<_> = (0..499).map(|n| mode(100.0 + 40.0 * f64::from(n), 60.0, 0.05, 0.0)).collect();
    modes.push(mode(333.0, 60.0, 2_000.0, 0.0));
    let loaded = load(one_pad(modes));
    let frames = 2_000_000 / TICK_FRAMES * TICK_FRAMES;
    let (bus, reports) = play(&loaded, RATE, Skipping::Off, &[strike(0, 1.0)], None, (frames, &[128]));
    let run: u64 = reports.iter().map(|report: &TickReport| u64::from(report.run_mode_frames())).sum();
    assert!(run >= 999_000_000, "{run}");
    let expected = law(&loaded, &performance(vec![strike(0, 1.0)], None, frames), RATE);
    let bus = real(&bus);
    for second in [0usize, 10, 20, 30, 40] {
        let window = second * 48_000..(second + 1) * 48_000;
        let snr = snr_db(&expected[window.clone()], &bus[window.clone()]);
        let level = |sound: &[[f64; 2]]| sound.iter().map(|frame| frame[0] * frame[0]).sum::<f64>();
        let drift_db = 10.0 * (level(&bus[window.clone()]) / level(&expected[window])).log10();
        println!("after {second} s: {snr:.1} dB, envelope {drift_db:+.5} dB");
        // The phase drifts apart within 0.01 cent; the envelope does not.
        assert!(drift_db.abs() < 0.01 && snr > 60.0, "after {second} s: {snr:.1} dB, {drift_db} dB");
    }
}

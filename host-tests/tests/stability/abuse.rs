//! Abuse of the engine: resonance, storms, extremes, a very long run.

use dsp_core::SampleRate;
use dsp_core::engine::Skipping;
use dsp_core::event::Action;
use host_tests::performance::{reference, snr_db};
use host_tests::scene::{hand, load, mode, one_pad, play, strike};
use host_tests::sweeps::stability::{performance, real};
use host_tests::sweeps::{self, Extent};

const RATE: SampleRate = SampleRate::HZ_48000;

#[test]
fn a_sine_on_a_mode_of_60_s_for_30_s_saturates_cleanly_and_decays_as_its_table_says() {
    sweeps::stability::resonance(Extent::Tenth);
}

#[test]
fn an_amplitude_beyond_all_headroom_is_refused_without_a_wrap() {
    // The largest gain, in resonance with a force of 16 times the reference force, would reach +220
    // dBFS.
    let kit = one_pad(vec![mode(1_000.0, 600.0, 7e8, 0.0)]);
    let force: Vec<i32> = (0..20 * 48_000).map(|n| if n % 48 < 24 { i32::MAX } else { i32::MIN }).collect();
    let (bus, reports) = play(&load(kit), RATE, Skipping::On, &[], Some(&force), (20 * 48_000, &[128]));
    assert!(reports.iter().any(|report| report.refused_inputs > 0));
    // The sound is clipped hard, but its sign follows the mode: half the frames of each period are
    // positive.
    let last = &bus[19 * 48_000..];
    let positive = last.iter().filter(|frame| frame[0] > 0).count();
    assert!((23_000..25_000).contains(&positive), "{positive}");
}

#[test]
fn a_thousand_strikes_a_second_on_every_pad_stay_bounded_and_end_in_silence() {
    sweeps::stability::strikes(Extent::Tenth);
}

#[test]
fn modes_in_phase_by_the_hundred_sum_up_without_a_wrap() {
    // A pad with so short a choke is in the fixed-point bank. The other one is in frames, where a
    // mode has an SNR of 105 dB and more (docs/frames.md), and 512 equal modes err alike.
    for (choke_t60_s, most) in [(0.01, 1e-6), (0.0, 5e-6)] {
        let mut kit = one_pad(vec![mode(300.0, 1.0, 0.0, 4_000.0); 512]);
        kit.pads[0].choke_t60_s = choke_t60_s;
        let loaded = load(kit);
        let (bus, _) = play(&loaded, RATE, Skipping::On, &[strike(0, 1.0)], None, (24_000, &[128]));
        let expected = reference(&loaded, &performance(vec![strike(0, 1.0)], None, 24_000), RATE);
        assert!(expected.iter().any(|frame| frame[0].abs() > 100.0));
        for ([got, _], [expected, _]) in real(&bus).iter().zip(&expected) {
            // The 512 amplitudes of 1.27 sum up to 650.
            assert!((got - expected.clamp(-16.0, 16.0)).abs() <= 650.0 * most, "{got} {expected}");
        }
    }
}

#[test]
fn the_edges_of_frequency_and_decay_follow_the_reference() {
    for frequency_hz in [1.0, 5.0, 0.25 * 48_000.0, 0.499 * 48_000.0] {
        for t60_s in [0.001, 0.01, 1.0, 120.0] {
            let loaded = load(one_pad(vec![mode(frequency_hz, t60_s, 200.0, 100.0)]));
            let events = vec![strike(3, 1.0), strike(20_000, 0.3)];
            let (bus, _) = play(&loaded, RATE, Skipping::Off, &events, None, (48_000, &[128]));
            let expected = reference(&loaded, &performance(events, None, 48_000), RATE);
            let snr = snr_db(&expected, &real(&bus));
            println!("{frequency_hz} Hz, {t60_s} s: {snr:.1} dB");
            // At exactly fs/4 the orbit repeats every four samples, and so do its roundings: they
            // add up instead of averaging. At 0.499 fs a smooth pulse excites next to nothing, and
            // only the remainder of the cancellation is compared. That is 54.8 dB at worst, with
            // samples that are means.
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
        let expected = reference(&loaded, &performance(events, None, 48_000), RATE);
        let snr = snr_db(&expected, &real(&bus));
        println!("choke T60 {choke_t60_s} s: {snr:.1} dB");
        assert!(snr > 90.0, "{choke_t60_s}: {snr:.1} dB");
    }
}

#[test]
fn a_hundred_million_mode_samples_bring_no_drift() {
    sweeps::stability::drift(Extent::Tenth);
}

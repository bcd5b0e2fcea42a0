//! Times of decisions: independent of the blocks, a fixed time after the onset, and at the right
//! frame of another clock.
//!
//! `cargo test -p host-tests --test trigger timing -- --nocapture` prints the figures.

use dsp_core::SampleRate;
use dsp_core::trigger::{FrameMap, Report, Resampler, Settings, Trigger};
use host_tests::trigger::listen::{on_pc, strike, usual_trigger};
use host_tests::trigger::piezo::{Attack, RATE_HZ};
use host_tests::trigger::random::Random;
use host_tests::trigger::set::{CHANNELS, scenes};
use host_tests::trigger::{Ring, Scene, Strike};
use proptest::prelude::*;

/// Scene of one strike on pad 0 of an otherwise quiet board.
fn one_strike(time_s: f64, velocity: f64, ring: Ring, noise_counts: f64) -> Scene<CHANNELS> {
    Scene {
        name: "one strike",
        strikes: vec![Strike { time_s, pad: 0, velocity }],
        rings: [(ring, 1.0); CHANNELS],
        noise_counts,
        hum: (0.0, 50.0),
        offset: (10.0, 0.0),
        crosstalk: (0.0, 0.0),
        length_s: time_s + 0.02,
        seed: 1,
    }
}

const WAVE: Ring = Ring { frequency_hz: 900.0, decay_s: 0.012, attack: Attack::Contact(0.000_6), second: (2.3, 0.2) };

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn the_blocks_lengths_change_no_bit_of_what_is_found(seed in 0..1000u64, kind in 0..9usize, lengths in prop::collection::vec(1..200usize, 1..20)) {
        let scene = &scenes(seed, 1)[kind];
        let counts = scene.counts();
        let counts = &counts[..counts.len().min(96_000)];
        let whole = {
            let mut found = Vec::new();
            usual_trigger().expect("valid").process(counts, |report| if let Report::Strike(strike) = report { found.push(strike) });
            found
        };
        let mut trigger = usual_trigger().expect("valid");
        let (mut rest, mut found) = (counts, Vec::new());
        for &length in lengths.iter().cycle() {
            let (block, behind) = rest.split_at(length.min(rest.len()));
            trigger.process(block, |report| if let Report::Strike(strike) = report { found.push(strike) });
            rest = behind;
            if rest.is_empty() {
                break;
            }
        }
        prop_assert!(!whole.is_empty());
        prop_assert_eq!(found, whole);
    }

    #[test]
    fn a_strike_is_reported_in_the_block_in_which_it_is_decided(length in 1..200usize) {
        let counts = one_strike(0.1, 0.5, WAVE, 0.5).counts();
        let mut trigger = usual_trigger().expect("valid");
        for block in counts.chunks(length) {
            let before = trigger.now();
            let mut late = false;
            trigger.process(block, |report| if let Report::Strike(strike) = report { late |= strike.frame <= before });
            prop_assert!(!late);
        }
    }
}

#[test]
fn latency_jitters_by_less_than_50_microseconds_over_1000_offsets_of_one_wave() {
    for (velocity, noise) in [(1.0, 0.5), (0.1, 0.5), (0.02, 0.5)] {
        let latencies: Vec<f64> = (0..1000)
            .map(|offset| {
                let time_s = 0.1 + f64::from(offset) / 16.0 / RATE_HZ;
                let found = on_pc(&one_strike(time_s, velocity, WAVE, noise).counts());
                assert_eq!(found.len(), 1, "velocity {velocity}, offset {offset}");
                found[0].frame as f64 / RATE_HZ - time_s
            })
            .collect();
        let least = latencies.iter().copied().fold(f64::INFINITY, f64::min);
        let most = latencies.iter().copied().fold(0.0, f64::max);
        println!("velocity {velocity}: decided after {:.3} to {:.3} ms", least * 1e3, most * 1e3);
        assert!(most - least < 50e-6, "{least} to {most}");
    }
}

#[test]
fn over_40_db_of_velocity_strikes_are_decided_after_1_45_to_1_55_ms() {
    let mut random = Random::new(7);
    let mut latencies = Vec::new();
    for step in 0..=40 {
        let velocity = 10f64.powf(-f64::from(step) / 20.0);
        let time_s = 0.1 + random.between(0.0, 0.001);
        let found = on_pc(&one_strike(time_s, velocity, WAVE, 0.5).counts());
        assert_eq!(found.len(), 1, "{velocity}");
        latencies.push((found[0].frame as f64 / RATE_HZ - time_s) * 1e3);
    }
    let least = latencies.iter().copied().fold(f64::INFINITY, f64::min);
    let most = latencies.iter().copied().fold(0.0, f64::max);
    println!("0 to -40 dB: decided after {least:.3} to {most:.3} ms");
    assert!(least >= 1.45 && most <= 1.55, "{least:.3} to {most:.3} ms");
}

#[test]
fn frames_map_to_the_other_clock_without_drift() {
    let i2s = SampleRate::new(86_000_000, 1792).expect("a rate");
    let map = FrameMap::new(SampleRate::HZ_48000, i2s).expect("a ratio");
    for frame in [0u64, 1, 5375, 5376, 48_000, 1 << 32, (1 << 40) + 12_345, 1 << 60] {
        let exact = u128::from(frame) * 5375 / 5376;
        assert_eq!(u128::from(map.output_frame(frame)), exact, "{frame}");
    }
    // After a day the mapped frame is still the right one.
    let day = 86_400 * 48_000;
    assert_eq!(map.output_frame(day), (86_400.0 * i2s.hz()).floor() as u64);
    assert!(map.adc_frame(map.output_frame(day)) <= day && day - map.adc_frame(map.output_frame(day)) <= 2);
}

#[test]
fn the_resampler_is_its_twin_and_keeps_its_place_for_ten_minutes() {
    let i2s = SampleRate::new(86_000_000, 1792).expect("a rate");
    let mut resampler = Resampler::new(SampleRate::HZ_48000, i2s, 40).expect("a delay");
    let step = 48_000.0 / i2s.hz();
    let wave = |n: f64, hz: f64| (std::f64::consts::TAU * hz * n / 48_000.0).sin() * f64::from(1 << 26);
    let mut noise_of = [0.0f64; 3];
    let (mut pushed, mut pulled) = (0u64, 0u64);
    let mut reference_in = Vec::new();
    let mut worst_twin = 0.0f64;
    while pulled < 48_000 * 600 {
        // Only about the first and the last second have waves. Silence lies between, which takes
        // less time to make.
        let sounding = !(40_000..48_000 * 599).contains(&pulled);
        let input: Vec<i32> =
            (pushed..pushed + 32).map(|n| if sounding { wave(n as f64, 1000.0).round() as i32 } else { 0 }).collect();
        resampler.push(&input);
        pushed += 32;
        let mut out = [0; 32];
        // The other clock takes `due` frames by now.
        let due = (pushed as f64 / step) as u64;
        let out = &mut out[..(due - pulled).min(32) as usize];
        resampler.pull(out);
        if pushed <= 4000 {
            reference_in.extend(input.iter().map(|&x| f64::from(x)));
        }
        if pushed == 4000 {
            let twin = reference::trigger::resample(&reference_in, step, 40, due as usize);
            for (x, twin) in out.iter().zip(&twin[pulled as usize..]) {
                worst_twin = worst_twin.max((f64::from(*x) - twin).abs());
            }
        }
        if sounding && pulled > 48_000 * 599 + 1000 {
            for (k, x) in (pulled..).zip(out.iter()) {
                let exact = wave(k as f64 * step - 40.0, 1000.0);
                noise_of[0] = noise_of[0].max((f64::from(*x) - exact).abs());
            }
        }
        pulled += out.len() as u64;
    }
    let error_db = 20.0 * (noise_of[0] / f64::from(1 << 26)).log10();
    println!("1 kHz after ten minutes: error {error_db:.1} dB; from the twin at most {worst_twin:.1} of 2^26");
    assert_eq!(resampler.missed(), 0);
    assert!(worst_twin <= 8.0);
    assert!(error_db < -80.0);
}

#[test]
fn a_resampler_without_input_is_silent_and_counts_and_then_goes_on_in_time() {
    let rate = SampleRate::HZ_48000;
    let mut resampler = Resampler::new(rate, rate, 3).expect("a delay");
    let mut out = [0; 32];
    resampler.push(&[1000; 32]);
    resampler.pull(&mut out);
    assert_eq!(resampler.missed(), 0);
    // One block does not come.
    resampler.pull(&mut out);
    assert!(resampler.missed() > 0);
    let missed = resampler.missed();
    // The block comes late, with the next one: time has not shifted.
    let ramp: Vec<i32> = (32..128).map(|n| n * 1000).collect();
    resampler.push(&ramp[..64]);
    resampler.pull(&mut out);
    assert_eq!(resampler.missed(), missed);
    assert_eq!(out[10], (64 + 10 - 3) * 1000);
    // More samples come at once than fit, so the oldest are overwritten before they are read.
    resampler.push(&vec![7; 1000]);
    resampler.pull(&mut out);
    assert_eq!((out[10], resampler.missed()), (0, missed + 32));
}

#[test]
fn direct_drive_is_under_way_within_0_2_ms_of_the_onset_and_silent_before_and_after() {
    let settings = Settings { mode: dsp_core::trigger::Mode::Direct, ..Settings::of_unset_pad(0) };
    let i2s = SampleRate::new(86_000_000, 1792).expect("a rate");
    for velocity in [1.0, 0.1] {
        let scene = Scene { length_s: 0.4, ..one_strike(0.1, velocity, WAVE, 0.5) };
        let mut trigger = Trigger::<CHANNELS>::new([settings], SampleRate::HZ_48000).expect("valid");
        let mut resampler = Resampler::new(SampleRate::HZ_48000, i2s, Resampler::MIN_DELAY).expect("valid");
        let mut force = Vec::new();
        let map = FrameMap::new(SampleRate::HZ_48000, i2s).expect("a ratio");
        for block in scene.counts().chunks(16) {
            trigger.process(block, |report| {
                if let Report::Force { samples, .. } = report {
                    resampler.push(samples);
                }
            });
            let due = map.output_frame(trigger.now()) as usize;
            let mut out = vec![0; due - force.len()];
            resampler.pull(&mut out);
            force.extend(out);
        }
        let onset = 0.1 * i2s.hz();
        let peak = force.iter().map(|x| x.unsigned_abs()).max().expect("samples");
        let tenth = force.iter().position(|x| x.unsigned_abs() > peak / 10).expect("a force");
        let after_ms = (tenth as f64 - onset) / i2s.hz() * 1e3;
        println!("velocity {velocity}: a tenth of the force's peak after {after_ms:.2} ms");
        assert!(after_ms < 0.2);
        assert!((f64::from(peak) / f64::from(1 << 27) / velocity - 1.0).abs() < 0.06);
        assert!(force[..onset as usize].iter().all(|&x| x == 0));
        assert!(force[force.len() - 2000..].iter().all(|&x| x == 0));
    }
}

#[test]
fn strikes_are_reported_as_found() {
    let counts = one_strike(0.1, 0.5, WAVE, 0.5).counts();
    let mut trigger = usual_trigger().expect("valid");
    let mut found = Vec::new();
    trigger.process(&counts, |report| found.extend(strike(&report)));
    assert_eq!(found.len(), 1);
    assert!((20.0 * (found[0].velocity / 0.5).log10()).abs() < 0.3, "{}", found[0].velocity);
}

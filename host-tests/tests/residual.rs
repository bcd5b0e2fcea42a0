//! The residual against the law: energies, decays, flatness and onset over many seeds; what strikes add; silence.

use dsp_core::SampleRate;
use dsp_core::noise::Sfc32;
use dsp_core::residual::{BandLaw, Shaper};
use dsp_core::resonator::TICK_FRAMES;
use host_tests::residual::law::{Measured, decays, energies, ideal_sound, mean_and_error, sounds};
use host_tests::residual::spectrum::{between, energy_spectrum};
use host_tests::residual::{Spacing, edges_hz, play, shaper};
use proptest::prelude::*;

const SEEDS: u32 = 200;
/// Frames of a sound: 1.4 s.
const FRAMES: usize = 65_536;

/// Bands of equal density whose decay (dB/s) is a function of their number.
fn bands(spacing: Spacing, count: usize, range_hz: [f64; 2], mut decay: impl FnMut(usize) -> f64) -> Vec<BandLaw> {
    let edges = edges_hz(spacing, count, range_hz);
    let mut band = |(index, edges): (usize, &[f64])| BandLaw {
        edges_hz: [edges[0] as f32, edges[1] as f32],
        weight: (0.003 * ((edges[1] - edges[0]) / 100.0).sqrt()) as f32,
        decay_db_per_s: decay(index) as f32,
    };
    edges.windows(2).enumerate().map(&mut band).collect()
}

/// The worst error beyond three standard errors, in dB.
fn worst(measured: &[Measured]) -> f64 {
    measured.iter().map(|m| m.error.abs() - 3.0 * m.standard_error).fold(0.0, f64::max)
}

#[test]
fn energies_of_a_hundred_bands_follow_the_law_in_either_spacing() {
    for (spacing, range_hz) in [(Spacing::Erb, [50.0, 23_500.0]), (Spacing::Linear, [50.0, 23_500.0])] {
        let bands = bands(spacing, 100, range_hz, |index| 120.0 + 2.0 * index as f64);
        let measured = energies(&bands, &sounds(&bands, SEEDS, FRAMES));
        let mean = measured.iter().map(|m| m.error.abs()).sum::<f64>() / 100.0;
        println!("{spacing:?}: mean |error| {mean:.2} dB, worst beyond 3 s.e. {:.2} dB", worst(&measured));
        assert!(worst(&measured) < 0.5, "{spacing:?}: {measured:?}");
    }
}

/// Even from 20 to 400 dB/s, another one for every call.
fn random_decays(seed: u32) -> impl FnMut(usize) -> f64 {
    let mut random = Sfc32::new(seed, 77);
    move |_| 20.0 + 380.0 * f64::from(random.draw()) / 2f64.powi(32)
}

/// Bands that are off by more than half a dB beyond three standard errors.
fn misses(measured: &[Measured]) -> usize {
    measured.iter().filter(|m| m.error.abs() - 3.0 * m.standard_error > 0.5).count()
}

#[test]
fn bands_of_two_lines_and_more_keep_their_energy_beside_others_that_last_longer_or_shorter() {
    // Lines of a frame are 48 000/1024 Hz apart.
    const WIDE_HZ: f32 = 2.0 * 48_000.0 / 1_024.0;
    // One of these that lies between two lines beside one of 2.5 lines that lasts ten times as long may be 0.6 dB off.
    for (spacing, most_misses) in [(Spacing::Linear, 0), (Spacing::Erb, 1)] {
        let mut missed = 0;
        for seed in 0..6 {
            let bands = bands(spacing, 100, [50.0, 23_500.0], random_decays(seed));
            let measured = energies(&bands, &sounds(&bands, SEEDS, FRAMES));
            let (wide, narrow): (Vec<_>, Vec<_>) =
                bands.iter().zip(measured).partition(|(band, _)| band.edges_hz[1] - band.edges_hz[0] > WIDE_HZ);
            let only = |part: &[(&BandLaw, Measured)]| part.iter().map(|(_, measured)| *measured).collect::<Vec<_>>();
            let (wide, narrow) = (only(&wide), only(&narrow));
            println!(
                "{spacing:?}, seed {seed}: {} bands of 94 Hz and more, worst {:.2} dB beyond 3 s.e.; of {} narrower ones {} miss, worst {:.2}",
                wide.len(),
                worst(&wide),
                narrow.len(),
                misses(&narrow),
                worst(&narrow)
            );
            missed += misses(&wide);
            assert!(missed <= most_misses && worst(&wide) < 0.7, "{spacing:?}, seed {seed}: {wide:?}");
        }
    }
}

#[test]
fn bands_of_five_lines_and_more_keep_their_energy_beside_louder_ones() {
    // Of 50, 16 and 5 lines each. A band of five may be one of 20 dB less beside one that lasts ten times as long: there it is a dB off.
    for (count, most_misses) in [(10, 0), (30, 0), (100, 1)] {
        let mut missed = 0;
        for seed in 0..12 {
            let mut random = Sfc32::new(seed, 78);
            let mut bands = bands(Spacing::Linear, count, [100.0, 23_500.0], random_decays(seed));
            // Densities within 20 dB.
            for band in &mut bands {
                band.weight *= 10f64.powf(f64::from(random.draw()) / 2f64.powi(32) - 0.5) as f32;
            }
            let measured = energies(&bands, &sounds(&bands, SEEDS, FRAMES));
            println!("{count} bands, seed {seed}: worst {:.2} dB beyond 3 s.e.", worst(&measured));
            missed += misses(&measured);
            assert!(missed <= most_misses && worst(&measured) < 1.0, "{count} bands, seed {seed}: {measured:?}");
        }
    }
}

#[test]
fn bands_decay_at_their_own_rate_beside_others() {
    let decays_db_per_s = [400.0, 60.0, 250.0, 100.0, 400.0, 150.0, 300.0, 60.0];
    let bands = bands(Spacing::Linear, 8, [500.0, 20_500.0], |index| decays_db_per_s[index]);
    let measured = decays(&bands, &sounds(&bands, SEEDS, FRAMES), 0.0, 20.0);
    println!("{decays_db_per_s:?} dB/s: {measured:.3?}");
    for measured in measured {
        assert!((measured.error - 1.0).abs() < 0.03 + 3.0 * measured.standard_error, "{measured:?}");
    }
}

#[test]
fn bands_decay_as_the_table_says() {
    for decay_db_per_s in [60.0, 200.0, 600.0] {
        let bands = bands(Spacing::Linear, 8, [500.0, 20_500.0], |_| decay_db_per_s);
        let sounds = sounds(&bands, SEEDS, FRAMES);
        let measured = decays(&bands, &sounds, 0.0, 20.0);
        println!("{decay_db_per_s} dB/s: {measured:.3?}");
        for measured in measured {
            assert!(
                (measured.error - 1.0).abs() < 0.03 + 3.0 * measured.standard_error,
                "{decay_db_per_s}: {measured:?}"
            );
        }
    }
}

#[test]
fn decays_of_a_hundred_bands_are_those_of_the_law_measured_in_the_same_way() {
    // A sharp cut of a narrow band smears its beginning, in the law's noise as in ours.
    const FRAMES: usize = 32_768;
    const IDEAL_SEEDS: u32 = 30;
    let smooth = |index: usize| 120.0 + 2.0 * index as f64;
    let tables = [
        ("linear, at random", bands(Spacing::Linear, 100, [50.0, 23_500.0], random_decays(3))),
        ("ERB, smooth", bands(Spacing::Erb, 100, [50.0, 23_500.0], smooth)),
    ];
    for (name, bands) in tables {
        let ours = decays(&bands, &sounds(&bands, SEEDS, FRAMES), 0.0, 20.0);
        let ideal: Vec<Vec<f64>> = (0..IDEAL_SEEDS).map(|seed| ideal_sound(&bands, seed, FRAMES)).collect();
        let ideal = decays(&bands, &ideal, 0.0, 20.0);
        let beyond = ours.iter().zip(&ideal).map(|(ours, ideal)| {
            let standard_error = ours.standard_error.hypot(ideal.standard_error) / ideal.error;
            (ours.error / ideal.error - 1.0).abs() - 3.0 * standard_error
        });
        let worst = beyond.fold(0.0, f64::max);
        println!("decays of a hundred bands, {name}: worst {:.1} % beyond 3 s.e. of the law's", 100.0 * worst);
        assert!(worst < 0.03, "{name}: {worst}");
    }
}

#[test]
fn a_band_is_flat_between_its_edges() {
    let bands = bands(Spacing::Linear, 1, [2_000.0, 12_000.0], |_| 100.0);
    let spectra: Vec<Vec<f64>> = sounds(&bands, SEEDS, FRAMES).iter().map(|sound| energy_spectrum(sound)).collect();
    // Twenty parts of the inner nine tenths; the edges are blurred by 70 Hz.
    let parts: Vec<f64> = (0..20)
        .map(|part| {
            let from = 2_500.0 + 450.0 * f64::from(part);
            let each: Vec<f64> = spectra.iter().map(|spectrum| between(spectrum, [from, from + 450.0])).collect();
            10.0 * mean_and_error(&each).0.log10()
        })
        .collect();
    let mean = parts.iter().sum::<f64>() / 20.0;
    let worst = parts.iter().map(|part| (part - mean).abs()).fold(0.0, f64::max);
    println!("flat within {worst:.2} dB");
    assert!(worst < 1.0, "{parts:?}");
}

#[test]
fn a_strike_sounds_from_its_own_frame_on_and_not_before() {
    let bands = bands(Spacing::Erb, 100, [50.0, 23_500.0], |_| 200.0);
    for start in [0, 1, 17, 31, 32, 100, 1_000] {
        let sound = play(&mut shaper(&bands, start as u32), &[(start, 1.0)], 2_048);
        let first = sound.iter().position(|&x| x != 0).unwrap_or(usize::MAX);
        assert!((start..=start + 1).contains(&first), "struck at {start}, sounds at {first}");
    }
    // At its full level at once: the first millisecond has the power of the law.
    let power = |from: usize| {
        let of = |seed| play(&mut shaper(&bands, seed), &[(0, 1.0)], 2_048);
        (0..SEEDS).flat_map(|seed| of(seed)[from..from + 48].to_vec()).map(|x| f64::from(x).powi(2)).sum::<f64>()
    };
    let ratio_db = 10.0 * (power(0) / power(480)).log10();
    println!("first millisecond over the one after ten: {ratio_db:.2} dB");
    assert!((ratio_db - 2.0).abs() < 0.5, "200 dB/s are 2 dB in 10 ms: {ratio_db:.2}");
}

#[test]
fn the_power_has_no_line_at_the_rate_of_ticks_or_frames() {
    let stationary = bands(Spacing::Linear, 1, [1_000.0, 20_000.0], |_| 0.0);
    // A period of both: 24 ticks, one steady frame.
    const PERIOD: usize = 24 * TICK_FRAMES;
    let mut profile = vec![0.0; PERIOD];
    for seed in 0..4 {
        let mut shaper = shaper(&stationary, seed);
        let sound = play(&mut shaper, &[(0, 1.0)], 2_500 * PERIOD);
        for (index, &x) in sound.iter().enumerate().skip(10 * PERIOD) {
            profile[index % PERIOD] += f64::from(x).powi(2);
        }
    }
    let mean = profile.iter().sum::<f64>() / PERIOD as f64;
    let line_db = |harmonic: usize| {
        let angle = |n: usize| std::f64::consts::TAU * (harmonic * n % PERIOD) as f64 / PERIOD as f64;
        let sum = |part: fn(f64) -> f64| profile.iter().enumerate().map(|(n, x)| x * part(angle(n))).sum::<f64>();
        20.0 * (2.0 * sum(f64::cos).hypot(sum(f64::sin)) / PERIOD as f64 / mean).log10()
    };
    let worst = (1..=48).map(line_db).fold(f64::MIN, f64::max);
    println!("strongest line up to 3 kHz: {worst:.1} dB; ticks {:.1} dB", line_db(24));
    assert!(worst < -50.0);
}

#[test]
fn strikes_add_in_energy() {
    let bands = bands(Spacing::Linear, 4, [1_000.0, 9_000.0], |_| 100.0);
    let energy = |strikes: &[(usize, f32)]| {
        let of = |seed| play(&mut shaper(&bands, seed), strikes, 48_000);
        (0..SEEDS).flat_map(of).map(|x| f64::from(x).powi(2)).sum::<f64>()
    };
    let single = energy(&[(0, 1.0)]);
    for gap in [3, 20, 100, 500, 767, 800, 1_000, 3_000] {
        let sum = energy(&[(0, 1.0), (gap, 0.5), (2 * gap, 0.7)]) / (single * (1.0 + 0.25 + 0.49));
        println!("three strikes {gap} frames apart: {:.2} dB", 10.0 * sum.log10());
        assert!((10.0 * sum.log10()).abs() < 0.04, "{gap}: {sum}");
    }
}

#[test]
fn an_hour_of_rolls_stays_bounded_and_ends_in_silence() {
    // As many strikes as an hour of ten a second, each over eight ticks.
    let bands = bands(Spacing::Erb, 20, [50.0, 23_500.0], |index| 5.0 + 40.0 * index as f64);
    let mut shaper = shaper(&bands, 1);
    let (mut loudest, mut random) = (0, Sfc32::new(5, 5));
    for _ in 0..36_000 {
        shaper.strike(1.0, (random.draw() % 32) as usize);
        for _ in 0..8 {
            let mut out = [0; TICK_FRAMES];
            shaper.render(&mut out);
            shaper.end_tick();
            loudest = out.iter().map(|x| x.unsigned_abs()).fold(loudest, u32::max);
        }
    }
    assert!(loudest < 1 << 30, "{loudest}");
    // 5 dB/s: half a minute to -110 dBFS.
    let end = play(&mut shaper, &[], 40 * 48_000);
    assert!(!shaper.is_active() && end[39 * 48_000..].iter().all(|&x| x == 0));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]

    #[test]
    fn any_table_and_any_strikes_stay_bounded_give_the_same_bits_in_any_runs_and_end(
        edges in prop::collection::vec(1.0f32..400.0, 2..101),
        raw in prop::collection::vec((0.0f32..=16.0, 0.0f32..=1.0), 100),
        strikes in prop::collection::vec((0usize..4_000, 0.0f32..16.0), 0..40),
        split in 1usize..32,
        seed: u32,
    ) {
        let mut edge = 1.0;
        let bands: Vec<BandLaw> = edges.iter().zip(&raw).map(|(width, (weight, decay))| {
            let below = edge;
            edge = (edge + width).min(23_900.0);
            // 100 to 20 000 dB/s, so that the end comes soon.
            BandLaw { edges_hz: [below, edge.max(below + 1.0)], weight: *weight, decay_db_per_s: 100.0 * 200f32.powf(*decay) }
        }).collect();
        let mut strikes = strikes;
        strikes.sort_by_key(|strike| strike.0);
        let whole = play(&mut shaper(&bands, seed), &strikes, 120_000);
        // The same in runs that are cut anywhere: strikes of strength 0 do nothing but cut.
        let mut cut: Vec<(usize, f32)> = strikes.clone();
        cut.extend((0..4_000 / split).map(|n| (n * split, 0.0)));
        cut.sort_by_key(|strike| strike.0);
        prop_assert_eq!(&whole, &play(&mut shaper(&bands, seed), &cut, 120_000));
        prop_assert!(whole[110_000..].iter().all(|&x| x == 0), "no silence in the end");
        if strikes.iter().all(|strike| strike.1 == 0.0) {
            prop_assert!(whole.iter().all(|&x| x == 0));
        }
    }
}

#[test]
fn a_stage_without_bands_or_strikes_does_nothing() {
    let mut none = Box::new(Shaper::NONE);
    none.strike(1.0, 0);
    assert!(!none.is_active());
    none.load(std::iter::empty(), SampleRate::HZ_48000, Sfc32::new(0, 0), 0.0);
    none.strike(1.0, 0);
    assert!(!none.is_active() && !none.is_built());
    let mut still = shaper(&bands(Spacing::Erb, 10, [50.0, 20_000.0], |_| 100.0), 0);
    assert!(play(&mut still, &[(5, 0.0)], 1_000).iter().all(|&x| x == 0) && !still.is_active());
}

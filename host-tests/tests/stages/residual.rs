//! The residual against the reference: energies, decays, flatness and onset over many seeds, sums
//! of strikes, silence.

use dsp_core::SampleRate;
use dsp_core::noise::Sfc32;
use dsp_core::residual::{ResidualBand, Shaper};
use dsp_core::resonator::TICK_FRAMES;
use host_tests::residual::{Spacing, play, shaper};
use host_tests::sweeps::residual::{SEEDS, bands};
use host_tests::sweeps::{self, Extent};
use proptest::prelude::*;

#[test]
fn energies_of_a_hundred_bands_follow_the_law_in_either_spacing() {
    sweeps::residual::energies(Extent::Tenth);
}

#[test]
fn bands_of_two_lines_keep_their_energy_beside_others_that_last_longer_or_shorter() {
    sweeps::residual::energies_beside_longer_ones(Extent::Tenth);
}

#[test]
fn bands_of_five_lines_and_more_keep_their_energy_beside_louder_ones() {
    sweeps::residual::energies_beside_louder_ones(Extent::Tenth);
}

#[test]
fn bands_decay_at_their_own_rate_beside_others() {
    sweeps::residual::decays_beside_others(Extent::Tenth);
}

#[test]
fn bands_decay_as_the_table_says() {
    sweeps::residual::decays_of_equal_bands(Extent::Tenth);
}

#[test]
fn decays_of_a_hundred_bands_are_those_of_the_law_measured_in_the_same_way() {
    sweeps::residual::decays_of_a_hundred_bands(Extent::Tenth);
}

#[test]
fn a_band_is_flat_between_its_edges() {
    sweeps::residual::flatness(Extent::Tenth);
}

#[test]
fn strikes_add_in_energy() {
    sweeps::residual::strikes_add(Extent::Tenth);
}

#[test]
fn minutes_of_rolls_stay_bounded_and_end_in_silence() {
    sweeps::residual::rolls(Extent::Tenth);
}

#[test]
fn a_strike_sounds_from_its_own_frame_on_and_not_before() {
    let bands = bands(Spacing::Erb, 100, [50.0, 23_500.0], |_| 200.0);
    for start in [0, 1, 17, 31, 32, 100, 1_000] {
        let sound = play(&mut shaper(&bands, start as u32), &[(start, 1.0)], 2_048);
        let first = sound.iter().position(|&x| x != 0).unwrap_or(usize::MAX);
        assert!((start..=start + 1).contains(&first), "struck at {start}, sounds at {first}");
    }
    // The level is full at once: the first millisecond has the power of the reference.
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
    // 24 ticks are one steady frame, and so a period of both.
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
        let bands: Vec<ResidualBand> = edges.iter().zip(&raw).map(|(width, (weight, decay))| {
            let below = edge;
            edge = (edge + width).min(23_900.0);
            // Decays are from 100 to 20 000 dB/s, so that the end comes soon.
            ResidualBand { edges_hz: [below, edge.max(below + 1.0)], weight: *weight, decay_db_per_s: 100.0 * 200f32.powf(*decay) }
        }).collect();
        let mut strikes = strikes;
        strikes.sort_by_key(|strike| strike.0);
        let whole = play(&mut shaper(&bands, seed), &strikes, 120_000);
        // The second play has runs that are cut anywhere: strikes of strength 0 only cut.
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
    let mut none = Shaper::none();
    none.strike(1.0, 0);
    assert!(!none.is_active());
    none.load(std::iter::empty(), SampleRate::HZ_48000, Sfc32::new(0, 0), 0.0);
    none.strike(1.0, 0);
    assert!(!none.is_active() && !none.is_built());
    let mut still = shaper(&bands(Spacing::Erb, 10, [50.0, 20_000.0], |_| 100.0), 0);
    assert!(play(&mut still, &[(5, 0.0)], 1_000).iter().all(|&x| x == 0) && !still.is_active());
}

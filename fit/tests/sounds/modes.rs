//! The modal estimator on sounds of known modes.

use fit::modes::{DampedSine, Settings, cramer_rao_bounds, estimate};
use fit::score::{Match, matches, quantile};
use fit::synthetic::{Synthetic, of_these, struck};

fn sine(frequency_hz: f64, t60_s: f64, level_db: f64, phase: f64) -> DampedSine {
    DampedSine { frequency_hz, decay_per_s: 1000f64.ln() / t60_s, amplitude: 10f64.powf(level_db / 20.0), phase }
}

fn estimate_of(sound: &Synthetic) -> Vec<DampedSine> {
    estimate(&sound.samples, sound.rate_hz, Settings::default())
}

/// Matches of the true modes, all within 20 cents; asserts that no other mode is found.
fn exactly_found(sound: &Synthetic) -> Vec<Match> {
    let estimates = estimate_of(sound);
    let found = matches(&sound.modes, &estimates, 20.0);
    assert_eq!(found.len(), sound.modes.len(), "{estimates:#?}");
    assert_eq!(estimates.len(), sound.modes.len(), "{estimates:#?}");
    found
}

#[test]
fn twenty_modes_are_found_at_the_accuracy_that_the_noise_allows() {
    // Seeds that the bench does not use.
    for (noise_dbfs, cents, t60_percent, t60_percent_p90, db, most) in
        [(-80.0, 0.00018, 0.0136, 0.094, 0.0008, 21), (-50.0, 0.0057, 0.42, 3.0, 0.024, 21)]
    {
        let mut found = Vec::new();
        for seed in 1001..1007 {
            let sound = struck(seed, noise_dbfs);
            let estimates = estimate_of(&sound);
            assert!(estimates.len() <= most, "seed {seed}: {} modes", estimates.len());
            found.extend(matches(&sound.modes, &estimates, 20.0));
        }
        let share = found.len() as f64 / 120.0;
        let errors = |error: fn(&Match) -> f64| found.iter().map(error).collect::<Vec<_>>();
        let medians =
            [Match::cents, Match::t60_percent, Match::amplitude_db].map(|error| quantile(&errors(error), 0.5));
        let p90 = quantile(&errors(Match::t60_percent), 0.9);
        println!(
            "{noise_dbfs} dBFS: {share} found; median cents, T60 %, dB {medians:.5?}, T60 90th percentile {p90:.3} %"
        );
        assert!(share == 1.0, "{share} found");
        // Twice the figures of docs/fit.md, which come from other seeds.
        assert!(quantile(&errors(Match::cents), 0.5) <= cents);
        assert!(quantile(&errors(Match::t60_percent), 0.5) <= t60_percent);
        assert!(quantile(&errors(Match::t60_percent), 0.9) <= t60_percent_p90);
        assert!(quantile(&errors(Match::amplitude_db), 0.5) <= db);
    }
}

#[test]
fn errors_scatter_by_the_cramer_rao_bounds() {
    let (mut squares, mut count) = (0.0, 0.0);
    for seed in 2001..2007 {
        let sound = struck(seed, -60.0);
        let estimates = estimate_of(&sound);
        let bounds = cramer_rao_bounds(&sound.modes, sound.samples.len(), sound.rate_hz, sound.noise_rms)
            .expect("the modes are 1 % apart");
        for (mode, bound) in sound.modes.iter().zip(&bounds) {
            for found in matches(&[*mode], &estimates, 20.0) {
                let error = (found.estimate.frequency_hz - mode.frequency_hz) / bound.frequency_hz;
                // One in a million lies beyond 5 deviations: such a mode was missed, and another
                // one matched.
                if error.abs() < 5.0 {
                    squares += error * error;
                    count += 1.0;
                }
            }
        }
    }
    let ratio = f64::sqrt(squares / count);
    assert!(count >= 0.97 * 120.0 && (0.8..1.25).contains(&ratio), "{count} modes, {ratio} times the bounds");
}

#[test]
fn pairs_a_third_of_a_percent_apart_are_two_modes() {
    for (index, frequency_hz) in [220.0, 440.0, 1000.0, 3000.0, 8000.0].into_iter().enumerate() {
        let seed = index as u64;
        let t60_s = 3.0 * (frequency_hz / 200.0f64).powf(-0.6);
        for noise_dbfs in [-80.0, -60.0] {
            let pair =
                vec![sine(frequency_hz, t60_s, 0.0, 0.4 + seed as f64), sine(frequency_hz * 1.003, t60_s, -6.0, 2.0)];
            for found in exactly_found(&of_these(pair, 88_200, seed, noise_dbfs)) {
                assert!(found.cents() < 0.5, "{frequency_hz} Hz, {noise_dbfs} dBFS: {} cents", found.cents());
            }
        }
    }
}

#[test]
fn a_mode_40_db_under_its_neighbour_at_5_percent_is_found() {
    for (index, frequency_hz) in [200.0, 600.0, 1500.0, 4000.0, 9000.0].into_iter().enumerate() {
        let t60_s = 3.0 * (frequency_hz / 200.0f64).powf(-0.6);
        for side in [1.05, 1.0 / 1.05] {
            let both = vec![sine(frequency_hz, t60_s, 0.0, 1.0), sine(frequency_hz * side, t60_s, -40.0, 5.0)];
            for found in exactly_found(&of_these(both, 88_200, index as u64, -80.0)) {
                assert!(found.cents() < 1.0 && found.amplitude_db() < 0.5, "{frequency_hz} Hz: {found:?}");
            }
        }
    }
}

#[test]
fn noise_alone_has_no_modes() {
    for seed in 0..6 {
        let sound = of_these(vec![sine(1000.0, 0.1, 0.0, 0.0)], 44_100, seed, 20.0);
        // The sine is 20 dB or more below the noise for all but a few cycles.
        let modes = estimate_of(&sound);
        assert!(modes.len() <= 1, "seed {seed}: {modes:?}");
    }
}

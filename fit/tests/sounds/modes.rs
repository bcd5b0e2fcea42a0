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

/// Amplitude of a table's mode at the end of the contact, in the strike at velocity 1.
fn amplitude_behind_contact(table: &kit::Kit, mode: &kit::Mode, rate_hz: f64) -> f64 {
    let striker = &table.strikers[0];
    let force = fit::contact::force(f64::from(striker.contact_time_s), rate_hz);
    let (mut re, mut im) = (0.0, 0.0);
    for (m, force) in force.iter().enumerate() {
        let time_s = (force_length(table, rate_hz) - m) as f64 / rate_hz;
        let left = force * (-f64::from(mode.decay_per_s) * time_s).exp();
        let (sine, cosine) = (std::f64::consts::TAU * f64::from(mode.frequency_hz) * time_s).sin_cos();
        re += left * cosine;
        im += left * sine;
    }
    let gain = f64::from(mode.gains[0].sine).hypot(f64::from(mode.gains[0].cosine));
    gain * f64::from(striker.peak_force) * re.hypot(im) / rate_hz
}

fn force_length(table: &kit::Kit, rate_hz: f64) -> usize {
    fit::contact::force(f64::from(table.strikers[0].contact_time_s), rate_hz).len()
}

#[test]
fn written_table_of_twenty_modes_is_as_exact_as_the_estimator() {
    for (noise_dbfs, cents, t60_percent, db) in [(-80.0, 0.0002, 0.015, 0.001), (-50.0, 0.006, 0.45, 0.03)] {
        let (mut all, mut off_db) = (Vec::new(), Vec::new());
        for seed in 3001..3004 {
            let sound = struck(seed, noise_dbfs);
            let hit = fit::segment::Hit { onset: 0, end: sound.samples.len() };
            let fit = fit::strike::fit_sound(&sound.samples, sound.rate_hz, &[hit], fit::strike::Settings::default())
                .expect("it has modes");
            assert!(fit.is_exact && fit.modes.len() <= 21, "seed {seed}: {} modes", fit.modes.len());
            let provenance =
                fit::table::Provenance { name: "sum".into(), source: String::new(), licence: String::new() };
            let table = fit::table::of_fit(&fit, &provenance);
            let length = force_length(&table, sound.rate_hz);
            let written: Vec<DampedSine> = table.objects[0]
                .modes
                .iter()
                .map(|mode| DampedSine {
                    frequency_hz: f64::from(mode.frequency_hz),
                    decay_per_s: f64::from(mode.decay_per_s),
                    amplitude: amplitude_behind_contact(&table, mode, sound.rate_hz),
                    phase: 0.0,
                })
                .collect();
            for found in matches(&sound.modes, &written, 20.0) {
                let then = found.truth.amplitude * (-found.truth.decay_per_s * length as f64 / sound.rate_hz).exp();
                off_db.push(20.0 * (found.estimate.amplitude / then).log10().abs());
                all.push(found);
            }
        }
        assert!(all.len() >= 59, "{}", all.len());
        let median = |error: fn(&Match) -> f64| quantile(&all.iter().map(error).collect::<Vec<_>>(), 0.5);
        let errors = [median(Match::cents), median(Match::t60_percent), quantile(&off_db, 0.5)];
        println!("{noise_dbfs} dBFS, written table: median cents, T60 %, dB {errors:.5?}");
        assert!(errors[0] <= cents && errors[1] <= t60_percent && errors[2] <= db, "{noise_dbfs} dBFS: {errors:?}");
    }
}

#[test]
fn slow_modes_within_ten_hertz_are_told_apart_in_a_sound_of_nine_seconds() {
    let modes: Vec<DampedSine> = [(2_149.3, -12.0), (2_152.3, -20.0), (2_155.6, -18.0), (2_158.4, -16.0)]
        .into_iter()
        .enumerate()
        .map(|(k, (hz, level_db))| sine(hz, 12.0, level_db, k as f64))
        .collect();
    let length = 9 * 44_100;
    let mut sound = of_these(modes.clone(), length, 3, -80.0).samples;
    // Noise that dies away keeps the modes from being exact.
    let noise = of_these(Vec::new(), length, 4, -20.0).samples;
    sound.iter_mut().zip(noise).enumerate().for_each(|(n, (x, noise))| *x += noise * (-(n as f64) / 15_000.0).exp());
    let hit = fit::segment::Hit { onset: 0, end: length };
    let fit = fit::strike::fit_sound(&sound, 44_100.0, &[hit], fit::strike::Settings::default()).expect("it has modes");
    for mode in &modes {
        let off = |found: &fit::strike::Mode| (found.frequency_hz - mode.frequency_hz).abs();
        let nearest_hz = fit.modes.iter().map(off).fold(f64::INFINITY, f64::min);
        println!("{:.1} Hz: a mode {nearest_hz:.3} Hz beside it, exact: {}", mode.frequency_hz, fit.is_exact);
        assert!(nearest_hz < 0.1, "{mode:?}: {nearest_hz} Hz, {:?}", fit.modes);
    }
}

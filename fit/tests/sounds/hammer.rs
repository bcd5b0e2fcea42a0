//! Strikes of an impact hammer: fits from sound alone, and from sound with its force.
//!
//! Strikes on known modes, rendered with noise, are made here. Recordings of a real hammer lie
//! beside the project, in `../shared/data`; without them their tests are ignored.

use std::path::Path;

use fit::audio::{Recording, read};
use fit::contact::{PULSE_FWHM, contact_interval_s, contact_time_s};
use fit::modes::Settings as ModeSettings;
use fit::multi_strike::{Layout, estimate};
use fit::score::quantile;
use fit::segment::{Hit, hits};
use fit::stages::RecordedStrike;
use fit::strike::{MeasuredHit, Settings, fit_sound, force_width_s, measured_hits, share_poles};
use fit::synthetic::{HAMMER_STRIKES, Hammered, hammered, of_these};
use fit::table::{Provenance, of_fit};

/// A recording of a real hammer and its strikes.
fn recording(name: &str) -> (Recording, Vec<Hit>) {
    let path = Path::new(env!("SHARED_DATA")).join("hammer").join(name);
    let recording = read(&path, Some(1)).expect("the recording is readable");
    let (found, _) = hits(&recording).expect("it holds strikes");
    (recording, found)
}

/// Strikes that the reference renders, with the contact times that made them.
fn synthetic() -> (Recording, Vec<Hit>, Vec<f64>) {
    let Hammered { recording, contact_times_s } = hammered(1);
    let (found, _) = hits(&recording).expect("it holds strikes");
    assert_eq!(found.len(), HAMMER_STRIKES, "{found:?}");
    (recording, found, contact_times_s)
}

#[cfg(not(has_shared_data))]
#[test]
fn recordings_are_still_absent_as_when_the_tests_were_built() {
    let data = Path::new(env!("SHARED_DATA"));
    assert!(!data.is_dir(), "{} is there now: run `touch build/shared_data.rs` and test again", data.display());
}

/// Mean log-spectral distance in dB of the tables of single hits, noise included, from the hits.
fn mean_lsd_db(recording: &Recording, found: &[Hit], most_modes: usize) -> f64 {
    let settings = Settings { modes: ModeSettings { most_modes, ..ModeSettings::default() }, ..Settings::default() };
    let provenance = Provenance { name: "hit".to_owned(), source: String::new(), licence: String::new() };
    let (mut of_modes, mut distances) = (Vec::new(), Vec::new());
    for hit in found {
        let fit = fit_sound(&recording.samples, recording.rate_hz, &[*hit], settings).expect("it has modes");
        assert!(fit.modes.len() <= most_modes);
        let (before, strike) = recording.samples[..hit.end].split_at(hit.onset);
        let stage = RecordedStrike::new(before, strike, recording.rate_hz, 0.0);
        let plain = stage.play(of_fit(&fit, &provenance), 1).expect("a board plays it");
        of_modes.push(plain.distances.lsd_db);
        let (whole, _) = stage.with_noise(plain, &fit.noise).expect("a board plays it");
        distances.push(whole.distances.lsd_db);
    }
    let mean = |distances: &[f64]| distances.iter().sum::<f64>() / distances.len() as f64;
    println!("modes alone: LSD {:.2} dB, mean over {} hits", mean(&of_modes), found.len());
    mean(&distances)
}

#[test]
fn twenty_modes_come_within_half_a_decibel_of_a_rendered_strike() {
    let (recording, found, _) = synthetic();
    let lsd_db = mean_lsd_db(&recording, &found[..3], 20);
    println!("rendered, 20 modes: LSD {lsd_db:.2} dB, mean over 3 hits");
    assert!(lsd_db <= 0.5, "{lsd_db:.2} dB");
}

/// Asserts that fits of all hits of two recordings come as near to them as `limits` has it: number
/// of modes and mean distance in dB, of ceramic and of wood.
fn modes_come_near(limits: [(usize, f64); 2]) {
    for ((name, count), (modes, limit)) in [("hammer_ceramic.wav", 8), ("hammer_wood.wav", 10)].into_iter().zip(limits)
    {
        let (recording, found) = recording(name);
        assert_eq!(found.len(), count, "{name}: {found:?}");
        let lsd_db = mean_lsd_db(&recording, &found, modes);
        println!("{name}, {modes} modes: LSD {lsd_db:.2} dB, mean over {count} hits");
        assert!(lsd_db <= limit, "{name}, {modes} modes: {lsd_db:.2} dB");
    }
}

#[test]
#[cfg_attr(not(has_shared_data), ignore = "needs the recordings in ../shared/data")]
fn a_few_modes_come_within_two_decibels_of_a_recorded_strike() {
    modes_come_near([(8, 1.85), (13, 1.3)]);
}

#[test]
#[ignore = "half a minute: cargo test -p fit --test sounds hammer::thirty_two -- --ignored --nocapture"]
fn thirty_two_modes_come_nearer_to_a_recorded_strike() {
    modes_come_near([(32, 1.75), (32, 1.15)]);
}

/// Full width at half maximum of the force of a strike, in seconds.
fn measured_width_s(recording: &Recording, hit: &Hit) -> f64 {
    let force = recording.force.as_ref().expect("channel 1 was asked for");
    let around = hit.onset - 150..hit.onset + 80;
    let peak = around.max_by(|&a, &b| force[a].total_cmp(&force[b])).expect("not empty");
    force_width_s(force, peak, recording.rate_hz)
}

#[test]
fn measured_widths_of_rendered_forces_are_within_5_percent() {
    let (recording, found, contact_times_s) = synthetic();
    for (hit, contact_time_s) in found.iter().zip(contact_times_s) {
        let ratio = measured_width_s(&recording, hit) / (PULSE_FWHM * contact_time_s);
        println!("rendered {:.3} ms: {ratio:.3} of the width measured", contact_time_s * 1e3);
        assert!((ratio - 1.0).abs() <= 0.05, "{ratio}");
    }
}

#[test]
#[cfg_attr(not(has_shared_data), ignore = "needs the recordings in ../shared/data")]
fn most_contact_times_from_sound_are_within_20_percent_of_the_measured_width() {
    let (mut near, mut all) = (0, 0);
    for name in ["hammer_ceramic.wav", "hammer_wood.wav"] {
        let (recording, found) = recording(name);
        let ratio = |hit: &Hit| {
            let heard = contact_time_s(&recording.samples[hit.onset..hit.end], recording.rate_hz);
            heard.expect("the hit is long enough") * PULSE_FWHM / measured_width_s(&recording, hit)
        };
        let ratios: Vec<f64> = found.iter().map(ratio).collect();
        println!("{name}: {ratios:.2?} of the measured width heard");
        near += ratios.iter().filter(|ratio| (*ratio - 1.0).abs() <= 0.2).count();
        all += ratios.len();
    }
    println!("{near} of {all} within 20 %");
    assert!(near >= 15 && all == 18, "{near} of {all}");
}

#[test]
#[cfg_attr(not(has_shared_data), ignore = "needs the recordings in ../shared/data")]
fn contact_intervals_from_sound_hold_nine_of_ten_measured_times() {
    let (mut held, mut all) = (0, 0);
    for name in ["hammer_ceramic.wav", "hammer_wood.wav"] {
        let (recording, found) = recording(name);
        for hit in &found {
            let measured_s = measured_width_s(&recording, hit) / PULSE_FWHM;
            let interval_s = contact_interval_s(&recording.samples[hit.onset..hit.end], recording.rate_hz);
            let [shortest_s, longest_s] = interval_s.expect("the hit is long enough");
            println!(
                "{name}: {:.2} ms measured, {:.2} to {:.2} ms possible",
                measured_s * 1e3,
                shortest_s * 1e3,
                longest_s * 1e3
            );
            held += usize::from((shortest_s..=longest_s).contains(&measured_s));
            all += 1;
        }
    }
    println!("{held} of {all} within the interval");
    assert!(10 * held >= 9 * all, "{held} of {all}");
}

#[test]
fn strikes_come_from_the_force_where_noise_hides_their_sound() {
    let (mut recording, quiet, _) = synthetic();
    let peak = recording.samples.iter().fold(0.0, |peak: f64, x| peak.max(x.abs()));
    let noise = of_these(Vec::new(), recording.samples.len(), 7, 20.0 * (0.2 * peak).log10());
    recording.samples.iter_mut().zip(noise.samples).for_each(|(x, noise)| *x += noise);
    let (found, _) = hits(&recording).expect("the force has pulses");
    assert_eq!(found.len(), HAMMER_STRIKES, "{found:?}");
    for (found, quiet) in found.iter().zip(&quiet) {
        let apart_s = found.onset.abs_diff(quiet.onset) as f64 / recording.rate_hz;
        assert!(apart_s < 0.005, "{found:?} {quiet:?}");
    }
    recording.force = None;
    let heard = hits(&recording).map_or(0, |(found, _)| found.len());
    assert!(heard < HAMMER_STRIKES, "{heard} are heard");
}

/// Residual in dB of each strike with shared poles, and median errors in dB of predictions.
///
/// Strikes 1 to 4 predict the others: by plain joint least squares, by one table, and by gains at
/// four positions.
fn shared_poles(name: &str, recording: &Recording, found: &[Hit]) -> (Vec<f64>, [f64; 3]) {
    let force = recording.force.as_ref().expect("channel 1 was asked for");
    let rate_hz = recording.rate_hz;
    let measured = measured_hits(&recording.samples, force, 1, rate_hz, found).expect("the force is there");
    let shared = share_poles(&measured, rate_hz, Settings::default()).expect("it has modes");
    println!("{name}: {} shared modes leave {:.1?} dB", shared.mode_count(), shared.residual_db);
    let first_three = {
        let (known, others) = measured.split_at(3);
        let learnt = share_poles(known, rate_hz, Settings::default()).expect("it has modes");
        let (plain, row) = (learnt.plain_place(known).expect("solved"), learnt.in_a_row(&[0, 1, 2]));
        let median = |of: &dyn Fn(&MeasuredHit) -> f64| quantile(&others.iter().map(of).collect::<Vec<_>>(), 0.5);
        [median(&|hit| learnt.prediction_db(&plain, hit)), median(&|hit| learnt.prediction_along_db(&row, hit).0)]
    };
    println!("{name}, hits 1 to 3 predict the others (median), plain and at three positions: {first_three:.2?} dB");
    let (known, others) = measured.split_at(4);
    let learnt = share_poles(known, rate_hz, Settings::default()).expect("it has modes");
    let (plain, common) = (learnt.plain_place(known).expect("solved"), learnt.common_place(known).expect("solved"));
    let row = learnt.in_a_row(&[0, 1, 2, 3]);
    let median = |of: &dyn Fn(usize) -> f64| quantile(&(0..others.len()).map(of).collect::<Vec<_>>(), 0.5);
    let plain = median(&|hit| learnt.prediction_db(&plain, &others[hit]));
    let common = median(&|hit| learnt.prediction_db(&common, &others[hit]));
    let along = median(&|hit| learnt.prediction_along_db(&row, &others[hit]).0);
    println!(
        "{name}, hits 1 to 4 predict the others (median): plain joint least squares {plain:.2} dB, one table {common:.2} dB, \
         four positions {along:.2} dB"
    );
    (shared.residual_db, [plain, common, along])
}

#[test]
fn a_fit_with_the_force_explains_rendered_strikes_down_to_their_noise() {
    let (recording, found, _) = synthetic();
    let (residual_db, [plain, _, along]) = shared_poles("rendered", &recording, &found);
    assert!(residual_db.iter().all(|residual| *residual <= -26.0), "{residual_db:.1?}");
    // The places lie on a line: positions along it explain the strikes, one set of gains cannot.
    assert!((plain + 11.2).abs() < 1.0 && (along + 32.1).abs() < 2.0, "{plain:.2} dB, {along:.2} dB");
}

/// Checks the figures of docs/fit.md: largest residual in dB, number of hits that leave at most
/// -20 dB, and predictions of hits by others.
fn shared_poles_are_as_documented(name: &str, worst: f64, good: usize, predicted: [f64; 3]) {
    let (recording, found) = recording(name);
    let (residual_db, predictions) = shared_poles(name, &recording, &found);
    assert!(residual_db.iter().filter(|residual| **residual <= -20.0).count() >= good, "{name}: {residual_db:.1?}");
    assert!(residual_db.iter().all(|residual| *residual <= worst + 1.0), "{name}: {residual_db:.1?}");
    let near = |(got, said): (&f64, &f64)| (got - said).abs() <= 1.0;
    assert!(predictions.iter().zip(&predicted).all(near), "{name}: {predictions:.2?}");
    assert!(predictions[1] < predictions[0] && predictions[2] < predictions[1], "{name}");
}

#[test]
#[cfg_attr(not(has_shared_data), ignore = "needs the recordings in ../shared/data")]
fn shared_poles_of_ceramic_with_the_force_leave_and_predict_as_documented() {
    shared_poles_are_as_documented("hammer_ceramic.wav", -22.8, 8, [-11.60, -12.76, -17.29]);
}

#[test]
#[ignore = "half a minute: cargo test -p fit --test sounds hammer::shared -- --ignored --nocapture"]
fn shared_poles_of_wood_with_the_force_leave_and_predict_as_documented() {
    shared_poles_are_as_documented("hammer_wood.wav", -27.4, 10, [-10.58, -10.65, -11.86]);
}

/// Skew A of the pulse `sin(πx) (1 + A cos(πx))`, 0 to 1, that comes nearest to a force round its
/// peak.
///
/// Onset, contact time and size are fitted as well.
fn skew(force: &[f64], peak: usize, rate_hz: f64) -> f64 {
    let around = &force[peak - 60..peak + 100];
    let energy: f64 = around.iter().map(|x| x * x).sum();
    let mut best = (energy, 0.0);
    for step in 0..=20 {
        let skew = f64::from(step) / 20.0;
        for time_s in (0..40).map(|n| 2.5e-4 + 2.5e-5 * f64::from(n)) {
            let time = time_s * rate_hz;
            // The peak lies between 0.33 and 0.5 of the contact, with a margin to either side.
            let (first, last) = (60.0 - 0.6 * time, 60.0 - 0.2 * time);
            let onsets = (0..).map(|n| first + 0.5 * f64::from(n)).take_while(|onset| *onset < last);
            for onset in onsets {
                let (mut cross, mut own) = (0.0, 0.0);
                for (n, x) in around.iter().enumerate() {
                    let at = (n as f64 - onset) / time;
                    if (0.0..1.0).contains(&at) {
                        let (sine, cosine) = (std::f64::consts::PI * at).sin_cos();
                        let shape = sine * (1.0 + skew * cosine);
                        cross += shape * x;
                        own += shape * shape;
                    }
                }
                let left = energy - cross * cross / own;
                if left < best.0 {
                    best = (left, skew);
                }
            }
        }
    }
    best.1
}

#[test]
#[cfg_attr(not(has_shared_data), ignore = "needs the recordings in ../shared/data")]
fn the_default_restitution_lies_between_those_of_the_two_measured_materials() {
    let medians = ["hammer_ceramic.wav", "hammer_wood.wav"].map(|name| {
        let (recording, found) = recording(name);
        let force = recording.force.as_ref().expect("channel 1 was asked for");
        let restitutions = found.iter().map(|hit| {
            let around = hit.onset - 150..hit.onset + 80;
            let peak = around.max_by(|&a, &b| force[a].total_cmp(&force[b])).expect("not empty");
            let skew = skew(force, peak, recording.rate_hz);
            ((1.0 - skew) / (1.0 + skew)).powf(1.0 / 4.6)
        });
        let restitutions: Vec<f64> = restitutions.collect();
        let median = quantile(&restitutions, 0.5);
        println!("{name}: e = {restitutions:.2?}, median {median:.2}");
        median
    });
    let usual = f64::from(kit::Striker::DEFAULT_RESTITUTION);
    assert!((medians[0] - 0.89).abs() < 0.06 && medians[1] < 0.1, "{medians:.2?}");
    assert!(medians[1] < usual && usual < medians[0], "{medians:.2?}");
}

/// Fits all strikes of a hammer recording together, from its sound alone, and compares their forces
/// with the measured ones. Returns the number of contact times within 20 % of the measured widths.
fn near_measured_widths(name: &str, count: usize) -> usize {
    let (recording, _) = recording(name);
    let measured = measured_forces(&recording);
    let fit = estimate(&recording.samples, recording.rate_hz, ModeSettings::default(), Layout::default(), |_| {})
        .expect("the strikes are told");
    assert_eq!((measured.len(), fit.strikes.len()), (count, count), "{name}: {measured:?}");
    let (mut near, mut impulses_db) = (0, Vec::new());
    for (strike, (at_s, width_s, impulse)) in fit.strikes.iter().zip(&measured) {
        assert!((strike.middle_s - at_s).abs() < 0.01, "{name}: {} s and {at_s} s", strike.middle_s);
        // A half-sine is at half its maximum or more for two thirds of its length.
        let ratio = strike.contact_time_s * (2.0 / 3.0) / width_s;
        near += usize::from((ratio - 1.0).abs() <= 0.2);
        impulses_db.push(20.0 * (strike.peak_force * strike.contact_time_s / impulse).log10());
        println!("{name}, {at_s:.3} s: {ratio:.2} of the measured width");
    }
    let unit_db = quantile(&impulses_db, 0.5);
    let errors_db: Vec<f64> = impulses_db.iter().map(|impulse| (impulse - unit_db).abs()).collect();
    println!(
        "{name}: {near} of {count} within 20 %; impulses off by {:.1} dB in the median, at most {:.1} dB",
        quantile(&errors_db, 0.5),
        quantile(&errors_db, 1.0)
    );
    // docs/multi-strike.md: 4.9 dB at most.
    assert!(quantile(&errors_db, 1.0) <= 7.9, "{name}: impulses are off by {errors_db:.1?} dB");
    near
}

/// Times of the measured forces' peaks and their widths at half maximum, both in seconds, and their
/// impulses in full scale and seconds.
fn measured_forces(recording: &Recording) -> Vec<(f64, f64, f64)> {
    let force = recording.force.as_ref().expect("channel 1 was asked for");
    let rate_hz = recording.rate_hz;
    let (found, _) = hits(recording).expect("it holds strikes");
    let of_hit = |hit: &Hit| {
        let around = hit.onset - 150..hit.onset + 80;
        let peak = around.clone().max_by(|&a, &b| force[a].total_cmp(&force[b])).expect("not empty");
        let impulse = force[around].iter().sum::<f64>() / rate_hz;
        (peak as f64 / rate_hz, force_width_s(force, peak, rate_hz), impulse)
    };
    found.iter().map(of_hit).collect()
}

#[test]
#[cfg_attr(not(has_shared_data), ignore = "needs the recordings in ../shared/data")]
fn strikes_on_a_mug_are_found_together_from_sound_alone() {
    assert!(near_measured_widths("hammer_ceramic.wav", 8) >= 6);
}

#[test]
#[cfg_attr(not(has_shared_data), ignore = "needs the recordings in ../shared/data")]
fn strikes_on_wood_are_found_together_from_sound_alone() {
    assert!(near_measured_widths("hammer_wood.wav", 10) >= 8);
}

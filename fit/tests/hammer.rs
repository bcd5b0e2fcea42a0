//! Strikes of an impact hammer: sound alone, and sound with its force. The recordings lie beside the project, in `../shared/data`.

use std::path::{Path, PathBuf};

use fit::audio::{Recording, read};
use fit::contact::{PULSE_FWHM, contact_time_s};
use fit::modes::Settings as ModeSettings;
use fit::score::quantile;
use fit::segment::{Hit, hits};
use fit::strike::{Settings, fit_sound, force_width_s, measured_hits, share_poles};

fn recording(name: &str) -> Option<(Recording, Vec<Hit>)> {
    let path: PathBuf = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/data/hammer").join(name);
    if !path.exists() {
        println!("ABSENT: {} is not there; nothing was compared with it", path.display());
        return None;
    }
    let recording = read(&path, Some(1)).expect("the recording is readable");
    let (found, _) = hits(&recording).expect("it holds strikes");
    Some((recording, found))
}

fn mean_lsd_db(recording: &Recording, found: &[Hit], most_modes: usize) -> f64 {
    let settings = Settings { modes: ModeSettings { most_modes, ..ModeSettings::default() }, ..Settings::default() };
    let distances: Vec<f64> = found
        .iter()
        .map(|hit| {
            let fit = fit_sound(&recording.samples, recording.rate_hz, &[*hit], settings).expect("it has modes");
            assert!(fit.modes.len() <= most_modes);
            fit.strikes[0].lsd_db
        })
        .collect();
    distances.iter().sum::<f64>() / distances.len() as f64
}

#[test]
fn a_few_modes_come_within_two_decibels_of_a_strike() {
    for (name, count, limits) in
        [("hammer_ceramic.wav", 8, [(8, 2.7), (32, 2.2)]), ("hammer_wood.wav", 10, [(13, 1.8), (32, 1.5)])]
    {
        let Some((recording, found)) = recording(name) else { continue };
        assert_eq!(found.len(), count, "{name}: {found:?}");
        for (modes, limit) in limits {
            let lsd_db = mean_lsd_db(&recording, &found, modes);
            println!("{name}, {modes} modes: LSD {lsd_db:.2} dB, mean over {count} hits");
            assert!(lsd_db <= limit, "{name}, {modes} modes: {lsd_db:.2} dB");
        }
    }
}

#[test]
fn contact_times_from_sound_are_within_20_percent_of_the_measured_width() {
    let (mut near, mut all) = (0, 0);
    for name in ["hammer_ceramic.wav", "hammer_wood.wav"] {
        let Some((recording, found)) = recording(name) else { continue };
        let force = recording.force.as_ref().expect("channel 1 was asked for");
        for hit in found {
            let around = hit.onset - 150..hit.onset + 80;
            let peak = around.clone().max_by(|&a, &b| force[a].total_cmp(&force[b])).expect("not empty");
            let width_s = force_width_s(force, peak, recording.rate_hz);
            let heard = contact_time_s(&recording.samples[hit.onset..hit.end], recording.rate_hz)
                .expect("the hit is long enough");
            let ratio = heard * PULSE_FWHM / width_s;
            println!(
                "{name} {:.3} s: {:.3} ms measured, {ratio:.2} of it heard",
                hit.onset as f64 / 44_100.0,
                width_s * 1e3
            );
            near += usize::from((ratio - 1.0).abs() <= 0.2);
            all += 1;
        }
    }
    println!("{near} of {all} within 20 %");
    assert!(4 * near >= 3 * all);
}

#[test]
fn with_the_force_shared_poles_leave_20_db_less_and_predict_other_strikes() {
    for name in ["hammer_ceramic.wav", "hammer_wood.wav"] {
        let Some((recording, found)) = recording(name) else { continue };
        let force = recording.force.as_ref().expect("channel 1 was asked for");
        let rate_hz = recording.rate_hz;
        let measured = measured_hits(&recording.samples, force, 1, rate_hz, &found).expect("the force is there");
        let shared = share_poles(&measured, rate_hz, Settings::default()).expect("it has modes");
        println!("{name}: {} shared modes leave {:.1?} dB", shared.mode_count(), shared.residual_db);
        let good = shared.residual_db.iter().filter(|residual| **residual <= -20.0).count();
        assert!(4 * good >= 3 * measured.len(), "{name}: {good} of {}", measured.len());
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
        assert!(common < plain && along < common, "{name}");
    }
}

/// A of `sin(πx) (1 + A cos(πx))`, 0 to 1, that comes nearest to a force round its peak, over onset, contact time and size.
fn skew(force: &[f64], peak: usize, rate_hz: f64) -> f64 {
    let around = &force[peak - 60..peak + 100];
    let energy: f64 = around.iter().map(|x| x * x).sum();
    let mut best = (energy, 0.0);
    for step in 0..=20 {
        let skew = f64::from(step) / 20.0;
        for time_s in (0..40).map(|n| 2.5e-4 + 2.5e-5 * f64::from(n)) {
            let time = time_s * rate_hz;
            // The peak lies between 0.33 and 0.5 of the contact; a margin to either side.
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
fn restitution_of_the_measured_forces_has_a_median_at_most_that_of_the_default() {
    let mut all = Vec::new();
    for name in ["hammer_ceramic.wav", "hammer_wood.wav"] {
        let Some((recording, found)) = recording(name) else { continue };
        let force = recording.force.as_ref().expect("channel 1 was asked for");
        let restitutions = found.iter().map(|hit| {
            let around = hit.onset - 150..hit.onset + 80;
            let peak = around.max_by(|&a, &b| force[a].total_cmp(&force[b])).expect("not empty");
            let skew = skew(force, peak, recording.rate_hz);
            ((1.0 - skew) / (1.0 + skew)).powf(1.0 / 4.6)
        });
        let restitutions: Vec<f64> = restitutions.collect();
        println!("{name}: e = {restitutions:.2?}, median {:.2}", quantile(&restitutions, 0.5));
        all.extend(restitutions);
    }
    if !all.is_empty() {
        let median = quantile(&all, 0.5);
        println!("all: median {median:.2}");
        // Below the default, and not below what the format allows.
        let usual = f64::from(kit::Striker::DEFAULT_RESTITUTION);
        assert!((0.2..=usual).contains(&median), "{median:.2}");
    }
}

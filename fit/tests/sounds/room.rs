//! Rooms whose bands are known, and recordings without a room.

use fit::modes::DampedSine;
use fit::residual::{Band, render};
use fit::room::estimate;
use fit::segment::Hit;
use fit::stages::{MOST_RISE_DB, RecordedStrike, is_worth_its_room};
use fit::strike::{Settings, fit_sound};
use fit::synthetic::of_these;
use fit::table::{Provenance, of_fit};

const RATE_HZ: f64 = 44_100.0;
const OCTAVES_HZ: [f64; 7] = [125.0, 250.0, 500.0, 1000.0, 2000.0, 4000.0, 8000.0];

/// An object of `count` modes between 110 Hz and 10 kHz with T60s of about `t60_s`, without noise.
fn thing(seed: u64, count: u64, t60_s: f64) -> Vec<f64> {
    let share = |k: u64, salt: u64| ((seed * 7919 + k * 104_729 + salt * 15_485_863) % 1009) as f64 / 1009.0;
    let modes: Vec<DampedSine> = (0..count)
        .map(|k| DampedSine {
            frequency_hz: 110.0 * (10_000f64 / 110.0).powf((k as f64 + 0.8 * share(k, 1)) / count as f64),
            decay_per_s: 1000f64.ln() / (t60_s * 4f64.powf(share(k, 2) - 0.5)),
            amplitude: 0.3 + share(k, 3),
            phase: std::f64::consts::TAU * share(k, 4),
        })
        .collect();
    of_these(modes, 66_150, seed, -180.0).samples
}

/// T60 of the room in seconds in an octave, by its index.
fn t60_s(octave: usize, longest_s: f64) -> f64 {
    longest_s * 0.9f64.powi(octave as i32)
}

/// Response of the room, noise that decays octave by octave, and its gain in each octave.
///
/// The gain is the energy relative to that of the direct sound, in dB.
fn response(seed: u64, longest_s: f64, rms: f64) -> (Vec<f64>, Vec<f64>) {
    let bands: Vec<Band> = OCTAVES_HZ
        .iter()
        .enumerate()
        .map(|(octave, centre_hz)| {
            let edges_hz = [centre_hz / 2f64.sqrt(), (centre_hz * 2f64.sqrt()).min(0.499 * RATE_HZ)];
            Band {
                edges_hz,
                weight: rms * (edges_hz[1] - edges_hz[0]).sqrt(),
                decay_db_per_s: 60.0 / t60_s(octave, longest_s),
            }
        })
        .collect();
    let gains = bands.iter().map(|band| {
        let energy = band.weight.powi(2) * RATE_HZ * 10.0 / (10f64.ln() * 2.0 * band.decay_db_per_s / 2.0);
        let direct = (band.edges_hz[1] - band.edges_hz[0]) / (0.5 * RATE_HZ);
        10.0 * (energy / direct).log10()
    });
    let gains = gains.collect();
    (render(&bands, (longest_s * RATE_HZ) as usize, RATE_HZ, seed), gains)
}

/// Sound in the room: `dry + dry ⊗ response + noise`.
fn in_room(dry: &[f64], response: &[f64], noise_dbfs: f64) -> Vec<f64> {
    let mut sound = of_these(Vec::new(), dry.len() + response.len(), 77, noise_dbfs).samples;
    for (n, x) in dry.iter().enumerate() {
        sound[n] += x;
        // A sample 100 dB down adds nothing.
        if x.abs() > 1e-5 {
            for (slot, h) in sound[n..].iter_mut().zip(response) {
                *slot += x * h;
            }
        }
    }
    sound
}

#[test]
fn t60_and_gain_of_a_rooms_bands_are_recovered() {
    let (mut t60_errors, mut gain_errors) = (Vec::new(), Vec::new());
    for (seed, longest_s, rms) in [(1, 1.6, 2e-5), (2, 0.9, 3e-5), (3, 1.2, 5e-5), (4, 2.0, 4e-5)] {
        let (response, gains) = response(seed, longest_s, rms);
        let sound = in_room(&thing(seed, 40, 0.08), &response, -75.0);
        let room = estimate(&sound, RATE_HZ).expect("a room is heard");
        println!("room of {longest_s} s: {} bands, {:.2} s, {:.1} dB", room.bands.len(), room.t60_s, room.gain_db);
        assert!(room.bands.len() >= 5, "{room:?}");
        for band in &room.bands {
            let centre_hz = (band.edges_hz[0] * band.edges_hz[1]).sqrt();
            let octave = OCTAVES_HZ.iter().position(|f| (f / centre_hz - 1.0).abs() < 0.01).expect("an octave");
            let error = band.t60_s / t60_s(octave, longest_s) - 1.0;
            let gain = band.gain_db - gains[octave];
            println!(
                "  {centre_hz:.0} Hz: T60 {:.2} s ({:+.0} %), gain {:.1} dB ({gain:+.1})",
                band.t60_s,
                100.0 * error,
                band.gain_db
            );
            t60_errors.push(error.abs());
            gain_errors.push(gain.abs());
        }
    }
    let mean = |errors: &[f64]| errors.iter().sum::<f64>() / errors.len() as f64;
    let most = |errors: &[f64]| errors.iter().copied().fold(0.0, f64::max);
    println!(
        "T60: mean error {:.1} %, worst {:.1} %; gain: mean {:.1} dB, worst {:.1} dB",
        100.0 * mean(&t60_errors),
        100.0 * most(&t60_errors),
        mean(&gain_errors),
        most(&gain_errors)
    );
    assert!(mean(&t60_errors) < 0.048 && most(&t60_errors) < 0.122);
    assert!(mean(&gain_errors) < 3.0 && most(&gain_errors) < 6.0);
}

#[test]
fn a_dry_recording_has_no_room() {
    for seed in 1..=4 {
        for (count, t60_s) in [(12, 0.1), (25, 0.3), (40, 0.8)] {
            let dry = in_room(&thing(seed, count, t60_s), &[0.0], -75.0);
            let room = estimate(&dry, RATE_HZ);
            assert!(room.is_none(), "seed {seed}, {count} modes of {t60_s} s: {room:?}");
        }
    }
}

#[test]
fn an_object_that_rings_longer_than_its_room_hides_it() {
    let (response, _) = response(5, 0.3, 3e-5);
    let sound = in_room(&thing(5, 25, 2.0), &response, -75.0);
    assert!(estimate(&sound, RATE_HZ).is_none());
}

#[test]
fn silence_and_short_sounds_have_no_room() {
    assert!(estimate(&[], RATE_HZ).is_none());
    assert!(estimate(&[0.0; 3000], RATE_HZ).is_none());
    assert!(estimate(&thing(1, 5, 0.05)[..700], RATE_HZ).is_none());
}

/// Writes a recording of a strike behind a moment of silence, with a peak of 0.9.
fn write(path: &std::path::Path, sound: &[f64]) {
    let format = hound::WavSpec {
        channels: 1,
        sample_rate: 44_100,
        bits_per_sample: 32,
        sample_format: hound::SampleFormat::Float,
    };
    let mut writer = hound::WavWriter::create(path, format).expect("a file");
    let peak = sound.iter().fold(0.0f64, |peak, x| peak.max(x.abs()));
    let silence = std::iter::repeat_n(0.0, 4_410);
    silence.chain(sound.iter().map(|x| 0.9 * x / peak)).for_each(|x| writer.write_sample(x as f32).expect("written"));
    writer.finalize().expect("written");
}

/// Modes and noise that are fitted together come nearer to this recording than the thing itself
/// does in another draw of the same room. So no room can bring the table nearer.
#[test]
fn a_room_that_modes_and_noise_explain_is_reported_and_not_in_the_table() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("block.wav");
    let dry = thing(3, 12, 0.06);
    let sound = in_room(&dry, &response(3, 1.2, 1.2e-4).0, -75.0);
    write(&path, &sound);
    let fitted = fit::recording::fit_file(&path, &fit::recording::Options::default()).expect("it fits");
    let report = &fitted.report;
    println!(
        "LSD: modes {:.2} dB, with residual {:.2}, in the room {:.2?}; ERB distance {:.2}, {:.2}, {:.2?} dB; room at {:?} dB",
        report.lsd_db,
        report.lsd_with_residual_db,
        report.lsd_with_room_db,
        report.erb_db,
        report.erb_with_residual_db,
        report.erb_with_room_db,
        report.room_level_db
    );
    let stage = RecordedStrike::new(&[], &sound, RATE_HZ, 0.0);
    let itself = [103, 104].map(|seed| stage.distances(&in_room(&dry, &response(seed, 1.2, 1.2e-4).0, -75.0)));
    println!("the thing in other draws of the room: {itself:.2?}");
    for itself in itself {
        // Single bins tell draws of noise apart, bands hardly do.
        assert!(report.lsd_with_residual_db < itself.lsd_db + 0.2 && report.erb_with_residual_db < itself.erb_db);
    }
    // Figures of docs/fit.md.
    let page = [(report.lsd_db, 7.10), (report.lsd_with_residual_db, 4.38)];
    assert!(page.iter().all(|(measured, page)| (measured - page).abs() < 0.5), "{page:.2?}");
    assert!(fitted.table.room.is_empty() && report.room_level_db.is_none());
    // The octave round 1 kHz.
    let room = report.room.as_ref().expect("a room is heard");
    let band = room.bands.iter().rfind(|band| band.edges_hz[0] < 1_000.0).expect("it has this octave");
    let expected_s = t60_s(3, 1.2);
    assert!((band.t60_s / expected_s - 1.0).abs() < 0.25, "{} s of {expected_s}", band.t60_s);
}

/// Modes of the thing alone hold nothing of the tail, which bands of noise do not explain.
#[test]
fn a_room_that_modes_and_residual_do_not_explain_brings_their_table_nearer() {
    let dry = thing(3, 12, 0.06);
    let hit = Hit { onset: 0, end: dry.len() };
    let fit = fit_sound(&dry, RATE_HZ, &[hit], Settings::default()).expect("it has modes");
    let provenance = Provenance { name: "thing".to_owned(), source: String::new(), licence: String::new() };
    let sound = in_room(&dry, &response(3, 1.2, 1.2e-4).0, -75.0);
    let room = estimate(&sound, RATE_HZ).expect("a room is heard");
    let stage = RecordedStrike::new(&[], &sound, RATE_HZ, 0.0);
    let modes = stage.play(of_fit(&fit, &provenance), 1).expect("a board plays it");
    let most_lsd_db = modes.distances.lsd_db + MOST_RISE_DB;
    let (noisy, _) = stage.with_residual(modes.clone(), most_lsd_db).expect("a board plays it");
    let in_room = stage.in_room(&modes.table, &room).expect("a board plays it");
    let (level_db, in_room) = in_room.expect("a level is best");
    let (wet, _) = stage.with_residual(in_room, most_lsd_db).expect("a board plays it");
    println!(
        "{} modes: {:.2?}, with residual {:.2?}, in the room at {level_db} dB {:.2?}",
        fit.modes.len(),
        modes.distances,
        noisy.distances,
        wet.distances
    );
    assert!(is_worth_its_room(&wet, &noisy, modes.distances));
    let measured = [modes.distances.lsd_db, noisy.distances.lsd_db, wet.distances.lsd_db];
    assert!(measured[2] < measured[1] && measured[1] < measured[0]);
    // Figures of docs/fit.md.
    let page = [11.00, 6.06, 5.49];
    assert!(measured.iter().zip(page).all(|(measured, page)| (measured - page).abs() < 0.5), "{page:.2?}");
    // The octave round 1 kHz.
    let band = wet.table.room.iter().rfind(|band| band.from_hz < 1_000.0).expect("the room stands in the table");
    let expected_s = t60_s(3, 1.2);
    assert!((band.t60_s() / expected_s - 1.0).abs() < 0.25, "{} s of {expected_s}", band.t60_s());
}

//! Unsuitable recordings: each gives an error of its own, or a note on the fallback.

use std::f64::consts::TAU;
use std::fs;
use std::path::PathBuf;

use fit::FitError;
use fit::modes::Settings;
use fit::multi_strike::synthetic::plain;
use fit::multi_strike::{Layout, estimate};
use fit::recording::{Fitted, Options, fit_file};
use fit::synthetic::of_these;
use hound::{SampleFormat, WavSpec, WavWriter};
use tempfile::TempDir;

/// Writes channels as a 16-bit WAV file.
fn wave(folder: &TempDir, name: &str, rate_hz: u32, channels: &[Vec<f64>]) -> PathBuf {
    let path = folder.path().join(name);
    let spec = WavSpec {
        channels: channels.len() as u16,
        sample_rate: rate_hz,
        bits_per_sample: 16,
        sample_format: SampleFormat::Int,
    };
    let mut writer = WavWriter::create(&path, spec).expect("the folder is writable");
    for n in 0..channels.first().map_or(0, Vec::len) {
        for channel in channels {
            writer.write_sample((channel[n].clamp(-1.0, 1.0) * 32_767.0) as i16).expect("written");
        }
    }
    writer.finalize().expect("written");
    path
}

/// Three modes struck after `before_s` of silence.
fn strike(rate_hz: f64, before_s: f64, length_s: f64) -> Vec<f64> {
    let start = (before_s * rate_hz) as usize;
    (0..(length_s * rate_hz) as usize)
        .map(|n| {
            let t = n.saturating_sub(start) as f64 / rate_hz;
            let mode = |f: f64, d: f64| (-d * t).exp() * (TAU * f * t).sin();
            if n < start { 0.0 } else { 0.25 * (mode(440.0, 12.0) + mode(1230.0, 20.0) + mode(2750.0, 30.0)) }
        })
        .collect()
}

fn noise(length: usize, level_dbfs: f64) -> Vec<f64> {
    of_these(Vec::new(), length, 7, level_dbfs).samples
}

fn fit(path: &std::path::Path) -> Result<Fitted, FitError> {
    let path = path.to_owned();
    // The engine that renders the table is large: `malleus fit` gives its workers such a stack,
    // too.
    let worker = std::thread::Builder::new().stack_size(64 << 20);
    let work = worker.spawn(move || fit_file(&path, &Options::default())).expect("a thread can be started");
    work.join().expect("it does not panic")
}

fn has_three_modes(fitted: &Fitted) {
    for frequency_hz in [440.0, 1230.0, 2750.0] {
        let near = fitted.fit.modes.iter().any(|mode| (mode.frequency_hz / frequency_hz - 1.0).abs() < 2e-3);
        assert!(near, "{frequency_hz} Hz is missing: {:?}", fitted.fit.modes);
    }
}

#[test]
fn a_file_without_audio_gives_an_error_of_its_kind() {
    let folder = TempDir::new().expect("a folder");
    let text = folder.path().join("text.wav");
    fs::write(&text, "this is no sound, however one listens to it, and goes on for a while").expect("written");
    assert!(matches!(fit(&text), Err(FitError::NotAudio { .. })));
    let empty = folder.path().join("empty.wav");
    fs::write(&empty, "").expect("written");
    assert!(matches!(fit(&empty), Err(FitError::Empty { .. })));
    assert!(matches!(fit(&folder.path().join("none.wav")), Err(FitError::Read { .. })));
    let header_only = wave(&folder, "header.wav", 44_100, &[Vec::new()]);
    let refusal = fit(&header_only).expect_err("no samples");
    assert!(matches!(refusal, FitError::Empty { .. }), "{refusal}");
}

#[test]
fn silence_noise_and_steady_tones_are_refused() {
    let folder = TempDir::new().expect("a folder");
    let silence = wave(&folder, "silence.wav", 44_100, &[vec![0.0; 44_100]]);
    assert!(matches!(fit(&silence), Err(FitError::Silence)));
    let constant = fit(&wave(&folder, "constant.wav", 44_100, &[vec![0.25; 44_100]])).expect_err("no sound");
    assert!(matches!(constant, FitError::Constant { channel: 0, .. }), "{constant}");
    let words = constant.to_string();
    assert!(words.contains("constant.wav: channel 0 holds the constant value 2.50e-1"), "{words}");
    // A recording as short as this has no offset that is taken off.
    let short = fit(&wave(&folder, "short.wav", 44_100, &[vec![-0.25; 9]]));
    assert!(matches!(short, Err(FitError::Constant { .. })));
    let hiss = wave(&folder, "noise.wav", 44_100, &[noise(88_200, -20.0)]);
    assert!(matches!(fit(&hiss), Err(FitError::NoOnset)));
    let tone = (0..88_200).map(|n| 0.5 * (0.06 * f64::from(n)).sin()).collect();
    assert!(matches!(fit(&wave(&folder, "tone.wav", 44_100, &[tone])), Err(FitError::NoOnset)));
}

#[test]
fn a_strike_cut_off_at_full_scale_is_refused() {
    let folder = TempDir::new().expect("a folder");
    let clipped = strike(44_100.0, 0.1, 1.0).iter().map(|x| (x * 40.0).clamp(-1.0, 1.0)).collect();
    assert!(matches!(fit(&wave(&folder, "clipped.wav", 44_100, &[clipped])), Err(FitError::Clipped { .. })));
    // An offset moves both limits, and is taken off before they are looked for.
    let percent = |offset: f64| {
        let raised = strike(44_100.0, 0.1, 1.0).iter().map(|x| (x * 8.0 + offset).clamp(-1.0, 1.0)).collect();
        match fit(&wave(&folder, "raised.wav", 44_100, &[raised])) {
            Err(FitError::Clipped { percent, .. }) => percent,
            other => panic!("not clipped: {:?}", other.map(|fitted| fitted.report)),
        }
    };
    let (plain, raised) = (percent(0.0), percent(0.1));
    assert!((raised / plain - 1.0).abs() < 0.3, "{plain} % and {raised} % with an offset");
}

/// A strike whose peaks above or below a share of the largest one are cut off.
fn cut_off(sound: &[f64], share: f64, sides: [bool; 2]) -> Vec<f64> {
    let limit = share * sound.iter().fold(0.0, |peak: f64, x| peak.max(x.abs()));
    let [low, high] = [if sides[0] { -limit } else { f64::MIN }, if sides[1] { limit } else { f64::MAX }];
    sound.iter().map(|x| x.clamp(low, high)).collect()
}

#[test]
fn a_strike_with_one_flat_peak_is_refused_at_every_rate() {
    let folder = TempDir::new().expect("a folder");
    for rate_hz in [44_100, 96_000] {
        let sound = strike(f64::from(rate_hz), 0.1, 1.0);
        let refusal = |sound: Vec<f64>| fit(&wave(&folder, "flat.wav", rate_hz, &[sound])).err();
        assert!(refusal(sound.clone()).is_none());
        for sides in [[true, true], [false, true], [true, false]] {
            let error = refusal(cut_off(&sound, 0.8, sides)).expect("it is clipped");
            assert!(matches!(error, FitError::Clipped { percent, .. } if percent < 10.0), "{error}");
        }
    }
}

#[test]
fn a_clipped_strike_beside_the_chosen_one_does_not_refuse_it() {
    let folder = TempDir::new().expect("a folder");
    let sound = strike(44_100.0, 0.1, 1.0);
    let both = [cut_off(&sound, 0.8, [true, true]), sound.iter().map(|x| 0.5 * x).collect()].concat();
    let path = wave(&folder, "two.wav", 44_100, &[both]);
    let error = fit(&path).expect_err("the first strike is clipped");
    assert!(error.to_string().contains("the strike at 0.100 s") && error.to_string().contains("choose other"));
    let options = Options { hits: vec![2], ..Options::default() };
    let worker = std::thread::Builder::new().stack_size(64 << 20);
    let work = worker.spawn(move || fit_file(&path, &options)).expect("a thread can be started");
    has_three_modes(&work.join().expect("it does not panic").expect("the second strike is not clipped"));
}

#[test]
fn rates_that_the_instrument_does_not_play_are_refused_before_a_fit() {
    let folder = TempDir::new().expect("a folder");
    for rate_hz in [4_000, 7_999] {
        let path = wave(&folder, "slow.wav", rate_hz, &[strike(f64::from(rate_hz), 0.1, 0.8)]);
        let refusal = fit(&path).expect_err("too slow");
        assert!(matches!(refusal, FitError::Rate { .. }), "{refusal}");
        assert!(refusal.to_string().contains("8000 to 768000 Hz"), "{refusal}");
    }
}

#[test]
fn every_rate_from_8_to_192_khz_gives_the_same_modes() {
    let folder = TempDir::new().expect("a folder");
    for rate_hz in [8_000, 22_050, 44_100, 48_000, 96_000, 192_000] {
        let path = wave(&folder, &format!("{rate_hz}.wav"), rate_hz, &[strike(f64::from(rate_hz), 0.1, 0.8)]);
        let fitted = fit(&path).expect("a strike");
        has_three_modes(&fitted);
        assert!(fitted.recording.rate_hz <= 48_000.0);
        assert_eq!(rate_hz > 48_000, fitted.report.notes.iter().any(|note| note.contains("decimated")));
    }
}

#[test]
fn the_loudest_of_eight_channels_is_taken_with_a_note() {
    let folder = TempDir::new().expect("a folder");
    let mut channels = vec![noise(44_100, -70.0); 8];
    channels[5] = strike(44_100.0, 0.1, 1.0);
    let fitted = fit(&wave(&folder, "eight.wav", 44_100, &channels)).expect("a strike");
    has_three_modes(&fitted);
    assert!(fitted.report.notes.iter().any(|note| note.contains("channel 5 of 8")), "{:?}", fitted.report.notes);
}

#[test]
fn the_readable_part_of_a_cut_file_is_used() {
    let folder = TempDir::new().expect("a folder");
    let path = wave(&folder, "cut.wav", 44_100, &[strike(44_100.0, 0.1, 2.0)]);
    let bytes = fs::read(&path).expect("it was written");
    fs::write(&path, &bytes[..bytes.len() / 2 + 1]).expect("written");
    has_three_modes(&fit(&path).expect("half of it is enough"));
}

#[test]
fn a_recording_that_ends_while_its_strike_rings_is_fitted_with_a_note() {
    let folder = TempDir::new().expect("a folder");
    let fitted = fit(&wave(&folder, "short.wav", 44_100, &[strike(44_100.0, 0.1, 0.15)])).expect("a strike");
    has_three_modes(&fitted);
    assert!(fitted.report.notes.iter().any(|note| note.contains("still rings")), "{:?}", fitted.report.notes);
    let fitted = fit(&wave(&folder, "whole.wav", 44_100, &[strike(44_100.0, 0.1, 1.0)])).expect("a strike");
    assert!(fitted.report.notes.is_empty(), "{:?}", fitted.report.notes);
}

#[test]
fn two_minutes_of_a_longer_file_are_read_with_a_note() {
    let folder = TempDir::new().expect("a folder");
    let mut sound = strike(8_000.0, 0.1, 2.0);
    sound.resize(8_000 * 60 * 30, 0.0);
    let fitted = fit(&wave(&folder, "long.wav", 8_000, &[sound])).expect("a strike");
    has_three_modes(&fitted);
    assert!(fitted.recording.samples.len() <= 8_000 * 120);
    assert!(fitted.report.notes.iter().any(|note| note.contains("first 120 s")), "{:?}", fitted.report.notes);
}

#[test]
fn strikes_that_are_too_close_are_taken_for_bounces() {
    let folder = TempDir::new().expect("a folder");
    // Half as loud as other strikes here, so that the second one is not clipped.
    let once: Vec<f64> = strike(44_100.0, 0.1, 1.0).iter().map(|x| 0.5 * x).collect();
    let mut twice = once.clone();
    for (n, x) in once.iter().enumerate().take(once.len() - 1_500) {
        twice[n + 1_500] = 0.3 * twice[n + 1_500] + if n > 4_400 { 1.5 * x } else { 0.0 };
    }
    match fit(&wave(&folder, "close.wav", 44_100, &[twice])) {
        Ok(fitted) => assert_eq!(fitted.report.strikes.len(), 1, "{:?}", fitted.report),
        Err(error) => assert!(matches!(error, FitError::TooShort { .. }), "{error}"),
    }
}

#[test]
fn missing_hits_and_channels_are_refused_by_number() {
    let folder = TempDir::new().expect("a folder");
    let path = wave(&folder, "one.wav", 44_100, &[strike(44_100.0, 0.1, 1.0)]);
    let hit = Options { hits: vec![2], ..Options::default() };
    assert!(matches!(fit_file(&path, &hit), Err(FitError::NoSuchHit { hit: 2, found: 1 })));
    let force = Options { force_channel: Some(3), ..Options::default() };
    assert!(matches!(fit_file(&path, &force), Err(FitError::Channel { channel: 3, channels: 1, .. })));
    let only_force = Options { force_channel: Some(0), ..Options::default() };
    assert!(matches!(fit_file(&path, &only_force), Err(FitError::NoMicrophone { .. })));
}

#[test]
fn a_strike_with_a_constant_offset_has_the_modes_of_the_one_without_and_a_note() {
    let folder = TempDir::new().expect("a folder");
    let sound: Vec<f64> = strike(44_100.0, 0.3, 1.0).iter().zip(noise(44_100, -70.0)).map(|(x, y)| x + y).collect();
    let plain = fit(&wave(&folder, "plain.wav", 44_100, std::slice::from_ref(&sound))).expect("a strike");
    assert_eq!((plain.recording.offset, plain.report.notes.len()), (0.0, 0));
    for offset in [0.02, -0.2] {
        let raised: Vec<f64> = sound.iter().map(|x| x + offset).collect();
        // The louder channel is not the one that stands higher.
        let path = wave(&folder, "raised.wav", 44_100, &[vec![0.9; 44_100], raised]);
        let fitted = fit(&path).expect("a strike");
        has_three_modes(&fitted);
        assert!(fitted.fit.modes.len().abs_diff(plain.fit.modes.len()) <= 1, "{} modes", fitted.fit.modes.len());
        let is_named = fitted.report.notes.iter().any(|note| note.contains("channel 1 has a constant offset"));
        assert!(is_named && (fitted.recording.offset - offset).abs() < 1e-4, "{:?}", fitted.report.notes);
    }
}

#[test]
fn many_strikes_with_a_constant_offset_leave_no_more_than_those_without() {
    let folder = TempDir::new().expect("a folder");
    let sound = plain(8, 3.0, 5, -60.0);
    let estimate = |offset: f64| {
        let raised = sound.samples.iter().map(|x| x + offset).collect();
        let recording = fit::audio::read(&wave(&folder, "taps.wav", 44_100, &[raised]), None).expect("it is audio");
        let told = estimate(&recording.samples, 44_100.0, Settings::default(), Layout::default(), |_| {});
        told.expect("strikes are told")
    };
    let (plain, raised) = (estimate(0.0), estimate(0.05));
    // Rounding to 16 bits differs, and the weakest mode may be told in one of both alone.
    assert!(plain.modes.len().abs_diff(raised.modes.len()) <= 1, "{} {}", plain.modes.len(), raised.modes.len());
    assert_eq!(plain.strikes.len(), raised.strikes.len());
    assert!((plain.left_dbfs - raised.left_dbfs).abs() < 0.05, "{} {}", plain.left_dbfs, raised.left_dbfs);
}

/// A strike behind 0.5 s, in another sound that lasts throughout.
fn strike_in(steady: impl Fn(usize) -> f64) -> Vec<f64> {
    strike(44_100.0, 0.5, 2.5).iter().enumerate().map(|(n, x)| x + steady(n)).collect()
}

/// Rms at its strike of all noise that a table has, in dBFS.
fn residual_dbfs(fitted: &Fitted) -> f64 {
    let power: f64 = fitted.report.residual_bands.iter().map(|band| band.weight * band.weight).sum();
    10.0 * power.max(1e-12).log10()
}

#[test]
fn noise_that_lasts_throughout_becomes_neither_modes_nor_a_residual() {
    let folder = TempDir::new().expect("a folder");
    for level_dbfs in [-40.0, -60.0] {
        let hiss = noise(110_250, level_dbfs);
        let path = wave(&folder, "hiss.wav", 44_100, &[strike_in(|n| hiss[n])]);
        let fitted = fit(&path).expect("a strike");
        has_three_modes(&fitted);
        let Fitted { fit, report, .. } = &fitted;
        // Short modes of the noise that are louder than its mean may stay; they are no hiss.
        let rings_on = fit.modes.iter().any(|mode| mode.t60_s() > 7.0);
        assert!(fit.modes.len() < 12 && !rings_on, "{level_dbfs} dBFS: {:?}", fit.modes);
        // A band takes up a little of what the noise is louder there than before the strike.
        let slow = report.residual_bands.iter().filter(|band| band.decay_db_per_s < 10.0);
        let power: f64 = slow.map(|band| band.weight * band.weight).sum();
        assert!(10.0 * power.max(1e-12).log10() < level_dbfs - 10.0, "{:?}", report.residual_bands);
        let note = format!("a steady noise of {level_dbfs:.0} dBFS lies under the strike");
        assert!(report.notes.iter().any(|told| told.contains(&note)), "{:?}", report.notes);
    }
}

#[test]
fn noise_of_the_strike_stays_in_the_residual_over_a_steady_one() {
    let folder = TempDir::new().expect("a folder");
    let (own, hiss) = (noise(110_250, -26.0), of_these(Vec::new(), 110_250, 8, -50.0).samples);
    // A reverberation of 0.8 s.
    let fades = |n: usize| 10f64.powf(-3.0 * n as f64 / 44_100.0 / 0.8);
    let reverberant = |n: usize| n.checked_sub(22_050).map_or(0.0, |since| fades(since) * own[n]);
    let path = wave(&folder, "both.wav", 44_100, &[strike_in(|n| reverberant(n) + hiss[n])]);
    let fitted = fit(&path).expect("a strike");
    let level_dbfs = residual_dbfs(&fitted);
    assert!((level_dbfs + 26.0).abs() < 3.0, "{level_dbfs} dBFS");
    let loud = fitted.report.residual_bands.iter().filter(|band| band.weight > 1e-3);
    assert!(loud.clone().count() > 20 && loud.clone().all(|band| band.decay_db_per_s > 40.0), "{:?}", fitted.report);
}

#[test]
fn hum_of_mains_is_taken_off_with_a_note_and_is_no_mode() {
    let folder = TempDir::new().expect("a folder");
    let tone = |n: usize, hz: f64, peak: f64| peak * (TAU * hz * n as f64 / 44_100.0 + hz).sin();
    let hiss = noise(110_250, -80.0);
    let hum = |n: usize| tone(n, 50.02, 0.01) + tone(n, 100.04, 0.006) + tone(n, 150.06, 0.004) + hiss[n];
    let fitted = fit(&wave(&folder, "hum.wav", 44_100, &[strike_in(hum)])).expect("a strike");
    has_three_modes(&fitted);
    // What is left of the tones is softer than the strike by 80 dB, and the hum was by 28 dB.
    let gain = |mode: &fit::strike::Mode| mode.gains[0][0].hypot(mode.gains[0][1]);
    let strongest = fitted.fit.modes.iter().map(gain).fold(0.0, f64::max);
    let is_left = |mode: &fit::strike::Mode| mode.frequency_hz < 400.0 && gain(mode) > 1e-4 * strongest;
    assert!(!fitted.fit.modes.iter().any(is_left), "{:?}", fitted.fit.modes);
    let told = "are taken off: 50.0 Hz at -43 dBFS, 100.0 Hz at -47 dBFS, 150.1 Hz at -51 dBFS";
    assert!(fitted.report.notes.iter().any(|note| note.ends_with(told)), "{:?}", fitted.report.notes);
    // Without a time before the strike nothing tells what is steady.
    let sound = strike_in(hum).split_off(22_000);
    let fitted = fit(&wave(&folder, "at-once.wav", 44_100, &[sound])).expect("a strike");
    assert!(!fitted.report.notes.iter().any(|note| note.contains("steady")), "{:?}", fitted.report.notes);
}

#[test]
fn ringing_of_an_earlier_strike_is_no_steady_sound_under_the_next_one() {
    let folder = TempDir::new().expect("a folder");
    let ringing = |since_s: f64| {
        let mode = |hz: f64, t60_s: f64| 10f64.powf(-3.0 * since_s / t60_s) * (TAU * hz * since_s).sin();
        if since_s < 0.0 { 0.0 } else { mode(440.0, 20.0) + mode(1230.0, 4.0) + mode(2750.0, 0.5) }
    };
    let quiet = noise(242_550, -80.0);
    let sound = |n: usize| n as f64 / 44_100.0;
    let bell = (0..242_550).map(|n| 0.1 * ringing(sound(n) - 0.5) + 0.15 * ringing(sound(n) - 3.0) + quiet[n]);
    let fitted = fit(&wave(&folder, "bell.wav", 44_100, &[bell.collect()])).expect("a strike");
    assert!(!fitted.report.notes.iter().any(|note| note.contains("steady")), "{:?}", fitted.report.notes);
    let slow = fitted.fit.modes.iter().find(|mode| (mode.frequency_hz / 440.0 - 1.0).abs() < 2e-3);
    assert!(slow.is_some_and(|mode| mode.t60_s() > 10.0), "{:?}", fitted.fit.modes);
}

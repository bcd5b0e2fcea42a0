//! One strike in seven forms of recording: none is refused, and all are fitted as near.
//!
//! `cargo test -p fit --test sounds forms:: -- --nocapture` prints the errors of four recordings;
//! with `--ignored` those of all.

use std::f64::consts::TAU;
use std::path::{Path, PathBuf};

use fit::FitError;
use fit::recording::{Fitted, Options, fit_file};
use fit::score::quantile;
use fit::synthetic::of_these;
use fourier::Complex;
use hound::{SampleFormat, WavSpec, WavWriter};
use tempfile::TempDir;

/// Form in which a strike may have been recorded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Form {
    /// Fifty milliseconds of what was before the strike, then the strike, mono.
    Plain,
    /// The file begins with the strike.
    FromFrame0,
    /// A second of noise, 20 dB below the strike's loudest 20 ms, and then the strike.
    BehindNoise,
    /// The file ends 50 ms behind the strike's peak.
    Cut,
    /// 22.05 kHz.
    HalfRate,
    /// 96 kHz.
    HighRate,
    /// Two channels: the second microphone is 6 dB softer, and 0.5 ms later.
    Stereo,
}

const FORMS: [Form; 7] =
    [Form::Plain, Form::FromFrame0, Form::BehindNoise, Form::Cut, Form::HalfRate, Form::HighRate, Form::Stereo];

/// A strike as it was recorded, with the sound before it.
struct Recorded {
    samples: Vec<f64>,
    onset: usize,
    rate_hz: u32,
}

/// Outcome of the fit of one form.
struct Outcome {
    loudness_error: f64,
    /// Onset found over the onset given, in milliseconds.
    late_ms: f64,
    notes: Vec<String>,
}

impl Recorded {
    /// Channels of a form, its rate, and the time of the strike in seconds.
    fn in_form(&self, form: Form) -> (Vec<Vec<f64>>, u32, f64) {
        let samples = |seconds: f64| (seconds * f64::from(self.rate_hz)) as usize;
        let from = self.onset.saturating_sub(samples(0.05));
        let at_s = (self.onset - from) as f64 / f64::from(self.rate_hz);
        let strike = &self.samples[self.onset..];
        let plain = self.samples[from..].to_vec();
        match form {
            Form::Plain => (vec![plain], self.rate_hz, at_s),
            Form::FromFrame0 => (vec![strike.to_vec()], self.rate_hz, 0.0),
            Form::BehindNoise => {
                let rms = |part: &[f64]| (part.iter().map(|x| x * x).sum::<f64>() / part.len() as f64).sqrt();
                let loudest = strike.chunks_exact(samples(0.02)).map(rms).fold(0.0, f64::max);
                let mut sound = of_these(Vec::new(), samples(1.0), 5, 20.0 * (0.1 * loudest).log10()).samples;
                sound.extend_from_slice(strike);
                (vec![sound], self.rate_hz, 1.0)
            }
            Form::Cut => {
                let peak = (0..strike.len()).max_by(|&a, &b| strike[a].abs().total_cmp(&strike[b].abs()));
                let end = self.onset + peak.expect("it is not empty") + samples(0.05);
                (vec![self.samples[from..end.min(self.samples.len())].to_vec()], self.rate_hz, at_s)
            }
            Form::HalfRate => (vec![resampled(plain, self.rate_hz, 22_050)], 22_050, at_s),
            Form::HighRate => (vec![resampled(plain, self.rate_hz, 96_000)], 96_000, at_s),
            Form::Stereo => {
                let mut second: Vec<f64> = vec![0.0; samples(0.0005)];
                second.extend(plain.iter().map(|x| 0.5 * x));
                second.truncate(plain.len());
                (vec![plain, second], self.rate_hz, at_s)
            }
        }
    }

    /// Fits a form of the strike.
    fn outcome(&self, form: Form, most_modes: usize) -> Result<Outcome, FitError> {
        let (channels, rate_hz, at_s) = self.in_form(form);
        let folder = TempDir::new().expect("a folder");
        let path = folder.path().join("form.wav");
        write(&path, rate_hz, &channels);
        let fitted = fit(path, most_modes)?;
        let found_s = fitted.fit.strikes[fitted.fit.loudest].hit.onset as f64 / fitted.recording.rate_hz;
        Ok(Outcome {
            loudness_error: fitted.report.hearing.loudness_error,
            late_ms: 1e3 * (found_s - at_s),
            notes: fitted.report.notes,
        })
    }
}

/// Fits a file on a stack that holds the engine which renders tables.
fn fit(path: PathBuf, most_modes: usize) -> Result<Fitted, FitError> {
    let mut options = Options::default();
    options.strike.modes.most_modes = most_modes;
    let worker = std::thread::Builder::new().stack_size(64 << 20);
    let work = worker.spawn(move || fit_file(&path, &options)).expect("a thread can be started");
    work.join().expect("it does not panic")
}

/// Writes channels as a WAV file in floating point.
fn write(path: &Path, rate_hz: u32, channels: &[Vec<f64>]) {
    let spec = WavSpec {
        channels: channels.len() as u16,
        sample_rate: rate_hz,
        bits_per_sample: 32,
        sample_format: SampleFormat::Float,
    };
    let mut writer = WavWriter::create(path, spec).expect("the folder is writable");
    for n in 0..channels[0].len() {
        for channel in channels {
            writer.write_sample(channel[n] as f32).expect("written");
        }
    }
    writer.finalize().expect("written");
}

/// A sound at another rate, by its spectrum, whose uppermost tenth is faded out.
fn resampled(mut sound: Vec<f64>, from_hz: u32, to_hz: u32) -> Vec<f64> {
    let common = gcd(from_hz, to_hz);
    let (step, new_step) = ((from_hz / common) as usize, (to_hz / common) as usize);
    // An even number of steps, so that both lengths are even.
    let steps = sound.len().div_ceil(2 * step) * 2;
    sound.resize(steps * step, 0.0);
    let (forward, inverse) = (fourier::forward(steps * step), fourier::inverse(steps * new_step));
    let mut bins = forward.make_output_vec();
    forward.process(&mut sound, &mut bins).expect("the lengths are right");
    let top = bins.len().min(steps * new_step / 2 + 1) - 1;
    let fade = |bin: usize| (10.0 * (1.0 - bin as f64 / top as f64)).clamp(0.0, 1.0);
    let scale = 1.0 / (steps * step) as f64;
    bins.iter_mut().take(top + 1).enumerate().for_each(|(bin, value)| *value *= scale * fade(bin));
    bins.resize(steps * new_step / 2 + 1, Complex::new(0.0, 0.0));
    bins.iter_mut().skip(top).for_each(|value| *value = Complex::new(0.0, 0.0));
    let mut out = inverse.make_output_vec();
    inverse.process(&mut bins, &mut out).expect("the lengths are right");
    out
}

fn gcd(a: u32, b: u32) -> u32 {
    if b == 0 { a } else { gcd(b, a % b) }
}

/// Fits all forms of a strike, prints a line of their errors, and returns the errors over that of
/// the plain form, or the forms that are refused.
fn errors_over_plain(name: &str, recorded: &Recorded, most_modes: usize) -> Result<Vec<(Form, f64)>, Vec<String>> {
    let (mut outcomes, mut refused) = (Vec::new(), Vec::new());
    for form in FORMS {
        match recorded.outcome(form, most_modes) {
            Ok(outcome) => outcomes.push((form, outcome)),
            Err(error) => refused.push(format!("{name}, {form:?}: {error}")),
        }
    }
    if !refused.is_empty() {
        return Err(refused);
    }
    let cells: Vec<String> = outcomes
        .iter()
        .map(|(_, outcome)| format!("{:.3} ({:+.1} ms)", outcome.loudness_error, outcome.late_ms))
        .collect();
    println!("| {name} | {} |", cells.join(" | "));
    for (form, outcome) in &outcomes {
        assert_notes(name, *form, &outcome.notes);
    }
    let plain = outcomes[0].1.loudness_error;
    Ok(outcomes.iter().map(|(form, outcome)| (*form, outcome.loudness_error - plain)).collect())
}

/// Asserts that what was assumed about a form is said.
fn assert_notes(name: &str, form: Form, notes: &[String]) {
    let says = |words: &str| notes.iter().any(|note| note.contains(words));
    let is_said = match form {
        Form::FromFrame0 => says("begins with the strike"),
        Form::HighRate => says("decimated from 96000 Hz to 48000 Hz"),
        Form::Stereo => says("channel 0 of 2"),
        // What is cut may have died away.
        Form::Plain | Form::BehindNoise | Form::HalfRate | Form::Cut => true,
    };
    assert!(is_said, "{name}, {form:?}: {notes:?}");
}

/// Five modes whose sound rises within 0.5 ms, and noise that dies away.
fn computed() -> Recorded {
    const RATE_HZ: u32 = 44_100;
    let onset = 6_000;
    let mut samples = of_these(Vec::new(), 44_100, 3, -70.0).samples;
    let hiss = of_these(Vec::new(), 44_100, 4, -30.0).samples;
    let modes =
        [(310.0, 7.0, 1.0), (790.0, 9.0, 0.8), (1_480.0, 14.0, 0.6), (2_900.0, 22.0, 0.4), (5_300.0, 35.0, 0.3)];
    for (n, x) in samples[onset..].iter_mut().enumerate() {
        let t = n as f64 / f64::from(RATE_HZ);
        let rise = (1.0 - (-t / 2e-4).exp()).powi(2);
        let mode = |(hz, decay, gain): (f64, f64, f64)| gain * (-decay * t).exp() * (TAU * hz * t).sin();
        *x += 0.25 * rise * modes.into_iter().map(mode).sum::<f64>() + (-60.0 * t).exp() * hiss[n];
    }
    Recorded { samples, onset, rate_hz: RATE_HZ }
}

fn head() {
    println!("| recording | {} |", FORMS.map(|form| format!("{form:?}")).join(" | "));
    println!("|{}", " --- |".repeat(1 + FORMS.len()));
}

#[test]
fn a_strike_is_fitted_as_near_in_each_of_seven_forms() {
    head();
    for (form, more) in errors_over_plain("computed", &computed(), 8).expect("no form is refused") {
        // The 50 ms of the cut form are another sound.
        let limit = if form == Form::Cut { 0.08 } else { 0.02 };
        assert!(more <= limit, "{form:?}: loudness error {more:+.3} over that of the plain form");
    }
}

/// A strike of the shared recordings: the loudest, from the sound before it on.
fn shared(path: &Path) -> Recorded {
    let recording = fit::audio::read(path, None).expect("it is readable");
    let (hits, _) = fit::segment::hits(&recording).expect("it holds a strike");
    let energy = |hit: &fit::segment::Hit| {
        let first = &recording.samples[hit.onset..hit.end.min(hit.onset + 4_410)];
        first.iter().map(|x| x * x).sum::<f64>()
    };
    let hit = hits.iter().max_by(|a, b| energy(a).total_cmp(&energy(b))).expect("it holds a strike");
    let samples = recording.samples[..hit.end].to_vec();
    Recorded { samples, onset: hit.onset, rate_hz: recording.rate_hz as u32 }
}

/// Paths of the shared recordings whose names contain one of `names`.
fn shared_paths(names: &[&str]) -> Vec<PathBuf> {
    let folder = Path::new(env!("SHARED_DATA")).join("recordings");
    let entries = std::fs::read_dir(&folder).expect("the recordings are there");
    let mut paths: Vec<PathBuf> = entries.map(|entry| entry.expect("a file").path()).collect();
    paths.retain(|path| {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        name.ends_with(".wav") && names.iter().any(|wanted| name.contains(wanted))
    });
    paths.sort();
    paths
}

/// Prints the errors of recordings in all forms; returns those over the plain form of all forms but
/// the cut one, whose 50 ms are another sound.
fn errors_of_recordings(names: &[&str], most_modes: usize) -> Vec<f64> {
    head();
    let (mut all, mut refused) = (Vec::new(), Vec::new());
    for path in shared_paths(names) {
        let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        match errors_over_plain(&name, &shared(&path), most_modes) {
            Ok(errors) => all.extend(errors.iter().filter(|(form, _)| *form != Form::Cut).map(|(_, more)| *more)),
            Err(forms) => refused.extend(forms),
        }
    }
    println!(
        "over the plain form: median {:+.3}, ninth tenth {:+.3}, at most {:+.3}",
        quantile(&all, 0.5),
        quantile(&all, 0.9),
        quantile(&all, 1.0)
    );
    assert!(refused.is_empty(), "refused: {refused:#?}");
    all
}

#[test]
#[cfg_attr(not(has_shared_data), ignore = "needs the recordings in ../shared/data")]
fn a_recording_is_fitted_as_near_in_each_of_seven_forms() {
    let all = errors_of_recordings(&["mug_1"], 16);
    assert!(quantile(&all, 1.0) <= 0.03, "{all:?}");
}

#[test]
#[ignore = "fits 28 recordings seven times: cargo test -p fit --test sounds forms:: -- --ignored --nocapture"]
fn no_recording_is_refused_in_any_of_seven_forms() {
    let all = errors_of_recordings(&[""], 16);
    assert!(quantile(&all, 0.9) <= 0.03, "{all:?}");
}

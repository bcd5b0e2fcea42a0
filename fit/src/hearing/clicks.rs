//! A click in the attack is heard by every measure that a fit prints: clicks one sample long, once
//! to ten times as high as the recording's peak.

use super::{Heard, Scores};
use crate::contact;
use crate::modes::DampedSine;
use crate::random::SplitMix64;

const RATE_HZ: f64 = 44_100.0;
const LENGTH: usize = 22_050;
/// Number of samples before the strike.
const SILENCE: usize = 4_410;

/// Noise that dies away, low-passed by a mean over `mean` samples.
fn noise(seed: u64, mean: usize, decay_per_s: f64) -> Vec<f64> {
    let mut random = SplitMix64(seed);
    let white: Vec<f64> = (0..LENGTH + mean).map(|_| random.normal()).collect();
    let smooth = white.windows(mean).take(LENGTH).map(|window| window.iter().sum::<f64>() / (mean as f64).sqrt());
    smooth.enumerate().map(|(n, x)| 0.1 * x * (-decay_per_s * n as f64 / RATE_HZ).exp()).collect()
}

/// Partials that a contact of `contact_s` excites, each `off_db` louder.
fn partials(contact_s: f64, off_db: f64) -> Vec<f64> {
    let mut sound = vec![0.0; LENGTH];
    for (frequency_hz, decay_per_s) in
        [(212.0, 6.0), (587.0, 9.0), (1_180.0, 14.0), (2_030.0, 25.0), (3_420.0, 40.0), (6_100.0, 90.0)]
    {
        let amplitude = 0.1 * 10f64.powf(off_db / 20.0);
        DampedSine { frequency_hz, decay_per_s, amplitude, phase: 0.4 }.add_to(&mut sound, RATE_HZ);
    }
    let force = contact::force(contact_s, RATE_HZ);
    let sum: f64 = force.iter().sum();
    let at = |n: usize| force.iter().enumerate().filter(|(m, _)| *m <= n).map(|(m, x)| x * sound[n - m]).sum::<f64>();
    (0..LENGTH).map(|n| at(n) / sum).collect()
}

/// Noise that dies away, and rises for 20 ms before.
fn slow_noise(seed: u64) -> Vec<f64> {
    let rise = |n: usize| (n as f64 / (0.02 * RATE_HZ)).min(1.0);
    noise(seed, 6, 12.0).into_iter().enumerate().map(|(n, x)| x * rise(n)).collect()
}

/// Sum of partials behind a short contact and of noise.
fn quick(seed: u64, off_db: f64) -> Vec<f64> {
    partials(3e-4, off_db).iter().zip(noise(seed, 3, 60.0)).map(|(a, b)| a + 0.03 * b).collect()
}

/// A recording, and renderings near to it.
struct Case {
    name: &'static str,
    recording: Vec<f64>,
    renderings: Vec<Vec<f64>>,
    /// Heights of clicks over the recording's peak.
    levels: [f64; 3],
}

/// Recordings with renderings: several draws of what is noise.
fn cases() -> Vec<Case> {
    let draws = |draw: &dyn Fn(u64) -> Vec<f64>| (100..104).map(draw).collect();
    // Slow noise has many samples nearly as high as its peak: a click of that height is masked.
    let (masked, bare) = ([2.0, 4.0, 10.0], [1.0, 2.0, 10.0]);
    vec![
        Case {
            name: "noise that dies away",
            recording: noise(1, 8, 20.0),
            renderings: draws(&|seed| noise(seed, 8, 20.0)),
            levels: masked,
        },
        Case {
            name: "noise that dies away at once",
            recording: noise(1, 12, 300.0),
            renderings: draws(&|seed| noise(seed, 12, 300.0)),
            levels: bare,
        },
        Case {
            name: "noise that rises for 20 ms",
            recording: slow_noise(1),
            renderings: draws(&slow_noise),
            levels: bare,
        },
        Case {
            name: "partials behind a long contact",
            recording: partials(3e-3, 0.0),
            renderings: vec![partials(3e-3, 0.5)],
            levels: bare,
        },
        Case {
            name: "partials and noise",
            recording: quick(1, 0.0),
            renderings: draws(&|seed| quick(seed, 0.7)),
            levels: bare,
        },
    ]
}

/// Mean measures of a case's renderings with a click at a time; without one at a level of 0.
fn scores(case: &Case, heard: &Heard, at: usize, level: f64) -> Scores {
    let peak = case.recording.iter().fold(0.0, |peak: f64, x| peak.max(x.abs()));
    let clicked = case.renderings.iter().map(|rendering| {
        let mut clicked = rendering.clone();
        clicked[at] += level * peak;
        heard.scores(&clicked)
    });
    Scores::mean(&clicked.collect::<Vec<_>>())
}

#[test]
fn click_in_the_first_3_ms_raises_every_distance() {
    let figures = |scores: &Scores| {
        [
            ("LSD", scores.lsd_db),
            ("ERB distance", scores.erb_db),
            ("ERB distance of the beginning", scores.early_erb_db),
            ("loudness error", scores.loudness_error),
            ("loudness error of the beginning", scores.early_loudness_error),
        ]
    };
    let mut missed = Vec::new();
    for case in cases() {
        // The recording's background is 80 dB down.
        let mut random = SplitMix64(3);
        let silence = std::iter::repeat_n(0.0, SILENCE);
        let whole: Vec<f64> =
            silence.chain(case.recording.iter().copied()).map(|x| x + 1e-5 * random.normal()).collect();
        let heard = Heard::new(&whole, RATE_HZ, SILENCE, whole.len());
        let plain = scores(&case, &heard, 0, 0.0);
        for at_ms in [0.0, 0.2, 0.5, 1.0, 2.0, 2.9] {
            let mut before = plain;
            for level in case.levels {
                let after = scores(&case, &heard, (at_ms * 1e-3 * RATE_HZ) as usize, level);
                for ((measure, now), (_, then)) in figures(&after).into_iter().zip(figures(&before)) {
                    if now <= then {
                        let name = case.name;
                        missed.push(format!("{name}, {at_ms} ms, {level}: {measure} from {then:.4} to {now:.4}"));
                    }
                }
                before = after;
            }
        }
    }
    assert!(missed.is_empty(), "{} of 450 do not rise:\n{}", missed.len(), missed.join("\n"));
}

//! Steady tones, such as the hum of mains, that sound through a whole recording: they are taken off
//! before a fit, like a constant offset.

use std::f64::consts::{PI, TAU};

use nalgebra::{Matrix3, Vector3};

/// Number of times that all tones are fitted, each to what the others leave.
const PASSES: usize = 3;
/// Number of Gauss-Newton steps of a tone in each pass.
const STEPS: usize = 4;
/// Largest share of a tone's power that may be left in either part for it to be steady: -10 dB.
const LEFT: f64 = 0.1;

/// A tone `a cos ωn + b sin ωn` of constant level, n from the onset on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Tone {
    /// Angular frequency in rad/sample.
    angular: f64,
    /// Amplitudes of cosine and sine.
    amplitudes: [f64; 2],
}

impl Tone {
    /// Frequency in Hz.
    pub(crate) fn frequency_hz(&self, rate_hz: f64) -> f64 {
        self.angular * rate_hz / TAU
    }

    /// Mean square, full scale 1.
    pub(crate) fn power(&self) -> f64 {
        0.5 * self.amplitudes.iter().map(|x| x * x).sum::<f64>()
    }

    /// Value at a sample, counted from the onset.
    pub(crate) fn at(&self, n: f64) -> f64 {
        let (sine, cosine) = (self.angular * n).sin_cos();
        self.amplitudes[0] * cosine + self.amplitudes[1] * sine
    }

    /// The tone after a Gauss-Newton step towards the sound of some parts.
    fn improved(&self, parts: &[Part]) -> Option<Self> {
        let (mut matrix, mut vector) = (Matrix3::zeros(), Vector3::zeros());
        for (n, x) in parts.iter().flat_map(Part::samples) {
            let (sine, cosine) = (self.angular * n).sin_cos();
            let by_angular = n * (self.amplitudes[1] * cosine - self.amplitudes[0] * sine);
            let row = Vector3::new(cosine, sine, by_angular);
            matrix += row * row.transpose();
            vector += row * (x - self.at(n));
        }
        // A tone without amplitude tells no frequency.
        matrix[(2, 2)] = matrix[(2, 2)].max(f64::MIN_POSITIVE.sqrt());
        let step = matrix.lu().solve(&vector).filter(|step| step.iter().all(|x| x.is_finite()))?;
        let amplitudes = [self.amplitudes[0] + step[0], self.amplitudes[1] + step[1]];
        Some(Self { angular: self.angular + step[2], amplitudes })
    }
}

/// A part of a recording, of which the strike's ringing is no part.
#[derive(Clone)]
struct Part {
    /// Sample at which it begins, counted from the onset.
    from: f64,
    samples: Vec<f64>,
}

impl Part {
    fn samples(&self) -> impl Iterator<Item = (f64, f64)> + '_ {
        self.samples.iter().enumerate().map(|(n, &x)| (self.from + n as f64, x))
    }

    fn add(&mut self, tone: &Tone, sign: f64) {
        let from = self.from;
        self.samples.iter_mut().enumerate().for_each(|(n, x)| *x += sign * tone.at(from + n as f64));
    }

    /// Power of a tone's frequency under a Hann window.
    fn power(&self, angular: f64) -> f64 {
        let length = self.samples.len() as f64;
        let (mut cosine, mut sine) = (0.0, 0.0);
        for (n, x) in self.samples() {
            let window = 0.5 - 0.5 * (TAU * (n - self.from) / length).cos();
            let (s, c) = (angular * n).sin_cos();
            cosine += window * x * c;
            sine += window * x * s;
        }
        (cosine * cosine + sine * sine) / (length * length)
    }
}

/// Tones near some frequencies in Hz that are as loud at a strike's end as before the strike.
///
/// `quiet` precedes the strike by `gap` samples, `end` begins `behind` samples after its onset.
/// Each tone keeps its frequency, level and phase through both, so that a mode that decays is none.
pub(crate) fn steady(
    (quiet, gap): (&[f64], usize),
    (end, behind): (&[f64], usize),
    near_hz: &[f64],
    rate_hz: f64,
) -> Vec<Tone> {
    let before = Part { from: -((quiet.len() + gap) as f64), samples: quiet.to_vec() };
    let mut parts = [before, Part { from: behind as f64, samples: end.to_vec() }];
    let whole = parts.clone();
    let tone = |hz: &f64| Tone { angular: TAU * hz / rate_hz, amplitudes: [0.0; 2] };
    let mut tones: Vec<Tone> = near_hz.iter().map(tone).filter(|tone| tone.angular < PI).collect();
    for pass in 0..PASSES {
        for tone in &mut tones {
            parts.iter_mut().for_each(|part| part.add(tone, 1.0));
            // The part before the strike alone tells how many turns lie between both.
            let used = if pass == 0 { &parts[..1] } else { &parts[..] };
            for _ in 0..STEPS {
                *tone = tone.improved(used).unwrap_or(*tone);
            }
            parts.iter_mut().for_each(|part| part.add(tone, -1.0));
        }
    }
    let is_steady = |tone: &Tone| {
        let left = |(part, whole): (&Part, &Part)| part.power(tone.angular) / whole.power(tone.angular);
        parts.iter().zip(&whole).map(left).all(|left| left < LEFT)
    };
    tones.into_iter().filter(is_steady).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::SplitMix64;

    #[test]
    fn hum_is_steady_and_a_mode_that_decays_by_8_db_a_second_is_not() {
        let (rate_hz, onset) = (44_100.0, 22_050.0);
        let mut random = SplitMix64(3);
        let sound: Vec<f64> = (0..110_250)
            .map(|n| {
                let t = (f64::from(n) - onset) / rate_hz;
                let hum = 0.01 * (TAU * 50.03 * t + 1.0).sin() + 0.004 * (TAU * 150.09 * t).sin();
                hum + 0.02 * (-0.9 * t).exp() * (TAU * 220.0 * t).cos() + 1e-4 * random.normal()
            })
            .collect();
        let tones = steady((&sound[..22_000], 50), (&sound[88_200..], 66_150), &[50.3, 149.8, 219.9], rate_hz);
        let hz: Vec<f64> = tones.iter().map(|tone| tone.frequency_hz(rate_hz)).collect();
        assert!(tones.len() == 2 && (hz[0] - 50.03).abs() < 5e-3 && (hz[1] - 150.09).abs() < 5e-3, "{hz:?}");
        assert!((tones[0].power() / 5e-5 - 1.0).abs() < 0.01, "{tones:?}");
    }
}

//! Modes from sound: frequency, decay, amplitude and phase of the damped sines that it is made of.
//!
//! ```text
//! sound ─► search ─► candidates ─► refine ─► prune ─► model ─► residual
//!            ▲     (likelihood    (all modes  (BIC)               │
//!            │      ratio)         jointly)                       │
//!            └────────────────────────────────────────────────────┘
//! ```
//!
//! Under white noise the refinement is the maximum-likelihood estimate of all modes together; it attains the Cramer-Rao bounds where the modes
//! are found at all (`cargo bench -p fit --bench synthetic` prints both).

mod basis;
mod noise;
mod pole;
mod polish;
mod power_sums;
mod refine;
mod search;

pub(crate) use basis::Basis;
pub(crate) use basis::Stretch;
use nalgebra::Complex;
use noise::NoiseFloor;
pub(crate) use pole::Pole;
pub(crate) use polish::polish;
pub(crate) use refine::{Ending, Gains, Group, Model, refine};
use search::{Range, search};

/// A damped sine: `amplitude e^{-d t} cos(2πft + phase)`, t from the first sample of the recording.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DampedSine {
    /// Frequency f in Hz.
    pub frequency_hz: f64,
    /// Decay rate d in 1/s; T60 = ln(1000)/d.
    pub decay_per_s: f64,
    /// Amplitude at t = 0, full scale = 1.
    pub amplitude: f64,
    /// Phase at t = 0, radians.
    pub phase: f64,
}

impl DampedSine {
    /// T60 in seconds.
    pub fn t60_s(&self) -> f64 {
        1000f64.ln() / self.decay_per_s
    }

    fn gain(&self) -> Complex<f64> {
        Complex::from_polar(self.amplitude, self.phase)
    }

    /// Adds the sine to `samples`, the first of which is at t = 0.
    pub fn add_to(&self, samples: &mut [f64], rate_hz: f64) {
        pole::add_ringing(Pole::new(self.frequency_hz, self.decay_per_s, rate_hz), self.gain(), samples);
    }
}

/// How to estimate.
#[derive(Clone, Copy, Debug)]
pub struct Settings {
    /// Modes at most.
    pub most_modes: usize,
    /// Fastest decay that counts as a mode, 1/s.
    pub fastest_decay_per_s: f64,
    /// Lowest frequency in Hz.
    pub lowest_hz: f64,
}

impl Default for Settings {
    /// 64 modes, decays up to 1500/s (T60 4.6 ms), from 30 Hz.
    fn default() -> Self {
        Self { most_modes: 64, fastest_decay_per_s: 1500.0, lowest_hz: 30.0 }
    }
}

/// Estimates the modes that ring freely from the first sample on, loudest energy first.
///
/// `samples` at full scale 1; `rate_hz` their rate. The number of modes follows from the sound: one more has to explain
/// more energy than the Bayesian criterion asks of its four numbers, at the noise floor round its frequency.
pub fn estimate(samples: &[f64], rate_hz: f64, settings: Settings) -> Vec<DampedSine> {
    let Some(model) = model(samples, rate_hz, settings) else { return Vec::new() };
    let gains = model.gains.iter().flat_map(|gains| &gains.modes);
    let mut modes: Vec<(f64, DampedSine)> = model
        .poles
        .iter()
        .zip(gains)
        .zip(&model.worth)
        .map(|((pole, gain), worth)| {
            let sine = DampedSine {
                frequency_hz: pole.frequency_hz(rate_hz),
                decay_per_s: pole.decay_per_s(rate_hz),
                amplitude: gain.norm(),
                phase: gain.arg(),
            };
            (*worth, sine)
        })
        .collect();
    modes.sort_by(|a, b| b.0.total_cmp(&a.0));
    modes.into_iter().map(|(_, sine)| sine).collect()
}

/// The poles alone of [`estimate`].
pub(crate) fn estimate_poles(samples: &[f64], rate_hz: f64, settings: Settings) -> Vec<Pole> {
    model(samples, rate_hz, settings).map_or(Vec::new(), |model| model.poles)
}

/// Passes of search and refinement at most.
const PASSES: usize = 24;

fn model(samples: &[f64], rate_hz: f64, settings: Settings) -> Option<Model> {
    let length = samples.len();
    if length < 64 {
        return None;
    }
    let groups = [Group::ringing(samples)];
    let range = Range {
        slowest: 0.5 / length as f64,
        fastest: (settings.fastest_decay_per_s / rate_hz).min(0.3),
        angular: (std::f64::consts::TAU * settings.lowest_hz / rate_hz, std::f64::consts::PI * 0.999),
    };
    // Four numbers a mode, each of which has to explain ln N times the noise.
    let threshold = 4.0 * (length as f64).ln();
    let mut model = Model { poles: Vec::new(), gains: Vec::new(), worth: Vec::new() };
    let mut residual = samples.to_vec();
    let mut noise = NoiseFloor::of_residual(&residual);
    for _ in 0..PASSES {
        let candidates = search(
            &residual,
            &noise,
            range,
            threshold,
            settings.most_modes - model.poles.len().min(settings.most_modes),
        );
        if candidates.is_empty() {
            break;
        }
        let mut poles = model.poles.clone();
        poles.extend(candidates.iter().map(|candidate| candidate.pole));
        let Some(more) = refine(&groups, &poles, Ending::COARSE)
            .and_then(|more| within(&groups, more, range))
            .and_then(|more| prune(&groups, more, &noise, threshold, Ending::COARSE))
        else {
            break;
        };
        model = more;
        residual = model.residual(0, &groups[0].stretches[0]);
        noise = NoiseFloor::of_residual(&residual);
        if model.poles.len() >= settings.most_modes {
            break;
        }
    }
    let model = refine(&groups, &model.poles, Ending::FINE)?;
    prune(&groups, within(&groups, model, range)?, &noise, threshold, Ending::FINE)
}

/// Takes out what has left the range that is searched: drifts and clicks, no modes.
fn within(groups: &[Group<'_>], model: Model, range: Range) -> Option<Model> {
    let (lowest, highest) = range.angular;
    let strayed =
        |pole: &Pole| pole.angular < 0.9 * lowest || pole.angular > highest || pole.decay > 1.5 * range.fastest;
    let outside: Vec<usize> = (0..model.poles.len()).filter(|&k| strayed(&model.poles[k])).collect();
    if outside.is_empty() { Some(model) } else { refine(groups, &model.without(&outside), Ending::COARSE) }
}

/// Takes out modes that do not earn their cost, the least worthy first, and refines what stays.
fn prune(groups: &[Group<'_>], model: Model, noise: &NoiseFloor, threshold: f64, ending: Ending) -> Option<Model> {
    let mut model = model;
    loop {
        let unworthy: Vec<usize> = (0..model.poles.len())
            .filter(|&k| model.worth[k] < threshold * noise.variance(model.poles[k].angular))
            .collect();
        if unworthy.is_empty() {
            return Some(model);
        }
        // Two that stand in each other's place are both worth nothing: of neighbours only the least goes at a time.
        let apart = |a: usize, b: usize| {
            let (a, b) = (model.poles[a], model.poles[b]);
            (a.angular - b.angular).abs() > 10.0 * (a.decay + b.decay)
        };
        let mut dropped: Vec<usize> = Vec::new();
        let mut in_order = unworthy;
        in_order.sort_by(|&a, &b| model.worth[a].total_cmp(&model.worth[b]));
        for candidate in in_order {
            if dropped.iter().all(|&other| apart(candidate, other)) {
                dropped.push(candidate);
            }
        }
        model = refine(groups, &model.without(&dropped), ending)?;
    }
}

/// Cramer-Rao bounds of a mode: what no unbiased estimator falls below.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// Standard deviation of the frequency, Hz.
    pub frequency_hz: f64,
    /// Standard deviation of the decay rate, 1/s.
    pub decay_per_s: f64,
    /// Standard deviation of the amplitude, relative.
    pub amplitude: f64,
}

/// The bounds of modes that ring together in white noise of `noise_rms`, over `length` samples; all frequencies, decays, amplitudes and phases
/// unknown. `None` where two modes are the same.
pub fn cramer_rao_bounds(modes: &[DampedSine], length: usize, rate_hz: f64, noise_rms: f64) -> Option<Vec<Bounds>> {
    let modes: Vec<_> =
        modes.iter().map(|sine| (Pole::new(sine.frequency_hz, sine.decay_per_s, rate_hz), sine.gain())).collect();
    let deviations = refine::standard_deviations(length, &modes, noise_rms * noise_rms)?;
    let bounds = deviations.into_iter().map(|[decay, angular, amplitude]| Bounds {
        frequency_hz: angular * rate_hz / std::f64::consts::TAU,
        decay_per_s: decay * rate_hz,
        amplitude,
    });
    Some(bounds.collect())
}

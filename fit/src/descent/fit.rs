//! The descent: from random numbers to modes and strikes.

use dsp_core::table::range::FREQUENCY_HZ;

use super::adam::Adam;
use super::error::DescentError;
use super::force::Pulse;
use super::loss::Loss;
use super::model::{Model, Rendered};
use super::parameters::Kind;
use super::settings::Settings;
use crate::clipping::Limits;
use crate::multi_strike::{Estimate, ModeEstimate, StrikeEstimate, is_clipped};
use crate::random::SplitMix64;

/// Shortest and longest recording in seconds.
const LENGTHS_S: [f64; 2] = [0.2, 20.0];
/// Magnitude relative to the largest under which a pulse is no strike: -40 dB.
const LEAST_STRIKE: f64 = 0.01;
/// Energy relative to the loudest under which a mode is not told: -50 dB.
const LEAST_MODE: f64 = 1e-5;
/// Time in seconds behind a strike's onset over which its residual is measured.
const BEHIND_S: f64 = 0.03;
/// Number of steps over which the loss of a start is averaged, since its noise differs each step.
const AVERAGED: usize = 10;

/// One descent under way.
struct Descent<'a> {
    model: Model,
    loss: &'a Loss,
    parameters: Vec<f64>,
    adam: Adam,
    random: SplitMix64,
    /// Losses of the last steps.
    losses: Vec<f64>,
}

impl<'a> Descent<'a> {
    fn new(settings: &Settings, start: usize, (length, rate_hz): (usize, f64), loss: &'a Loss) -> Self {
        let mut random = SplitMix64(settings.seed.wrapping_mul(0x9E37_79B9) ^ ((start as u64) << 32));
        let model = Model::new(length, rate_hz, settings.modes, &mut random);
        let parameters = model.start(&mut random);
        let adam = Adam::new(&model.places, settings.rates[start]);
        Self { model, loss, parameters, adam, random, losses: Vec::new() }
    }

    fn step(&mut self) {
        let draw = self.model.draw(&mut self.random);
        let rendered = self.model.render(&self.parameters, &draw);
        let mut by_sound = vec![0.0; rendered.sound.len()];
        self.losses.push(self.loss.at(&rendered.sound, &mut by_sound));
        let gradient = self.model.gradient(&self.parameters, &draw, &rendered, &by_sound);
        self.adam.step(&self.model.places, &mut self.parameters, gradient);
    }

    /// Mean loss of the last steps.
    fn loss(&self) -> f64 {
        let last = &self.losses[self.losses.len().saturating_sub(AVERAGED)..];
        last.iter().sum::<f64>() / last.len().max(1) as f64
    }

    /// Numbers of the model as it is, for a recording whose largest sample is `unit`.
    fn estimate(&self, samples: &[f64], unit: f64, rate_hz: f64) -> Result<Estimate, DescentError> {
        let rendered = self.model.render(&self.parameters, &self.model.still());
        let acceleration = self.model.single(&self.parameters, Kind::Acceleration);
        numbers(&rendered, acceleration, samples, unit, rate_hz)
    }
}

/// Fits all strikes of a recording by descent, as DiffImpact does.
///
/// Full scale of `samples` is 1; the recording lasts 0.2 to 20 s. The estimate has no standard
/// deviations: they are NaN, which JSON writes as `null`. Contact times are those of Gaussians
/// (eq. 2), and onsets those of the contacts that these smooth. Modes 50 dB below the loudest and
/// pulses 40 dB below the strongest are left out, and so are modes whose frequency no table holds:
/// the range of the lowest one reaches below 0 Hz. The residual is the recording without the sound
/// of strikes and room. It may be as loud as the recording, because modes have no phases.
/// A step takes about 35 ms for each second of sound, with 64 modes (docs/multi-strike.md has the
/// accuracy). `told` gets the share of the work that is done, from 0 to 1.
///
/// # Errors
/// [`DescentError`] if the recording is too short, too long or silent.
pub fn estimate(
    samples: &[f64],
    rate_hz: f64,
    settings: &Settings,
    told: impl Fn(f64),
) -> Result<Estimate, DescentError> {
    let seconds = samples.len() as f64 / rate_hz;
    let [shortest, longest] = LENGTHS_S;
    if !(shortest..=longest).contains(&seconds) {
        return Err(DescentError::Length { seconds, shortest, longest });
    }
    let unit = samples.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
    if unit == 0.0 {
        return Err(DescentError::Silent);
    }
    let recording: Vec<f64> = samples.iter().map(|x| x / unit).collect();
    let loss = Loss::new(&recording);
    let all = settings.all_steps().max(1) as f64;
    let mut done = 0u32;
    let mut best: Option<Descent<'_>> = None;
    for start in 0..settings.rates.len() {
        let mut descent = Descent::new(settings, start, (samples.len(), rate_hz), &loss);
        for _ in 0..settings.trial_steps() {
            descent.step();
            done += 1;
            told(f64::from(done) / all);
        }
        if best.as_ref().is_none_or(|best| descent.loss() < best.loss()) {
            best = Some(descent);
        }
    }
    let mut best = best.ok_or(DescentError::Lost)?;
    for _ in settings.trial_steps()..settings.steps {
        best.step();
        done += 1;
        told(f64::from(done) / all);
    }
    best.estimate(samples, unit, rate_hz)
}

/// Numbers of a rendered model; forces and gains in units of the strongest strike.
fn numbers(
    rendered: &Rendered,
    acceleration: f64,
    samples: &[f64],
    unit: f64,
    rate_hz: f64,
) -> Result<Estimate, DescentError> {
    let strongest = rendered.pulses.iter().map(|pulse| pulse.magnitude).fold(0.0, f64::max);
    if !(strongest > 0.0 && rendered.sound.iter().all(|x| x.is_finite())) {
        return Err(DescentError::Lost);
    }
    let residual: Vec<f64> = samples.iter().zip(&rendered.sound).map(|(x, sound)| x - unit * sound).collect();
    let energy = |mode: &super::modes::ScaledMode| mode.gain * mode.gain / mode.decay_per_s.0;
    let loudest = rendered.modes.iter().map(energy).fold(0.0, f64::max);
    let is_held = |hz: f64| FREQUENCY_HZ.holds(hz as f32);
    let mut modes: Vec<ModeEstimate> = rendered
        .modes
        .iter()
        .filter(|mode| energy(mode) >= LEAST_MODE * loudest && is_held(mode.frequency_hz.0))
        .map(|mode| ModeEstimate {
            frequency_hz: mode.frequency_hz.0,
            frequency_hz_sd: f64::NAN,
            decay_per_s: mode.decay_per_s.0,
            decay_per_s_sd: f64::NAN,
            gain: [mode.gain * strongest * unit * rate_hz, 0.0],
            gain_sd: f64::NAN,
            gains: Vec::new(),
            striker: None,
        })
        .collect();
    if modes.is_empty() {
        return Err(DescentError::Lost);
    }
    modes.sort_by(|a, b| a.frequency_hz.total_cmp(&b.frequency_hz));
    let mut pulses: Vec<Pulse> =
        rendered.pulses.iter().filter(|pulse| pulse.magnitude >= LEAST_STRIKE * strongest).copied().collect();
    pulses.sort_by(|a, b| a.onset.total_cmp(&b.onset));
    let power = |sound: &[f64]| sound.iter().map(|x| x * x).sum::<f64>() / sound.len().max(1) as f64;
    let behind = (BEHIND_S * rate_hz) as usize;
    let left = |pulse: &Pulse| {
        // The last pulse may begin behind the recording's end.
        let first = (pulse.onset.max(0.0) as usize).min(residual.len().saturating_sub(behind));
        power(&residual[first..(first + behind).min(residual.len())]).max(f64::MIN_POSITIVE)
    };
    let powers: Vec<f64> = pulses.iter().map(left).collect();
    let median = crate::score::quantile(&powers, 0.5);
    let limits = Limits::of(samples);
    let strike = |(pulse, power): (&Pulse, &f64)| StrikeEstimate {
        at_s: pulse.onset / rate_hz,
        at_s_sd: f64::NAN,
        middle_s: pulse.middle() / rate_hz,
        middle_s_sd: f64::NAN,
        contact_time_s: pulse.contact_time / rate_hz,
        contact_time_s_sd: f64::NAN,
        peak_force: pulse.magnitude / strongest,
        peak_force_sd: f64::NAN,
        position: 0.0,
        position_sd: f64::NAN,
        striker: 0,
        left_db: 10.0 * (power / median).log10(),
        is_clipped: is_clipped(samples, pulse.onset.max(0.0) as usize, rate_hz, limits),
    };
    Ok(Estimate {
        rate_hz,
        modes,
        strikes: pulses.iter().zip(&powers).map(strike).collect(),
        contact_times_are_heard: false,
        acceleration: acceleration * strongest * unit,
        acceleration_sd: f64::NAN,
        left_dbfs: 10.0 * power(&residual).max(1e-30).log10(),
        room: None,
        residual,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::multi_strike::synthetic::plain;

    #[test]
    fn descent_lowers_the_loss_and_its_strongest_pulse_is_a_strike() {
        let sound = plain(3, 1.0, 3, -60.0);
        let settings = Settings { modes: 32, steps: 200, rates: vec![0.03], seed: 2 };
        let unit = sound.samples.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
        let loss = Loss::new(&sound.samples.iter().map(|x| x / unit).collect::<Vec<f64>>());
        let mut descent = Descent::new(&settings, 0, (sound.samples.len(), sound.rate_hz), &loss);
        (0..settings.steps).for_each(|_| descent.step());
        assert!(descent.loss() < 0.5 * descent.losses[0], "{} of {}", descent.loss(), descent.losses[0]);
        let estimate = descent.estimate(&sound.samples, unit, sound.rate_hz).expect("it is a clip");
        // The pulse that is told to be the strongest is a strike.
        let strongest = estimate.strikes.iter().find(|strike| strike.peak_force == 1.0).expect("one is the unit");
        let late_s = sound.strikes.iter().map(|strike| (strike.middle_s() - strongest.middle_s).abs());
        let late_s = late_s.fold(f64::INFINITY, f64::min);
        assert!(late_s < 0.01, "{late_s} s");
        assert!(estimate.strikes.iter().all(|strike| strike.left_db.abs() < 60.0));
        assert!(estimate.modes.iter().all(|mode| mode.frequency_hz_sd.is_nan() && mode.gain[0] > 0.0));
    }

    #[test]
    fn modes_whose_frequency_no_table_holds_are_left_out() {
        let sound = plain(3, 0.5, 2, -60.0);
        let settings = Settings { modes: 16, steps: 1, rates: vec![0.03], seed: 2 };
        let loss = Loss::new(&sound.samples);
        let mut descent = Descent::new(&settings, 0, (sound.samples.len(), sound.rate_hz), &loss);
        let [frequencies, dampings] = [Kind::Frequency, Kind::Damping].map(|kind| descent.model.places.of(kind));
        let gains = descent.model.places.of(Kind::Gain);
        descent.parameters[frequencies].fill(-5.0);
        descent.parameters[dampings].fill(0.0);
        descent.parameters[gains].fill(0.0);
        let estimate = descent.estimate(&sound.samples, 1.0, sound.rate_hz).expect("all but one are held");
        // The lowest of 16 ranges begins at -7 Hz.
        assert_eq!(estimate.modes.len(), 15);
        assert!(estimate.modes.iter().all(|mode| mode.frequency_hz >= 0.1), "{}", estimate.modes[0].frequency_hz);
    }

    #[test]
    fn silence_and_long_recordings_are_refused_by_name() {
        let refused = |samples: &[f64]| estimate(samples, 8_000.0, &Settings::default(), |_| {}).err();
        assert_eq!(refused(&[0.0; 8_000]), Some(DescentError::Silent));
        for length in [80, 168_000] {
            assert!(matches!(refused(&vec![0.1; length]), Some(DescentError::Length { .. })));
        }
    }
}

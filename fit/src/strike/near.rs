//! Modes and noise of one strike, as near to the recording as an ear tells.
//!
//! Candidates from subbands, those chosen that explain most loudness, gains by joint least squares,
//! and noise from what they leave: from there the joint descent begins.

use super::audible::choose;
use crate::distance::{Spectrogram, band_power};
use crate::hearing::Loudness;
use crate::joint::{Descent, Sounding};
use crate::modes::{DampedSine, Ending, Group, Pole, Settings, Stretch, candidates, refine};
use crate::residual::{Band, usual_edges_hz};

/// Number of steps of the descent.
const STEPS: usize = 120;
/// Length of the strike whose loudness is compared, in seconds.
const LONGEST_S: f64 = 4.0;
/// Number of samples in the frames that measure the noise.
const FRAME: usize = 1024;

/// A strike, driven by a force from sample `onset` on.
#[derive(Clone, Copy)]
pub(super) struct Heard<'a> {
    pub(super) samples: &'a [f64],
    pub(super) onset: usize,
    pub(super) end: usize,
    pub(super) rate_hz: f64,
    pub(super) force: &'a [f64],
}

impl Heard<'_> {
    fn strike(&self) -> &[f64] {
        &self.samples[self.onset..self.end.min(self.samples.len())]
    }

    /// Modes and noise near to the strike; `None` if it has no audible mode.
    pub(super) fn near(&self, settings: Settings) -> Option<Sounding> {
        let start = self.start(&self.audible(settings))?;
        let edges_hz = usual_edges_hz(self.rate_hz);
        let fastest = settings.fastest_decay_per_s / self.rate_hz;
        let mut descent =
            Descent::new(self.samples, self.onset, self.end, self.rate_hz, self.force, &edges_hz, fastest);
        let (near, _) = descent.run(&start, STEPS);
        Some(near)
    }

    /// Candidates that explain most loudness, ringing from the end of the force on.
    fn audible(&self, settings: Settings) -> Vec<DampedSine> {
        let strike = self.strike();
        let behind = self.force.len().min(strike.len());
        let all = candidates(&strike[behind..], self.rate_hz, settings);
        let longest = strike.len().min((LONGEST_S * self.rate_hz) as usize);
        let loudness = Loudness::new(&strike[..longest], &self.samples[..self.onset], self.rate_hz);
        choose(&all, &loudness, settings.most_modes)
    }

    /// Modes with gains by least squares, and the noise that they leave.
    fn start(&self, audible: &[DampedSine]) -> Option<Sounding> {
        let strike = self.strike();
        let stretch = Stretch { samples: strike, force: Some(&self.force[..self.force.len().min(strike.len())]) };
        let group = [Group { stretches: vec![stretch] }];
        let poles: Vec<Pole> = audible
            .iter()
            .map(|mode| Pole::new(mode.frequency_hz, mode.decay_per_s, self.rate_hz))
            .collect();
        let model = refine(&group, &poles, Ending { steps: 0, ..Ending::COARSE })?;
        let left = model.residual(0, &stretch);
        let bands = noise_of(&left, self.rate_hz);
        Some(Sounding { gains: model.gains.into_iter().next()?, poles: model.poles, bands })
    }
}

/// Noise in bands with the energy, and the mean time of it, of a sound that dies away.
fn noise_of(sound: &[f64], rate_hz: f64) -> Vec<Band> {
    let spectrogram = Spectrogram::new(FRAME);
    let power = spectrogram.power(sound);
    let hop_s = spectrogram.hop() as f64 / rate_hz;
    // Power that noise of unit rms has in a frame, summed over all bins.
    let unit = spectrogram.window().iter().map(|w| w * w).sum::<f64>() * FRAME as f64 / 2.0;
    let edges_hz = usual_edges_hz(rate_hz);
    let bands = edges_hz.windows(2).map(|edge| {
        let [from, to] = [edge[0], edge[1]].map(|hz| hz / rate_hz * FRAME as f64);
        let (mut energy, mut moment) = (0.0, 0.0);
        for (index, frame) in power.chunks_exact(spectrogram.bin_count()).enumerate() {
            let power = band_power(frame, from, to) / unit;
            energy += power * hop_s;
            moment += power * hop_s * (index as f64 * hop_s + 0.004);
        }
        let time_s = (moment / energy.max(f64::MIN_POSITIVE)).max(0.003);
        Band {
            edges_hz: [edge[0], edge[1]],
            weight: (energy / time_s).sqrt(),
            decay_db_per_s: 10.0 / std::f64::consts::LN_10 / time_s,
        }
    });
    bands.collect()
}

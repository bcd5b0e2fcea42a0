//! White noise for recordings that have next to none.
//!
//! The fit looks for strikes, modes and a room in what is louder than the noise between strikes.
//! Without noise it would find them in errors: in rounding, in the leakage of windows 100 dB below
//! the peak, and in pulses that are no half-sines.

use super::rises::quietest_db;
use crate::random::SplitMix64;

/// Level of the quietest frames in dB of the peak's power, below which noise is added. The frames
/// lie 6 dB below the noise: this is noise of -88 dB.
///
/// The noise of strikes on the hammer's wooden holder lies at -82 dB. Noise added to them spoiled
/// at least three of ten contact times (`cargo test -p fit --test sounds strikes_on_wood`).
const LEAST_DB: f64 = -94.0;
/// Rms of the added noise relative to the peak: -72 dB.
const ADDED: f64 = 2.5e-4;
/// Seed of the noise, so that equal recordings give equal fits.
const SEED: u64 = 1;

/// White noise that is drawn anew each time, so that it takes no memory.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct AddedNoise {
    rms: f64,
}

impl AddedNoise {
    /// Adds the noise times a factor to samples; it is the same each time.
    pub(super) fn add_to(self, samples: &mut [f64], factor: f64) {
        let mut random = SplitMix64(SEED);
        samples.iter_mut().for_each(|x| *x += factor * self.rms * random.normal());
    }
}

/// Noise to be added to a recording before it is fitted; `None` if its own is loud enough.
pub(super) fn added_noise(samples: &[f64], rate_hz: f64) -> Option<AddedNoise> {
    let peak = samples.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
    let is_loud = quietest_db(samples, rate_hz)? - 20.0 * peak.log10() > LEAST_DB;
    (!is_loud).then_some(AddedNoise { rms: ADDED * peak })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::multi_strike::synthetic::plain;

    #[test]
    fn noise_is_added_only_to_recordings_that_have_next_to_none() {
        for seed in 1..4 {
            let noise = |dbfs: f64| {
                let sound = plain(seed, 3.0, 5, dbfs);
                added_noise(&sound.samples, sound.rate_hz)
            };
            assert!(noise(-60.0).is_none() && noise(-80.0).is_none());
            assert!(noise(-120.0).is_some() && noise(-200.0).is_some());
        }
        assert!(added_noise(&[0.0; 9_000], 44_100.0).is_none() && added_noise(&[0.5; 9], 44_100.0).is_none());
    }

    #[test]
    fn noise_lies_72_db_below_the_peak_and_can_be_taken_off_again() {
        let sound = plain(1, 3.0, 5, -200.0);
        let noise = added_noise(&sound.samples, sound.rate_hz).expect("the recording has none");
        let peak = sound.samples.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
        let mut samples = sound.samples.clone();
        let off = |samples: &[f64]| -> Vec<f64> { samples.iter().zip(&sound.samples).map(|(x, y)| x - y).collect() };
        noise.add_to(&mut samples, 1.0);
        let added = off(&samples);
        let rms = (added.iter().map(|x| x * x).sum::<f64>() / added.len() as f64).sqrt();
        assert!((20.0 * (rms / peak).log10() + 72.04).abs() < 0.1, "{rms} {peak}");
        noise.add_to(&mut samples, -1.0);
        assert!(off(&samples).iter().all(|x| x.abs() < 1e-15 * peak.max(1.0)));
    }
}

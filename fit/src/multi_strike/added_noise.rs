//! White noise for recordings that have next to none.
//!
//! What is a strike and what is a mode is decided against the noise between strikes. Under noise
//! 100 dB below the peak lies what no model explains, such as rounding and the leakage of windows,
//! and all of it would count.

use super::rises::quietest_db;
use crate::random::SplitMix64;

/// Noise relative to the peak in dB below which noise is added. Recordings with noise of -94 dB are
/// fitted as they are, and those with -104 dB were refused.
const LEAST_DB: f64 = -100.0;
/// Rms of the noise that is added, relative to the peak: -72 dB. The model is then told to -105 dB;
/// with -84 dB some descents ended in poor minima.
const ADDED: f64 = 2.5e-4;
/// Seed of the noise, so that equal recordings give equal fits.
const SEED: u64 = 1;

/// Noise to be added to a recording before it is fitted; `None` if its own is loud enough.
pub(super) fn added_noise(samples: &[f64], rate_hz: f64) -> Option<Vec<f64>> {
    let peak = samples.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
    let is_loud = quietest_db(samples, rate_hz)? - 20.0 * peak.log10() > LEAST_DB;
    let mut random = SplitMix64(SEED);
    (!is_loud).then(|| samples.iter().map(|_| ADDED * peak * random.normal()).collect())
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
}

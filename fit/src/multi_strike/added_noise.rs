//! White noise for recordings that have next to none.
//!
//! The fit compares strikes and modes with the noise between strikes. Rounding and the leakage of
//! windows, 100 dB below the peak, are louder than the noise of such a recording, and would be
//! taken for strikes and modes.

use super::rises::quietest_db;
use crate::random::SplitMix64;

/// Level of the quietest frames in dB of the peak's power, below which noise is added. The frames
/// lie 6 dB below the noise: this is noise of -94 dB.
const LEAST_DB: f64 = -100.0;
/// Rms of the added noise relative to the peak: -72 dB.
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

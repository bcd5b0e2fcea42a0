//! A strike on the Bark scale: damping law, gain, spectral centroids, emergent modes
//! (dynamic-filter §IV).
//!
//! ```text
//! strike ─► spectrum ─┬► Gaussian bands, one a Bark (Fig. 6) ─► analytic signal
//!                     │                        ─► Λ e^{-αt}: damping law α(f), gain Λ(f)
//!                     ├► centroids G1, G2, G3 (eq. 18)
//!                     └► smooth part ─► emergence of modes
//! ```
//!
//! The dynamic filter is estimated from Λ and α at the three centroids (eq. 19 to 21).

mod centroids;
mod emergent;
mod filter_bank;
mod scale;

pub use centroids::Centroids;
pub use emergent::{EMERGENT_DB, emergence_db};
pub(crate) use filter_bank::{Spectrum, Subband, gaussian};
pub use scale::{HIGHEST_BARK, bark, frequency_hz, width_hz};

use serde::Serialize;

use crate::decay;

/// Fall of a band to which its decay is fitted, as a power ratio: 40 dB.
const RELEVANT: f64 = 1e-4;
/// Least power of a band over its own floor, as a ratio: 10 dB.
const OVER_FLOOR: f64 = 10.0;
/// Least power of a band relative to the loudest band, as a ratio: 50 dB.
const BELOW_LOUDEST: f64 = 1e-5;
/// Time after the strike that a band's filter smears, in standard deviations of its response in
/// time.
const SETTLED: f64 = 3.0;
/// Largest ratio of the amplitude's decay to the filter's own: a faster decay would be the
/// filter's.
const FASTEST: f64 = 1.0;

/// Least evidence for a decay over a constant, as the logarithm of a likelihood ratio.
const EVIDENCE: f64 = 10.0;

/// One band of the damping law: `Λ e^{-αt}`, t from the strike.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct DampingBand {
    /// Critical-band rate of the band's middle, a whole number of Bark.
    pub bark: f64,
    /// Middle of the band in Hz.
    pub centre_hz: f64,
    /// Λ: amplitude of the band's analytic signal at the strike, full scale 1.
    ///
    /// For a sine in the middle of the band it is the sine's amplitude, for noise √2 times the rms.
    pub gain: f64,
    /// α: decay of the amplitude in 1/s; T60 = ln(1000)/α.
    pub decay_per_s: f64,
}

impl DampingBand {
    /// T60 in seconds.
    pub fn t60_s(&self) -> f64 {
        1000f64.ln() / self.decay_per_s
    }
}

/// Damping law and centroids of a strike.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DampingLaw {
    /// Bands with energy, at least one, in order of frequency.
    pub bands: Vec<DampingBand>,
    /// Spectral centroids.
    pub centroids: Centroids,
}

impl DampingLaw {
    /// α in 1/s at a frequency in Hz, interpolated in its logarithm along the Bark scale.
    ///
    /// Beyond the first and the last band it is theirs.
    pub fn decay_per_s(&self, frequency_hz: f64) -> f64 {
        self.at(frequency_hz, |band| band.decay_per_s)
    }

    /// Λ at a frequency in Hz, interpolated in its logarithm along the Bark scale.
    ///
    /// Beyond the first and the last band it is theirs.
    pub fn gain(&self, frequency_hz: f64) -> f64 {
        self.at(frequency_hz, |band| band.gain)
    }

    fn at(&self, frequency_hz: f64, of: fn(&DampingBand) -> f64) -> f64 {
        let rate = bark(frequency_hz);
        let above = self.bands.partition_point(|band| band.bark <= rate);
        let (lower, upper) = (above.checked_sub(1).and_then(|below| self.bands.get(below)), self.bands.get(above));
        match (lower, upper) {
            (Some(lower), Some(upper)) => {
                let share = (rate - lower.bark) / (upper.bark - lower.bark);
                (of(lower).ln() * (1.0 - share) + of(upper).ln() * share).exp()
            }
            (Some(only), None) | (None, Some(only)) => of(only),
            (None, None) => 0.0,
        }
    }
}

/// Estimates damping law and centroids of a strike.
///
/// `strike` has full scale 1 and begins at its onset; `rate_hz` is its rate. Each whole number of
/// Bark below half the rate has a Gaussian band with a standard deviation of half a Bark.
/// `Λ² e^{-2αt}` and a floor are fitted to its analytic signal's power, by maximum likelihood over
/// the band's first 40 dB. Bands whose decay does not stand out of their floor are left out. `None`
/// for silence, or if no band decays.
///
/// A single mode's α is found within 1 % (a test's bound), that of decaying noise within 10 % on
/// average over bands. A decay faster than that of the band's filter cannot be measured (α above 2π
/// · half the band's width).
pub fn damping_law(strike: &[f64], rate_hz: f64) -> Option<DampingLaw> {
    let spectrum = Spectrum::of(strike, rate_hz)?;
    let centroids = centroids::centroids(&spectrum)?;
    let length_s = strike.len() as f64 / rate_hz;
    let mut loudest_band: f64 = 0.0;
    let bands: Vec<DampingBand> = (1..=HIGHEST_BARK as u32)
        .map(f64::from)
        .map(|rate| (rate, frequency_hz(rate)))
        .take_while(|(_, centre_hz)| *centre_hz < 0.49 * rate_hz)
        .filter_map(|(rate, centre_hz)| {
            let band = spectrum.bark_band(rate, centre_hz)?;
            loudest_band = band.power.iter().copied().fold(loudest_band, f64::max);
            let from_s = SETTLED * band.smear_s;
            let blocks = decay::blocks(&band.power, band.rate_hz, from_s, length_s - from_s);
            let loudest = blocks.iter().map(|block| block.power).fold(0.0, f64::max);
            let heard = blocks.iter().rposition(|block| block.power > loudest * RELEVANT)?;
            // A part of the sound after that is included, so that the fit sees the floor.
            let end = (heard + heard / 8 + 8).min(blocks.len());
            let fitted = decay::fit(blocks.get(..end)?, 1)?;
            let (power, rate_of_power) = *fitted.parts.first()?;
            let decay_per_s = 0.5 * rate_of_power;
            let smeared = decay_per_s * band.smear_s;
            let used = blocks.get(..end)?;
            let gained = decay::constant_misfit(used) - fitted.misfit;
            let heard_s: f64 = used.iter().map(|block| block.length_s).sum();
            let evidence = gained * heard_s * band.independent_per_s();
            let tells = power > OVER_FLOOR * fitted.floor && smeared < FASTEST && evidence > EVIDENCE;
            // A Gaussian filter raises an exponential by e^{(ασ)²/2}.
            let gain = power.sqrt() * (-0.5 * smeared * smeared).exp();
            tells.then_some(DampingBand { bark: rate, centre_hz, gain, decay_per_s })
        })
        .collect();
    let least = (loudest_band * BELOW_LOUDEST).sqrt();
    let bands: Vec<DampingBand> = bands.into_iter().filter(|band| band.gain > least).collect();
    (!bands.is_empty()).then_some(DampingLaw { bands, centroids })
}

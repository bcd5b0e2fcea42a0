//! A strike on the Bark scale: damping law, gain, spectral centroids, emergent modes (dynamic-filter §IV).
//!
//! ```text
//! strike ─► spectrum ─┬► Gaussian bands, one a Bark (Fig. 6) ─► analytic signal ─► Λ e^{-αt}: damping law α(f), gain Λ(f)
//!                     ├► centroids G1, G2, G3 (eq. 18)
//!                     └► smooth part ─► which modes emerge
//! ```
//!
//! What the dynamic filter is estimated from (eq. 19 to 21): Λ and α at the three centroids.

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

/// The law is fitted to a band's first so many dB, as a power ratio: 40 dB.
const RELEVANT: f64 = 1e-4;
/// A band counts if at its loudest it stands so far over its own floor, as a power ratio: 10 dB ...
const OVER_FLOOR: f64 = 10.0;
/// ... and is at most so far below the loudest band, as a power ratio: 50 dB.
const BELOW_LOUDEST: f64 = 1e-5;
/// A band's filter smears the strike's beginning: what comes so many of its standard deviations later is the band's own.
const SETTLED: f64 = 3.0;
/// Ratio of the amplitude's decay to the filter's own beyond which a band tells its filter's.
const FASTEST: f64 = 1.0;

/// By how much a decay has to explain the band better than a constant, as the logarithm of a ratio of likelihoods.
const EVIDENCE: f64 = 10.0;

/// One band of the damping law: `Λ e^{-αt}`, t from the strike.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct DampingBand {
    /// Critical-band rate of the middle, a whole number of Bark.
    pub bark: f64,
    /// Middle in Hz.
    pub centre_hz: f64,
    /// Λ: amplitude of the band's analytic signal at the strike, full scale = 1: that of a sine in the middle of the band; for noise √2 times its rms.
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

/// A strike's damping law and centroids.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DampingLaw {
    /// Bands in which there is energy, in order of frequency; at least one.
    pub bands: Vec<DampingBand>,
    /// Where the energy lies.
    pub centroids: Centroids,
}

impl DampingLaw {
    /// α in 1/s at a frequency in Hz: between the middles of bands, interpolated in its logarithm along the Bark scale; beyond the first and the
    /// last, theirs.
    pub fn decay_per_s(&self, frequency_hz: f64) -> f64 {
        self.at(frequency_hz, |band| band.decay_per_s)
    }

    /// Λ at a frequency in Hz, interpolated likewise.
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

/// Estimates damping law and centroids of a strike: `strike` at full scale 1 from its onset on, `rate_hz` its rate.
///
/// Each whole number of Bark below half the rate has a Gaussian band (standard deviation half a Bark); to its analytic signal's power
/// `Λ² e^{-2αt}` and a floor are fitted by maximum likelihood over the band's first 40 dB. Bands without a decay that stands out of their floor are
/// left out. `None` for silence, or where no band decays.
///
/// A single mode's α is met within 1 % (a test's bound); noise that dies away, within 10 % on the mean over bands. Faster than the band's filter
/// (α above 2π · half the band's width) no decay can be told.
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
            // Some of what follows belongs to the fit, so that the floor is seen.
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

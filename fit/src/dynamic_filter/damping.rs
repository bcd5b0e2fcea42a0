//! Comparison of damping laws: how well a resynthesis keeps that of a recording.

use super::model::RATE_HZ;
use crate::bark::{DampingBand, DampingLaw, damping_law};

/// Gain of a band relative to the loudest one from which the band counts, as a ratio of amplitudes:
/// 40 dB.
const COUNTED: f64 = 1e-2;

/// A counted band of a recording beside that of a resynthesis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Comparison {
    /// Band of the recording.
    pub recorded: DampingBand,
    /// Decay rate α of the resynthesis in 1/s; `None` if it shows no decay in that band.
    pub decay_per_s: Option<f64>,
}

impl Comparison {
    /// Relative error of α, without sign; 1 if the resynthesis shows no decay.
    pub fn error(&self) -> f64 {
        self.decay_per_s.map_or(1.0, |decay| (decay / self.recorded.decay_per_s - 1.0).abs())
    }
}

/// Bands that count: those of the law within 40 dB of the loudest.
pub fn counted(law: &DampingLaw) -> impl Iterator<Item = &DampingBand> {
    let loudest = law.bands.iter().map(|band| band.gain).fold(0.0, f64::max);
    law.bands.iter().filter(move |band| band.gain >= COUNTED * loudest)
}

/// Mean damping law of several resyntheses `sounds`, at 48 kHz and from the strike on.
///
/// Each band is the geometric mean over the sounds that show it. Bands that fewer than half of them
/// show are left out. `None` if no band is left.
pub fn mean_law(sounds: &[Vec<f64>]) -> Option<DampingLaw> {
    let laws: Vec<Option<DampingLaw>> = sounds.iter().map(|sound| damping_law(sound, RATE_HZ)).collect();
    mean_of(&laws)
}

/// Mean of damping laws as in [`mean_law`]; `None` stands for a sound without a law.
pub(crate) fn mean_of(all: &[Option<DampingLaw>]) -> Option<DampingLaw> {
    let laws: Vec<&DampingLaw> = all.iter().flatten().collect();
    let mut bands: Vec<DampingBand> = Vec::new();
    for rate in (1..=crate::bark::HIGHEST_BARK as u32).map(f64::from) {
        let shown: Vec<&DampingBand> =
            laws.iter().filter_map(|law| law.bands.iter().find(|band| band.bark == rate)).collect();
        if 2 * shown.len() < all.len() {
            continue;
        }
        let mean = |of: fn(&DampingBand) -> f64| {
            (shown.iter().map(|band| of(band).ln()).sum::<f64>() / shown.len() as f64).exp()
        };
        if let Some(first) = shown.first() {
            bands.push(DampingBand {
                gain: mean(|band| band.gain),
                decay_per_s: mean(|band| band.decay_per_s),
                ..**first
            });
        }
    }
    let centroids = laws.first()?.centroids;
    (!bands.is_empty()).then_some(DampingLaw { bands, centroids })
}

/// Comparison of the counted bands of a recording's law with those of a resynthesis.
pub fn compare(recorded: &DampingLaw, resynthesis: Option<&DampingLaw>) -> Vec<Comparison> {
    let found = |rate: f64| {
        let law = resynthesis?;
        law.bands.iter().find(|band| band.bark == rate).map(|band| band.decay_per_s)
    };
    counted(recorded).map(|band| Comparison { recorded: *band, decay_per_s: found(band.bark) }).collect()
}

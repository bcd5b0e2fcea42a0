//! How well a resynthesis keeps a damping law.

use super::RATE_HZ;
use crate::bark::{DampingBand, DampingLaw, damping_law};

/// Bands count whose gain is at most so far below the loudest's, as a ratio of amplitudes: 40 dB.
const COUNTED: f64 = 1e-2;

/// One counted band.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Comparison {
    /// The band of the recording.
    pub recorded: DampingBand,
    /// α of the resynthesis in 1/s; `None` where it shows no decay there.
    pub decay_per_s: Option<f64>,
}

impl Comparison {
    /// By how much α is off, as a ratio less 1, without sign; 1 where the resynthesis shows no decay.
    pub fn error(&self) -> f64 {
        self.decay_per_s.map_or(1.0, |decay| (decay / self.recorded.decay_per_s - 1.0).abs())
    }
}

/// The bands that count: those of the law within 40 dB of the loudest.
pub fn counted(law: &DampingLaw) -> impl Iterator<Item = &DampingBand> {
    let loudest = law.bands.iter().map(|band| band.gain).fold(0.0, f64::max);
    law.bands.iter().filter(move |band| band.gain >= COUNTED * loudest)
}

/// The laws of several resyntheses as one: in each band the geometric mean of those that show it, where at least half do.
///
/// `sounds` at 48 kHz, from the strike on. `None` where no band is left.
pub fn mean_law(sounds: &[Vec<f64>]) -> Option<DampingLaw> {
    let laws: Vec<Option<DampingLaw>> = sounds.iter().map(|sound| damping_law(sound, RATE_HZ)).collect();
    mean_of(&laws)
}

/// The same of the sounds' laws.
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

/// The counted bands of a recording's law beside those of a resynthesis.
pub fn compare(recorded: &DampingLaw, resynthesis: Option<&DampingLaw>) -> Vec<Comparison> {
    let found = |rate: f64| {
        let law = resynthesis?;
        law.bands.iter().find(|band| band.bark == rate).map(|band| band.decay_per_s)
    };
    counted(recorded).map(|band| Comparison { recorded: *band, decay_per_s: found(band.bark) }).collect()
}

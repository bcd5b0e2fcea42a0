//! Levels over time that a damping law asks of all bands.

use super::candidate::Candidate;
use super::rows::{Row, Span};
use crate::bark::{DampingLaw, HIGHEST_BARK, frequency_hz};
use crate::dynamic_filter::damping::counted;
use crate::dynamic_filter::lattice::{Lattice, squared};
use crate::dynamic_filter::misfit::{db_per_s, settled_s};
use crate::dynamic_filter::model::RATE_HZ;
use crate::dynamic_filter::response::{NoiseBand, sine_power_in_band};

/// Fall of a band in dB off which its decay is read.
const HEARD_DB: f64 = 40.0;
/// Fall in dB that bounds the level asked for after that.
const AFTER_DB: f64 = 52.0;
/// Weight of a band that is too quiet to count.
const QUIET_WEIGHT: f64 = 0.05;
/// Weight of a band without a law, whose level must stay below that of its nearest neighbour.
const NEIGHBOUR_WEIGHT: f64 = 0.03;
/// Maximum distance in Bark of a band without a law from its nearest neighbour with one.
const NEIGHBOURS: f64 = 3.0;
/// Weight of a level that is too high after the decay.
const AFTER_WEIGHT: f64 = 0.3;

/// The band levels over time that a law asks for.
pub(crate) struct Objective {
    /// Times in seconds after the strike.
    pub(crate) times_s: Vec<f64>,
    /// Rates of the bands in Bark: those of the law, then neighbours without a law.
    pub(crate) rates: Vec<f64>,
    /// Responses of the bands to the filter's noise.
    pub(crate) noise_bands: Vec<NoiseBand>,
    /// Levels asked for.
    pub(crate) rows: Vec<Row>,
    /// Number of bands with a law; each has an offset.
    lawful: usize,
}

impl Objective {
    /// The levels that a law asks for at times in seconds.
    pub(crate) fn new(law: &DampingLaw, times_s: &[f64]) -> Self {
        let counts: Vec<f64> = counted(law).map(|band| band.bark).collect();
        let mut rates: Vec<f64> = law.bands.iter().map(|band| band.bark).collect();
        let mut rows = Vec::new();
        for (index, band) in law.bands.iter().enumerate() {
            let weight = if counts.contains(&band.bark) { 1.0 } else { QUIET_WEIGHT };
            let decay = db_per_s(band.decay_per_s);
            let (from_s, heard_s) = (settled_s(band), HEARD_DB / decay);
            let level = |time_s: f64| 20.0 * band.gain.log10() - decay * time_s;
            let heard = Span { band: index, from_s, to_s: from_s + heard_s, weight, ceiling: false };
            rows.extend(heard.rows(times_s, level));
            let after = |time_s: f64| level(time_s).max(level(AFTER_DB / decay));
            // A noise that is louder for a moment, long after the strike, would pass for the band's
            // decay. So the level is bounded until the end.
            let end_s = times_s.last().copied().unwrap_or(0.0).max(from_s + 1.5 * heard_s);
            let faded = Span {
                band: index,
                from_s: from_s + heard_s,
                to_s: end_s,
                weight: AFTER_WEIGHT * weight,
                ceiling: true,
            };
            rows.extend(faded.rows(times_s, after));
        }
        let lawful = rates.len();
        for rate in (1..=HIGHEST_BARK as u32).map(f64::from) {
            let apart = |bark: f64| (bark - rate).abs();
            let nearest = law.bands.iter().min_by(|a, b| apart(a.bark).total_cmp(&apart(b.bark)));
            let Some(band) = nearest.filter(|band| (0.5..=NEIGHBOURS).contains(&apart(band.bark))) else { continue };
            if frequency_hz(rate) > 0.45 * RATE_HZ {
                continue;
            }
            let decay = db_per_s(band.decay_per_s);
            let level = |time_s: f64| 20.0 * band.gain.log10() - decay * time_s;
            let span = Span {
                band: rates.len(),
                from_s: 0.0,
                to_s: HEARD_DB / decay,
                weight: NEIGHBOUR_WEIGHT,
                ceiling: true,
            };
            rows.extend(span.rows(times_s, level));
            rates.push(rate);
        }
        let noise_bands = rates.iter().map(|rate| NoiseBand::new(*rate)).collect();
        Self { times_s: times_s.to_vec(), rates, noise_bands, rows, lawful }
    }

    /// Number of bands with a law.
    pub(crate) fn lawful(&self) -> usize {
        self.lawful
    }

    /// Band powers of a candidate as `[time][band]`.
    pub(crate) fn powers(&self, candidate: &Candidate) -> Vec<Vec<f64>> {
        let heard: Vec<Vec<(usize, f64)>> = candidate
            .modes
            .iter()
            .map(|mode| {
                let in_band = |(band, rate): (usize, &f64)| {
                    let heard = sine_power_in_band(mode.frequency_hz, *rate);
                    (heard > 1e-9).then_some((band, heard * mode.amplitude.powi(2)))
                };
                self.rates.iter().enumerate().filter_map(in_band).collect()
            })
            .collect();
        let at = |(time, (time_s, filter)): (usize, (&f64, &Lattice))| {
            let squared = squared(&filter.coefficients());
            let mut powers: Vec<f64> = if candidate.end.is_some_and(|end| time > end) {
                vec![0.0; self.noise_bands.len()]
            } else {
                self.noise_bands.iter().map(|band| band.power(&squared)).collect()
            };
            for (mode, heard) in candidate.modes.iter().zip(&heard) {
                let fallen = (-2.0 * mode.decay_per_s * time_s).exp();
                for (band, power) in heard {
                    if let Some(sum) = powers.get_mut(*band) {
                        *sum += power * fallen;
                    }
                }
            }
            powers
        };
        let mut powers: Vec<Vec<f64>> = self.times_s.iter().zip(&candidate.filters).enumerate().map(at).collect();
        for guide in &candidate.guides {
            let heard: Vec<f64> = self.rates.iter().map(|rate| sine_power_in_band(guide.frequency_hz, *rate)).collect();
            for (powers, own) in powers.iter_mut().zip(guide.powers(&self.times_s, &candidate.filters, candidate.end)) {
                powers.iter_mut().zip(&heard).for_each(|(power, heard)| *power += heard * own);
            }
        }
        powers
    }
}

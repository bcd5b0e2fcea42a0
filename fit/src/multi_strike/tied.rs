//! Search for modes that a fitted model lacks, with the amplitudes that its contacts ask for.
//!
//! Behind strike j a mode of gain g rings as `g G_j z^n`, `G_j = m_j Q(s, τ_j) e^{s(t_j - c_j)}`,
//! c_j the middle of the contact and t_j the beginning of the stretch. With the contacts known, all
//! stretches share the one number g, and a mode explains the energy
//! `2 |Σ_j G_j* Σ_n r z*ⁿ|² / Σ_j |G_j|² Σ_n |z|²ⁿ`. So modes are found that no single stretch
//! shows.

use std::f64::consts::PI;
use std::ops::Range;

use nalgebra::Complex;
use rayon::prelude::*;

use super::contact::Contact;
use super::free::search_range;
use super::model::{Model, segments};
use crate::modes::{Candidate, NoiseFloor, Pole, Settings, standing_out};
use crate::parabola;

type C64 = Complex<f64>;

/// Number of frequencies whose amplitudes follow from the first one's by turning it.
const RUN: usize = 1024;

/// Maximum number of stretches that are searched, those behind the strongest strikes.
const MOST_STRETCHES: usize = 24;
/// Maximum length of a stretch in seconds.
const LONGEST_S: f64 = 1.5;
/// Samples behind a contact that are left out.
const BEHIND: usize = 4;
/// Stretch behind a strike, and the strike's contact.
type Behind = (Contact, Range<usize>);

/// Poles of modes that stand out of the residual, the most significant first.
pub(crate) fn tied_modes(model: &Model, residual: &[f64], rate_hz: f64, settings: Settings) -> Vec<Pole> {
    let longest = (LONGEST_S * rate_hz) as usize;
    let mut behind: Vec<Behind> = segments(&model.strikes, residual.len(), BEHIND)
        .into_iter()
        .filter(|segment| segment.strikes.len() == 1 && segment.end > segment.free + 64)
        .map(|segment| {
            let contact = model.strikes[segment.strikes.start].contact;
            (contact, segment.free..segment.end.min(segment.free + longest))
        })
        .collect();
    behind.sort_by(|a, b| b.0.peak.total_cmp(&a.0.peak));
    behind.truncate(MOST_STRETCHES);
    let Some(length) = behind.iter().map(|(_, stretch)| stretch.len()).max() else { return Vec::new() };
    let noise: Vec<f64> = behind.iter().flat_map(|(_, stretch)| residual[stretch.clone()].iter().copied()).collect();
    let noise = NoiseFloor::of_residual(&noise);
    let range = search_range(length, rate_hz, settings);
    let threshold = 4.0 * (residual.len() as f64).ln();
    let found: Vec<Candidate> = (range.decays())
        .flat_map(|decay| peaks(&behind, residual, decay))
        .map(|(energy, pole)| Candidate { pole, significance: energy / noise.variance(pole.angular) })
        .filter(|candidate| candidate.significance > threshold && range.holds(candidate.pole.angular))
        .collect();
    let chosen = standing_out(found, threshold, settings.most_modes, length);
    chosen.into_iter().map(|candidate| candidate.pole).collect()
}

/// Frequencies at which one more mode of a decay explains most energy, with that energy.
fn peaks(behind: &[Behind], residual: &[f64], decay: f64) -> Vec<(f64, Pole)> {
    let lasting = (6.0 / decay).ceil() as usize + 2;
    let longest = behind.iter().map(|(_, stretch)| stretch.len().min(lasting)).max().unwrap_or(1);
    let size = (2 * longest).next_power_of_two().max(64);
    let transform = fourier::forward(size);
    let (mut input, mut output) = (transform.make_input_vec(), transform.make_output_vec());
    let bin = PI / (size / 2) as f64;
    let mut along = vec![C64::new(0.0, 0.0); output.len()];
    let mut sizes = vec![0.0; output.len()];
    for (contact, stretch) in behind {
        let samples = &residual[stretch.start..stretch.end.min(stretch.start + lasting)];
        let (mut weight, ratio, mut energy) = (1.0, (-decay).exp(), 0.0);
        input.fill(0.0);
        for (slot, x) in input.iter_mut().zip(samples) {
            *slot = x * weight;
            energy += weight * weight;
            weight *= ratio;
        }
        if transform.process(&mut input, &mut output).is_err() {
            continue;
        }
        let since = stretch.start as f64 - contact.middle;
        (along.par_chunks_mut(RUN).zip(sizes.par_chunks_mut(RUN)).zip(output.par_chunks(RUN)).enumerate()).for_each(
            |(run, ((along, sizes), sums))| {
                let amplitudes = Amplitudes::new(contact, since, decay, bin, run * RUN);
                for (((along, size), sum), amplitude) in along.iter_mut().zip(sizes).zip(sums).zip(amplitudes) {
                    *along += amplitude.conj() * sum;
                    *size += amplitude.norm_sqr() * energy;
                }
            },
        );
    }
    let power: Vec<f64> =
        along.iter().zip(&sizes).map(|(along, size)| 2.0 * along.norm_sqr() / size.max(1e-300)).collect();
    parabola::peaks(&power).map(|(place, power)| (power, Pole { decay, angular: bin * place })).collect()
}

/// Amplitudes behind a contact of modes of gain 1 and one decay, at evenly spaced frequencies.
///
/// They are `m Q(s, τ) e^{st}` (`super::contact`), whose exponentials turn by a constant angle from
/// one frequency to the next.
struct Amplitudes {
    exponent: C64,
    /// `e^{sτ/2}`, `e^{-sτ/2}` and `e^{st}`.
    powers: [C64; 3],
    /// Factors of the powers from one frequency to the next.
    turns: [C64; 3],
    step: f64,
    p: f64,
    peak: f64,
}

impl Amplitudes {
    /// Amplitudes `since` samples behind the contact's middle, from the frequency `first` on in
    /// steps of `step` radians per sample.
    fn new(contact: &Contact, since: f64, decay: f64, step: f64, first: usize) -> Self {
        let exponent = C64::new(-decay, step * first as f64);
        let times = [0.5 * contact.time, -0.5 * contact.time, since];
        Self {
            exponent,
            powers: times.map(|time| (exponent * time).exp()),
            turns: times.map(|time| C64::new(0.0, step * time).exp()),
            step,
            p: PI / contact.time,
            peak: contact.peak,
        }
    }
}

impl Iterator for Amplitudes {
    type Item = C64;

    fn next(&mut self) -> Option<C64> {
        let [grown, shrunk, ringing] = self.powers;
        let below = self.exponent * self.exponent + self.p * self.p;
        let amplitude = (grown + shrunk) * ringing * (self.p * self.peak) / below;
        self.powers.iter_mut().zip(&self.turns).for_each(|(power, turn)| *power *= turn);
        self.exponent.im += self.step;
        Some(amplitude)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::multi_strike::contact::strength;

    #[test]
    fn amplitudes_at_all_frequencies_are_those_of_the_contact() {
        let contact = Contact { middle: 50.0, time: 31.7, peak: 0.3 };
        let (decay, step, since) = (2e-3, 1e-3, 4321.5);
        for (index, amplitude) in Amplitudes::new(&contact, since, decay, step, 500).take(RUN).enumerate() {
            let s = C64::new(-decay, step * (500 + index) as f64);
            let expected = strength(s, contact.time).value * (s * since).exp() * contact.peak;
            assert!((amplitude - expected).norm() < 1e-10 * expected.norm() + 1e-18, "{index}: {amplitude} {expected}");
        }
    }
}

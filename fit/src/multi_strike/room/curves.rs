//! Powers of a decaying sound over time in octaves, and the search for the one that is most alike.

use crate::band::highest_hz;

/// Centre frequencies in Hz of the octaves.
const OCTAVES_HZ: [f64; 7] = [125.0, 250.0, 500.0, 1000.0, 2000.0, 4000.0, 8000.0];
/// Standard deviation of an octave's Gaussian response in octaves.
const SPREAD_OCTAVES: f64 = 0.3;
/// Length of a block in seconds.
const BLOCK_S: f64 = 0.025;
/// Share of the blocks, the last ones, that tell the noise.
const NOISE: f64 = 0.15;
/// Least ratio of the loudest block to the noise.
const OVER_NOISE: f64 = 10.0;
/// Range of the factor between two curves in dB, and its step.
const FACTORS_DB: (f64, f64) = (-40.0, 30.0);
const STEP_DB: f64 = 0.25;

/// Mean powers in blocks of 25 ms, octave by octave.
#[derive(Clone, Debug)]
pub(crate) struct Curves {
    bands: Vec<Vec<f64>>,
}

/// Curve among a row of them that is most like another.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Match {
    /// Place in the row, between two curves.
    pub(crate) place: f64,
    /// Factor by which the curve at that place is multiplied.
    pub(crate) factor: f64,
}

impl Curves {
    /// Curves of a sound that begins with its onset.
    pub(crate) fn of(sound: &[f64], rate_hz: f64) -> Self {
        let size = (sound.len() + (0.1 * rate_hz) as usize).next_power_of_two();
        let (forward, inverse) = (fourier::forward(size), fourier::inverse(size));
        let (mut padded, mut bins) = (forward.make_input_vec(), forward.make_output_vec());
        padded[..sound.len()].copy_from_slice(sound);
        let is_made = forward.process(&mut padded, &mut bins).is_ok();
        let block = ((BLOCK_S * rate_hz) as usize).max(1);
        let of_octave = |centre_hz: &f64| {
            let weight = |bin: usize| {
                let octaves = (bin as f64 * rate_hz / size as f64 / centre_hz).log2();
                (-0.5 * (octaves / SPREAD_OCTAVES).powi(2)).exp()
            };
            let mut own: Vec<_> = bins.iter().enumerate().map(|(bin, x)| x * weight(bin)).collect();
            let last = own.len() - 1;
            (own[0].im, own[last].im) = (0.0, 0.0);
            let mut filtered = inverse.make_output_vec();
            assert!(is_made && inverse.process(&mut own, &mut filtered).is_ok(), "the lengths are those of the plans");
            let power = |block: &[f64]| block.iter().map(|x| x * x).sum::<f64>() / block.len() as f64;
            filtered[..sound.len()].chunks_exact(block).map(power).collect()
        };
        let top = highest_hz(rate_hz) / std::f64::consts::SQRT_2;
        Self { bands: OCTAVES_HZ.iter().filter(|centre_hz| **centre_hz < top).map(of_octave).collect() }
    }

    /// Number of octaves.
    pub(crate) fn count(&self) -> usize {
        self.bands.len()
    }

    /// Edges of an octave in Hz.
    pub(crate) fn edges_hz(&self, band: usize) -> [f64; 2] {
        let root = std::f64::consts::SQRT_2;
        [OCTAVES_HZ[band] / root, OCTAVES_HZ[band] * root]
    }

    /// Mean of several curves; empty for none.
    pub(crate) fn mean<'a>(all: impl Iterator<Item = &'a Self>) -> Self {
        let mut sum = Self { bands: Vec::new() };
        let mut count = 0.0;
        for curves in all {
            count += 1.0;
            if sum.bands.is_empty() {
                sum = curves.clone();
                continue;
            }
            for (sum, x) in sum.bands.iter_mut().flatten().zip(curves.bands.iter().flatten()) {
                *sum += x;
            }
        }
        sum.bands.iter_mut().flatten().for_each(|x| *x /= count);
        sum
    }

    /// Power of the noise in each octave: that of the last blocks.
    pub(crate) fn floors(&self) -> Vec<f64> {
        let floor = |powers: &Vec<f64>| {
            let last = &powers[powers.len() - ((NOISE * powers.len() as f64) as usize).max(1).min(powers.len())..];
            last.iter().sum::<f64>() / last.len().max(1) as f64
        };
        self.bands.iter().map(floor).collect()
    }

    /// Place and factor of the curve that is most like that of an octave, in noise.
    ///
    /// Powers of noise have a standard deviation in proportion to their mean m, so that
    /// `Σ ln m + p/m` is least. `None` if the octave hardly stands out of the noise, or if no curve
    /// within the row is most alike.
    pub(crate) fn matched(&self, band: usize, row: &[Self], floor: f64) -> Option<Match> {
        let powers = &self.bands[band];
        let floor = floor.max(1e-30);
        if powers.iter().copied().fold(0.0, f64::max) < OVER_NOISE * floor {
            return None;
        }
        let misfit = |curve: &[f64], factor: f64| {
            let of_block = |(power, mean): (&f64, &f64)| {
                let mean = factor * mean + floor;
                mean.ln() + power / mean
            };
            powers.iter().zip(curve).map(of_block).sum::<f64>()
        };
        let steps = ((FACTORS_DB.1 - FACTORS_DB.0) / STEP_DB) as i32;
        let best: Vec<(f64, f64)> = row
            .iter()
            .map(|curves| {
                let tried = (0..=steps).map(|step| {
                    let db = FACTORS_DB.0 + STEP_DB * f64::from(step);
                    (misfit(&curves.bands[band], 10f64.powf(db / 10.0)), db)
                });
                tried.min_by(|a, b| a.0.total_cmp(&b.0)).unwrap_or((f64::INFINITY, 0.0))
            })
            .collect();
        let place = (0..best.len()).min_by(|a, b| best[*a].0.total_cmp(&best[*b].0))?;
        if place == 0 || place + 1 == best.len() {
            return None;
        }
        let (before, here, behind) = (best[place - 1], best[place], best[place + 1]);
        let bend = before.0 - 2.0 * here.0 + behind.0;
        let offset = if bend > 0.0 { (0.5 * (before.0 - behind.0) / bend).clamp(-0.5, 0.5) } else { 0.0 };
        let neighbour = if offset < 0.0 { before.1 } else { behind.1 };
        let db = here.1 + offset.abs() * (neighbour - here.1);
        Some(Match { place: place as f64 + offset, factor: 10f64.powf(db / 10.0) })
    }
}

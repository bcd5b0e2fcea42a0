//! Audible partials of a strike: peaks of its spectra that stand over what masks them.

use fourier::Complex;

use super::gammatone::threshold_db;
use crate::parabola;

/// Number of samples in a spectrum.
const SIZE: usize = 8192;
/// Times behind the onset at which spectra begin, in seconds.
const STARTS_S: [f64; 4] = [0.01, 0.15, 0.4, 0.9];
/// Level in dB SPL of the loudest bin of the first spectrum.
const LOUDEST_DB: f64 = 85.0;
/// Range of partials in Hz.
const RANGE_HZ: [f64; 2] = [50.0, 16_000.0];
/// Level in dB by which a partial stands over the median of the bins round it.
const OVER_MEDIAN_DB: f64 = 10.0;
/// Level in dB by which a partial stands over the background before the strike.
const OVER_BACKGROUND_DB: f64 = 8.0;
/// Level in dB by which a partial stands over the threshold of hearing.
const OVER_THRESHOLD_DB: f64 = 3.0;
/// Largest error of a partial's level that counts as right, in dB.
pub const RIGHT_DB: f64 = 3.0;
/// Distance in bins up to which peaks of two spectra are one partial.
const SAME_BINS: f64 = 1.5;

/// An audible partial of one spectrum.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Partial {
    /// Beginning of the spectrum behind the onset, in seconds.
    pub at_s: f64,
    /// Frequency of the peak in Hz, a whole number of bins.
    pub frequency_hz: f64,
    /// Level in dB SPL, if the loudest bin of the first spectrum has 85 dB.
    pub level_db: f64,
}

/// Peak of a spectrum.
#[derive(Clone, Copy, Debug)]
struct Peak {
    bin: usize,
    level_db: f64,
    /// Place between the bins, by a parabola through three levels.
    place: f64,
}

/// Audible partials of a strike.
#[derive(Clone, Debug)]
pub struct Partials {
    rate_hz: f64,
    calibration_db: f64,
    /// Share of the first spectrum's power in its partials.
    tonal_share: f64,
    /// First sample of each spectrum, and its partials.
    spectra: Vec<(usize, Vec<Peak>)>,
}

impl Peak {
    fn new(levels: &[f64], bin: usize) -> Self {
        let offset = parabola::top([levels[bin - 1], levels[bin], levels[bin + 1]]);
        Self { bin, level_db: levels[bin], place: bin as f64 + offset }
    }
}

impl Partials {
    /// Partials of a strike; `before` are the samples that precede it.
    pub fn new(before: &[f64], strike: &[f64], rate_hz: f64) -> Self {
        let samples = |seconds: f64| (seconds * rate_hz) as usize;
        let hz = |bin: usize| bin as f64 * rate_hz / SIZE as f64;
        let bark: Vec<f64> = (0..=SIZE / 2)
            .map(|bin| 13.0 * (0.000_76 * hz(bin)).atan() + 3.5 * (hz(bin) / 7500.0).powi(2).atan())
            .collect();
        let loudest = power(strike.get(samples(0.002)..).unwrap_or(&[])).into_iter().fold(1e-20, f64::max);
        let calibration_db = LOUDEST_DB - 10.0 * loudest.log10();
        let background = background_db(before, rate_hz, calibration_db);
        let mut spectra = Vec::new();
        let mut tonal_share = None;
        for start in STARTS_S.map(samples) {
            if start + SIZE / 2 > strike.len() {
                break;
            }
            let levels = levels_db(&strike[start..], calibration_db);
            let medians = running_medians(&levels);
            let is_peak = |bin: &usize| {
                let (bin, level) = (*bin, levels[*bin]);
                (RANGE_HZ[0]..RANGE_HZ[1]).contains(&hz(bin))
                    && levels[bin - 3..=bin + 3].iter().all(|near| *near <= level)
                    && level > threshold_db(hz(bin).max(30.0)) + OVER_THRESHOLD_DB
                    && level > background[bin] + OVER_BACKGROUND_DB
                    && level > medians[bin] + OVER_MEDIAN_DB
            };
            let peaks: Vec<usize> = (3..levels.len() - 3).filter(is_peak).collect();
            let masked = |bin: usize| {
                let masks = peaks.iter().filter(|&&masker| masker != bin).map(|&masker| {
                    let distance = bark[bin] - bark[masker];
                    if distance.abs() <= 0.02 {
                        return -100.0;
                    }
                    let slope = if distance > 0.0 { 10.0 * distance } else { -27.0 * distance };
                    levels[masker] - 14.0 - slope
                });
                masks.fold(-100.0, f64::max)
            };
            let kept = peaks.iter().filter(|&&bin| levels[bin] > masked(bin)).map(|&bin| Peak::new(&levels, bin));
            let kept: Vec<Peak> = kept.collect();
            tonal_share.get_or_insert_with(|| share_of(&kept, &levels));
            spectra.push((start, kept));
        }
        Self { rate_hz, calibration_db, tonal_share: tonal_share.unwrap_or(0.0), spectra }
    }

    /// All partials, spectrum after spectrum.
    pub fn all(&self) -> impl Iterator<Item = Partial> {
        self.spectra.iter().flat_map(|(start, partials)| {
            partials.iter().map(|peak| Partial {
                at_s: *start as f64 / self.rate_hz,
                frequency_hz: peak.bin as f64 * self.bin_hz(),
                level_db: peak.level_db,
            })
        })
    }

    /// The loudest partials of all spectra, the loudest first, with their places in [`Self::all`].
    ///
    /// Each is taken from the spectrum in which it is loudest. Its frequency lies between the bins.
    pub fn loudest(&self, count: usize) -> Vec<(usize, Partial)> {
        let places = self.spectra.iter().flat_map(|(_, partials)| partials.iter().map(|peak| peak.place));
        let between = |(partial, place): (Partial, f64)| Partial { frequency_hz: place * self.bin_hz(), ..partial };
        let mut all: Vec<(usize, Partial)> = self.all().zip(places).map(between).enumerate().collect();
        all.sort_by(|a, b| b.1.level_db.total_cmp(&a.1.level_db));
        let mut loudest: Vec<(usize, Partial)> = Vec::new();
        for (index, partial) in all {
            let is_other = |(_, other): &(usize, Partial)| {
                (other.frequency_hz - partial.frequency_hz).abs() > SAME_BINS * self.bin_hz()
            };
            if loudest.len() < count && loudest.iter().all(is_other) {
                loudest.push((index, partial));
            }
        }
        loudest
    }

    /// Share of the first spectrum's power that lies within three bins of its partials, 0 to 1.
    ///
    /// A strike whose partials have less than half is noise.
    pub fn tonal_share(&self) -> f64 {
        self.tonal_share
    }

    /// Distance of two bins in Hz.
    pub fn bin_hz(&self) -> f64 {
        self.rate_hz / SIZE as f64
    }

    /// Error of a rendering's level at each partial in dB, in the order of [`Self::all`].
    pub fn errors_db(&self, rendering: &[f64]) -> Vec<f64> {
        let mut errors = Vec::new();
        for (start, partials) in &self.spectra {
            let levels = levels_db(rendering.get(*start..).unwrap_or(&[]), self.calibration_db);
            for &Peak { bin, level_db: wanted, .. } in partials {
                let near = levels[bin - 1..=bin + 1].iter().copied().fold(f64::NEG_INFINITY, f64::max);
                errors.push(near - wanted);
            }
        }
        errors
    }

    /// Share of the partials whose level in the rendering is right within 3 dB, weighted by
    /// loudness; 0 without partials.
    pub fn matched(&self, rendering: &[f64]) -> f64 {
        let (mut right, mut sum) = (0.0, 0.0);
        for (partial, error_db) in self.all().zip(self.errors_db(rendering)) {
            let weight = 10f64.powf(0.03 * partial.level_db);
            sum += weight;
            right += if error_db.abs() <= RIGHT_DB { weight } else { 0.0 };
        }
        right / f64::max(sum, 1e-9)
    }
}

/// Share of a spectrum's power within three bins of its partials.
fn share_of(partials: &[Peak], levels: &[f64]) -> f64 {
    let power = |level: &f64| 10f64.powf(0.1 * level);
    let is_near = |bin: usize| partials.iter().any(|partial| partial.bin.abs_diff(bin) <= 3);
    let near: f64 = levels.iter().enumerate().filter(|(bin, _)| is_near(*bin)).map(|(_, level)| power(level)).sum();
    near / levels.iter().map(power).sum::<f64>().max(f64::MIN_POSITIVE)
}

/// Power of the Hann spectrum of the first 8192 samples.
fn power(samples: &[f64]) -> Vec<f64> {
    spectrum_power(samples, SIZE)
}

fn spectrum_power(samples: &[f64], size: usize) -> Vec<f64> {
    let transform = fourier::forward(size);
    let (mut input, mut output) = (transform.make_input_vec(), transform.make_output_vec());
    for (n, (slot, x)) in input.iter_mut().zip(samples).enumerate() {
        *slot = x * (0.5 - 0.5 * (std::f64::consts::TAU * n as f64 / size as f64).cos());
    }
    if transform.process(&mut input, &mut output).is_err() {
        output.iter_mut().for_each(|bin| *bin = Complex::new(0.0, 0.0));
    }
    output.iter().map(Complex::norm_sqr).collect()
}

fn levels_db(samples: &[f64], calibration_db: f64) -> Vec<f64> {
    power(samples).into_iter().map(|power| 10.0 * (power + 1e-20).log10() + calibration_db).collect()
}

/// Level in dB of the sound before a strike, as a spectrum of 8192 samples would show it.
fn background_db(before: &[f64], rate_hz: f64, calibration_db: f64) -> Vec<f64> {
    const SHORT: usize = 1024;
    let samples = |seconds: f64| (seconds * rate_hz) as usize;
    let quiet = before.get(before.len().saturating_sub(samples(0.095))..before.len().saturating_sub(64)).unwrap_or(&[]);
    if before.len() <= samples(0.05) || quiet.len() <= SHORT {
        return vec![-100.0; SIZE / 2 + 1];
    }
    let starts: Vec<usize> = (0..=quiet.len() - SHORT).step_by(SHORT / 4).collect();
    let mut mean = vec![0.0; SHORT / 2 + 1];
    for &start in &starts {
        for (mean, power) in mean.iter_mut().zip(spectrum_power(&quiet[start..start + SHORT], SHORT)) {
            *mean += power / starts.len() as f64;
        }
    }
    let level = |power: f64| 10.0 * (power * (SIZE / SHORT) as f64 + 1e-20).log10() + calibration_db;
    let at = |bin: usize| {
        let place = bin as f64 * SHORT as f64 / SIZE as f64;
        let low = (place as usize).min(SHORT / 2 - 1);
        let [from, to] = [level(mean[low]), level(mean[low + 1])];
        from + (to - from) * (place - low as f64)
    };
    (0..=SIZE / 2).map(at).collect()
}

/// Median of the 81 bins round every bin, interpolated between every eighth.
fn running_medians(levels: &[f64]) -> Vec<f64> {
    const STEP: usize = 8;
    const REACH: usize = 40;
    let coarse: Vec<f64> = (0..levels.len())
        .step_by(STEP)
        .map(|bin| {
            let mut near = levels[bin.saturating_sub(REACH)..levels.len().min(bin + REACH + 1)].to_vec();
            near.sort_by(f64::total_cmp);
            let middle = near.len() / 2;
            if near.len() % 2 == 1 { near[middle] } else { 0.5 * (near[middle - 1] + near[middle]) }
        })
        .collect();
    let at = |bin: usize| {
        let low = bin / STEP;
        let (from, to) = (coarse[low], coarse.get(low + 1).copied().unwrap_or(coarse[low]));
        from + (to - from) * (bin % STEP) as f64 / STEP as f64
    };
    (0..levels.len()).map(at).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sines(levels: &[(f64, f64)]) -> Vec<f64> {
        let at = |n: u32| {
            let sine = |&(hz, level_db): &(f64, f64)| {
                10f64.powf(level_db / 20.0) * (std::f64::consts::TAU * hz * f64::from(n) / 44_100.0).sin()
            };
            0.1 * levels.iter().map(sine).sum::<f64>()
        };
        (0..22_050).map(at).collect()
    }

    #[test]
    fn masked_partials_do_not_count_and_others_are_matched_within_3_db() {
        // 1060 Hz lies 45 dB under its neighbour a third of a Bark away.
        let partials = Partials::new(&[], &sines(&[(1_000.0, 0.0), (1_060.0, -45.0), (4_000.0, -20.0)]), 44_100.0);
        let found: Vec<f64> = partials.all().map(|partial| partial.frequency_hz.round()).collect();
        assert!(found.iter().all(|hz| (hz - 1_000.0).abs() < 5.0 || (hz - 4_000.0).abs() < 5.0), "{found:?}");
        assert!(found.len() >= 4, "{found:?}");
        assert_eq!(partials.matched(&sines(&[(1_000.0, -2.0), (4_000.0, -22.0)])), 1.0);
        let half = partials.matched(&sines(&[(1_000.0, 0.0), (4_000.0, -26.0)]));
        assert!(half > 0.5 && half < 1.0, "{half}");
    }
}

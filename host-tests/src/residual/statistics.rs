//! Energies and decays, averaged over many seeds, against the reference.

use dsp_core::noise::Sfc32;
use dsp_core::residual::ResidualBand;

use super::spectrum::{RATE_HZ, between, cut, energy_spectrum};
use super::{play, reference_bands, shaper};

/// Ratio of a measured figure to the reference's expectation, and its standard error.
#[derive(Clone, Copy, Debug)]
pub struct Measured {
    /// Measured over expected: in dB for energies, as a ratio for decays.
    pub error: f64,
    /// Standard error of `error`, in its unit.
    pub standard_error: f64,
}

/// Sounds of one strike of strength 1, each of `frames` frames, one for each seed.
pub fn sounds(bands: &[ResidualBand], seeds: u32, frames: usize) -> Vec<Vec<f64>> {
    let sound = |seed| {
        let out = play(&mut shaper(bands, seed), &[(0, 1.0)], frames);
        out.iter().map(|&x| f64::from(x) / 2f64.powi(27)).collect()
    };
    (0..seeds).map(sound).collect()
}

/// Sound that the reference describes: white noise cut sharply into bands, each under its own
/// envelope.
///
/// It does as `reference::residual::render`, whose plain textbook transforms are slow.
pub fn ideal_sound(bands: &[ResidualBand], seed: u32, frames: usize) -> Vec<f64> {
    let mut random = Sfc32::new(seed, 99);
    // The sum of twelve uniform numbers is nearly normal with variance 1.
    let mut normal = || (0..12).map(|_| f64::from(random.draw()) / 2f64.powi(32)).sum::<f64>() - 6.0;
    let noise: Vec<f64> = (0..frames).map(|_| normal()).collect();
    let mut sound = vec![0.0; frames];
    for band in reference_bands(bands) {
        let [low, high] = band.edges_hz;
        let gain = band.weight / ((high - low) / (0.5 * RATE_HZ)).sqrt();
        let per_frame = -band.decay_db_per_s * std::f64::consts::LN_10 / 20.0 / RATE_HZ;
        for (frame, (sound, wave)) in sound.iter_mut().zip(cut(&noise, band.edges_hz)).enumerate() {
            *sound += gain * wave * (per_frame * frame as f64).exp();
        }
    }
    sound
}

/// Energy between the edges of each band, in dB over the reference's expectation. It is the mean
/// over all sounds.
pub fn energies(bands: &[ResidualBand], sounds: &[Vec<f64>]) -> Vec<Measured> {
    let reference = reference_bands(bands);
    let frames = sounds[0].len();
    let bin_hz = RATE_HZ / frames as f64;
    let expected: Vec<f64> = (0..=frames / 2)
        .map(|bin| reference::residual::energy_density(&reference, bin as f64 * bin_hz) * bin_hz)
        .collect();
    let spectra: Vec<Vec<f64>> = sounds.iter().map(|sound| energy_spectrum(sound)).collect();
    reference
        .iter()
        .map(|band| {
            let each: Vec<f64> = spectra.iter().map(|spectrum| between(spectrum, band.edges_hz)).collect();
            let (mean, error) = mean_and_error(&each);
            let db = |ratio: f64| 10.0 * ratio.log10();
            Measured {
                error: db(mean / between(&expected, band.edges_hz)),
                standard_error: 10.0 / std::f64::consts::LN_10 * error / mean,
            }
        })
        .collect()
}

/// Decay of each band over the reference's, from the mean power of all sounds between its edges.
///
/// A line is fitted from `from_s` after the strike to the time at which the reference has fallen by
/// `fall_db`. The standard error comes from ten groups of sounds.
pub fn decays(bands: &[ResidualBand], sounds: &[Vec<f64>], from_s: f64, fall_db: f64) -> Vec<Measured> {
    const STEP: usize = 48;
    let of_band = |band: &ResidualBand| {
        let powers: Vec<Vec<f64>> = sounds
            .iter()
            .map(|sound| {
                let cut = cut(sound, band.edges_hz.map(f64::from));
                cut.chunks(STEP).map(|x| x.iter().map(|x| x * x).sum()).collect()
            })
            .collect();
        let last_s = from_s + fall_db / f64::from(band.decay_db_per_s);
        let slope = |powers: &mut dyn Iterator<Item = &Vec<f64>>| {
            let mut mean = vec![0.0; powers_len(sounds, STEP)];
            powers.for_each(|power| mean.iter_mut().zip(power).for_each(|(mean, power)| *mean += power));
            let second = |step: usize| (step as f64 + 0.5) * STEP as f64 / RATE_HZ;
            let points = mean.iter().enumerate().map(|(step, power)| (second(step), 10.0 * power.log10()));
            -line_slope(points.filter(|(t, _)| (from_s..last_s).contains(t)))
        };
        let whole = slope(&mut powers.iter());
        let groups: Vec<f64> = (0..10).map(|group| slope(&mut powers.iter().skip(group).step_by(10))).collect();
        let (_, error) = mean_and_error(&groups);
        let decay = f64::from(band.decay_db_per_s);
        Measured { error: whole / decay, standard_error: error / decay }
    };
    bands.iter().map(of_band).collect()
}

fn powers_len(sounds: &[Vec<f64>], step: usize) -> usize {
    sounds[0].len().div_ceil(step)
}

fn line_slope(points: impl Iterator<Item = (f64, f64)>) -> f64 {
    let points: Vec<_> = points.collect();
    let count = points.len() as f64;
    let (mean_x, mean_y) = points.iter().fold((0.0, 0.0), |(x, y), point| (x + point.0 / count, y + point.1 / count));
    let spread: f64 = points.iter().map(|(x, _)| (x - mean_x).powi(2)).sum();
    points.iter().map(|(x, y)| (x - mean_x) * (y - mean_y)).sum::<f64>() / spread
}

/// Mean of values, and the standard error of the mean.
pub fn mean_and_error(values: &[f64]) -> (f64, f64) {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let variance = values.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / (count - 1.0);
    (mean, (variance / count).sqrt())
}

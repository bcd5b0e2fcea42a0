//! Weight and decay of each residual band, from short-time levels.
//!
//! The level of noise in a frame is random: in a narrow band it scatters by decibels. So the fit
//! minimises the squared error in dB expected over all noises, not the error of the mean level.
//! Noise that would fit only by chance is penalised by its scatter.

use super::spread;
use crate::band::{Band, highest_hz};
use crate::distance::Background;
use crate::distance::{Spectrogram, band_power, erb_edges_hz, lead};
use crate::error::FitError;

/// Number of samples in a frame, as in the ERB distance.
const WINDOW: usize = 1024;
/// Number of samples before the strike at which the first frame begins.
const BEFORE: usize = WINDOW / 2;
/// Lower limit of a prior's bands in Hz, that of the ERB distance.
const LOWEST_HZ: f64 = 50.0;
/// Number of bands of a prior (physics-diffusion §4.1).
const PRIOR_BANDS: usize = 100;
/// Level, as a power ratio to the loudest band and frame, below which nothing counts: -60 dB.
const FLOOR: f64 = 1e-6;
/// Number of frames of the beginning (0.25 s), which are all used.
const FIRST_FRAMES: usize = 44;
/// Number of later frames that are used, evenly spread.
const LATER_FRAMES: usize = 150;
/// Weight of the beginning, relative to the whole.
const BEGINNING: f64 = 0.3;
/// Slowest and fastest decay in dB/s.
const DECAYS_DB_PER_S: [f64; 2] = [1.0, 5000.0];
/// Number of steps between the two in which decays are tried.
const DECAY_STEPS: i32 = 12;
/// Number of levels that are tried, from 6 dB below the floor on, 6 dB apart.
const LEVEL_STEPS: i32 = 12;
/// Medians of the four quarters of a normal distribution.
const DRAWS: [f64; 4] = [-1.15, -0.32, 0.32, 1.15];
/// Share of the other sound below which noise changes nothing.
const NEGLIGIBLE: f64 = 1e-3;
/// Number of passes until the weights of the frames settle.
///
/// A frame counts less the further it is from the recording, because its distance is the root of a
/// mean square.
const PASSES: usize = 4;

/// Edges in Hz of the 100 bands of a physical prior (physics-diffusion §4.1).
///
/// They reach from 50 Hz to 20 kHz, as far as the rate does, equally wide on the ERB scale: the
/// paper does not say where its bands lie.
pub fn prior_edges_hz(rate_hz: f64) -> Vec<f64> {
    erb_edges_hz([LOWEST_HZ, highest_hz(rate_hz)], PRIOR_BANDS)
}

/// Fits residual bands to the difference between `recording` and `model`, which begin at the strike
/// and are equally long. `before` are the samples that precede the strike.
///
/// Bands in which noise would not help get the weight 0.
///
/// # Errors
/// [`FitError::Render`] at a rate that the instrument does not play.
pub fn fit_bands(
    before: &[f64],
    recording: &[f64],
    model: &[f64],
    rate_hz: f64,
    edges_hz: &[f64],
) -> Result<Vec<Band>, FitError> {
    let background = Background::under(before, recording, rate_hz);
    let lead = lead(before, BEFORE);
    let [recording, model] = [recording, model].map(|sound| [&lead, sound].concat());
    let levels = Levels::new(&recording, &model, background.as_ref(), rate_hz, edges_hz)?;
    let mut weights = levels.counts.clone();
    let mut bands = vec![Noise::NONE; edges_hz.len().saturating_sub(1)];
    for _ in 0..PASSES {
        for band in 0..bands.len() {
            bands[band] = levels.fit(band, bands[band], &levels.leaked(band, &bands), &weights);
        }
        let mut squares = vec![0.0; weights.len()];
        for (band, &noise) in bands.iter().enumerate() {
            levels.add_squares(band, noise, &levels.leaked(band, &bands), &mut squares);
        }
        let count = bands.len().max(1) as f64;
        let weight = |(square, count_of): (&f64, &f64)| count_of / ((square / count).sqrt() + 1.0);
        weights = squares.iter().zip(&levels.counts).map(weight).collect();
    }
    let bands = bands.iter().zip(edges_hz.windows(2)).map(|(noise, edges)| Band {
        edges_hz: [edges[0], edges[1]],
        weight: noise.power.sqrt(),
        decay_db_per_s: noise.decay_db_per_s,
    });
    Ok(bands.collect())
}

/// Noise of a band: mean square at the strike, and its decay.
#[derive(Clone, Copy)]
struct Noise {
    power: f64,
    decay_db_per_s: f64,
}

impl Noise {
    const NONE: Self = Self { power: 0.0, decay_db_per_s: DECAYS_DB_PER_S[0] };
}

/// Powers of all bands in the frames that are compared.
struct Levels {
    /// Start of each frame in seconds from the strike, below 0 for frames that begin before it.
    frames: Vec<f64>,
    /// Weight of each frame: the number of frames for which it stands.
    counts: Vec<f64>,
    rate_hz: f64,
    /// Level of the recording in dB, by band and frame.
    wanted_db: Vec<Vec<f64>>,
    /// Power of the model, by band and frame.
    model: Vec<Vec<f64>>,
    floor: f64,
    /// Squared window, with a sum of 1.
    window: Vec<f64>,
    /// Power that noise of unit rms in one band (rows) has in each band.
    spread: spread::Spread,
    /// Levels of a band's noise in the four quarters of its distribution, relative to the mean.
    draws: Vec<[f64; 4]>,
    /// Share of a band's noise that falls on a mode in it.
    cells: Vec<f64>,
}

impl Levels {
    /// Levels of sounds that begin `BEFORE` samples before the strike.
    ///
    /// The steady background counts as part of the model, so that no band of the residual fills it.
    fn new(
        recording: &[f64],
        model: &[f64],
        background: Option<&Background>,
        rate_hz: f64,
        edges_hz: &[f64],
    ) -> Result<Self, FitError> {
        let spectrogram = Spectrogram::new(WINDOW);
        let count = spectrogram.frame_count(recording.len()).min(spectrogram.frame_count(model.len()));
        let step = (count / LATER_FRAMES).max(1);
        let frames: Vec<usize> = (0..count).filter(|frame| *frame < FIRST_FRAMES || frame % step == 0).collect();
        let beginning = 1.0 + BEGINNING * count as f64 / FIRST_FRAMES.min(count).max(1) as f64;
        let stands_for = |&frame: &usize| if frame < FIRST_FRAMES { beginning } else { step as f64 };
        let bins = spectrogram.bin_count();
        let edges: Vec<f64> = edges_hz.iter().map(|edge| edge / rate_hz * WINDOW as f64).collect();
        let powers = |sound: &[f64]| -> Vec<Vec<f64>> {
            let power = spectrogram.power(sound);
            let of_band = |edge: &[f64]| -> Vec<f64> {
                let at = |frame: &usize| power.get(frame * bins..(frame + 1) * bins).unwrap_or(&[]);
                frames.iter().map(|frame| band_power(at(frame), edge[0], edge[1])).collect()
            };
            edges.windows(2).map(of_band).collect()
        };
        let (wanted, mut model) = (powers(recording), powers(model));
        if let Some(background) = background.map(|background| background.bins(WINDOW)) {
            for (powers, edge) in model.iter_mut().zip(edges.windows(2)) {
                let steady = band_power(&background, edge[0], edge[1]);
                powers.iter_mut().for_each(|power| *power += steady);
            }
        }
        let floor = wanted.iter().flatten().copied().fold(f64::MIN_POSITIVE, f64::max) * FLOOR;
        let window: Vec<f64> =
            (0..WINDOW).map(|n| (std::f64::consts::PI * n as f64 / WINDOW as f64).sin().powi(4)).collect();
        let whole: f64 = window.iter().sum();
        // A Hann window smears 1.5 bins into one, which gives the number of independent complex
        // values in a band.
        let cells: Vec<f64> = edges.windows(2).map(|edge| ((edge[1] - edge[0]) / 1.5).max(1.0)).collect();
        let draws = cells.iter().map(|cells| {
            // Wilson and Hilferty's cube approximates the chi-squared distribution.
            let spread = 2.0 / (9.0 * 2.0 * cells);
            DRAWS.map(|z| (1.0 - spread + z * spread.sqrt()).max(0.05).powi(3))
        });
        Ok(Self {
            spread: spread::measured(edges_hz, rate_hz, WINDOW)?,
            draws: draws.collect(),
            cells: cells.iter().map(|cells| 1.0 / cells).collect(),
            wanted_db: wanted
                .iter()
                .map(|band| band.iter().map(|power| 10.0 * power.max(floor).log10()).collect())
                .collect(),
            model,
            floor,
            window: window.iter().map(|value| value / whole).collect(),
            rate_hz,
            counts: frames.iter().map(stands_for).collect(),
            frames: frames
                .iter()
                .map(|&frame| ((frame * spectrogram.hop()) as f64 - BEFORE as f64) / rate_hz)
                .collect(),
        })
    }

    /// Power that the other bands' noise adds to a band.
    fn leaked(&self, band: usize, noises: &[Noise]) -> Vec<f64> {
        let mut sum = vec![0.0; self.frames.len()];
        for (other, (noise, row)) in noises.iter().zip(self.spread.iter()).enumerate() {
            let share = row.get(band).copied().unwrap_or(0.0) * noise.power;
            // Power 30 dB below the floor is ignored.
            if other != band && share > 1e-3 * self.floor {
                for (sum, shape) in sum.iter_mut().zip(self.shape(noise.decay_db_per_s)) {
                    *sum += share * shape;
                }
            }
        }
        sum
    }

    /// Power that noise of unit rms in a band has in that band.
    fn own(&self, band: usize) -> f64 {
        self.spread.get(band).and_then(|row| row.get(band)).copied().unwrap_or(0.0).max(1e-9)
    }

    /// Mean of `10^{-γt/10}` under the squared window, for each frame.
    fn shape(&self, decay_db_per_s: f64) -> Vec<f64> {
        let fade = |seconds: f64| 10f64.powf(-decay_db_per_s * seconds / 10.0);
        // Means from each sample of the window on, as if the decay began there, by Horner's rule.
        let (by_sample, mut mean) = (fade(1.0 / self.rate_hz), 0.0);
        let mut means = vec![0.0; WINDOW];
        for (of_sample, window) in means.iter_mut().zip(&self.window).rev() {
            mean = window + by_sample * mean;
            *of_sample = mean;
        }
        let shape = |&start_s: &f64| {
            let before = ((-start_s * self.rate_hz).round().max(0.0) as usize).min(BEFORE);
            fade(start_s + before as f64 / self.rate_hz) * means[before]
        };
        self.frames.iter().map(shape).collect()
    }

    /// Expected squared error in dB of a frame with noise of power `noise`.
    fn square(&self, band: usize, frame: usize, noise: f64) -> f64 {
        let at = |of: &[Vec<f64>]| of.get(band).and_then(|values| values.get(frame)).copied();
        let (Some(wanted_db), Some(model)) = (at(&self.wanted_db), at(&self.model)) else { return 0.0 };
        let (Some(draws), Some(cell)) = (self.draws.get(band), self.cells.get(band)) else { return 0.0 };
        let square = |power: f64| (10.0 * power.max(self.floor).log10() - wanted_db).powi(2);
        if noise < NEGLIGIBLE * model.max(self.floor) {
            return square(model);
        }
        // Noise on a mode beats with it, so the sum is larger or smaller by this much.
        let beat = (2.0 * model * noise * cell).sqrt();
        let both = |draw: &f64| {
            let sum = model + draw * noise;
            square(sum + beat) + square((sum - beat).max(0.1 * sum))
        };
        draws.iter().map(both).sum::<f64>() / (2 * draws.len()) as f64
    }

    /// Weighted sum of expected squared errors over all frames.
    ///
    /// `power` is that of the band's own noise in a frame, before it decays by `shape`; `leaked` is
    /// that of the other bands.
    fn cost(&self, band: usize, power: f64, shape: &[f64], leaked: &[f64], weights: &[f64]) -> f64 {
        let frames = shape.iter().zip(leaked).zip(weights).enumerate();
        frames.map(|(frame, ((shape, leaked), weight))| weight * self.square(band, frame, leaked + power * shape)).sum()
    }

    fn add_squares(&self, band: usize, noise: Noise, leaked: &[f64], squares: &mut [f64]) {
        let shape = self.shape(noise.decay_db_per_s);
        for (frame, ((sum, shape), leaked)) in squares.iter_mut().zip(shape).zip(leaked).enumerate() {
            *sum += self.square(band, frame, leaked + self.own(band) * noise.power * shape);
        }
    }

    /// The noise of least cost.
    ///
    /// Found on a grid, or from `before` on, then by halving steps round the best point.
    fn fit(&self, band: usize, before: Noise, leaked: &[f64], weights: &[f64]) -> Noise {
        let [slowest, fastest] = DECAYS_DB_PER_S;
        let octaves = (fastest / slowest).ln() / f64::from(DECAY_STEPS);
        let decay = |step: f64| slowest * (octaves * step).exp();
        let power = |step: f64| self.floor * 10f64.powf((6.0 * step - 6.0) / 10.0);
        let cost = |decay_step: f64, level_step: f64| {
            self.cost(band, power(level_step), &self.shape(decay(decay_step)), leaked, weights)
        };
        let without = self.cost(band, 0.0, &self.shape(slowest), leaked, weights);
        let mut best = (without, 0.0, 0.0);
        if before.power > 0.0 {
            let level_step = (10.0 * (before.power * self.own(band) / self.floor).log10() + 6.0) / 6.0;
            let decay_step = (before.decay_db_per_s / slowest).ln() / octaves;
            best = (cost(decay_step, level_step), decay_step, level_step);
        }
        if best.0 >= without {
            best = (without, 0.0, 0.0);
            for decay_step in (0..=DECAY_STEPS).map(f64::from) {
                let shape = self.shape(decay(decay_step));
                for level_step in (0..=LEVEL_STEPS).map(f64::from) {
                    let cost = self.cost(band, power(level_step), &shape, leaked, weights);
                    if cost < best.0 {
                        best = (cost, decay_step, level_step);
                    }
                }
            }
        }
        if best.0 >= without {
            return Noise::NONE;
        }
        let mut step = 0.5;
        while step > 0.02 {
            let (_, decay_step, level_step) = best;
            let ways = [(step, 0.0), (-step, 0.0), (0.0, step), (0.0, -step), (step, step), (-step, -step)];
            for (by_decay, by_level) in ways {
                let decay_step = (decay_step + by_decay).clamp(0.0, f64::from(DECAY_STEPS));
                let cost = cost(decay_step, level_step + by_level);
                if cost < best.0 {
                    best = (cost, decay_step, level_step + by_level);
                }
            }
            if best.1 == decay_step && best.2 == level_step {
                step /= 2.0;
            }
        }
        Noise { power: power(best.2) / self.own(band), decay_db_per_s: decay(best.1) }
    }
}

#[cfg(test)]
mod tests {
    use super::super::table::with_residual;
    use super::*;
    use crate::band::usual_edges_hz;
    use crate::distance::ErbLevels;
    use crate::random::SplitMix64;
    use crate::table;

    #[test]
    fn weights_and_decays_of_noise_bands_are_recovered() {
        let rate_hz = 44_100.0;
        let edges = ErbLevels::edges_hz();
        let truth: Vec<Band> = edges
            .windows(2)
            .enumerate()
            .map(|(index, edge)| Band {
                edges_hz: [edge[0], edge[1]],
                weight: 0.1 / (1.0 + 0.1 * index as f64),
                decay_db_per_s: 60.0 + 6.0 * index as f64,
            })
            .collect();
        // Single estimates scatter; their mean over many noises has no significant bias.
        const DRAWS: u32 = 16;
        let silent = table::of_fit(
            &crate::strike::Fit::silent(rate_hz),
            &table::Provenance { name: "noise".to_owned(), source: String::new(), licence: String::new() },
        );
        let mut mean = vec![(0.0, 0.0); truth.len()];
        for seed in 0..DRAWS {
            let table = with_residual(silent.clone(), &truth, seed);
            let mut sound = crate::render::by_instrument(&table, 0.0, rate_hz, 44_100).expect("a right table");
            let mut random = SplitMix64(100 + u64::from(seed));
            sound.iter_mut().for_each(|x| *x += 1e-6 * random.normal());
            let found = fit_bands(&[], &sound, &vec![0.0; sound.len()], rate_hz, &usual_edges_hz(rate_hz))
                .expect("a usual rate");
            for ((truth, found), mean) in truth.iter().zip(&found).zip(&mut mean) {
                let level_db = 20.0 * (found.weight.max(1e-6) / truth.weight).log10();
                mean.0 += level_db / f64::from(DRAWS);
                mean.1 += found.decay_db_per_s / truth.decay_db_per_s / f64::from(DRAWS);
            }
        }
        for ((level_db, decay), truth) in mean.iter().zip(&truth) {
            println!("{:?} Hz: level {level_db:+.2} dB, decay {decay:.3}", truth.edges_hz);
        }
        let is_narrow = |band: &Band| band.edges_hz[1] - band.edges_hz[0] < 150.0;
        for ((level_db, decay), truth) in mean.iter().zip(&truth).filter(|(_, truth)| !is_narrow(truth)) {
            assert!(level_db.abs() < 1.5 && (decay - 1.0).abs() < 0.08, "{truth:?}: {level_db:+.2} dB, {decay:.3}");
        }
        // Bands narrower than a frame resolves share their power with their neighbours; their sum
        // is right.
        let power = |of: &dyn Fn(usize) -> f64| -> f64 {
            let narrow = truth.iter().enumerate().filter(|(_, band)| is_narrow(band));
            narrow.map(|(index, band)| (band.weight * 10f64.powf(of(index) / 20.0)).powi(2)).sum()
        };
        let together_db = 10.0 * (power(&|index| mean[index].0) / power(&|_| 0.0)).log10();
        assert!(together_db.abs() < 2.5, "{together_db:+.2} dB");
    }

    #[test]
    fn a_model_equal_to_the_recording_leaves_no_noise() {
        let mut random = SplitMix64(5);
        let sound: Vec<f64> = (0..20_000).map(|n| random.normal() * (-1e-4 * f64::from(n)).exp()).collect();
        let bands = fit_bands(&[], &sound, &sound, 48_000.0, &usual_edges_hz(48_000.0)).expect("a usual rate");
        assert!(bands.len() >= 40 && bands.iter().all(|band| band.weight < 1e-3), "{bands:?}");
    }
}

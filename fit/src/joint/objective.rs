//! The distance that the descent lowers, over several grids of frames.

use super::LOUDEST;
use super::cell::Moments;
use super::grid::{Cells, Frame, Grid, LEAST_SQUARE, LOUDNESS, bands};
use super::noise::{Fall, NoiseGrid};
use super::response::Response;
use super::spectra::{Shape, Slopes, Spectra};
use super::split::Split;
use crate::band::Band;
use crate::distance::Background;
use crate::distance::{ErbLevels, LSD_SECONDS, lsd_window};
use crate::hearing::{LOUDNESS_S, Partial, Partials};
use crate::vectors::{dot, sum, vectorized};
use fourier::Complex;

/// Weight of the log-spectral distance of the first 0.25 s, for each of its two window sizes.
const LSD_WEIGHT: f64 = 4.0;
/// Weights of the ERB distance: of the whole strike, and of its first 0.25 s.
const ERB_WEIGHT: f64 = 1.0;
const EARLY_ERB_WEIGHT: f64 = 0.5;
/// Weight of the loudness error of the whole strike.
const LOUDNESS_WEIGHT: f64 = 6.0;
/// Weight of the attack's frames of 128 samples.
const ATTACK_WEIGHT: f64 = 0.3;
/// Weight of the levels of partials, in long frames.
const PARTIALS_WEIGHT: f64 = 0.15;
/// Times at which the frames of partials begin behind the onset, in seconds.
const PARTIALS_S: [f64; 6] = [0.005, 0.1, 0.22, 0.4, 0.65, 1.0];
/// Weight of the levels of the loudest partials.
const LOUDEST_WEIGHT: f64 = 0.3;
/// Number of frames from 0.25 s to 4 s.
const LATER_FRAMES: usize = 30;
/// Number of frames after 4 s.
const LAST_FRAMES: usize = 20;
/// Bins at which the bands of the attack's frames begin.
const ATTACK_BINS: [f64; 9] = [0.0, 2.5, 4.5, 7.5, 11.5, 16.5, 24.5, 36.5, 64.5];
/// Number of samples in the attack's frames.
const ATTACK_SIZE: usize = 128;
/// Length of the attack behind the force, in seconds.
const ATTACK_S: f64 = 0.004;

/// Part of the distance of one grid.
struct Part {
    grid: Grid,
    spectra: Spectra,
    noise: NoiseGrid,
    /// Power of the steady background in each cell.
    background: Vec<f32>,
}

/// The distance, and what is needed to follow its slope.
pub(super) struct Objective {
    parts: Vec<Part>,
    force: Vec<f64>,
    /// Frequencies of the loudest partials in rad/sample.
    partials: Vec<f64>,
}

/// A band's power at the strike, its decay, and the derivatives by both.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct BandSlope {
    pub(super) by_power: f64,
    pub(super) by_decay: f64,
}

/// Value of the distance, and all derivatives.
pub(super) struct Slope {
    pub(super) distance: f64,
    pub(super) modes: Vec<Slopes>,
    pub(super) force_gain: f64,
    pub(super) bands: Vec<BandSlope>,
}

impl Objective {
    /// Distance from the strike in `sound` that begins at sample `onset` and ends before `end`.
    pub(super) fn new(
        sound: &[f64],
        onset: usize,
        end: usize,
        rate_hz: f64,
        force: &[f64],
        noise_edges_hz: &[f64],
        background: Option<&Background>,
    ) -> Self {
        let strike = &sound[onset..end.min(sound.len())];
        let sound = &sound[..end.min(sound.len())];
        let window = lsd_window(strike, rate_hz);
        let mut parts = Vec::new();
        let mut add = |grid: Grid| {
            let spectra = Spectra::new(&grid, force);
            let noise = NoiseGrid::new(noise_edges_hz, rate_hz, grid.size, &grid.frames, &grid.cells);
            let background = background.map_or_else(
                || vec![0.0; grid.cell_count()],
                |background| {
                    let bins: Vec<f32> = background.bins(grid.size).iter().map(|power| *power as f32).collect();
                    super::grid::powers(&grid.cells, &bins)
                },
            );
            parts.push(Part { grid, spectra, noise, background });
        };
        for size in [512usize, 2048] {
            let hop = size / 4;
            // As the log-spectral distance has them. One more short frame comes before: it has the
            // onset in its last quarter.
            let first = if size == 512 { -1 } else { 0 };
            let before = (size / 2) as i64;
            let count = ((window.end + size / 2).saturating_sub(size) / hop) as i64;
            let weight = LSD_WEIGHT / (count + 1) as f64;
            let frames = (first..=count).map(|index| index * hop as i64 - before);
            let frame = |start| Frame { start, weight: weight as f32, loudness_weight: 0.0 };
            add(Grid::new(sound, onset, size, frames.map(frame).collect(), Cells::Bins));
        }
        let cells = bands(&ErbLevels::edges_hz(), 1024, rate_hz);
        add(Grid::new(sound, onset, 1024, erb_frames(strike, rate_hz), cells).with_loudness());
        let starts: Vec<i64> = PARTIALS_S.iter().map(|seconds| (seconds * rate_hz) as i64).collect();
        let starts: Vec<i64> = starts.into_iter().filter(|start| start + 4_096 < strike.len() as i64).collect();
        let weight = PARTIALS_WEIGHT as f32 / starts.len().max(1) as f32;
        let frames = starts.into_iter().map(|start| Frame { start, weight, loudness_weight: 0.0 });
        add(Grid::new(sound, onset, 8_192, frames.collect(), Cells::Bins).with_weights());
        let partials = Partials::new(&sound[..onset], strike, rate_hz);
        let partials: Vec<Partial> = partials.loudest(LOUDEST).into_iter().map(|(_, partial)| partial).collect();
        if let Some(grid) = Grid::of_partials(sound, onset, rate_hz, &partials, LOUDEST_WEIGHT as f32) {
            add(grid);
        }
        let behind = force.len() as i64 + (ATTACK_S * rate_hz) as i64;
        let starts: Vec<i64> = (-96..behind).step_by(ATTACK_SIZE / 4).collect();
        let weight = (ATTACK_WEIGHT / starts.len() as f64) as f32;
        let frames = starts.into_iter().map(|start| Frame { start, weight, loudness_weight: 0.0 });
        let edges: Vec<f64> = ATTACK_BINS.iter().map(|bin| bin * rate_hz / ATTACK_SIZE as f64).collect();
        let cells = bands(&edges, ATTACK_SIZE, rate_hz);
        add(Grid::new(sound, onset, ATTACK_SIZE, frames.collect(), cells));
        let angular = |partial: &Partial| std::f64::consts::TAU * partial.frequency_hz / rate_hz;
        Self { parts, force: force.to_vec(), partials: partials.iter().map(angular).collect() }
    }

    /// Frequencies of the loudest partials in rad/sample.
    pub(super) fn partials(&self) -> &[f64] {
        &self.partials
    }

    /// The distance of modes `(ln z, gain)` with the noise of `bands`, and its derivatives.
    ///
    /// Derivatives of a band are by its power at the strike and by its decay in dB/s.
    pub(super) fn slope(&mut self, modes: &[(Complex<f64>, Complex<f64>)], force_gain: f64, noise: &[Band]) -> Slope {
        let responses: Vec<Response> = modes.iter().map(|mode| Response::new(mode.0, &self.force)).collect();
        let gains: Vec<Complex<f64>> = modes.iter().map(|mode| mode.1).collect();
        let mut total = Slope {
            distance: 0.0,
            modes: vec![Slopes::default(); modes.len()],
            force_gain: 0.0,
            bands: vec![BandSlope::default(); noise.len()],
        };
        for part in &mut self.parts {
            part.add(&responses, &gains, force_gain, noise, &mut total);
        }
        total
    }
}

/// Frames of the ERB distance: all of the first 0.25 s, and some of the later ones.
///
/// Loudness counts as long as the loudness error does.
fn erb_frames(strike: &[f64], rate_hz: f64) -> Vec<Frame> {
    const SIZE: usize = 1024;
    const HOP: usize = SIZE / 4;
    let count = 1 + strike.len().saturating_sub(SIZE) / HOP;
    let first = ((LSD_SECONDS * rate_hz) as usize / HOP).min(count);
    let heard = ((LOUDNESS_S * rate_hz) as usize / HOP).clamp(first, count);
    let whole = ERB_WEIGHT / count as f64;
    let early = EARLY_ERB_WEIGHT / first.max(1) as f64;
    let frame = |index: i64, stands_for: f64, early: f64, loudness: f64| Frame {
        start: index * HOP as i64,
        weight: (whole * stands_for + early) as f32,
        loudness_weight: (loudness * stands_for) as f32,
    };
    let before = (-3..0).map(|index| frame(index, 1.0, early, LOUDNESS_WEIGHT));
    let begin = (0..first as i64).map(|index| frame(index, 1.0, early, LOUDNESS_WEIGHT));
    let spread = |from: usize, to: usize, most: usize, loudness: f64| {
        let step = (to - from).div_ceil(most).max(1);
        let index = (from + step / 2..to).step_by(step);
        index.map(move |index| frame(index as i64, step as f64, 0.0, loudness))
    };
    let later = spread(first, heard, LATER_FRAMES, LOUDNESS_WEIGHT);
    before.chain(begin).chain(later).chain(spread(heard, count, LAST_FRAMES, 0.0)).collect()
}

impl Part {
    /// Adds this grid's distance and derivatives.
    fn add(
        &mut self,
        responses: &[Response],
        gains: &[Complex<f64>],
        force_gain: f64,
        noise: &[Band],
        total: &mut Slope,
    ) {
        let shapes: Vec<Shape> = responses.iter().map(|response| self.spectra.shape(response)).collect();
        self.spectra.sum(&shapes, gains, force_gain);
        let falls: Vec<Vec<Fall>> = noise.iter().map(|band| self.noise.falls(band.decay_db_per_s)).collect();
        let fall =
            |band: usize, frame: usize| falls.get(band).and_then(|falls| falls.get(frame)).copied().unwrap_or_default();
        let whole_loudness = if self.grid.threshold.is_empty() { 1.0 } else { self.whole_loudness() };
        for frame in 0..self.grid.frames.len() {
            let spectrum = self.spectra.folded(frame);
            let slope = vectorized(
                #[inline(always)]
                || self.add_frame(frame, &spectrum, noise, fall, whole_loudness, total),
            );
            self.spectra.put_slope(frame, &slope);
        }
        total.force_gain += self.spectra.gather();
        for ((shape, gain), slopes) in shapes.iter().zip(gains).zip(&mut total.modes) {
            self.spectra.slopes(shape, *gain, slopes);
        }
    }

    /// Adds a frame's distance and its derivatives by the noise; gives its slope by the bins of the
    /// modes' spectrum.
    #[inline(always)]
    fn add_frame(
        &self,
        frame: usize,
        spectrum: &Split,
        noise: &[Band],
        fall: impl Fn(usize, usize) -> Fall,
        whole_loudness: f32,
        total: &mut Slope,
    ) -> Split {
        let mut powers = self.background.clone();
        for (band, its) in noise.iter().enumerate().filter(|(_, its)| its.weight > 0.0) {
            let (first, shares) = self.noise.powers(band, frame);
            let power = (its.weight * its.weight) as f32 * fall(band, frame).0;
            for (sum, share) in powers.iter_mut().skip(first).zip(shares) {
                *sum += power * share;
            }
        }
        let (distance, slope, by_noise) = self.compare(frame, spectrum, &powers, whole_loudness);
        total.distance += distance;
        for (band, its) in noise.iter().enumerate() {
            let (first, shares) = self.noise.powers(band, frame);
            let along = dot(by_noise.get(first..).unwrap_or(&[]), shares);
            let (left, bend) = fall(band, frame);
            total.bands[band].by_power += f64::from(along * left);
            total.bands[band].by_decay += f64::from(along * bend) * its.weight * its.weight;
        }
        slope
    }

    /// Wanted loudness of all frames, each as often as it stands for.
    fn whole_loudness(&self) -> f32 {
        let frames = self.grid.wanted_loudness.chunks(self.grid.cell_count()).zip(&self.grid.frames);
        frames
            .map(|(cells, frame)| {
                frame.loudness_weight / LOUDNESS_WEIGHT as f32
                    * cells.iter().map(|loudness| loudness - 1.0).sum::<f32>()
            })
            .sum::<f32>()
            .max(1e-6)
    }

    /// Distance of a frame, its slope by the bins of the modes' spectrum, and that by the noise's
    /// power in each cell.
    #[inline(always)]
    fn compare(&self, frame: usize, spectrum: &Split, noise: &[f32], whole_loudness: f32) -> (f64, Split, Vec<f32>) {
        let count = self.grid.cell_count();
        let bins: Vec<f32> = spectrum.re.iter().zip(&spectrum.im).map(|(re, im)| re * re + im * im).collect();
        let modes = super::grid::powers(&self.grid.cells, &bins);
        let of_frame = frame * count..(frame + 1) * count;
        let (wanted, weights) = (&self.grid.wanted_ln[of_frame.clone()], &self.grid.weights[of_frame]);
        let place = self.grid.frames[frame];
        let moments: Vec<Moments> = (modes.iter().zip(noise))
            .zip(&self.grid.freedom)
            .map(|((&modes, &noise), &freedom)| Moments::new(modes, noise, self.grid.floor, freedom))
            .collect();
        // Logarithms have a loop of their own: they are calls, which would keep the other from
        // being one of vectors.
        let over: Vec<f32> = moments.iter().zip(wanted).map(|(moments, wanted)| moments.mean.ln() - wanted).collect();
        let (mut squares, mut by_modes, mut by_noise) = (vec![0.0f32; count], vec![0.0f32; count], vec![0.0f32; count]);
        let slopes = by_modes.iter_mut().zip(&mut by_noise);
        let cells = moments.iter().zip(&over).map(|(moments, over)| moments.cell(*over));
        for (((square, (by_modes, by_noise)), cell), weight) in squares.iter_mut().zip(slopes).zip(cells).zip(weights) {
            *square = weight * cell.square;
            *by_modes = weight * cell.by_modes;
            *by_noise = weight * cell.by_noise;
        }
        let rms = (sum(&squares) + LEAST_SQUARE).sqrt();
        let factor = place.weight / (2.0 * rms);
        let mut distance = f64::from(place.weight * rms);
        by_modes.iter_mut().chain(&mut by_noise).for_each(|slope| *slope *= factor);
        if !self.grid.threshold.is_empty() {
            let share = place.loudness_weight / whole_loudness;
            let wanted = &self.grid.wanted_loudness[frame * count..(frame + 1) * count];
            for cell in 0..count {
                let Moments { mean, variance, by_modes: more_modes, by_noise: more_noise, .. } = moments[cell];
                // The floor belongs to the distance in dB alone.
                let power = (mean - self.grid.floor).max(0.0);
                let over = 1.0 + power / self.grid.threshold[cell];
                let loudness = over.powf(LOUDNESS);
                let by_mean = LOUDNESS * loudness / (over * self.grid.threshold[cell]);
                let error = loudness - wanted[cell];
                let scatter = (by_mean * power).powi(2);
                let size = (error * error + scatter * variance + 1e-6).sqrt();
                distance += f64::from(share * size);
                let slope = |more: f32| share * (error * by_mean + 0.5 * scatter * more) / size;
                by_modes[cell] += slope(more_modes);
                by_noise[cell] += slope(more_noise);
            }
        }
        (distance, self.by_bin(spectrum, &by_modes), by_noise)
    }

    /// Slope by the complex bins, from that by the powers of the cells.
    #[inline(always)]
    fn by_bin(&self, spectrum: &Split, by_cell: &[f32]) -> Split {
        let mut by_power = vec![0.0f32; spectrum.re.len()];
        match &self.grid.cells {
            Cells::Bins => by_power.copy_from_slice(by_cell),
            Cells::Bands(bands) => {
                for ((first, shares), slope) in bands.iter().zip(by_cell) {
                    for (sum, share) in by_power.iter_mut().skip(*first).zip(shares) {
                        *sum += slope * share;
                    }
                }
            }
        }
        let times = |part: &[f32]| part.iter().zip(&by_power).map(|(x, slope)| 2.0 * x * slope).collect();
        Split { re: times(&spectrum.re), im: times(&spectrum.im) }
    }
}

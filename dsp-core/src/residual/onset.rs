//! A strike's own frame: noise that is ready before the strike comes.

use super::bands::{Band, Bands, Common, FRAME_TICKS};
use super::fourier::{self, Complex, Progress};
use super::job::{PAIR_CYCLES, pair_cycles, pairs_within};
use super::lines::fill_onset;
use super::stream::SLOPE_FRAMES;
use super::{ONSET_POINTS, fill_pairs, random_lines};
use crate::noise::Sfc32;
use crate::resonator::TICK_FRAMES;

/// What strikes at the reference force begin with.
#[derive(Clone, Debug)]
pub(super) struct Onset {
    /// Amplitudes of the lines.
    amplitudes: [f32; ONSET_POINTS],
    /// The noise of the next strike.
    pub(super) wave: [Complex; ONSET_POINTS],
    /// Share of the amplitude that is left after a sample.
    pub(super) per_frame: f32,
    /// Whether a strike has had the noise. Until there is new, another one has it from another place on.
    pub(super) is_used: bool,
}

impl Onset {
    pub(super) const NONE: Self =
        Self { amplitudes: [0.0; ONSET_POINTS], wave: [[0.0; 2]; ONSET_POINTS], per_frame: 1.0, is_used: false };

    /// Derives it in place, with noise for the first strike.
    pub(super) fn load(&mut self, bands: &Bands, noise: &mut Sfc32) {
        let (mut power, mut left, mut lower) = (0.0, 0.0, bands.lower());
        for band in bands.all() {
            let energy = band.strike * (band.upper - lower);
            (power, left) = (power + energy, left + energy * band.per_eighth * band.per_eighth);
            lower = band.upper;
        }
        let common = Common::of(power, left);
        let per_tick = libm::pow(f64::from(common.quarter), 1.0 / 8.0);
        let all = energy_under_window(per_tick);
        let energy = |band: &Band| f64::from(band.strike) * energy_under_window(f64::from(band.per_tick)) / all;
        fill_onset(bands, |index| bands.all().get(index).map_or(0.0, energy) as f32, &mut self.amplitudes);
        self.per_frame = common.per_frame();
        self.is_used = false;
        let mut renewal = Renewal::new(0);
        let mut wave = [[0.0; 2]; ONSET_POINTS];
        while !renewal.is_over() {
            renewal.advance(self, &mut wave, noise, u32::MAX);
        }
    }
}

/// Energy under a strike's own frame, in ticks, of which so much is left after each: until the next frame fades in, and while it does.
fn energy_under_window(per_tick: f64) -> f64 {
    const FADE_TICKS: u32 = SLOPE_FRAMES / TICK_FRAMES as u32;
    // On average over a tick: (1 - p) / -ln p.
    let within = if per_tick < 0.9999 { (1.0 - per_tick) / -libm::log(per_tick.max(1e-30)) } else { 1.0 };
    let (mut sum, mut left) = (0.0, within);
    for tick in 0..FRAME_TICKS + FADE_TICKS {
        let into = (f64::from(tick) + 0.5 - f64::from(FRAME_TICKS)) / f64::from(FADE_TICKS);
        let cosine = libm::cos(core::f64::consts::FRAC_PI_2 * into.max(0.0));
        sum += left * cosine * cosine;
        left *= per_tick;
    }
    sum
}

/// Cycles of writing the whole wave once; measured on the virtual core.
const COPY_CYCLES: u32 = 1_300;

/// New noise for the next strike, in the making.
#[derive(Clone, Copy, Debug)]
pub(super) struct Renewal {
    /// Where it is made.
    pub(super) region: usize,
    step: Step,
    left: u32,
}

#[derive(Clone, Copy, Debug)]
enum Step {
    Amplitudes,
    Lines(usize),
    Transform(Progress),
}

impl Renewal {
    /// Cycles of all of it, about.
    pub(super) const CYCLES: u32 = 2 * COPY_CYCLES + pair_cycles(ONSET_POINTS) + fourier::cycles(ONSET_POINTS);

    /// Not begun.
    pub(super) const fn new(region: usize) -> Self {
        Self { region, step: Step::Amplitudes, left: Self::CYCLES }
    }

    /// Cycles that are left to do, about.
    pub(super) fn left(&self) -> u32 {
        self.left
    }

    pub(super) fn is_over(&self) -> bool {
        matches!(self.step, Step::Transform(progress) if progress.is_over())
    }

    /// Does what costs about so many cycles in memory that begins with `wave`; at its end the noise is the strike's.
    pub(super) fn advance(&mut self, onset: &mut Onset, wave: &mut [Complex], noise: &mut Sfc32, share: u32) {
        let Some(wave) = wave.get_mut(..ONSET_POINTS) else { return };
        let mut spent = 0;
        while spent < share && !self.is_over() {
            let room = share - spent;
            match &mut self.step {
                Step::Amplitudes => {
                    for (line, &amplitude) in wave.iter_mut().zip(&onset.amplitudes) {
                        *line = [amplitude, 0.0];
                    }
                    fourier::fill_middle(wave, random_lines(noise));
                    spent += COPY_CYCLES;
                    self.step = Step::Lines(1);
                }
                Step::Lines(from) => {
                    let range = *from..pairs_within(room).saturating_add(*from).min(ONSET_POINTS / 2);
                    fill_pairs(wave, range.clone(), noise);
                    spent += range.len() as u32 * PAIR_CYCLES;
                    *from = range.end;
                    if range.end == ONSET_POINTS / 2 {
                        self.step = Step::Transform(Progress::start(ONSET_POINTS));
                    }
                }
                Step::Transform(progress) => spent += progress.advance(wave, room),
            }
        }
        self.left = self.left.saturating_sub(spent);
        if self.is_over() {
            onset.wave.copy_from_slice(wave);
            onset.is_used = false;
        }
    }
}

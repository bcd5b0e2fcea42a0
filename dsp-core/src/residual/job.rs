//! A frame in the making: its work is shared among the ticks before it sounds.

use super::bands::{Bands, Common, Cursor, Shape, When};
use super::fourier::{self, Complex, Progress};
use super::stream::{Stream, Wave};
use super::{ONSET_POINTS, line};
use crate::noise::Sfc32;

/// What comes next in the making of a frame.
#[derive(Clone, Copy, Debug)]
enum Step {
    Bands(When),
    Amplitudes(usize, Cursor),
    Lines(usize),
    Transform(Progress),
    Done,
}

/// A frame in the making.
#[derive(Clone, Copy, Debug)]
pub(super) struct Job {
    pub(super) wave: Wave,
    /// Number (0: 64 points, 3: 512) and shape.
    pub(super) frame: (usize, Shape),
    step: Step,
    /// Cycles that are left to do, about.
    left: u32,
    common: Common,
    /// Cycles that the bands have already cost in this tick.
    owed: u32,
    /// By how much strikes that came too late for it raise its energy.
    growth: f32,
}

/// Cycles of a band, of a line's amplitude and of a pair of lines, for sharing the work; measured on the virtual core.
const BAND_CYCLES: u32 = 80;
const AMPLITUDE_CYCLES: u32 = 45;
const PAIR_CYCLES: u32 = 75;

impl Job {
    pub(super) fn new(wave: Wave, frame: (usize, Shape), when: When, bands: usize) -> Self {
        let points = wave.points() as u32;
        let left = bands as u32 * BAND_CYCLES
            + points * AMPLITUDE_CYCLES
            + points / 2 * PAIR_CYCLES
            + fourier::cycles(wave.points());
        let common = Common { power: 0.0, gain: 1.0, per_frame: 1.0 };
        Self { wave, frame, step: Step::Bands(when), left, common, owed: 0, growth: 1.0 }
    }

    /// When the frame begins, where the bands are yet to be made ready for it.
    pub(super) fn when(&self) -> Option<When> {
        if let Step::Bands(when) = self.step { Some(when) } else { None }
    }

    /// The bands are ready, and said so much of the frame.
    pub(super) fn set_common(&mut self, bands: &Bands, common: Common) {
        self.common = common;
        self.owed = bands.count() as u32 * BAND_CYCLES;
        self.step = Step::Amplitudes(0, bands.lowest());
    }

    /// Energy of a strike that the bands did not know of when they were made ready.
    pub(super) fn grow(&mut self, energy: f32) {
        if !matches!(self.step, Step::Bands(_)) && self.common.power > 0.0 {
            self.growth += energy / self.common.power;
        }
    }

    /// Does the share of this tick, one of `slices` that are left.
    pub(super) fn advance(&mut self, bands: &Bands, spectrum: &mut [Complex], noise: &mut Sfc32, slices: u32) {
        let points = spectrum.len();
        let share = if slices > 1 { self.left / slices } else { u32::MAX };
        let mut spent = core::mem::take(&mut self.owed);
        while spent < share {
            let room = share - spent;
            match &mut self.step {
                Step::Amplitudes(from, cursor) => {
                    let to = points.min(*from + (room / AMPLITUDE_CYCLES) as usize + 1);
                    bands.fill_amplitudes(spectrum, *from, to, cursor);
                    spent += (to - *from) as u32 * AMPLITUDE_CYCLES;
                    *from = to;
                    if to == points {
                        fourier::fill_middle(spectrum, || line(noise));
                        self.step = Step::Lines(1);
                    }
                }
                Step::Lines(from) => {
                    let to = (points / 2).min(*from + (room / PAIR_CYCLES) as usize + 1);
                    fourier::fill_pairs(spectrum, *from..to, || line(noise));
                    spent += (to - *from) as u32 * PAIR_CYCLES;
                    *from = to;
                    if to == points / 2 {
                        self.step = Step::Transform(Progress::start(points));
                    }
                }
                Step::Transform(progress) => {
                    spent += progress.advance(spectrum, room);
                    if progress.is_over() {
                        self.step = Step::Done;
                    }
                }
                Step::Bands(_) | Step::Done => break,
            }
        }
        self.left = self.left.saturating_sub(spent);
    }

    /// The frame as it sounds. `kept` is what chokes have left of its amplitude.
    pub(super) fn stream(&self, kept: f32) -> Stream {
        let (number, shape) = self.frame;
        let unit = (ONSET_POINTS as u32) << number;
        // A quarter of the wave; see `Shape`.
        let (quarter, quarters, fade_out) = match shape {
            Shape::Steady => (unit / 2, 3, unit / 2),
            Shape::Growing | Shape::Onset => (unit / 2, 4, unit),
        };
        Stream {
            wave: self.wave,
            position: 0,
            fade_in: quarter,
            fade_out_at: quarter * quarters,
            fade_out,
            gain: kept * super::square_root(self.growth),
            per_frame: self.common.per_frame,
        }
    }
}

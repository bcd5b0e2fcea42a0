//! A frame in the making: its work is shared among the ticks before it sounds.

use super::bands::{Bands, Common, Cursor, Shape, WAITING, When, amplitude_cycles};
use super::fourier::{self, Complex, Progress};
use super::stream::{Stream, Wave};
use super::{ONSET_POINTS, fill_pairs, lines};
use crate::noise::Sfc32;

/// What comes next in the making of a frame.
#[derive(Clone, Copy, Debug)]
enum Step {
    Bands(When),
    Update { ticks: u32, kept: f32, from: usize },
    Waiting,
    Frame,
    Amplitudes(Cursor),
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
    /// Energy of strikes that came too late for it.
    late: f32,
}

/// Cycles of a band that is brought up to date after a strike (more where it still sounds), that is given the strike's energy and that is made ready, and of a pair of lines, for sharing the work; measured on the virtual core.
const UPDATE_CYCLES: u32 = 20;
const POWER_CYCLES: u32 = 60;
const WAITING_CYCLES: u32 = 50;
const BAND_CYCLES: u32 = 60;
const PAIR_CYCLES: u32 = 92;

impl Job {
    pub(super) fn new(wave: Wave, frame: (usize, Shape), when: When, bands: usize) -> Self {
        let points = wave.points() as u32;
        let of_band = BAND_CYCLES + if let When::AfterStrike(_) = when { UPDATE_CYCLES + WAITING_CYCLES } else { 0 };
        let left = bands as u32 * of_band
            + amplitude_cycles(wave.points(), bands)
            + points / 2 * PAIR_CYCLES
            + fourier::cycles(wave.points());
        let common = Common { power: 0.0, gain: 1.0, per_frame: 1.0 };
        Self { wave, frame, step: Step::Bands(when), left, common, owed: 0, late: 0.0 }
    }

    /// When the frame begins, where the bands are yet to be brought up to date for it.
    pub(super) fn when(&self) -> Option<When> {
        if let Step::Bands(when) = self.step { Some(when) } else { None }
    }

    /// Begins to bring the bands up to date after a strike: chokes have left `kept` of their energy.
    pub(super) fn begin_update(&mut self, ticks: u32, kept: f32) {
        self.step = Step::Update { ticks, kept, from: 0 };
    }

    /// The bands are ready, and said so much of the frame.
    pub(super) fn set_common(&mut self, bands: &Bands, common: Common) {
        self.common = common;
        self.owed = bands.count() as u32 * BAND_CYCLES;
        self.step = Step::Amplitudes(bands.lowest());
    }

    /// Energy of a strike that the bands did not know of when they were brought up to date.
    pub(super) fn add_late(&mut self, energy: f32) {
        if !matches!(self.step, Step::Bands(_) | Step::Update { .. } | Step::Waiting) {
            self.late += energy;
        }
    }

    /// Does the share of this tick, one of `slices` that are left; `waiting` is the energy of strikes that no band has yet.
    pub(super) fn advance(
        &mut self,
        bands: &mut Bands,
        waiting: &mut [f32; WAITING],
        spectrum: &mut [Complex],
        noise: &mut Sfc32,
        slices: u32,
    ) {
        let points = spectrum.len();
        let share = if slices > 1 { self.left / slices } else { u32::MAX };
        let mut spent = core::mem::take(&mut self.owed);
        // What cannot be cut is left to the next tick where it does not fit.
        let fits = |spent: u32, cycles: u32| spent == 0 || spent.saturating_add(cycles) <= share;
        while spent < share {
            let room = share - spent;
            match &mut self.step {
                Step::Update { ticks, kept, from } => {
                    let to = bands.count().min(*from + 8);
                    let sounding = bands.update(*from..to, *ticks, *kept);
                    spent += (to - *from) as u32 * UPDATE_CYCLES + sounding as u32 * POWER_CYCLES;
                    *from = to;
                    if to == bands.count() {
                        self.step = Step::Waiting;
                    }
                }
                Step::Waiting => {
                    let cycles = bands.count() as u32 * WAITING_CYCLES;
                    if !fits(spent, cycles) {
                        break;
                    }
                    bands.add_waiting(&core::mem::replace(waiting, [0.0; WAITING]));
                    spent += cycles;
                    self.step = Step::Frame;
                }
                Step::Frame => {
                    if !fits(spent, bands.count() as u32 * BAND_CYCLES) {
                        break;
                    }
                    let common = bands.ready(None, self.frame);
                    self.set_common(bands, common);
                    spent += core::mem::take(&mut self.owed);
                }
                Step::Amplitudes(cursor) => {
                    spent += bands.fill_amplitudes(spectrum, cursor, room);
                    if cursor.lines() == points {
                        fourier::fill_middle(spectrum, lines(noise));
                        self.step = Step::Lines(1);
                    }
                }
                Step::Lines(from) => {
                    let to = (points / 2).min(*from + (room / PAIR_CYCLES) as usize + 1);
                    fill_pairs(spectrum, *from..to, noise);
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

    /// By how much late strikes raise the whole frame's amplitude.
    fn growth(&self) -> f32 {
        let has_late = self.late > 0.0 && self.common.power > 0.0;
        if has_late { super::square_root(1.0 + self.late / self.common.power) } else { 1.0 }
    }

    /// Cycles that the next tick's share will take, about, where so many ticks are left.
    pub(super) fn share(&self, slices: u32) -> u32 {
        self.left / slices.max(1)
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
            gain: kept * self.growth(),
            per_frame: self.common.per_frame,
        }
    }
}

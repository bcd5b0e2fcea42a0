//! Streams: waves as they sound, under a window that fades in and out by quarter sines, times an
//! exponential decay.

use super::bands::FRAME_TICKS;
use super::fill::place;
use super::slope::{self, SLOPE};
use crate::fourier::{Complex, MAX_POINTS};
use crate::time::TICK_FRAMES;

/// Frames of a slope: a quarter of a wave.
const SLOPE_FRAMES: u32 = slope::SLOPE_FRAMES as u32;
/// Position of an end that does not come.
const NEVER: u32 = u32::MAX / 2;

const POINTS_LOG2: u32 = MAX_POINTS.ilog2();
/// Number of samples of a wave.
const WAVE_FRAMES: u32 = 2 * MAX_POINTS as u32;

/// A wave that sounds.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stream {
    /// Region of the stage's memory in which the wave stands.
    pub(super) region: usize,
    /// True if the wave is read backwards beyond its end, then forwards again: noise turned round
    /// has the same spectrum, and a wave that repeats would be a tone. False for a strike's own,
    /// which is heard for one whole wave from wherever it begins, and goes round.
    turns: bool,
    /// Frames since the stream began.
    position: u32,
    /// Place in the wave at which the stream began.
    start: u32,
    /// Frames of the fade in; 0 without one.
    fade_in: u32,
    /// Position at which the fade out begins.
    fade_out_at: u32,
    /// Present amplitude.
    pub(super) gain: f32,
    /// Shares of the amplitude that are left after a sample, without a hand and with one.
    per_frame: [f32; 2],
}

impl Stream {
    /// A frame, which fades in, and fades out where the next one begins.
    pub(super) fn of_frame(region: usize, gain: f32, per_frame: [f32; 2]) -> Self {
        let fade_out_at = FRAME_TICKS * TICK_FRAMES as u32;
        Self { region, turns: true, position: 0, start: 0, fade_in: SLOPE_FRAMES, fade_out_at, gain, per_frame }
    }

    /// A strike's own noise, without a fade in and with no end yet, from an even place in its wave
    /// on.
    pub(super) fn of_strike(region: usize, start: u32, gain: f32, per_frame: [f32; 2]) -> Self {
        let start = start & !1;
        Self { region, turns: false, position: 0, start, fade_in: 0, fade_out_at: NEVER, gain, per_frame }
    }

    /// True if it is a strike's own.
    pub(super) fn is_own(&self) -> bool {
        !self.turns
    }

    pub(super) fn is_over(&self) -> bool {
        self.position >= self.fade_out_at + SLOPE_FRAMES
    }

    /// True if it has not begun to fade out.
    pub(super) fn is_held(&self) -> bool {
        self.position < self.fade_out_at
    }

    /// Fades out from now on, unless it does so already.
    pub(super) fn end(&mut self) {
        self.fade_out_at = self.fade_out_at.min(self.position);
    }

    /// Sounds on, unless it fades out already.
    pub(super) fn hold(&mut self) {
        if self.is_held() {
            self.fade_out_at = NEVER;
        }
    }

    /// Ticks until its fade out is over, the one just rendered among them; `None` before it begins.
    pub(super) fn ticks_to_end(&self) -> Option<u32> {
        let left = (self.fade_out_at + SLOPE_FRAMES).saturating_sub(self.position);
        (left < SLOPE_FRAMES).then_some(left / TICK_FRAMES as u32 + 1)
    }

    /// Adds its next frames to `out` and moves on.
    pub(super) fn add_to(&mut self, memory: &[Complex; MAX_POINTS], is_choked: bool, mut out: &mut [f32]) {
        let [free, choked] = self.per_frame;
        let per_frame = if is_choked { choked } else { free };
        while !out.is_empty() {
            // To the end of the window's part or of the wave.
            let (length, part) = self.part();
            let length = length.min(WAVE_FRAMES - self.place() % WAVE_FRAMES) as usize;
            let length = length.min(out.len());
            let (now, later) = core::mem::take(&mut out).split_at_mut(length);
            match part {
                Part::In(from) => self.add_slope(memory, per_frame, (from, 1), now),
                Part::Out(from) => self.add_slope(memory, per_frame, (SLOPE.len() - 1 - from, -1), now),
                Part::Whole => self.add_flat(memory, per_frame, now),
                Part::Over => {}
            }
            self.position = self.position.saturating_add(length as u32);
            out = later;
        }
    }

    #[inline(never)]
    fn add_flat(&mut self, memory: &[Complex; MAX_POINTS], per_frame: f32, out: &mut [f32]) {
        self.add(memory, per_frame, || 1.0, out);
    }

    /// Adds frames of a slope, from a place on, up or down.
    #[inline(never)] // one copy for both: each would wait for flash anew
    fn add_slope(
        &mut self,
        memory: &[Complex; MAX_POINTS],
        per_frame: f32,
        (mut place, step): (usize, isize),
        out: &mut [f32],
    ) {
        let next = || {
            let slope = SLOPE.get(place).copied().unwrap_or(0.0);
            place = place.wrapping_add_signed(step);
            slope
        };
        self.add(memory, per_frame, next, out);
    }

    #[inline(always)]
    fn add(
        &mut self,
        memory: &[Complex; MAX_POINTS],
        per_frame: f32,
        mut window: impl FnMut() -> f32,
        mut out: &mut [f32],
    ) {
        let (mut position, mut gain) = (self.place(), self.gain);
        let turn = self.turn();
        let at = |position: u32| sample_pair(memory, position, turn);
        if position % 2 == 1
            && let Some(first) = out.split_off_first_mut()
        {
            *first += at(position)[1] * (gain * window());
            (position, gain) = (position + 1, gain * per_frame);
        }
        let (pairs, last) = out.as_chunks_mut::<2>();
        for [even, odd] in pairs {
            let [x, y] = at(position);
            // One factor at a time, so that no bit depends on the cut of runs.
            let next = gain * per_frame;
            *even += x * (gain * window());
            *odd += y * (next * window());
            (position, gain) = (position.wrapping_add(2), next * per_frame);
        }
        if let Some(last) = last.first_mut() {
            *last += at(position)[0] * (gain * window());
            gain *= per_frame;
        }
        self.gain = gain;
    }

    /// All ones while the wave is read backwards, else 0.
    #[inline(always)]
    fn turn(&self) -> u32 {
        let is_backwards = (self.place() >> (POINTS_LOG2 + 1)) & u32::from(self.turns);
        is_backwards.wrapping_neg()
    }

    /// Place in the wave, counted on beyond its end.
    #[inline(always)]
    fn place(&self) -> u32 {
        self.position.wrapping_add(self.start)
    }

    /// Part of the window at the present position, and the frames that are left of it.
    fn part(&self) -> (u32, Part) {
        let position = self.position;
        let end = self.fade_out_at + SLOPE_FRAMES;
        if position < self.fade_in {
            (self.fade_in - position, Part::In(position as usize))
        } else if position < self.fade_out_at {
            (self.fade_out_at - position, Part::Whole)
        } else if position < end {
            (end - position, Part::Out((position - self.fade_out_at) as usize))
        } else {
            (u32::MAX, Part::Over)
        }
    }
}

/// A part of a window; a slope from a frame on.
#[derive(Clone, Copy, Debug)]
enum Part {
    In(usize),
    Whole,
    Out(usize),
    Over,
}

/// Samples at an even position and the next one, or those of the pair that an odd position is in;
/// `turn` as of [`Stream::turn`].
#[inline(always)]
fn sample_pair(memory: &[Complex; MAX_POINTS], position: u32, turn: u32) -> [f32; 2] {
    let [even, odd] = memory.get(place(position ^ turn, POINTS_LOG2)).copied().unwrap_or([0.0; 2]);
    if turn == 0 { [even, odd] } else { [odd, even] }
}

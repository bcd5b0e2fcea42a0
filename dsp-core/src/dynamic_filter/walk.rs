//! The place on a strike's path, and the parameters of each frame.

use super::path::{PARAMETERS, Path};
use crate::time::TICK_FRAMES;

/// A parameter that changes linearly over a run of frames: `value + n step`.
#[derive(Clone, Copy, Debug, Default)]
#[repr(C)]
pub struct Line {
    /// Value at the next frame.
    pub value: i32,
    /// Change per frame.
    pub step: i32,
}

impl Line {
    /// True if the parameter is 0 in all frames.
    pub fn is_zero(&self) -> bool {
        (self.value, self.step) == (0, 0)
    }

    /// Moves on by a frame. The value may wrap after a segment's last frame, where it is no longer
    /// used.
    #[inline(always)]
    pub fn advance(&mut self) {
        self.value = self.value.wrapping_add(self.step);
    }
}

/// Place on the path.
#[derive(Clone, Copy, Debug)]
pub(super) struct Walk {
    /// Number of frames since the strike; it stops at the path's last breakpoint.
    time: u32,
    /// Index of the piece.
    piece: usize,
    /// First frame of the next piece; `u32::MAX` in the last piece.
    next: u32,
    /// Frame up to which [`tick`](Self::tick) may go. It is 0 until a segment of the piece has set
    /// the lines' steps, and after the path's last breakpoint.
    whole: u32,
    /// True if the lines hold the parameters that stay after the path's end.
    over: bool,
    ramps: [Ramp; PARAMETERS],
    noise: Ramp,
}

/// A parameter on the way through a piece.
#[derive(Clone, Copy, Debug)]
struct Ramp {
    /// Value at the next segment's start, with 32 bits more. It includes the correction by which
    /// the middle of a tick is right ([`Walk::segment`]).
    wide: i64,
    /// Change in a tick.
    of_tick: i64,
}

impl Ramp {
    const NOTHING: Self = Self { wide: 0, of_tick: 0 };

    fn new(value: i32, slope: i64) -> Self {
        Self {
            wide: (i64::from(value) << 32).wrapping_add(middle(slope, TICK_FRAMES as u32)),
            of_tick: slope.wrapping_mul(TICK_FRAMES as i64),
        }
    }

    /// Gives the line over the next frames, and moves the ramp to their end.
    fn segment(&mut self, slope: i64, frames: u32) -> Line {
        let shorter = middle(slope, frames).wrapping_sub(middle(slope, TICK_FRAMES as u32));
        let value = (self.wide.wrapping_add(shorter) >> 32) as i32;
        self.wide = self.wide.wrapping_add(slope.wrapping_mul(i64::from(frames)));
        Line { value, step: step(slope) }
    }
}

impl Walk {
    /// Place on an empty path.
    pub(super) const NOWHERE: Self = Self {
        time: 0,
        piece: 0,
        next: u32::MAX,
        whole: 0,
        over: false,
        ramps: [Ramp::NOTHING; PARAMETERS],
        noise: Ramp::NOTHING,
    };

    /// Goes to the path's start.
    pub(super) fn start(&mut self, path: &Path<'_>) {
        self.time = 0;
        self.enter(path, 0);
    }

    /// Goes to the path's last piece, where parameters stay.
    pub(super) fn end(&mut self, path: &Path<'_>) {
        self.time = path.last_frame();
        self.enter(path, path.pieces().len().saturating_sub(1));
    }

    fn enter(&mut self, path: &Path<'_>, piece: usize) {
        self.piece = piece;
        (self.whole, self.over) = (0, false);
        self.next = path.pieces().get(piece + 1).map_or(u32::MAX, |next| next.start);
        let Some(piece) = path.pieces().get(piece) else { return };
        for ((ramp, &value), &slope) in self.ramps.iter_mut().zip(&piece.value).zip(&piece.slope) {
            *ramp = Ramp::new(value, slope);
        }
        self.noise = Ramp::new(piece.noise, piece.noise_slope);
    }

    /// True if the path's last breakpoint is still to come.
    pub(super) fn is_under_way(&self) -> bool {
        self.next != u32::MAX
    }

    /// True before a frame, which is counted from the strike.
    pub(super) fn is_before(&self, frame: u32) -> bool {
        self.time < frame
    }

    /// Begins a segment, which lasts to the next breakpoint, or for `most` frames if that is
    /// sooner. Sets the lines, and gives the segment's number of frames.
    ///
    /// Segments begin and end only at ticks, strikes and breakpoints, so that a caller's blocks
    /// change nothing. A step has only 32 bits. To keep its rounding errors from adding up, a line
    /// is right in the middle of its segment, and each segment begins from the 64-bit parameters.
    pub(super) fn segment(
        &mut self,
        path: &Path<'_>,
        most: usize,
        lines: &mut [Line; PARAMETERS],
        noise: &mut Line,
    ) -> usize {
        if self.time >= self.next {
            self.enter(path, self.piece + 1);
        }
        let Some(piece) = path.pieces().get(self.piece) else { return most };
        let frames = most.min(TICK_FRAMES).min((self.next - self.time) as usize);
        let all = self.ramps.iter_mut().zip(&piece.slope).zip(lines);
        for ((ramp, &slope), line) in all.take(path.form.parameters()) {
            *line = ramp.segment(slope, frames as u32);
        }
        if path.has_levels {
            *noise = self.noise.segment(piece.noise_slope, frames as u32);
        }
        if self.is_under_way() {
            self.time += frames as u32;
            self.whole = self.next;
        } else {
            self.over = true;
        }
        frames
    }

    /// Number of whole ticks that are left of the piece. The lines hold its steps already.
    pub(super) fn whole_ticks(&self) -> u32 {
        self.whole.saturating_sub(self.time) / TICK_FRAMES as u32
    }

    /// Moves the time on by whole ticks.
    pub(super) fn pass(&mut self, whole_ticks: u32) {
        if self.is_under_way() {
            self.time += whole_ticks * TICK_FRAMES as u32;
        }
    }

    /// Sets the lines' values for the next whole tick, as [`segment`](Self::segment) would. The
    /// time moves on only by [`pass`](Self::pass).
    #[inline(always)]
    pub(super) fn tick(&mut self, lines: &mut [Line; PARAMETERS], parameters: usize) {
        for (ramp, line) in self.ramps.iter_mut().zip(lines).take(parameters) {
            line.value = (ramp.wide >> 32) as i32;
            ramp.wide = ramp.wide.wrapping_add(ramp.of_tick);
        }
    }

    /// Sets the value of the noise's level for the next whole tick.
    #[inline(always)]
    pub(super) fn tick_level(&mut self, level: &mut Line) {
        level.value = (self.noise.wide >> 32) as i32;
        self.noise.wide = self.noise.wide.wrapping_add(self.noise.of_tick);
    }

    /// True if the lines hold the parameters that stay after the path's end.
    pub(super) fn is_over(&self) -> bool {
        self.over
    }
}

/// Step of 32 bits that is nearest to a slope.
fn step(slope: i64) -> i32 {
    (slope.wrapping_add(1 << 31) >> 32) as i32
}

/// Correction by which a line is right in the middle of a segment: half the segment's frames times
/// the part of the slope that [`step`] leaves out, plus half a step for rounding. That part is
/// within half a step.
fn middle(slope: i64, frames: u32) -> i64 {
    i64::from(slope as i32) * i64::from(frames >> 1) + (1 << 31)
}

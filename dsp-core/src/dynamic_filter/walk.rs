//! Where a strike's path is: the parameters of each frame.

use super::path::{PARAMETERS, Path};
use crate::time::TICK_FRAMES;

/// A parameter over a run of frames: `value + n step`.
#[derive(Clone, Copy, Debug, Default)]
#[repr(C)]
pub struct Line {
    /// At the next frame.
    pub value: i32,
    /// Change a frame.
    pub step: i32,
}

impl Line {
    /// True if it is 0 in all frames.
    pub fn is_zero(&self) -> bool {
        (self.value, self.step) == (0, 0)
    }

    /// A frame on. After a segment's last frame the value is used no more, so that it may wrap.
    #[inline(always)]
    pub fn advance(&mut self) {
        self.value = self.value.wrapping_add(self.step);
    }
}

/// The place on the path.
#[derive(Clone, Copy, Debug)]
pub(super) struct Walk {
    /// Frames since the strike, up to the path's last.
    time: u32,
    /// The piece, and where the next one begins.
    piece: usize,
    next: u32,
    /// Up to here [`tick`](Self::tick) may go: 0 until a segment of the piece has set the lines'
    /// steps, and after the path's last breakpoint.
    whole: u32,
    over: bool,
    ramps: [Ramp; PARAMETERS],
    noise: Ramp,
}

/// A parameter on the way through a piece.
#[derive(Clone, Copy, Debug)]
struct Ramp {
    /// At the next segment's start, with 32 bits more, and with what makes the middle of a tick
    /// right ([`Walk::segment`]).
    wide: i64,
    /// Its change in a tick.
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

    /// The line over so many frames, after which the ramp is behind them.
    fn segment(&mut self, slope: i64, frames: u32) -> Line {
        let shorter = middle(slope, frames).wrapping_sub(middle(slope, TICK_FRAMES as u32));
        let value = (self.wide.wrapping_add(shorter) >> 32) as i32;
        self.wide = self.wide.wrapping_add(slope.wrapping_mul(i64::from(frames)));
        Line { value, step: step(slope) }
    }
}

impl Walk {
    /// On an empty path.
    pub(super) const NOWHERE: Self = Self {
        time: 0,
        piece: 0,
        next: u32::MAX,
        whole: 0,
        over: false,
        ramps: [Ramp::NOTHING; PARAMETERS],
        noise: Ramp::NOTHING,
    };

    /// To the path's start.
    pub(super) fn start(&mut self, path: &Path<'_>) {
        self.time = 0;
        self.enter(path, 0);
    }

    /// To the path's last piece, where parameters stay.
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

    /// Begins a segment, which lasts to the next breakpoint or to `most` frames: gives its frames,
    /// and sets the lines. Segments begin and end at ticks, strikes and breakpoints only, so that a
    /// caller's blocks change nothing.
    ///
    /// A step has 32 bits only. So that what it leaves out cannot add up, a line is right in the
    /// middle of its segment, and each segment begins anew from the 64-bit parameters.
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

    /// Number of whole ticks within the piece, whose steps are in the lines already.
    pub(super) fn whole_ticks(&self) -> u32 {
        self.whole.saturating_sub(self.time) / TICK_FRAMES as u32
    }

    /// Goes on by so many of them.
    pub(super) fn pass(&mut self, whole_ticks: u32) {
        if self.is_under_way() {
            self.time += whole_ticks * TICK_FRAMES as u32;
        }
    }

    /// As [`segment`](Self::segment) for the next whole tick, but for [`pass`](Self::pass).
    #[inline(always)]
    pub(super) fn tick(&mut self, lines: &mut [Line; PARAMETERS], parameters: usize) {
        for (ramp, line) in self.ramps.iter_mut().zip(lines).take(parameters) {
            line.value = (ramp.wide >> 32) as i32;
            ramp.wide = ramp.wide.wrapping_add(ramp.of_tick);
        }
    }

    /// Steps the line of the noise's level.
    #[inline(always)]
    pub(super) fn tick_level(&mut self, level: &mut Line) {
        level.value = (self.noise.wide >> 32) as i32;
        self.noise.wide = self.noise.wide.wrapping_add(self.noise.of_tick);
    }

    /// True if the lines hold what stays after the path's end.
    pub(super) fn is_over(&self) -> bool {
        self.over
    }
}

/// A slope's step of 32 bits, nearest.
fn step(slope: i64) -> i32 {
    (slope.wrapping_add(1 << 31) >> 32) as i32
}

/// Half a segment's frames of what the step leaves out, which is within half a step, and half a
/// step for rounding.
fn middle(slope: i64, frames: u32) -> i64 {
    i64::from(slope as i32) * i64::from(frames >> 1) + (1 << 31)
}

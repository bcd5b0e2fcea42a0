//! Where a strike's path is: the parameters of each frame.

use super::path::{PARAMETERS, Path};
use crate::resonator::TICK_FRAMES;

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
    /// The parameters at the next segment's start, with 32 bits more.
    wide: [i64; PARAMETERS],
}

impl Walk {
    /// On an empty path.
    pub(super) const NOWHERE: Self = Self { time: 0, piece: 0, next: u32::MAX, wide: [0; PARAMETERS] };

    /// To the path's start.
    pub(super) fn start<const N: usize>(&mut self, path: &Path<N>) {
        self.time = 0;
        self.enter(path, 0);
    }

    /// To the path's last piece, where parameters stay.
    pub(super) fn end<const N: usize>(&mut self, path: &Path<N>) {
        self.time = path.last_frame();
        self.enter(path, path.pieces().len().saturating_sub(1));
    }

    fn enter<const N: usize>(&mut self, path: &Path<N>, piece: usize) {
        self.piece = piece;
        self.next = path.pieces().get(piece + 1).map_or(u32::MAX, |next| next.start);
        if let Some(piece) = path.pieces().get(piece) {
            self.wide = piece.value.map(|value| i64::from(value) << 32);
        }
    }

    /// Whether the path's last breakpoint is still to come.
    pub(super) fn is_under_way(&self) -> bool {
        self.next != u32::MAX
    }

    /// Begins a segment, which lasts to the next breakpoint or to `most` frames: gives its frames, and sets the lines. Segments begin and end at ticks,
    /// strikes and breakpoints only, so that a caller's blocks change nothing.
    ///
    /// A step has 32 bits only. So that what it leaves out cannot add up, a line is right in the middle of its segment, and each segment begins anew from
    /// the 64-bit parameters.
    pub(super) fn segment<const N: usize>(
        &mut self,
        path: &Path<N>,
        most: usize,
        lines: &mut [Line; PARAMETERS],
    ) -> usize {
        if self.time >= self.next {
            self.enter(path, self.piece + 1);
        }
        let Some(piece) = path.pieces().get(self.piece) else { return most };
        let frames = most.min(TICK_FRAMES).min((self.next - self.time) as usize);
        let all = self.wide.iter_mut().zip(&piece.slope).zip(lines);
        for ((wide, &slope), line) in all.take(path.form.parameters()) {
            let step = (slope.wrapping_add(1 << 31) >> 32) as i32;
            // What the step leaves out, within half a step; half the segment's frames of it are added.
            let rest = slope as i32;
            let middle = i64::from(rest) * i64::from(frames as u32 >> 1);
            let value = (wide.wrapping_add(middle).wrapping_add(1 << 31) >> 32) as i32;
            *line = Line { value, step };
            *wide = wide.wrapping_add(slope.wrapping_mul(i64::from(frames as u32)));
        }
        if self.is_under_way() {
            self.time += frames as u32;
        }
        frames
    }
}

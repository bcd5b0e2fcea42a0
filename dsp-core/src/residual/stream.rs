//! A frame as it sounds: a wave under a window that fades in and out by quarter sines, times a common exponential decay.

use super::fourier::{Complex, SLOPE, SLOPE_STEPS, place};

/// Where a wave stands in a stage's memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Wave {
    /// Which region.
    pub(super) region: usize,
    /// First complex number in it.
    pub(super) first: usize,
    /// log2 of its complex numbers.
    pub(super) points_log2: u32,
}

impl Wave {
    /// Complex numbers.
    pub(super) const fn points(self) -> usize {
        1 << self.points_log2
    }

    pub(super) fn of(self, memory: &[Complex]) -> &[Complex] {
        memory.get(self.first..self.first + self.points()).unwrap_or(&[])
    }

    pub(super) fn of_mut(self, memory: &mut [Complex]) -> &mut [Complex] {
        memory.get_mut(self.first..self.first + self.points()).unwrap_or(&mut [])
    }
}

/// A wave under way. Beyond its end it is read backwards, then forwards again: noise turned round is noise of the same spectrum, and a
/// wave that repeats would be a tone.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stream {
    pub(super) wave: Wave,
    /// Frames since its beginning.
    pub(super) position: u32,
    /// Frames of the fade in; 0: at once there.
    pub(super) fade_in: u32,
    /// Where the fade out begins.
    pub(super) fade_out_at: u32,
    /// Its frames.
    pub(super) fade_out: u32,
    /// Amplitude now.
    pub(super) gain: f32,
    /// What is left of it after a frame.
    pub(super) per_frame: f32,
}

impl Stream {
    pub(super) fn is_over(&self) -> bool {
        self.position >= self.fade_out_at + self.fade_out
    }

    /// Adds so many frames and moves on; `choke` is what a hand leaves after a frame.
    pub(super) fn add_to(&mut self, memory: &[Complex], choke: f32, mut out: &mut [f32]) {
        let per_frame = self.per_frame * choke;
        while !out.is_empty() {
            // To the end of the window's part.
            let (length, slope) = self.part();
            let wave = 2 * self.wave.points() as u32;
            let length = length.min(wave - self.position % wave) as usize;
            let length = length.min(out.len());
            let (now, later) = core::mem::take(&mut out).split_at_mut(length);
            match slope {
                Some((index, step)) => self.add_slope(memory, per_frame, (index, step), now),
                None if self.position >= self.fade_out_at => {}
                None => self.add_flat(memory, per_frame, now),
            }
            self.position = self.position.saturating_add(length as u32);
            out = later;
        }
    }

    #[inline(never)]
    fn add_flat(&mut self, memory: &[Complex], per_frame: f32, mut out: &mut [f32]) {
        let (mut position, mut gain) = (self.position, self.gain);
        let (turn, points_log2) = (self.turn(), self.wave.points_log2);
        let at = |position: u32| sample_pair(memory, position, turn, points_log2);
        if position % 2 == 1
            && let Some(first) = out.split_off_first_mut()
        {
            *first += at(position)[1] * gain;
            (position, gain) = (position + 1, gain * per_frame);
        }
        let (pairs, last) = out.as_chunks_mut::<2>();
        for [even, odd] in pairs {
            let [x, y] = at(position);
            // One factor at a time, so that where a run is cut cannot change a bit.
            let next = gain * per_frame;
            *even += x * gain;
            *odd += y * next;
            (position, gain) = (position.wrapping_add(2), next * per_frame);
        }
        if let Some(last) = last.first_mut() {
            *last += at(position)[0] * gain;
            gain *= per_frame;
        }
        self.gain = gain;
    }

    #[inline(never)]
    fn add_slope(&mut self, memory: &[Complex], per_frame: f32, (mut index, step): (u32, u32), mut out: &mut [f32]) {
        let (mut position, mut gain) = (self.position, self.gain);
        let (turn, points_log2) = (self.turn(), self.wave.points_log2);
        let at = |position: u32| sample_pair(memory, position, turn, points_log2);
        let window = |index: u32| SLOPE.get(index as usize).copied().unwrap_or(0.0);
        if position % 2 == 1
            && let Some(first) = out.split_off_first_mut()
        {
            *first += at(position)[1] * (gain * window(index));
            (position, index, gain) = (position + 1, index.wrapping_add(step), gain * per_frame);
        }
        let (pairs, last) = out.as_chunks_mut::<2>();
        for [even, odd] in pairs {
            let [x, y] = at(position);
            let next = gain * per_frame;
            *even += x * (gain * window(index));
            *odd += y * (next * window(index.wrapping_add(step)));
            (position, index) = (position.wrapping_add(2), index.wrapping_add(step.wrapping_mul(2)));
            gain = next * per_frame;
        }
        if let Some(last) = last.first_mut() {
            *last += at(position)[0] * (gain * window(index));
            gain *= per_frame;
        }
        self.gain = gain;
    }

    /// All ones where the wave is read backwards.
    #[inline(always)]
    fn turn(&self) -> u32 {
        let is_backwards = (self.position >> (self.wave.points_log2 + 1)) & 1;
        is_backwards.wrapping_neg()
    }

    /// Frames left of the window's part, and where its slope stands in [`SLOPE`], with its step.
    fn part(&self) -> (u32, Option<(u32, u32)>) {
        let (steps, position) = (SLOPE_STEPS as u32, self.position);
        let end = self.fade_out_at + self.fade_out;
        if position < self.fade_in {
            let step = steps / self.fade_in;
            (self.fade_in - position, Some((position * step, step)))
        } else if position < self.fade_out_at {
            (self.fade_out_at - position, None)
        } else if position < end {
            let step = steps / self.fade_out.max(1);
            (end - position, Some(((end - position) * step, step.wrapping_neg())))
        } else {
            (u32::MAX, None)
        }
    }
}

/// The samples at an even position and the next one, or those of the pair that an odd position is in; `turn` as of [`Stream::turn`].
#[inline(always)]
fn sample_pair(memory: &[Complex], position: u32, turn: u32, points_log2: u32) -> [f32; 2] {
    let [even, odd] = memory.get(place(position ^ turn, points_log2)).copied().unwrap_or([0.0; 2]);
    if turn == 0 { [even, odd] } else { [odd, even] }
}

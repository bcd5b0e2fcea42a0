//! Sound of a voice's filters over a run of frames.

use super::state::{Filters, PAST};
use crate::fixed;
use crate::time::TICK_FRAMES;

/// Work of a voice's filters over a run of frames.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct FilterWork {
    /// Frames that the dynamic filter rendered.
    pub filter_frames: u32,
    /// Loop-frames: those frames times the filter's loops.
    pub loop_frames: u32,
    /// Biquad-frames: frames that the biquads rendered times their number.
    pub biquad_frames: u32,
}

impl Filters<'_> {
    /// Adds a run from a frame of the tick, within that tick, to the pad's bus.
    ///
    /// `force` is the force over the run, if any. `modes` are the sound of the object's modes if
    /// they go through the dynamic filter.
    pub fn render(
        &mut self,
        frame: usize,
        force: Option<&[i32]>,
        modes: Option<&mut [i32]>,
        bus: &mut [i32],
    ) -> FilterWork {
        self.align(frame);
        let (mut work, frames) = (FilterWork::default(), bus.len() as u32);
        if self.has_biquads() {
            let force = force.filter(|_| !self.deaf);
            if force.is_some() || self.biquads.is_ringing() {
                work.biquad_frames = frames * self.biquads.size().0 as u32;
            }
            self.biquads.render(force, bus);
            self.struck &= !self.biquads.is_ringing();
        }
        let modes = modes.filter(|_| self.takes_modes());
        if modes.is_some() || self.dynamic.is_ringing() {
            (work.filter_frames, work.loop_frames) = (frames, frames * self.loop_count);
        }
        let mut modes = modes;
        if let Some(modes) = &mut modes {
            let half = (1 << self.louder) >> 1;
            modes.iter_mut().for_each(|mode| *mode = mode.saturating_add(half) >> self.louder);
        }
        if self.choke.is_open() {
            self.add_dynamic(modes.as_deref(), bus);
        } else {
            self.add_choked(modes, bus);
        }
        self.since = self.since.saturating_add(frames).min(PAST);
        self.frame = (self.frame + bus.len()) % TICK_FRAMES;
        if self.frame == 0 && self.choke.settle() {
            self.dynamic.mute();
            self.since = PAST;
        }
        work
    }

    /// Adds a run of the dynamic filter to a bus.
    fn add_dynamic(&mut self, modes: Option<&[i32]>, bus: &mut [i32]) {
        if modes.is_some() || self.dynamic.is_ringing() {
            self.dynamic.render(modes, bus);
        } else {
            self.dynamic.pass(bus.len());
        }
    }

    /// Adds a run of the dynamic filter to a bus under a choke.
    ///
    /// The share that the choke takes of a frame changes only at ticks, strikes and breakpoints, so
    /// that a caller's blocks change nothing.
    #[inline(never)]
    fn add_choked(&mut self, mut modes: Option<&mut [i32]>, bus: &mut [i32]) {
        let (mut sound, mut since, mut frame) = ([0; TICK_FRAMES], self.since, self.frame);
        let Some(mut rest) = sound.get_mut(..bus.len()) else { return };
        while !rest.is_empty() {
            let mut frames = rest.len();
            // The filter is silent up to the first sample of the modes that is not 0.
            let given = modes.as_deref().unwrap_or(&[]);
            let waits = if self.dynamic.is_ringing() {
                0
            } else {
                given.iter().position(|&mode| mode != 0).unwrap_or(frames).min(frames)
            };
            if waits > 0 {
                self.choke.rest();
                frames = waits;
            } else {
                if self.choke.frames() == 0 {
                    let (frames, falls) = self.levels.falls(since, (TICK_FRAMES - frame) as u32);
                    self.choke.plan(frames, falls);
                }
                frames = frames.min(self.choke.frames() as usize);
            }
            let Some((now, later)) = core::mem::take(&mut rest).split_at_mut_checked(frames) else { return };
            let given = modes.take().and_then(|given| given.split_at_mut_checked(frames)).map(|(given, more)| {
                modes = Some(more);
                if waits == 0 {
                    self.choke.raise(given);
                }
                &*given
            });
            self.add_dynamic(given, now);
            if waits == 0 {
                self.choke.fade(now);
            }
            (rest, since, frame) =
                (later, since.saturating_add(frames as u32).min(PAST), (frame + frames) % TICK_FRAMES);
        }
        bus.iter_mut().zip(&sound).for_each(|(bus, &x)| *bus = fixed::qadd(*bus, x));
    }
}

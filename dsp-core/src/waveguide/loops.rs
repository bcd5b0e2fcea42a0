//! The loops at work.

use super::SILENCE;
use super::band::{Loop, LoopError, check};
use crate::SampleRate;
use crate::biquad::{Bank, Biquad, Root};
use crate::dynamic_filter::{Breakpoint, Filter};
use crate::fixed::qadd;
use crate::resonator::TICK_FRAMES;

/// At most `LOOPS` loops with at most `FRAMES` frames of delay round a dynamic filter of at most `N` breakpoints.
///
/// Worst SNR against `f64` at a T60 of 20 s: `cargo test -p host-tests --test waveguides -- --nocapture`.
#[derive(Clone, Debug)]
pub struct Waveguides<const N: usize, const LOOPS: usize, const FRAMES: usize> {
    filter: Filter<N>,
    bands: [Bank<1>; LOOPS],
    delays: [usize; LOOPS],
    count: usize,
    /// s, a ring.
    line: [i32; FRAMES],
    place: usize,
    frame: usize,
    peak: u32,
    quiet_frames: usize,
    ringing: bool,
}

impl<const N: usize, const LOOPS: usize, const FRAMES: usize> Waveguides<N, LOOPS, FRAMES> {
    /// Loops at rest round a filter at rest. `path` is what the filter was made of.
    ///
    /// # Errors
    /// [`LoopError`].
    pub fn new(
        filter: Filter<N>,
        path: impl Iterator<Item = Breakpoint> + Clone,
        loops: impl Iterator<Item = Loop> + Clone,
        rate: SampleRate,
    ) -> Result<Self, LoopError> {
        let count = loops.clone().count();
        if count > LOOPS {
            return Err(LoopError::Room { needed: count, room: LOOPS });
        }
        let mut biquads = [Biquad { pole: Root { real: 0.0, imaginary: 0.0 }, numerator: [0.0; 3] }; LOOPS];
        let mut delays = [0; LOOPS];
        for (index, ((one, delay), biquad)) in loops.zip(&mut delays).zip(&mut biquads).enumerate() {
            (*delay, *biquad) = one.derive(index, rate)?;
            if *delay > FRAMES {
                return Err(LoopError::Room { needed: *delay, room: FRAMES });
            }
        }
        let used = biquads.get(..count).unwrap_or(&[]);
        check(used, path, rate)?;
        let mut banks = [const { Bank::EMPTY }; LOOPS];
        for (index, (bank, biquad)) in banks.iter_mut().zip(used).enumerate() {
            bank.load(&[*biquad], 1).map_err(|_| LoopError::Band { index })?;
        }
        Ok(Self {
            filter,
            bands: banks,
            delays,
            count,
            line: [0; FRAMES],
            place: 0,
            frame: 0,
            peak: 0,
            quiet_frames: 0,
            ringing: false,
        })
    }

    /// A strike: noise of a level from 0 to 1, the path from its start.
    pub fn strike(&mut self, level: f32) {
        self.filter.strike_with_noise(level);
        (self.ringing, self.quiet_frames) = (true, 0);
    }

    /// Whether anything sounds; false means that a block costs nothing.
    pub fn is_ringing(&self) -> bool {
        self.ringing
    }

    /// How many loops.
    pub fn count(&self) -> usize {
        self.count
    }

    /// Clears what rings.
    pub fn rest(&mut self) {
        self.filter.rest();
        self.bands.iter_mut().for_each(Bank::rest);
        self.line.fill(0);
        self.ringing = false;
    }

    /// Adds s to `out`.
    pub fn render(&mut self, modes: Option<&[i32]>, out: &mut [i32]) {
        let (mut modes, mut out) = (modes.unwrap_or(&[]), out);
        while !out.is_empty() {
            if self.frame == 0 {
                self.tick();
            }
            let frames = out.len().min(TICK_FRAMES - self.frame);
            let (now, later) = out.split_at_mut(frames);
            let (given, more) = modes.split_at(frames.min(modes.len()));
            modes = more;
            if self.ringing || given.iter().any(|&mode| mode != 0) {
                self.ringing = true;
                self.run(given, now);
            } else {
                let mut nothing = [0; TICK_FRAMES];
                self.filter.render(None, nothing.get_mut(..frames).unwrap_or(&mut []));
                self.bands.iter_mut().for_each(|band| band.render(None, nothing.get_mut(..frames).unwrap_or(&mut [])));
            }
            self.frame = (self.frame + frames) % TICK_FRAMES;
            out = later;
        }
    }

    fn tick(&mut self) {
        self.quiet_frames = if self.peak < SILENCE { self.quiet_frames + TICK_FRAMES } else { 0 };
        self.peak = 0;
        if self.ringing && !self.filter.is_sounding() && self.quiet_frames > FRAMES {
            self.rest();
        }
    }

    fn run(&mut self, modes: &[i32], out: &mut [i32]) {
        let frames = out.len();
        let (mut feedback, mut sound) = ([0; TICK_FRAMES], [0; TICK_FRAMES]);
        let (Some(feedback), Some(sound)) = (feedback.get_mut(..frames), sound.get_mut(..frames)) else { return };
        for (band, &delay) in self.bands.iter_mut().zip(&self.delays).take(self.count) {
            let mut delayed = [0; TICK_FRAMES];
            let start = (self.place + FRAMES - delay) % FRAMES;
            let ring = self.line.iter().skip(start).chain(self.line.iter());
            delayed.iter_mut().zip(ring).take(frames).for_each(|(word, &s)| *word = s);
            band.render(delayed.get(..frames), feedback);
        }
        feedback.iter_mut().zip(modes).for_each(|(word, &mode)| *word = qadd(*word, mode));
        self.filter.render(Some(feedback), sound);
        for (out, &s) in out.iter_mut().zip(sound.iter()) {
            *out = qadd(*out, s);
            self.peak = self.peak.max(s.unsigned_abs());
            if let Some(word) = self.line.get_mut(self.place) {
                *word = s;
            }
            self.place = (self.place + 1) % FRAMES;
        }
    }
}

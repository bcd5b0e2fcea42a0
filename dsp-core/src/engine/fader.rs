//! Fader of the whole sound: its level, and its end.
//!
//! The gain moves in a straight line from frame to frame, so that the caller's blocks change
//! nothing. At level 1 no sample is touched.

use crate::SampleRate;

/// Gain of 1, Q30.
const ONE: i32 = 1 << 30;
/// Time of the way to a new level, in seconds.
pub const LEVEL_S: f64 = 0.02;
/// Time from an order of silence to exact zeros, in seconds.
pub const END_S: f64 = 0.004;
/// Nominal cycles of a tick in which the fader multiplies.
const TICK_CYCLES: u32 = 600;

/// Fader of the stereo bus.
#[derive(Clone, Copy, Debug)]
pub(super) struct Fader {
    /// Gain of the last frame, change per frame, and gain at the end of the way, Q30.
    gain: i32,
    step: i32,
    end: i32,
    /// Number of frames of the way that are left.
    left: u32,
    /// Level that the sound has, or will have after its end, Q30.
    level: i32,
    /// True from an order of silence until the sound has been cleared.
    is_ending: bool,
}

impl Fader {
    /// A fader at level 1.
    pub(super) const OPEN: Self = Self { gain: ONE, step: 0, end: ONE, left: 0, level: ONE, is_ending: false };

    /// Sets the level, a gain of 0 to 1. If nothing `sounds` it holds at once.
    pub(super) fn set_level(&mut self, level: f32, sounds: bool, rate: SampleRate) {
        // The product is at most 2^30.
        self.level = (level.clamp(0.0, 1.0) * ONE as f32) as i32;
        match (self.is_ending, sounds) {
            (true, _) => {}
            (_, true) => self.go_to(self.level, LEVEL_S, rate),
            _ => self.settle(),
        }
    }

    /// Lets the sound end. [`is_over`](Self::is_over) tells when it has.
    pub(super) fn end(&mut self, rate: SampleRate) {
        if !self.is_ending {
            self.is_ending = true;
            self.go_to(0, END_S, rate);
        }
    }

    fn go_to(&mut self, end: i32, seconds: f64, rate: SampleRate) {
        let frames = ((seconds * rate.hz()) as u32).max(1);
        // Both gains are 0 to 2^30, so the difference is an i32. The quotient in floats has no
        // panic, and what it lacks the last frame makes up for.
        let step = (end - self.gain) as f32 / frames as f32;
        (self.left, self.end, self.step) = (frames, end, step as i32);
    }

    /// True from an order of silence until the sound has been cleared.
    pub(super) fn is_ending(&self) -> bool {
        self.is_ending
    }

    /// True if the sound has ended and is to be cleared.
    pub(super) fn is_over(&self) -> bool {
        self.is_ending && self.left == 0
    }

    /// Opens the fader to its level at once, where nothing sounds.
    pub(super) fn settle(&mut self) {
        (self.gain, self.end, self.step, self.left, self.is_ending) = (self.level, self.level, 0, 0, false);
    }

    /// Goes from silence to its level, where something sounds on.
    pub(super) fn begin(&mut self, rate: SampleRate) {
        (self.gain, self.is_ending) = (0, false);
        self.go_to(self.level, LEVEL_S, rate);
    }

    /// Multiplies a run of the stereo bus.
    #[inline(always)]
    pub(super) fn render(&mut self, bus: &mut [[i32; 2]]) {
        if self.is_active() {
            self.multiply(bus);
        }
    }

    fn is_active(&self) -> bool {
        self.gain != ONE || self.left > 0
    }

    #[inline(never)] // its registers must not weigh on a sound of level 1
    fn multiply(&mut self, bus: &mut [[i32; 2]]) {
        for [left, right] in bus {
            if self.left > 0 {
                self.left -= 1;
                // Between the gains at both ends of the way.
                self.gain = if self.left == 0 { self.end } else { self.gain + self.step };
            }
            // |sample| <= 2^31 and the gain is at most 2^30, so the product is at most the sample.
            let gain = i64::from(self.gain);
            let fade = |sample: i32| ((i64::from(sample) * gain) >> 30) as i32;
            (*left, *right) = (fade(*left), fade(*right));
        }
    }

    /// Nominal cycles of a tick.
    pub(super) fn cycles(&self) -> u32 {
        if self.is_active() { TICK_CYCLES } else { 0 }
    }
}

//! States of a motion at many times in order, each in constant time.

use dsp_core::SampleRate;
use dsp_core::time::TICK_FRAMES;

use super::path::{Motion, State};

impl Motion {
    /// Reader of the states at many times.
    pub fn reader(&self) -> Reader<'_> {
        Reader::new(self)
    }

    /// States at the ends of the ticks of 32 frames, from the tick that begins at time 0 on.
    ///
    /// The state of tick k is that at `32 (k + 1) / rate` seconds. The last one is the first that
    /// is behind the last lift: always `None`. A contact within one tick has no state.
    pub fn ticks(&self, rate: SampleRate) -> Ticks<'_> {
        Ticks::new(self, rate)
    }
}

/// Reads the states of a motion at times that mostly lie near one another.
///
/// From one time to the next it passes the lines between them: a pass over the whole motion takes
/// as many steps as there are times and lines together. Times may go back as well.
#[derive(Clone, Debug)]
pub struct Reader<'m> {
    motion: &'m Motion,
    /// Number of knots that are not behind the last time.
    passed: usize,
}

impl<'m> Reader<'m> {
    pub(super) fn new(motion: &'m Motion) -> Self {
        Self { motion, passed: 0 }
    }

    /// State at a time in seconds; `None` while nothing is touched, and for times that are not
    /// finite. The states are those of [`Motion::at`].
    pub fn at(&mut self, time_s: f64) -> Option<State> {
        let knots = &self.motion.knots;
        while knots.get(self.passed).is_some_and(|next| next.time_s <= time_s) {
            self.passed += 1;
        }
        while self.passed > 0 && knots[self.passed - 1].time_s > time_s {
            self.passed -= 1;
        }
        if time_s.is_nan() {
            return None;
        }
        self.motion.behind(self.passed.checked_sub(1)?, time_s)
    }
}

/// States at the ends of ticks: [`Motion::ticks`].
#[derive(Clone, Debug)]
pub struct Ticks<'m> {
    reader: Reader<'m>,
    rate_hz: f64,
    tick: u64,
    is_over: bool,
}

impl<'m> Ticks<'m> {
    pub(super) fn new(motion: &'m Motion, rate: SampleRate) -> Self {
        Self { reader: motion.reader(), rate_hz: rate.hz(), tick: 0, is_over: false }
    }
}

impl Iterator for Ticks<'_> {
    type Item = Option<State>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.is_over {
            return None;
        }
        self.tick += 1;
        let time_s = (self.tick * TICK_FRAMES as u64) as f64 / self.rate_hz;
        self.is_over = time_s > self.reader.motion.end_s();
        Some(self.reader.at(time_s))
    }
}

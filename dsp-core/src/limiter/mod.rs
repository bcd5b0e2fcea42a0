//! The limiter: keeps the stereo sum below a ceiling, so that pads struck together do not clip.
//!
//! ```text
//!  left, right ─┬─► line of two ticks ─────► x gain ─► left, right
//!               └─► peak of each tick ─► gain at the end of the next one
//! ```
//!
//! Sound leaves two ticks (64 frames) after it came in, so that the peaks of a tick and of the next
//! one are known before the first sample leaves. In each tick the gain runs in a straight line to
//! the largest value that keeps both below the ceiling. A line between two such gains is below both
//! bounds in all of the tick, so that no sample exceeds the ceiling. Without peaks above the
//! ceiling the gain returns to 1 with a time constant of [`RELEASE_S`] and is then exactly 1: the
//! samples that come out are those that went in.
//!
//! Samples and gains are in 32-bit fixed point. Blocks of the caller change nothing, since the line
//! of the gain begins and ends at ticks.
//!
//! **Measured** (`cargo test -p host-tests --test stages limiter -- --nocapture`, and `--test
//! on_chip limiter` for cycles):
//!
//! | what | figure |
//! | --- | --- |
//! | samples above the ceiling, noise and strikes up to +24 dBFS | none |
//! | sound below the ceiling | bit for bit, 64 frames later |
//! | largest step of the gain between two frames | 1/32 |
//! | nominal cycles of a tick, with all that it costs the engine | 1 937 at most |
//! | RAM | 568 bytes |

use crate::SampleRate;
use crate::exponential::{loss, ratio_of_db};
use crate::fixed::{self, ONE_Q27};
use crate::memory::{Memory, OutOfMemory, Region};
use crate::time::TICK_FRAMES;

/// Time constant of the gain's return to 1, in seconds.
pub const RELEASE_S: f64 = 0.1;

/// Lowest ceiling, in dB below full scale.
pub const LOWEST_CEILING_DB: f32 = -40.0;

/// Nominal cycles of a tick in which sound passes the limiter.
pub const TICK_CYCLES: u32 = 2000;

/// A gain of 1, Q31, at which samples pass unchanged.
const UNITY: i32 = i32::MAX;

/// Bus steps by which a rounded product may exceed the exact one.
const ROUNDING: i32 = 2;

/// Highest ceiling in bus steps: a sample of 24 bits that is not clipped.
const HIGHEST_CEILING: i32 = ONE_Q27 - 16;

/// A limiter of the stereo bus.
#[derive(Debug)]
pub struct Limiter {
    /// Ceiling in bus steps, Q4.27.
    ceiling: i32,
    /// Share of the gain's distance to 1 that a tick takes away, Q31.
    release: i32,
    /// Gain of the frame that leaves, and at the end of the tick, Q31; change per frame.
    gain: i32,
    end: i32,
    step: i32,
    /// Peaks of the tick that comes in and of the one before, bus steps.
    peaks: [u32; 2],
    /// Half of the line that is written and read.
    half: bool,
    line: [[[i32; 2]; TICK_FRAMES]; 2],
}

impl Limiter {
    /// A limiter at rest with a ceiling in dB of full scale, from [`LOWEST_CEILING_DB`] to 0; a
    /// value beyond is taken as the nearer end, and one that is no number as 0.
    pub fn new(ceiling_db: f32, rate: SampleRate) -> Self {
        let db = if ceiling_db.is_nan() { 0.0 } else { f64::from(ceiling_db.clamp(LOWEST_CEILING_DB, 0.0)) };
        let ceiling = ratio_of_db(db) * f64::from(ONE_Q27);
        let release = loss(TICK_FRAMES as f64 / (RELEASE_S * rate.hz()));
        Self {
            ceiling: (ceiling as i32).min(HIGHEST_CEILING) - ROUNDING,
            release: (release * 2_147_483_648.0) as i32,
            gain: UNITY,
            end: UNITY,
            step: 0,
            peaks: [0; 2],
            half: false,
            line: [[[0; 2]; TICK_FRAMES]; 2],
        }
    }

    /// Takes the memory of a limiter at rest; `None` from an account.
    ///
    /// # Errors
    /// [`OutOfMemory`].
    pub fn place<'m>(
        memory: &mut Memory<'m>,
        ceiling_db: f32,
        rate: SampleRate,
    ) -> Result<Option<&'m mut Self>, OutOfMemory> {
        Ok(memory.take(Region::Fast, 1, || Self::new(ceiling_db, rate))?.first_mut())
    }

    /// True if the line is empty and the gain is 1: frames of silence may then pass untold.
    #[inline(always)]
    pub fn is_silent(&self) -> bool {
        self.peaks == [0; 2] && self.gain == UNITY && self.step == 0
    }

    /// Takes in a run within a tick, in place: the sound of two ticks before comes out. `frame` is
    /// the run's first frame within its tick.
    #[inline(never)]
    pub fn render(&mut self, frame: usize, bus: &mut [[i32; 2]]) {
        if frame == 0 {
            self.begin_tick();
        }
        let [first, second] = &mut self.line;
        let line = if self.half { second } else { first };
        let Some(line) = line.get_mut(frame..frame + bus.len()) else { return };
        let mut peak = self.peaks[0];
        for ([left, right], late) in bus.iter_mut().zip(line) {
            peak = peak.max(left.unsigned_abs()).max(right.unsigned_abs());
            [*left, *right] = core::mem::replace(late, [*left, *right]);
        }
        self.peaks[0] = peak;
        if self.gain == UNITY && self.step == 0 {
            return;
        }
        let (mut gain, step) = (self.gain, self.step);
        for [left, right] in bus {
            (*left, *right) = (scaled(*left, gain), scaled(*right, gain));
            gain += step;
        }
        self.gain = gain;
    }

    /// Chooses the gain at the end of the tick, whose frames came in two ticks ago.
    fn begin_tick(&mut self) {
        self.half = !self.half;
        let [last, before] = self.peaks;
        self.peaks = [0, last];
        self.gain = self.end;
        let distance = UNITY - self.end;
        let back = ((i64::from(distance) * i64::from(self.release)) >> 31) as i32;
        // One step at least, or the last of the way would never end.
        let returned = self.end + back.max(distance.min(1));
        self.end = returned.min(self.bound(last.max(before)));
        // Rounded down, so that no frame's gain is above both ends of its tick.
        self.step = (self.end - self.gain) >> TICK_FRAMES.ilog2();
    }

    /// Largest gain that keeps a peak at or below the ceiling, at most 1.
    fn bound(&self, peak: u32) -> i32 {
        if peak <= self.ceiling.unsigned_abs() {
            return UNITY;
        }
        ((u64::from(self.ceiling.unsigned_abs()) << 31) / u64::from(peak)) as i32
    }
}

/// A sample times a gain below 1, Q31, to within two bus steps: no product exceeds the ceiling by
/// more than [`ROUNDING`].
#[inline(always)]
fn scaled(x: i32, gain: i32) -> i32 {
    fixed::smmulr(x, gain) << 1
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_limiter_takes_at_most_568_bytes() {
        assert!(size_of::<Limiter>() <= 568, "{}", size_of::<Limiter>());
    }
}

//! A hand on a pad's filters: a gain that falls.

use crate::fixed::times_q31;

/// The gain of a hand: it falls by the T60 that the hand imposes while it lies there, and is 1 without one.
#[derive(Clone, Copy, Debug)]
pub struct Hand {
    /// What is left of the amplitude, 1.0 = 2^62: so many bits that the slowest hand still moves it, T60 100 s at 192 kHz.
    gain: u64,
    /// What a frame takes of it, 1.0 = 2^31; 0 without a hand.
    drop: u32,
    /// Whether the last tick left nothing.
    mute: bool,
}

const ONE: u64 = 1 << 62;

/// 2^-20, -120 dB: below it there is nothing.
const MUTE: u64 = ONE >> 20;

impl Hand {
    /// No hand.
    pub const AWAY: Self = Self { gain: ONE, drop: 0, mute: false };

    /// Whether it changes nothing.
    #[inline(always)]
    pub fn is_away(&self) -> bool {
        self.drop == 0 && self.gain == ONE
    }

    /// Whether it lets nothing through, as [`settle`](Self::settle) found.
    #[inline(always)]
    pub fn is_mute(&self) -> bool {
        self.mute
    }

    /// Whether it is still taking away: it goes on in silence, too, so that what is not computed cannot change when it is over.
    #[inline(always)]
    pub fn is_fading(&self) -> bool {
        self.drop > 0 && !self.mute
    }

    /// At a tick's end: whether there is anything left. Not before, so that no caller's block can change when.
    pub fn settle(&mut self) {
        self.mute = self.gain < MUTE;
    }

    /// Comes, leaving so much of the amplitude after a frame (from above 0 to below 1), or goes. What it has left so far stays until [`lift`](Self::lift).
    pub fn set(&mut self, per_frame: Option<f64>) {
        let taken = per_frame.map_or(0.0, |per_frame| 1.0 - per_frame);
        self.drop = libm::rint(taken * f64::from(1u32 << 31)) as u32;
    }

    /// The gain begins anew at 1; gives what it was as Q31, where it was not 1.
    pub fn lift(&mut self) -> Option<i32> {
        let left = (self.gain >> 31).min(i32::MAX as u64) as i32;
        let was_one = self.gain == ONE;
        (self.gain, self.mute) = (ONE, false);
        (!was_one).then_some(left)
    }

    /// Fades a run, a step a frame.
    pub fn fade(&mut self, sound: &mut [i32]) {
        for sample in sound {
            let left = self.gain >> 31;
            *sample = times_q31(*sample, left.min(i32::MAX as u64) as i32);
            // left is below 2^31 and drop at most 2^31.
            self.gain -= left * u64::from(self.drop);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixed::ONE_Q27;

    #[test]
    fn a_hand_takes_60_db_in_its_t60_and_is_mute_at_120() {
        for (t60_s, rate_hz) in [(0.001, 8_000.0), (0.1, 48_000.0), (100.0, 192_000.0)] {
            let mut hand = Hand::AWAY;
            assert!(hand.is_away() && hand.lift().is_none());
            hand.set(Some((-1000f64.ln() / (t60_s * rate_hz)).exp()));
            let frames = (t60_s * rate_hz) as usize;
            let mut last = 0;
            for _ in 0..frames {
                let mut sample = [ONE_Q27];
                hand.fade(&mut sample);
                last = sample[0];
            }
            let db = 20.0 * (f64::from(last) / f64::from(ONE_Q27)).log10();
            let step = 60.0 / frames as f64;
            // The slowest hand takes 773 steps of 2^-31 a frame, to half a step.
            assert!((db + 60.0 - step).abs() < 0.04, "{t60_s} s: {db} dB");
            hand.settle();
            assert!(!hand.is_mute());
            // 2^-20 is 120.4 dB.
            for _ in 0..frames + frames / 100 + 2 {
                hand.fade(&mut [0]);
            }
            hand.settle();
            assert!(hand.is_mute(), "{t60_s} s at {rate_hz} Hz");
        }
    }
}

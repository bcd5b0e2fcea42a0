//! A hand on a pad's dynamic filter: a gain that falls, and its inverse for what comes into the filter from outside.
//!
//! The law takes from what the filter, its exciter and its loops hold, and from the noise to come, a share a frame. All of that is linear in itself, so a gain behind the
//! filter does it, as long as what comes in beside the noise, the object's modes, is divided by the same gain.

use crate::fixed::times_q31;

/// The gain of a hand: it is 1 without one, and falls while one lies there.
#[derive(Clone, Copy, Debug)]
pub struct Hand {
    /// What is left of the amplitude, 1.0 = 2^62: so many bits that the slowest hand still moves it, T60 100 s at 192 kHz.
    gain: u64,
    /// By how many nepers a frame the sound is to fall; 0 without a hand.
    wanted: f32,
    /// What a frame takes of the gain, 1.0 = 2^31, for so many frames to come.
    drop: u32,
    frames: u32,
    /// Whether there is nothing left to take, until it is lifted.
    spent: bool,
}

const ONE: u64 = 1 << 62;

/// 2^-20, -120 dB: below it there is nothing.
const MUTE: u64 = ONE >> 20;

impl Hand {
    /// No hand.
    pub const AWAY: Self = Self { gain: ONE, wanted: 0.0, drop: 0, frames: 0, spent: false };

    /// Whether it changes nothing.
    #[inline(always)]
    pub fn is_away(&self) -> bool {
        self.gain == ONE && !self.is_fading()
    }

    /// Whether it is still taking away.
    #[inline(always)]
    fn is_fading(&self) -> bool {
        self.wanted > 0.0 && !self.spent
    }

    /// At a tick's end: whether it has just taken all, so that the filter is to rest. Not before, so that no caller's block can change when.
    pub fn settle(&mut self) -> bool {
        let is_mute = self.gain < MUTE;
        if is_mute {
            (self.gain, self.frames, self.spent) = (ONE, 0, true);
        }
        is_mute
    }

    /// In silence there is nothing to take, and the gain begins anew: so what is not computed cannot change what follows.
    pub fn rest(&mut self) {
        (self.gain, self.frames) = (ONE, 0);
    }

    /// Comes, to let the sound fall by so many nepers a frame, or goes. What it has left so far stays until [`lift`](Self::lift).
    pub fn set(&mut self, nepers: Option<f64>) {
        (self.wanted, self.frames) = (nepers.unwrap_or(0.0) as f32, 0);
        if nepers.is_none() {
            self.drop = 0;
        }
    }

    /// The gain begins anew at 1; gives what it was as Q31, where it was not 1.
    pub fn lift(&mut self) -> Option<i32> {
        let left = (self.gain >> 31).min(i32::MAX as u64) as i32;
        let was_one = self.gain == ONE;
        (self.gain, self.frames, self.spent) = (ONE, 0, false);
        (!was_one).then_some(left)
    }

    /// Frames to come for which it knows what to take; 0: [`expect`](Self::expect) is due.
    pub fn frames(&self) -> u32 {
        self.frames
    }

    /// Over so many frames the sound falls by so many nepers a frame by itself: it takes what is missing.
    pub fn expect(&mut self, frames: u32, falls: f32) {
        let missing = if self.is_fading() { (self.wanted - falls).max(0.0) } else { 0.0 };
        // `as` saturates; a hand takes 1 - e^-0.9 of a frame at most (T60 1 ms at 8 kHz).
        self.drop = (-libm::expm1f(-missing) * 2_147_483_648.0) as u32;
        self.frames = frames.max(1);
    }

    /// Divides what comes in over a run by the gain, saturating; the gain stays where it is until [`fade`](Self::fade).
    ///
    /// In single precision, within 2^-23 of each word: a recursion for the inverse would drift from the
    /// gain by up to 0.6 % over a T60.
    pub fn raise(&self, input: &mut [i32]) {
        let mut gain = self.gain;
        for word in input {
            let left = gain >> 31;
            // `as` saturates, and makes 0 of 0/0.
            *word = (*word as f32 * (2_147_483_648.0 / left as u32 as f32)) as i32;
            gain -= left * u64::from(self.drop);
        }
    }

    /// Fades a run of at most [`frames`](Self::frames), a step a frame.
    pub fn fade(&mut self, sound: &mut [i32]) {
        self.frames = self.frames.saturating_sub(sound.len() as u32);
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
    fn a_hand_takes_what_is_missing_of_60_db_in_its_t60_and_all_at_120() {
        for (t60_s, rate_hz) in [(0.001, 8_000.0), (0.1, 48_000.0), (100.0, 192_000.0)] {
            let mut hand = Hand::AWAY;
            assert!(hand.is_away() && hand.lift().is_none());
            hand.set(Some(1000f64.ln() / (t60_s * rate_hz)));
            let frames = (t60_s * rate_hz) as usize;
            let mut last = 0;
            for _ in 0..frames {
                hand.expect(1, 0.0);
                let (mut sample, mut input) = ([1 << 30], [1 << 20]);
                hand.raise(&mut input);
                let before = input[0];
                hand.fade(&mut sample);
                last = sample[0];
                let round = f64::from(before) * f64::from(sample[0]) / 2f64.powi(50);
                assert!((round - 1.0).abs() < 2e-6, "{t60_s} s: {round}");
            }
            let db = 20.0 * (f64::from(last) / 2f64.powi(30)).log10();
            let step = 60.0 / frames as f64;
            // The slowest hand takes 773 steps of 2^-31 a frame, to half a step.
            assert!((db + 60.0 - step).abs() < 0.09, "{t60_s} s: {db} dB");
            assert!(!hand.settle());
            // 2^-20 is 120.4 dB.
            for _ in 0..frames + frames / 100 + 2 {
                hand.expect(1, 0.0);
                hand.fade(&mut [0]);
            }
            assert!(hand.settle(), "{t60_s} s at {rate_hz} Hz");
            assert!(hand.is_away() && hand.lift().is_none());
        }
    }

    #[test]
    fn a_hand_takes_nothing_of_what_falls_faster_by_itself() {
        let mut hand = Hand::AWAY;
        hand.set(Some(0.001));
        hand.expect(32, 0.002);
        let mut sound = [ONE_Q27; 32];
        hand.fade(&mut sound);
        assert!(sound.iter().all(|&sample| sample >= ONE_Q27 - 1) && hand.frames() == 0);
    }
}

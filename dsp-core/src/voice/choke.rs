//! Choke of a pad's dynamic filter: a gain that falls behind the filter, and its inverse for the
//! modes that go into it.
//!
//! By the law a choke takes a share a frame from all that the filter, its exciter and its loops
//! hold, and from the noise to come. All of these are linear in themselves, so a gain behind the
//! filter does it, as long as the only other input, the object's modes, is divided by the same
//! gain.

use crate::SampleRate;
use crate::fixed::times_q31;

/// Gain of a choke: 1 without one, falling under one.
#[derive(Clone, Copy, Debug)]
pub(super) struct ChokeEnvelope {
    /// Share of the amplitude that is left, 1.0 = 2^62: enough bits for the slowest choke to move
    /// it, T60 100 s at 192 kHz.
    gain: u64,
    /// Nepers a frame by which the sound is to fall; 0 without a choke.
    wanted: f32,
    /// Share of the gain that each of the coming frames takes, 1.0 = 2^31.
    drop: u32,
    /// Number of coming frames for which `drop` holds.
    frames: u32,
    /// True if the choke has taken all, until the gain begins anew.
    spent: bool,
}

const ONE: u64 = 1 << 62;

/// Gain below which the filter is silent: 2^-20, -120 dB.
const MUTE: u64 = ONE >> 20;

/// Nepers a frame by which a choke of a T60 lets the sound fall.
pub(crate) fn nepers_per_frame(t60_s: f32, rate: SampleRate) -> f64 {
    core::f64::consts::LN_10 * 3.0 / (f64::from(t60_s) * rate.hz())
}

impl ChokeEnvelope {
    /// Envelope without a choke.
    pub(super) const OPEN: Self = Self { gain: ONE, wanted: 0.0, drop: 0, frames: 0, spent: false };

    /// True if it changes no sample.
    #[inline(always)]
    pub(super) fn is_open(&self) -> bool {
        self.gain == ONE && !self.is_fading()
    }

    /// True if the gain is still falling.
    #[inline(always)]
    fn is_fading(&self) -> bool {
        self.wanted > 0.0 && !self.spent
    }

    /// True if the choke has just taken all, so that the filter is to rest.
    ///
    /// Call it at a tick's end and not before, so that no caller's block can change the moment.
    pub(super) fn settle(&mut self) -> bool {
        let is_mute = self.gain < MUTE;
        if is_mute {
            (self.gain, self.frames, self.spent) = (ONE, 0, true);
        }
        is_mute
    }

    /// Lets the gain begin anew at 1 in silence, so that frames which are not computed cannot
    /// change those that follow.
    pub(super) fn rest(&mut self) {
        (self.gain, self.frames) = (ONE, 0);
    }

    /// Begins a choke by a number of nepers a frame, or ends it. The gain stays until
    /// [`take_gain`](Self::take_gain).
    pub(super) fn set(&mut self, nepers: Option<f64>) {
        (self.wanted, self.frames) = (nepers.unwrap_or(0.0) as f32, 0);
        if nepers.is_none() {
            self.drop = 0;
        }
    }

    /// Lets the gain begin anew at 1; gives the gain before as Q31, `None` if it was 1.
    pub(super) fn take_gain(&mut self) -> Option<i32> {
        let left = (self.gain >> 31).min(i32::MAX as u64) as i32;
        let was_one = self.gain == ONE;
        (self.gain, self.frames, self.spent) = (ONE, 0, false);
        (!was_one).then_some(left)
    }

    /// Number of coming frames that are planned; 0 if [`plan`](Self::plan) is due.
    pub(super) fn frames(&self) -> u32 {
        self.frames
    }

    /// Plans frames in which the sound falls by `falls` nepers a frame by itself: the gain takes
    /// the rest of the choke's fall.
    pub(super) fn plan(&mut self, frames: u32, falls: f32) {
        let missing = if self.is_fading() { (self.wanted - falls).max(0.0) } else { 0.0 };
        // `as` saturates; a choke takes 1 - e^-0.9 of a frame at most (T60 1 ms at 8 kHz).
        self.drop = (-libm::expm1f(-missing) * 2_147_483_648.0) as u32;
        self.frames = frames.max(1);
    }

    /// Divides the input of a run by the gain, saturating; the gain stays until
    /// [`fade`](Self::fade).
    ///
    /// In single precision, within 2^-23 of each word: a recursion for the inverse would drift from
    /// the gain by up to 0.6 % over a T60.
    pub(super) fn raise(&self, input: &mut [i32]) {
        let mut gain = self.gain;
        for word in input {
            let left = gain >> 31;
            // `as` saturates, and makes 0 of 0/0.
            *word = (*word as f32 * (2_147_483_648.0 / left as u32 as f32)) as i32;
            gain -= left * u64::from(self.drop);
        }
    }

    /// Fades a run of at most [`frames`](Self::frames), a step a frame.
    pub(super) fn fade(&mut self, sound: &mut [i32]) {
        self.frames = self.frames.saturating_sub(sound.len() as u32);
        for sample in sound {
            let left = self.gain >> 31;
            *sample = times_q31(*sample, left.min(i32::MAX as u64) as i32);
            // `left` is below 2^31 and `drop` at most 2^31.
            self.gain -= left * u64::from(self.drop);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixed::ONE_Q27;

    #[test]
    fn choke_takes_60_db_in_its_t60_and_mutes_at_120_db() {
        for (t60_s, rate_hz) in [(0.001, 8_000.0), (0.1, 48_000.0), (100.0, 192_000.0)] {
            let mut choke = ChokeEnvelope::OPEN;
            assert!(choke.is_open() && choke.take_gain().is_none());
            choke.set(Some(1000f64.ln() / (t60_s * rate_hz)));
            let frames = (t60_s * rate_hz) as usize;
            let mut last = 0;
            for _ in 0..frames {
                choke.plan(1, 0.0);
                let (mut sample, mut input) = ([1 << 30], [1 << 20]);
                choke.raise(&mut input);
                let before = input[0];
                choke.fade(&mut sample);
                last = sample[0];
                let round = f64::from(before) * f64::from(sample[0]) / 2f64.powi(50);
                assert!((round - 1.0).abs() < 2e-6, "{t60_s} s: {round}");
            }
            let db = 20.0 * (f64::from(last) / 2f64.powi(30)).log10();
            let step = 60.0 / frames as f64;
            // The slowest choke takes 773 steps of 2^-31 a frame, to half a step.
            assert!((db + 60.0 - step).abs() < 0.09, "{t60_s} s: {db} dB");
            assert!(!choke.settle());
            // 2^-20 is 120.4 dB.
            for _ in 0..frames + frames / 100 + 2 {
                choke.plan(1, 0.0);
                choke.fade(&mut [0]);
            }
            assert!(choke.settle(), "{t60_s} s at {rate_hz} Hz");
            assert!(choke.is_open() && choke.take_gain().is_none());
        }
    }

    #[test]
    fn choke_takes_nothing_of_a_sound_that_falls_faster_by_itself() {
        let mut choke = ChokeEnvelope::OPEN;
        choke.set(Some(0.001));
        choke.plan(32, 0.002);
        let mut sound = [ONE_Q27; 32];
        choke.fade(&mut sound);
        assert!(sound.iter().all(|&sample| sample >= ONE_Q27 - 1) && choke.frames() == 0);
    }
}

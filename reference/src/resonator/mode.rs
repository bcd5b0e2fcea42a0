//! Physical parameters of a mode.

/// Response of a mode to an impulse, in full scale (1.0) per newton-second.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gain {
    /// Amplitude `gs` of `e^(-d t) sin 2πf t`.
    pub sine: f64,
    /// Amplitude `gc` of `e^(-d t) cos 2πf t`.
    pub cosine: f64,
}

/// One mode of vibration (§3.3).
#[derive(Clone, Debug, PartialEq)]
pub struct Mode {
    /// Frequency `f` in hertz, 0 or above. A mode at or above half the sample rate is never
    /// rendered.
    pub frequency_hz: f64,
    /// Decay rate `d` in 1/s, 0 or above: the amplitude falls as `e^(-d t)`, by 60 dB in
    /// `T60 = ln(1000)/d` seconds.
    pub decay_per_s: f64,
    /// One gain for each of P >= 1 positions, evenly spaced along the object from 0 to 1.
    ///
    /// All modes of a bank have the same P.
    pub gains: Vec<Gain>,
}

impl Mode {
    /// Gain for a contact at `position`, 0 to 1; `None` if the mode has no gains.
    ///
    /// It is linear between the two nearest of the P positions, at index `position (P-1)`. Eq. 1
    /// fixes a gain for the whole body; §3.3 calls that a simplification.
    pub fn gain_at(&self, position: f64) -> Option<Gain> {
        let last = self.gains.len().checked_sub(1)?;
        let index = position.clamp(0.0, 1.0) * last as f64;
        let below = index.floor() as usize;
        let share = index - index.floor();
        let [from, to] = [self.gains[below], self.gains[last.min(below + 1)]];
        Some(Gain {
            sine: from.sine + share * (to.sine - from.sine),
            cosine: from.cosine + share * (to.cosine - from.cosine),
        })
    }
}

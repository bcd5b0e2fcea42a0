//! Bands of decaying noise, and the hands that damp them.

/// Band of decaying noise.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Band {
    /// Lower and upper edge in hertz.
    pub edges_hz: [f64; 2],
    /// Rms w at t = 0, 1.0 = full scale.
    pub weight: f64,
    /// Decay γ in dB/s.
    pub decay_db_per_s: f64,
}

/// Interval in which a hand lies on the object, in times counted from the strike.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hold {
    /// Start in seconds after the strike; below 0 if the hand lay there before the strike.
    pub from_s: f64,
    /// End in seconds after the strike.
    pub to_s: f64,
    /// T60 that the hand imposes, in seconds.
    pub t60_s: f64,
}

impl Band {
    /// Decay of the amplitude in nepers per second.
    pub(super) fn decay_per_s(&self) -> f64 {
        self.decay_db_per_s * std::f64::consts::LN_10 / 20.0
    }
}

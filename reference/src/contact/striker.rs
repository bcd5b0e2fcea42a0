//! Strikers, and Hertz's power laws from velocity to force and contact time.

use super::impact::Impact;
use super::pulse::Pulse;
use crate::resonator::Mode;

/// A stick, mallet or finger: its contact force, and its own modes.
#[derive(Clone, Debug, PartialEq)]
pub struct Striker {
    /// Shape of the contact force.
    pub pulse: Pulse,
    /// Peak force `m1` in newtons at velocity 1.
    pub peak_force: f64,
    /// Exponent `a` in `m = m1 v^a`; see [`Self::HERTZ_PEAK_EXPONENT`].
    pub peak_exponent: f64,
    /// Contact time `τ1` in seconds at velocity 1, above 0.
    pub contact_time_s: f64,
    /// Exponent `b` in `τ = τ1 v^b`; see [`Self::HERTZ_CONTACT_EXPONENT`].
    pub contact_exponent: f64,
    /// The striker's own modes (§4.3, the tool's impulse response); empty if it does not ring.
    ///
    /// The modes have gains at one position. If they have several, the first is used.
    pub modes: Vec<Mode>,
}

impl Striker {
    /// Exponent of Hertz's law for colliding spheres: the peak force grows as velocity to the 6/5.
    pub const HERTZ_PEAK_EXPONENT: f64 = 1.2;

    /// Exponent of Hertz's law for colliding spheres: the contact time falls as velocity to the
    /// -1/5.
    ///
    /// It makes a harder strike a brighter one.
    pub const HERTZ_CONTACT_EXPONENT: f64 = -0.2;

    /// Shortest and longest contact time τ in seconds, to which the power law is clamped.
    pub const CONTACT_TIME_RANGE_S: [f64; 2] = [1e-5, 0.25];

    /// Contact that a strike at `velocity` (0 to 1) makes, starting at `onset_samples`:
    ///
    /// ```text
    /// m = m1 v^a,   τ = τ1 v^b, clamped to 10 µs .. 0.25 s
    /// ```
    ///
    /// `None` for a velocity of 0, which is no strike.
    pub fn strike(&self, velocity: f64, onset_samples: f64) -> Option<Impact> {
        (velocity > 0.0).then(|| Impact {
            onset_samples,
            pulse: self.pulse,
            peak_force: self.peak_force * velocity.powf(self.peak_exponent),
            contact_time_s: (self.contact_time_s * velocity.powf(self.contact_exponent))
                .clamp(Self::CONTACT_TIME_RANGE_S[0], Self::CONTACT_TIME_RANGE_S[1]),
        })
    }
}

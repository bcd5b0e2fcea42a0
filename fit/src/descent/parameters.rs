//! Kinds of numbers that the descent learns, and their places in one vector.

use std::ops::Range;

/// Kind of learned numbers. Their order is that of the vector.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// Magnitudes of the force over time, m_in of eq. 4.
    Magnitude,
    /// Standard deviations of the noise on the magnitudes (appendix B).
    Spread,
    /// Contact times over time, τ_in of eq. 6.
    ContactTime,
    /// Bias b_τ of all contact times (eq. 6).
    ContactBias,
    /// Gains of the modes, a of eq. 9.
    Gain,
    /// Dampings of the modes, b of eq. 11.
    Damping,
    /// Frequencies of the modes, f_in of eq. 17.
    Frequency,
    /// Scalar α of the acceleration sound (eq. 1).
    Acceleration,
    /// Gains of the bands of background noise (§3.4).
    NoiseGain,
    /// Gains of the bands of the room (eq. 20).
    RoomGain,
    /// Dampings of the bands of the room (eq. 22).
    RoomDecay,
}

impl Kind {
    /// All kinds in order.
    pub(super) const ALL: [Self; 11] = [
        Self::Magnitude,
        Self::Spread,
        Self::ContactTime,
        Self::ContactBias,
        Self::Gain,
        Self::Damping,
        Self::Frequency,
        Self::Acceleration,
        Self::NoiseGain,
        Self::RoomGain,
        Self::RoomDecay,
    ];
}

/// Numbers of nodes, modes and bands, from which the places of all parameters follow.
#[derive(Clone, Copy, Debug)]
pub(super) struct Places {
    /// Number of nodes of the force over time, T_in.
    pub(super) nodes: usize,
    /// Number of modes, K.
    pub(super) modes: usize,
    /// Number of bands of background noise, B_n.
    pub(super) noise_bands: usize,
    /// Number of bands of the room, B_e.
    pub(super) room_bands: usize,
}

impl Places {
    fn count(&self, kind: Kind) -> usize {
        match kind {
            Kind::Magnitude | Kind::Spread | Kind::ContactTime => self.nodes,
            Kind::ContactBias | Kind::Acceleration => 1,
            Kind::Gain | Kind::Damping | Kind::Frequency => self.modes,
            Kind::NoiseGain => self.noise_bands,
            Kind::RoomGain | Kind::RoomDecay => self.room_bands,
        }
    }

    /// Places of the numbers of a kind.
    pub(super) fn of(&self, kind: Kind) -> Range<usize> {
        let before = Kind::ALL.into_iter().take_while(|other| *other != kind);
        let first: usize = before.map(|other| self.count(other)).sum();
        first..first + self.count(kind)
    }

    /// Number of all parameters.
    pub(super) fn total(&self) -> usize {
        Kind::ALL.into_iter().map(|kind| self.count(kind)).sum()
    }
}

//! Frequency bands of a room.

/// Frequency band of a room. A room's bands are sorted from the lowest up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RoomBand {
    /// Lower edge in Hz; 0 for the first band. The upper edge is the next band's lower edge, or
    /// Nyquist.
    pub from_hz: f64,
    /// Initial gain g in 1/√s.
    pub gain: f64,
    /// Decay rate d in 1/s; T60 = ln(1000)/d.
    pub decay_per_s: f64,
}

//! Numbers of positions and strikers of a recording.

/// Numbers of places and strikers in which strikes differ.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Layout {
    /// Number of gains of each mode along the object, 1 to 16; 1 for strikes at one place.
    ///
    /// The gains are the coefficients of a cubic spline, so that at least 4 are needed for gains
    /// that curve; each half wave along the object needs about three. 4 to 10 become 2P - 3, again
    /// and again, while that explains clearly more than chance does and three strikes or more tell
    /// each coefficient.
    pub positions: usize,
    /// Number of strikers, 1 to 4.
    pub strikers: usize,
}

impl Default for Layout {
    fn default() -> Self {
        Self { positions: 1, strikers: 1 }
    }
}

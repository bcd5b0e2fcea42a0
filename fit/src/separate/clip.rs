//! Recordings with their labels.

/// A recording, and who struck what in it.
#[derive(Clone, Copy, Debug)]
pub struct Clip<'a> {
    /// Samples, full scale 1.
    pub samples: &'a [f64],
    /// Sample rate in Hz.
    pub rate_hz: f64,
    /// Index of the thing.
    pub object: usize,
    /// Index of the striker.
    pub striker: usize,
}

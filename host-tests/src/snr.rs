//! Signal-to-noise ratio of a fixed-point signal, and random numbers for tests.

/// SNR in dB of samples against exact ones in the same unit; infinite if all are equal.
pub fn snr_db(exact: &[f64], samples: &[i32]) -> f64 {
    let signal: f64 = exact.iter().map(|x| x * x).sum();
    let error: f64 = exact.iter().zip(samples).map(|(x, &y)| (x - f64::from(y)).powi(2)).sum();
    10.0 * (signal / error).log10()
}

/// Deterministic random numbers (xorshift).
#[derive(Clone, Debug)]
pub struct Random(u64);

impl Random {
    /// Generator with a seed other than 0.
    pub fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1)
    }

    /// Draws a number evenly between two bounds.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        low + (high - low) * ((self.0 >> 11) as f64 / (1u64 << 53) as f64)
    }
}

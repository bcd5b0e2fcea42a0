//! Mean powers over blocks whose length grows with time.

/// Mean power over a block of time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Block {
    /// Middle of the block in seconds from the strike.
    pub(crate) time_s: f64,
    /// Length of the block in seconds.
    pub(crate) length_s: f64,
    /// Mean power in the block.
    pub(crate) power: f64,
}

/// Largest length of a block, as a share of the time since the strike.
///
/// An exponential's mean over a block is then its middle within 0.4 % down to 60 dB, and fast
/// decays are resolved as well as slow ones.
const SHARE: f64 = 0.02;

/// Blocks of `power`, sampled at `rate_hz` from the strike on, between two times.
pub(crate) fn blocks(power: &[f64], rate_hz: f64, from_s: f64, to_s: f64) -> Vec<Block> {
    let mut at = (from_s * rate_hz).ceil().max(0.0) as usize;
    let end = power.len().min((to_s * rate_hz) as usize);
    let mut blocks = Vec::new();
    while at < end {
        let length = ((at as f64 * SHARE) as usize).max(1);
        let inside = power.get(at..end.min(at + length)).unwrap_or(&[]);
        let count = inside.len().max(1) as f64;
        blocks.push(Block {
            time_s: (at as f64 + 0.5 * (count - 1.0)) / rate_hz,
            length_s: count / rate_hz,
            power: inside.iter().sum::<f64>() / count,
        });
        at += length;
    }
    blocks
}

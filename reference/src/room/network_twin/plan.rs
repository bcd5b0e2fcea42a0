//! Plan of the network: the rates, delays and gains of all bands.

use super::crossover::{Crossover, crossovers};
use crate::room::band::RoomBand;

/// Number of frames in a block. The wet sound begins two blocks, and one delay line more, after the
/// dry one.
pub(super) const BLOCK_FRAMES: usize = 128;
/// Number of delay lines in a network; each holds pairs of values.
pub(super) const LINES: usize = 4;

/// Network of one band.
pub(super) struct Plan {
    /// Divider of the full sample rate.
    pub(super) division: usize,
    /// Upper edge of the band in Hz.
    pub(super) to_hz: f64,
    /// Crossover at the lower edge; `None` for the lowest band.
    pub(super) crossover: Option<Crossover>,
    /// Length of each delay line in pairs, at the band's own rate.
    pub(super) delays: Vec<usize>,
    /// Gain of each delay line, by which it decays over its delay.
    pub(super) gains: Vec<f64>,
    /// Number of samples for which the moving angle stays constant.
    pub(super) held: usize,
    /// Factor on the network's output.
    pub(super) output: f64,
}

/// Plans of all bands of a network, from the lowest up, at a sample rate of `hz`.
///
/// All delays together hold at most `samples` values.
pub(super) fn plans(bands: &[RoomBand], hz: f64, samples: usize) -> Vec<Plan> {
    let to_hz = |band: usize| bands.get(band + 1).map_or(hz / 2.0, |next| next.from_hz);
    let (slowest, edge) = if bands.len() <= 4 { (8, 0.42) } else { (32, 0.35) };
    let divisions: Vec<usize> = (0..bands.len())
        .map(|band| {
            let fits = |division: usize| to_hz(band) * division as f64 <= edge * hz;
            [32, 16, 8, 4, 2].into_iter().find(|&division| division <= slowest && fits(division)).unwrap_or(1)
        })
        .collect();
    // The delay in seconds is 0.15 of T60, or a hundred resonances in the band if that is longer.
    // Memory limits it, and the longest line is limited to 47 blocks.
    let wishes: Vec<f64> = bands
        .iter()
        .enumerate()
        .map(|(band, table)| {
            let wish = (0.15 * 1000f64.ln() / table.decay_per_s).max(100.0 / (to_hz(band) - table.from_hz));
            // A limit keeps the echoes dense in the highest band.
            if band + 1 == bands.len() { wish.min(0.16) } else { wish }
        })
        .collect();
    let parts: Vec<f64> = {
        let sum: f64 = (0..LINES as i32).map(|line| 1.4f64.powi(line)).sum();
        (0..LINES as i32).map(|line| 1.4f64.powi(line) / sum).collect()
    };
    let needed = |limit: f64| -> f64 {
        wishes.iter().zip(&divisions).map(|(wish, &division)| wish.min(limit) * hz / division as f64).sum()
    };
    let (mut limit, mut high) = (0.0, 2.0 * 47.0 * BLOCK_FRAMES as f64 / hz / parts[LINES - 1]);
    if needed(high) <= samples as f64 {
        limit = high;
    }
    for _ in 0..30 {
        let middle = 0.5 * (limit + high);
        if needed(middle) <= samples as f64 { limit = middle } else { high = middle }
    }
    let (crossovers, factors) = crossovers(bands, &divisions, hz);
    let crossovers = std::iter::once(None).chain(crossovers.into_iter().map(Some));
    let band = |(band, crossover): (usize, Option<Crossover>)| {
        let own_hz = hz / divisions[band] as f64;
        let delays = delays(0.5 * wishes[band].min(limit) * own_hz, BLOCK_FRAMES / divisions[band], &parts);
        let table = bands[band];
        let gains: Vec<f64> = delays.iter().map(|&delay| (-table.decay_per_s * delay as f64 / own_hz).exp()).collect();
        // The energy assumes that each line's output spreads evenly over all lines. Outputs are
        // differences of lines 2 and 3.
        let passed: Vec<f64> = gains.iter().map(|gain| gain * gain).collect();
        let given = 1.0 / 16.0 / (1.0 - passed.iter().sum::<f64>() / LINES as f64);
        let output = table.gain * (factors[band] / (2.0 * table.decay_per_s * given * (passed[2] + passed[3]))).sqrt();
        let held_frames = if bands.len() <= 4 && divisions[band] > 1 { 32 } else { 16 };
        let held = (held_frames / divisions[band]).max(1);
        Plan { held, division: divisions[band], to_hz: to_hz(band), crossover, delays, gains, output }
    };
    (0..bands.len()).zip(crossovers).map(band).collect()
}

/// Distinct primes. Each is at most its part of `total`, unless the block is longer.
fn delays(total: f64, block: usize, parts: &[f64]) -> Vec<usize> {
    let is_prime = |n: usize| n > 1 && (2..).take_while(|d| d * d <= n).all(|d| !n.is_multiple_of(d));
    let mut delays = Vec::new();
    for part in parts {
        let least = block.max(delays.last().map_or(2, |last| last + 1));
        let wanted = ((part * total) as usize).max(least);
        let below = (least..=wanted).rev().find(|&n| is_prime(n));
        delays.push(below.unwrap_or_else(|| (wanted..).find(|&n| is_prime(n)).unwrap_or(wanted)));
    }
    delays
}

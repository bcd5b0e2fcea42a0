//! Choice of the crossovers between bands, and corrections of the bands' energies.
//!
//! Each crossover favours the band that the other one would drown: see `dsp-core`'s room.

use std::f64::consts::PI;

use super::split::{Elliptic, shared_db};
use crate::room::band::RoomBand;

/// Crossover: its low-pass, and the `tan(π f)` at which it lies.
pub(super) struct Crossover {
    pub(super) low_pass: Elliptic,
    pub(super) tangent: f64,
}

/// Number of all-pass sections wanted for the crossover between two bands.
fn wanted(low: &RoomBand, high: &RoomBand) -> usize {
    let ratio = (low.decay_per_s / high.decay_per_s).max(high.decay_per_s / low.decay_per_s);
    if ratio >= 2.0 {
        4
    } else if ratio >= 1.25 {
        3
    } else {
        2
    }
}

/// Number of all-pass sections of each crossover, from the lowest edge up.
///
/// Crossovers get further sections in turn as long as the cost fits the budget. The cost is counted
/// on a Cortex-M4F in 32nds of a cycle.
fn sections(bands: &[RoomBand], divisions: &[usize]) -> Vec<usize> {
    let rates: usize = divisions.iter().map(|division| 32 / division).sum();
    let splits: usize = divisions.iter().skip(1).map(|division| 32 / division).sum();
    let doubling = if divisions[0] > 1 { 28 * 32 } else { 0 };
    let mut cycles = 56 * rates + 34 * splits + 32 * (61 + 12 * bands.len()) + doubling;
    let limit = 32 * if bands.len() <= 4 { 285 } else { 715 };
    let mut sections = vec![2; bands.len().saturating_sub(1)];
    for count in [3, 4] {
        for (edge, pair) in bands.windows(2).enumerate() {
            let more = 10 * 32 / divisions[edge + 1];
            if wanted(&pair[0], &pair[1]) >= count && sections[edge] + 1 == count && cycles + more <= limit {
                sections[edge] = count;
                cycles += more;
            }
        }
    }
    sections
}

/// All crossovers, from the lowest edge up, and a factor on each band's energy.
///
/// The factors make up for the energy that a band loses at its edges and gets from its neighbours.
pub(super) fn crossovers(bands: &[RoomBand], divisions: &[usize], hz: f64) -> (Vec<Crossover>, Vec<f64>) {
    let edge_hz = |band: usize| bands.get(band).map_or(hz / 2.0, |band| band.from_hz);
    let energy = |band: usize| bands[band].gain.max(1e-4).powi(2) / (2.0 * bands[band].decay_per_s);
    let width = |band: usize| edge_hz(band + 1) - edge_hz(band);
    // Level in dB by which one band's skirt exceeds another band.
    let drowning_db = |skirt: usize, other: usize| {
        let longer = (bands[other].decay_per_s / bands[skirt].decay_per_s).log2().clamp(-1.0, 1.0);
        10.0 * (energy(skirt) / energy(other)).log10() + 20.0 * longer
    };
    let mut own: Vec<f64> = (0..bands.len()).map(width).collect();
    let mut others = vec![0.0; bands.len()];
    let mut splits = Vec::new();
    for (low, sections) in sections(bands, divisions).into_iter().enumerate() {
        let high = low + 1;
        let k = [0.65, 0.72, 0.8][sections - 2];
        let by_high_db = (0..=low).map(|below| drowning_db(high, below)).fold(f64::MIN, f64::max);
        let lean_db = 0.5 * (drowning_db(low, high) - by_high_db);
        let all_db = shared_db(sections, k);
        let low_pass = Elliptic::with_high_pass(sections, k, (0.5 * (all_db - lean_db)).clamp(10.0, all_db - 10.0));
        let own_hz = hz / divisions[high] as f64;
        let tangent = (PI * edge_hz(high) / own_hz).tan() * k.powf(0.2 * (lean_db / 20.0).clamp(-1.0, 1.0));
        let low_power = |hz: f64| low_pass.low_power((PI * hz / own_hz).tan() / tangent);
        let lost_below = integral(edge_hz(low).max(edge_hz(high) / 16.0), edge_hz(high), |hz| 1.0 - low_power(hz));
        let lost_above = integral(edge_hz(high), edge_hz(high + 1), low_power);
        own[low] -= lost_below;
        own[high] -= lost_above;
        others[low] += lost_below * energy(high);
        others[high] += lost_above * energy(low);
        splits.push(Crossover { low_pass, tangent });
    }
    let factor = |band: usize| {
        let wanted = width(band) - others[band] / energy(band);
        (wanted / own[band].max(0.5 * width(band))).clamp(0.9, 1.0 / 0.9)
    };
    (splits, (0..bands.len()).map(factor).collect())
}

/// Integral by the midpoint rule, in 24 steps of equal ratio.
fn integral(from: f64, to: f64, power: impl Fn(f64) -> f64) -> f64 {
    let step = (to / from).ln() / 24.0;
    (0..24).map(|index| from * ((f64::from(index) + 0.5) * step).exp()).map(|at| power(at) * at * step).sum()
}

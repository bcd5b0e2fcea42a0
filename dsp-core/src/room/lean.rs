//! Leaning of a split to one of its sides, and the loss of each side to the other.
//!
//! A low-pass and a high-pass from one pair of all-passes share a sum of attenuations: the one's
//! gain is the other's loss. Neighbours that decay alike and are as loud get half each. If one
//! rings longer, or is louder, its skirt is heard in the other's tail, while the other's is drowned
//! or gone. The split then leans, and lies a little on the longer one's side, at no cost in cycles.

use super::elliptic::{Elliptic, shared_db};
use super::split::{LEAST_SECTIONS, Split};
use crate::exponential::{self, exp, log2};
use crate::sine;
use core::f64::consts::PI;

/// Selectivity k of splits of two, three and four sections: the end of the pass band over the
/// beginning of the stop band.
pub(super) const SELECTIVITIES: [f64; 3] = [0.65, 0.72, 0.8];
/// Least attenuation of each side, in dB.
pub(super) const LEAST_DB: f64 = 10.0;
/// Attenuation in dB that a band which rings twice as long or longer gets beyond the other's, and
/// the part of the distance between the bands' ends by which the edge then moves.
const LONGER_DB: f64 = 20.0;
const SHIFT: f64 = 0.4;
/// Ratios of T60 from which a split gets three sections, and four.
const UNLIKE: f64 = 1.25;
const FAR_APART: f64 = 2.0;
/// Number of steps of an integral.
const STEPS: i32 = 24;
/// Lower end of the range in which a lowest band is looked at, as a part of its edge.
const LOWEST_PART: f64 = 1.0 / 16.0;

/// The band on one side of an edge.
#[derive(Clone, Copy, Debug)]
pub(super) struct Side {
    /// Decay in nepers a second.
    pub(super) decay_per_s: f64,
    /// Energy a hertz, `g²/(2 d)`.
    pub(super) energy: f64,
}

/// Place of a split, of the sample rate at which it runs: both bands' outer ends, and the edge.
#[derive(Clone, Copy, Debug)]
pub(super) struct Edge {
    pub(super) from: f64,
    pub(super) edge: f64,
    pub(super) to: f64,
}

/// A split, and the energy of the table's bands that goes astray, as widths in parts of the rate.
#[derive(Clone, Copy, Debug)]
pub(super) struct Leaning {
    pub(super) split: Split,
    /// Loss of the low side to the high one.
    pub(super) lost_below: f64,
    /// Loss of the high side to the low one.
    pub(super) lost_above: f64,
}

/// Number of sections that a split between two bands should have if there are cycles for them.
pub(super) fn sections_wanted(low: &Side, high: &Side) -> usize {
    let ratio = (low.decay_per_s / high.decay_per_s).max(high.decay_per_s / low.decay_per_s);
    LEAST_SECTIONS + usize::from(ratio >= UNLIKE) + usize::from(ratio >= FAR_APART)
}

/// Level in dB by which a band's skirt drowns another band, beyond that of bands alike.
pub(super) fn drowning_db(skirt: &Side, other: &Side) -> f64 {
    let louder_db = 10.0 * core::f64::consts::LOG10_2 * log2(skirt.energy / other.energy);
    louder_db + LONGER_DB * log2(other.decay_per_s / skirt.decay_per_s).clamp(-1.0, 1.0)
}

/// Split of `sections` sections between two bands, of which the low side's skirt drowns the other
/// by `by_low_db`, and the high side's by `by_high_db`.
///
/// Sound above the next band is behind that one's split too; but the high side reaches everything
/// below.
pub(super) fn leaning(by_low_db: f64, by_high_db: f64, at: &Edge, sections: usize) -> Leaning {
    let k = SELECTIVITIES.get(sections - LEAST_SECTIONS).copied().unwrap_or(0.8);
    let lean_db = 0.5 * (by_low_db - by_high_db);
    let all_db = shared_db(sections, k);
    let high_db = (0.5 * (all_db - lean_db)).max(LEAST_DB).min(all_db - LEAST_DB);
    let filter = Elliptic::leaning(sections, k, high_db);
    let shift = SHIFT * (lean_db / LONGER_DB).clamp(-1.0, 1.0);
    let tangent = sine::tan(PI * at.edge) * exponential::power(k, 0.5 * shift);
    let low_power = |f: f64| filter.low_power(sine::tan(PI * f) / tangent);
    Leaning {
        split: Split::new(&filter, tangent),
        lost_below: integral(at.from.max(LOWEST_PART * at.edge), at.edge, |f| 1.0 - low_power(f)),
        lost_above: integral(at.edge, at.to, low_power),
    }
}

/// Integral by midpoints, in steps of one ratio.
fn integral(from: f64, to: f64, power: impl Fn(f64) -> f64) -> f64 {
    let step = libm::log(to / from) / f64::from(STEPS);
    let at = |index: i32| from * exp((f64::from(index) + 0.5) * step);
    (0..STEPS).map(|index| power(at(index)) * at(index) * step).sum()
}

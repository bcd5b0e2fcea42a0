//! Short holes of rows, filled by polynomials through their neighbours.

use std::ops::Range;

/// Maximum number of points of a hole that a polynomial fills.
const SHORT: usize = 8;
/// Maximum number of neighbours on either side of a hole that a polynomial runs through.
const SIDE: usize = 6;
/// Maximum distance in points of such a neighbour from the hole.
const REACH: usize = 2 * SIDE;
/// Least and greatest number of places at which known points decide on the polynomial.
const TRIALS: [usize; 2] = [50, 2_000];

/// A missing point's height, and how far off it may be.
#[derive(Clone, Copy, Debug)]
pub(super) struct Estimate {
    height: f64,
    /// Mean square error that the same polynomials have at known points.
    square: f64,
}

impl Estimate {
    /// Height in metres.
    pub(super) fn height(self) -> f64 {
        self.height
    }

    /// Mean of two estimates, each weighted by the other's mean square error.
    pub(super) fn mean(self, other: Self) -> Self {
        let whole = self.square + other.square;
        let share = if whole > 0.0 { other.square / whole } else { 0.5 };
        let height = share * self.height + (1.0 - share) * other.height;
        Self { height, square: share * self.square }
    }
}

/// Polynomial for holes of one length.
#[derive(Clone, Copy, Debug)]
struct Rule {
    /// Number of neighbours on either side that it runs through.
    side: usize,
    /// Its mean square error at known points.
    square: f64,
}

/// Estimates of the points in the short holes of rows; `None` elsewhere.
///
/// A straight line over a hole is a bend at either end, which counts as roughness: with 5 % of the
/// points missing, the shortest wave of a profile without waves below 40 µm was read as 10 µm. The
/// surface itself tells how many neighbours to take. Many follow a smooth surface closely, and few
/// are better on a rough one, where a high polynomial amplifies noise: those are taken that miss
/// known points the least.
pub(super) fn estimates(values: &[f64], columns: usize) -> Vec<Option<Estimate>> {
    let rows = || values.chunks_exact(columns).enumerate();
    let is_short = |hole: &Range<usize>| (1..=SHORT).contains(&hole.len());
    let mut rules: [Option<Option<Rule>>; SHORT + 1] = [None; SHORT + 1];
    let mut estimates = vec![None; values.len()];
    for (number, row) in rows() {
        for hole in stretches(row, |height| !height.is_finite()).filter(is_short) {
            let Some(rule) = *rules[hole.len()].get_or_insert_with(|| rule(values, columns, hole.len())) else {
                continue;
            };
            let (before, after) = neighbours(row, &hole);
            let side = rule.side.min(before.len()).min(after.len());
            if side == 0 {
                continue;
            }
            let nodes: Vec<usize> = before[..side].iter().chain(&after[..side]).copied().collect();
            for point in hole {
                let height = weights(&nodes, point).zip(&nodes).map(|(weight, node)| weight * row[*node]).sum();
                estimates[number * columns + point] = Some(Estimate { height, square: rule.square });
            }
        }
    }
    estimates
}

/// Stretches of a row whose heights are all of a kind.
fn stretches(row: &[f64], is_of_kind: impl Fn(&f64) -> bool) -> impl Iterator<Item = Range<usize>> {
    let mut end = 0;
    std::iter::from_fn(move || {
        let begin = end + row[end..].iter().position(&is_of_kind)?;
        end = row[begin..].iter().position(|height| !is_of_kind(height)).map_or(row.len(), |length| begin + length);
        Some(begin..end)
    })
}

/// Known points before and behind a hole, the nearest first.
fn neighbours(row: &[f64], hole: &Range<usize>) -> (Vec<usize>, Vec<usize>) {
    let is_known = |point: &usize| row[*point].is_finite();
    let before = (hole.start.saturating_sub(REACH)..hole.start).rev().filter(is_known).take(SIDE).collect();
    let after = (hole.end..(hole.end + REACH).min(row.len())).filter(is_known).take(SIDE).collect();
    (before, after)
}

/// The polynomial that misses known points the least where they are taken for a hole; `None` if
/// there are too few places to tell.
fn rule(values: &[f64], columns: usize, hole: usize) -> Option<Rule> {
    let length = hole + 2 * SIDE;
    let mut places = Vec::new();
    for (number, row) in values.chunks_exact(columns).enumerate() {
        for known in stretches(row, |height| height.is_finite()).filter(|known| known.len() >= length) {
            places.extend((known.start..=known.end - length).map(|begin| number * columns + begin));
        }
    }
    let [least, most] = TRIALS;
    if places.len() < least {
        return None;
    }
    let stride = places.len().div_ceil(most);
    let of_side = |side: usize| {
        let nodes: Vec<usize> = (SIDE - side..SIDE).chain(SIDE + hole..SIDE + hole + side).collect();
        let weights: Vec<Vec<f64>> = (SIDE..SIDE + hole).map(|point| weights(&nodes, point).collect()).collect();
        let miss = |begin: usize| -> f64 {
            let at = |point: usize| values[begin + point];
            let of_point = |(point, weights): (usize, &Vec<f64>)| {
                let guess: f64 = weights.iter().zip(&nodes).map(|(weight, node)| weight * at(*node)).sum();
                (guess - at(SIDE + point)).powi(2)
            };
            weights.iter().enumerate().map(of_point).sum()
        };
        let trials = places.iter().step_by(stride);
        let count = (trials.len() * hole) as f64;
        Rule { side, square: trials.map(|begin| miss(*begin)).sum::<f64>() / count }
    };
    (1..=SIDE).map(of_side).min_by(|a, b| a.square.total_cmp(&b.square))
}

/// Weights of the nodes' heights in their polynomial at a point (Lagrange).
fn weights(nodes: &[usize], point: usize) -> impl Iterator<Item = f64> {
    let from = |a: usize, b: usize| a as f64 - b as f64;
    nodes.iter().map(move |node| {
        let others = nodes.iter().filter(move |other| *other != node);
        others.map(|other| from(point, *other) / from(*node, *other)).product()
    })
}

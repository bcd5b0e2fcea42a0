//! Waves below the shortest measured one, by the spectrum's slope.

use super::options::Note;
use super::statistics::{Band, Octave, Statistics};

/// Wavelengths, in shortest ones, over which the slope is fitted: beyond the edge of a measurement.
/// Shorter waves follow the slope.
pub(super) const FITTED: [f64; 2] = [3.0, 24.0];
/// Ratio of the edges of an added band: a sixth of an octave.
const BAND: f64 = 1.122_462_048_309_373;

/// Statistics that go on to shorter waves: the density of heights follows the line through its
/// logarithm over that of frequency from 3 to 24 shortest waves, and the octaves' distributions
/// are those of the last octave that lies on it.
pub(super) fn extended(mut statistics: Statistics, to_m: f64) -> (Statistics, Note) {
    let from_m = statistics.shortest_m;
    let density = |band: &Band| {
        let [lower, upper] = band.edges_per_m;
        band.power / ((upper - lower) * (lower * upper).powi(2))
    };
    let is_fitted = |band: &&Band| {
        let length = 1.0 / (band.edges_per_m[1] * from_m);
        band.edges_per_m[0] > 0.0 && (FITTED[0]..=FITTED[1]).contains(&length) && band.power > 0.0
    };
    let middle = |edges: [f64; 2]| 0.5 * (edges[0] * edges[1]).ln();
    let points: Vec<[f64; 2]> = (statistics.bands.iter().filter(is_fitted))
        .map(|band| [middle(band.edges_per_m), density(band).ln()])
        .collect();
    let count = points.len().max(1) as f64;
    let mean = |axis: usize| points.iter().map(|point| point[axis]).sum::<f64>() / count;
    let (x, y) = (mean(0), mean(1));
    let size: f64 = points.iter().map(|point| (point[0] - x).powi(2)).sum();
    let along: f64 = points.iter().map(|point| (point[0] - x) * (point[1] - y)).sum();
    let slope = along / size.max(f64::MIN_POSITIVE);
    let power = |edges: [f64; 2]| {
        let [lower, upper] = edges;
        (y + slope * (middle(edges) - x)).exp() * (upper - lower) * (lower * upper).powi(2)
    };
    let kept_per_m = 1.0 / (FITTED[0] * from_m);
    let added = |ratio: f64| {
        let mut all = Vec::new();
        let mut upper = 1.0 / to_m;
        while upper > 1.0001 / from_m {
            let lower = (upper / ratio).max(1.0 / from_m);
            all.push([lower, upper]);
            upper = lower;
        }
        all
    };
    let of_edges = |edges_per_m: [f64; 2]| Band { edges_per_m, power: power(edges_per_m) };
    let mut bands: Vec<Band> = added(BAND).into_iter().map(of_edges).collect();
    bands.extend(
        statistics.bands.iter().map(
            |band| {
                if band.edges_per_m[0] > kept_per_m { of_edges(band.edges_per_m) } else { *band }
            },
        ),
    );
    let on_line = statistics.octaves.iter().find(|octave| octave.edges_per_m[1] <= 1.001 * kept_per_m);
    let shape = on_line.or(statistics.octaves.last()).map(|octave| octave.sorted.clone()).unwrap_or_default();
    let mut octaves: Vec<Octave> =
        added(2.0).into_iter().map(|edges_per_m| Octave { edges_per_m, sorted: shape.clone() }).collect();
    octaves.extend(statistics.octaves.drain(..).map(|octave| {
        let is_kept = octave.edges_per_m[1] <= 1.001 * kept_per_m;
        if is_kept { octave } else { Octave { sorted: shape.clone(), ..octave } }
    }));
    let note = Note::Extended { from_m, to_m, slope };
    (Statistics { shortest_m: to_m, bands, octaves, sorted: Vec::new() }, note)
}

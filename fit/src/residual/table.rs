//! Residual bands as a part of a table.

use kit::{Kit, Residual};

use crate::band::Band;

/// Highest edge of a residual band in a table, in Hz: every rate of 44.1 kHz and more plays it.
const HIGHEST_EDGE_HZ: f64 = 20_000.0;
/// Largest weight of a band that the format holds.
const MOST_WEIGHT: f32 = 16.0;
/// Slowest decay of a band that the format holds, in dB/s.
const LEAST_DECAY_DB_PER_S: f32 = 1.0;
/// Fastest decay of a band that the format holds, in dB/s.
const MOST_DECAY_DB_PER_S: f32 = 20_000.0;

/// Adds a residual to the table.
///
/// `bands` are neighbours without gaps, fitted by [`fit_bands`](super::fit_bands) to a strike of
/// the table's peak force. Bands that end above 20 kHz, and those without weight at either end, are
/// left out. If no band has weight, the table stays as it is.
pub fn with_residual(table: Kit, bands: &[Band], seed: u32) -> Kit {
    let audible: Vec<Band> = bands.iter().filter(|band| band.edges_hz[1] <= HIGHEST_EDGE_HZ).copied().collect();
    let sounds = |band: &Band| band.weight > 0.0;
    let first = audible.iter().position(sounds).unwrap_or(audible.len());
    let last = audible.iter().rposition(sounds).map_or(first, |last| last + 1);
    let kept = audible.get(first..last).unwrap_or(&[]);
    with_bands(table, kept, seed)
}

/// Adds a residual of all these bands to the table, silent ones included.
///
/// `bands` are neighbours without gaps, fitted by [`fit_bands`](super::fit_bands) to a strike of
/// the table's peak force. Without bands the table stays as it is.
pub fn with_bands(mut table: Kit, bands: &[Band], seed: u32) -> Kit {
    let peak_force = table.strikers.first().map_or(1.0, |striker| f64::from(striker.peak_force));
    if let (Some(lowest), Some(object)) = (bands.first(), table.objects.first_mut()) {
        let edges = std::iter::once(lowest.edges_hz[0]).chain(bands.iter().map(|band| band.edges_hz[1]));
        // Bands are measured at the strike's peak force; a table's weights are those of the
        // reference force.
        let ratio = f64::from(object.reference_force) / peak_force;
        let weight = |band: &Band| ((band.weight * ratio) as f32).min(MOST_WEIGHT);
        let decay = |band: &Band| (band.decay_db_per_s as f32).clamp(LEAST_DECAY_DB_PER_S, MOST_DECAY_DB_PER_S);
        object.residual = Some(Residual {
            seed,
            edges_hz: edges.map(|edge| edge as f32).collect(),
            weight: bands.iter().map(weight).collect(),
            decay_db_per_s: bands.iter().map(decay).collect(),
        });
    }
    table
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::strike::Fit;
    use crate::table::{Provenance, of_fit};

    fn table(peak_force: f32) -> Kit {
        let fit = Fit::silent(44_100.0);
        let provenance = Provenance { name: "mug".to_owned(), source: String::new(), licence: String::new() };
        let mut table = of_fit(&fit, &provenance);
        table.strikers[0].peak_force = peak_force;
        table
    }

    #[test]
    fn a_residual_keeps_silent_bands_between_others_and_drops_outer_ones() {
        let edges = [50.0, 100.0, 200.0, 400.0, 800.0, 19_000.0, 21_000.0];
        let weights = [0.0, 0.02, 0.0, 0.01, 0.0, 0.3];
        let bands: Vec<Band> = edges
            .windows(2)
            .zip(weights)
            .map(|(edge, weight)| Band { edges_hz: [edge[0], edge[1]], weight, decay_db_per_s: 0.0 })
            .collect();
        let table = with_residual(table(0.5), &bands, 7);
        let residual = table.objects[0].residual.as_ref().expect("some bands sound");
        assert_eq!(residual.edges_hz, [100.0, 200.0, 400.0, 800.0]);
        // The peak force is half the reference force, so a strike sounds half as loud as the
        // table's weight.
        assert_eq!(residual.weight, [0.04, 0.0, 0.02]);
        assert_eq!(residual.decay_db_per_s, [1.0; 3]);
    }

    #[test]
    fn a_fitted_strike_of_many_newtons_is_the_reference_force() {
        let strike = |peak_force: f64| crate::strike::Strike {
            hit: crate::segment::Hit { onset: 0, end: 1 },
            contact_time_s: 1e-3,
            peak_force,
            position: 0.0,
            acceleration: 0.0,
            lsd_db: 0.0,
            residual_db: 0.0,
        };
        let provenance = Provenance { name: "mug".to_owned(), source: String::new(), licence: String::new() };
        for (peak_force, expected) in [(250.0, 250.0), (0.5, 1.0), (1.0, 1.0)] {
            let strikes = vec![strike(peak_force)];
            let fit = Fit { strikes, measured: true, ..Fit::silent(44_100.0) };
            let band = Band { edges_hz: [100.0, 200.0], weight: 0.02, decay_db_per_s: 10.0 };
            let table = with_residual(of_fit(&fit, &provenance), &[band], 7);
            let object = &table.objects[0];
            assert_eq!(object.reference_force, expected);
            // A strike of the table's peak force has the measured weight.
            let weight = object.residual.as_ref().map_or(0.0, |residual| f64::from(residual.weight[0]));
            assert!((weight * peak_force / f64::from(object.reference_force) - 0.02).abs() < 1e-8, "{weight}");
        }
    }

    #[test]
    fn silent_bands_add_no_residual() {
        let band = Band { edges_hz: [100.0, 200.0], weight: 0.0, decay_db_per_s: 10.0 };
        assert!(with_residual(table(1.0), &[band], 7).objects[0].residual.is_none());
        assert!(with_residual(table(1.0), &[], 7).objects[0].residual.is_none());
    }
}

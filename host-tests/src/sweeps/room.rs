//! Sweep of the room: decays and energies of random tables.

use dsp_core::SampleRate;

use super::Extent;
use crate::room::{LARGE, Look, band_errors, frames_needed, ideal_response, impulse_response, random_tables};

const RATE: SampleRate = SampleRate::HZ_48000;

/// Random tables of one kind, with the limits that hold for them.
struct Set {
    /// Number of bands of each table.
    bands: usize,
    /// Number of tables.
    tables: usize,
    /// Largest ratio of the T60s of neighbouring bands.
    neighbours: f64,
    /// Largest gain of a band, up or down, in dB.
    gains_db: f64,
    seed: u64,
    /// Smallest part of the bands that must hold their T60 within 5 %.
    least: f64,
    /// Largest allowed error of a band's energy, in dB.
    most_db: f64,
}

/// All sets. The tests run only the second.
const SETS: &[Set] = &[
    Set { bands: 4, tables: 6, neighbours: 2.0, gains_db: 0.0, seed: 1, least: 1.0, most_db: 1.15 },
    Set { bands: 4, tables: 6, neighbours: 4.0, gains_db: 6.0, seed: 2, least: 0.9, most_db: 0.9 },
    Set { bands: 4, tables: 6, neighbours: 30.0, gains_db: 6.0, seed: 3, least: 0.85, most_db: 1.7 },
    Set { bands: 8, tables: 4, neighbours: 2.0, gains_db: 0.0, seed: 4, least: 0.95, most_db: 1.0 },
    Set { bands: 8, tables: 4, neighbours: 4.0, gains_db: 6.0, seed: 5, least: 0.9, most_db: 1.0 },
    Set { bands: 8, tables: 4, neighbours: 30.0, gains_db: 6.0, seed: 6, least: 0.9, most_db: 1.35 },
];

/// Compares decays and energies of random tables with the table, and with an ideal room.
///
/// # Panics
/// If a limit is broken.
pub fn decays_and_energies(extent: Extent) {
    // Only bands of at least 300 independent samples count, and only if two ideal rooms both hold
    // their T60. Narrower or shorter bands scatter as noise itself does.
    let hz = RATE.hz();
    for set in extent.pick(&SETS[1..2], SETS) {
        let (mut within, mut all, mut worst_db) = (0, 0, 0.0f64);
        for table in random_tables(set.bands, set.tables, set.neighbours, set.gains_db, set.seed) {
            let frames = frames_needed(&table, hz);
            let sides = impulse_response::<i16, LARGE>(&table, RATE, frames).expect("a random table is valid");
            let errors = |sides: &[Vec<f64>; 2]| band_errors(&table, sides, Look::Inside, 25.0, hz);
            let ideal = [0, 1].map(|seed| errors(&ideal_response(&table, hz, frames, seed)));
            for (band, error) in errors(&sides).iter().enumerate() {
                let is_fair = ideal.iter().all(|errors| errors[band].t60.abs() <= 0.05);
                if error.samples >= 300.0 && is_fair {
                    all += 1;
                    within += usize::from(error.t60.abs() <= 0.05);
                    worst_db = worst_db.max(error.energy_db.abs());
                }
            }
        }
        println!(
            "{} bands, neighbours within {}, gains ±{} dB: T60 within 5 %: {within} of {all}; energy within {worst_db:.2} dB",
            set.bands, set.neighbours, set.gains_db
        );
        assert!(
            all >= 10 && within as f64 >= set.least * f64::from(all) && worst_db <= set.most_db,
            "{within} of {all}, {worst_db} dB"
        );
    }
}

//! The room compared with its reference: decay, energy, echo density and spectral crest.
//!
//! `cargo bench -p host-tests --bench room`

use dsp_core::SampleRate;
use host_tests::room::{
    BandError, LARGE, Look, SMALL, Table, band_errors, crest_db, echo_density_per_s, frames_needed, ideal_response,
    impulse_response, octave_tables, random_tables,
};

const RATE: SampleRate = SampleRate::HZ_48000;

/// Number of ideal rooms with which each table is compared.
const SEEDS: u64 = 4;

/// Counts bands whose T60 is within 5 % and whose energy is within 1 dB, and prints the counts.
///
/// It counts bands of `dsp-core`'s room, bands of ideal rooms, and bands of `dsp-core`'s room where
/// the T60 of every ideal room is within 5 %.
fn follow(tables: &[Table], what: &str) {
    let hz = RATE.hz();
    println!("{what}");
    let responses: Vec<_> = tables
        .iter()
        .map(|table| {
            let frames = frames_needed(table, hz);
            let own = impulse_response::<i16, LARGE>(table, RATE, frames).expect("a table in range");
            let ideal: Vec<_> = (0..SEEDS).map(|seed| ideal_response(table, hz, frames, seed)).collect();
            (table, own, ideal)
        })
        .collect();
    for (look, to_db) in [(Look::Inside, 25.0), (Look::Inside, 35.0), (Look::Whole, 25.0), (Look::Butterworth, 25.0)] {
        let holds = |error: &BandError| error.t60.abs() <= 0.05;
        let (mut all, mut own_holds, mut ideal_holds, mut fair, mut own_fair) = (0, 0, 0, 0, 0);
        let (mut energy_holds, mut worst_db, mut ideal_energy_holds) = (0, 0.0f64, 0);
        for (table, own, ideal) in &responses {
            let own = band_errors(table, own, look, to_db, hz);
            let ideal: Vec<_> = ideal.iter().map(|sides| band_errors(table, sides, look, to_db, hz)).collect();
            for (band, error) in own.iter().enumerate() {
                let of_ideal = || ideal.iter().map(|errors| errors[band]);
                all += 1;
                own_holds += usize::from(holds(error));
                ideal_holds += of_ideal().filter(holds).count();
                let is_fair = of_ideal().all(|error| holds(&error));
                fair += usize::from(is_fair);
                own_fair += usize::from(is_fair && holds(error));
                energy_holds += usize::from(error.energy_db.abs() <= 1.0);
                ideal_energy_holds += of_ideal().filter(|error| error.energy_db.abs() <= 1.0).count();
                if is_fair {
                    worst_db = worst_db.max(error.energy_db.abs());
                }
            }
        }
        println!(
            "  {look:?}, -5 to -{to_db} dB: T60 within 5 %: {own_holds} of {all} (ideal {:.1}); of {fair} where the ideal always does: {own_fair}; energy within 1 dB: \
             {energy_holds} (ideal {:.1}), worst there {worst_db:.2} dB",
            ideal_holds as f64 / SEEDS as f64,
            ideal_energy_holds as f64 / SEEDS as f64,
        );
    }
}

fn tails<const SAMPLES: usize>() {
    let hz = RATE.hz();
    for table in octave_tables(6.0) {
        let sides = impulse_response::<i16, SAMPLES>(&table, RATE, 160_000).expect("a table in range");
        let mut crests = Vec::new();
        for side in &sides {
            for start in [48_000, 72_000, 96_000] {
                crests.push(crest_db(&side[start..start + 48_000], 100.0, 20_000.0, hz));
            }
        }
        println!(
            "{} samples, {} bands: crest {:.1?} dB; echoes a second from 80 to 100 ms {:.0}",
            SAMPLES,
            table.bands.len(),
            crests,
            echo_density_per_s(&sides[0][3840..4800], hz)
        );
    }
}

fn main() {
    follow(&octave_tables(1.0), "even tables, T60 1 s");
    for bands in [4, 8] {
        follow(&random_tables(bands, 10, 2.0, 0.0, 1), &format!("{bands} bands, neighbours within 2, one gain"));
        follow(&random_tables(bands, 10, 4.0, 6.0, 2), &format!("{bands} bands, neighbours within 4, gains ±6 dB"));
        follow(&random_tables(bands, 10, 30.0, 6.0, 3), &format!("{bands} bands, any neighbours, gains ±6 dB"));
    }
    tails::<LARGE>();
    tails::<SMALL>();
}

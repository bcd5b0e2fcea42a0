//! The room against its law: decay, energy, echo density and spectral crest.
//!
//! `cargo bench -p host-tests --bench room`

use dsp_core::SampleRate;
use host_tests::room::{
    Band, LARGE, SMALL, Table, band_of, crest_db, echo_density_per_s, energy, impulse_response, octave_tables,
    random_tables, t60_s,
};

const RATE: SampleRate = SampleRate::HZ_48000;

fn quantiles(mut values: Vec<f64>) -> String {
    values.sort_by(f64::total_cmp);
    let at = |part: f64| values[((values.len() - 1) as f64 * part).round() as usize];
    [0.0, 0.05, 0.25, 0.5, 0.75, 0.95, 1.0].map(|part| format!("{:7.3}", at(part))).join(" ")
}

fn decays(tables: &[Table], what: &str) {
    let hz = RATE.hz();
    let (mut errors, mut energies) = (Vec::new(), Vec::new());
    for table in tables {
        let longest = table.bands.iter().fold(0.0, |longest: f64, band| longest.max(band.t60_s));
        let frames = ((0.7 * longest + 0.3) * hz) as usize;
        let [left, _] = impulse_response::<i16, LARGE>(table, RATE, frames).expect("a table in range");
        for (index, band) in table.bands.iter().enumerate() {
            let inside = Band { from_hz: band.from_hz.max(20.0), to_hz: table.to_hz(index, hz) }.inside(hz);
            let part = band_of(&left, inside, hz);
            errors.push(t60_s(&part, 5.0, 25.0, hz) / band.t60_s - 1.0);
            let law = band.gain * band.gain / (2.0 * 1000f64.ln() / band.t60_s) * (inside.to_hz - inside.from_hz)
                / (hz / 2.0);
            energies.push(10.0 * (energy(&part) / law).log10());
        }
    }
    let within = |values: &[f64], limit: f64| {
        values.iter().filter(|value| value.abs() <= limit).count() as f64 / values.len() as f64
    };
    println!("{what}: within 5 %: {:.3}, within 1 dB: {:.3}", within(&errors, 0.05), within(&energies, 1.0));
    println!("  T60 error    {}", quantiles(errors));
    println!("  energy, dB   {}", quantiles(energies));
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
    decays(&octave_tables(1.0), "even tables, T60 1 s");
    for bands in [4, 8] {
        decays(&random_tables(bands, 10, 2.0, 0.0, 1), &format!("{bands} bands, neighbours within 2, one gain"));
        decays(&random_tables(bands, 10, 4.0, 6.0, 2), &format!("{bands} bands, neighbours within 4, gains ±6 dB"));
    }
    tails::<LARGE>();
    tails::<SMALL>();
}

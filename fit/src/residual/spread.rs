//! Power that the instrument's noise of one band has in all bands: short frames smear narrow bands.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError};

use super::table::with_residual;
use crate::band::Band;
use crate::distance::{Spectrogram, band_power};
use crate::error::FitError;
use crate::{render, table};

/// Length of the noise that is measured, in seconds.
const SECONDS: f64 = 2.0;
/// Beginning of the noise that is left out, in seconds: the strike's own frame.
const SETTLING_S: f64 = 0.1;
/// Slowest decay that a table holds, in dB/s.
const DECAY_DB_PER_S: f64 = 1.0;

/// Powers by band of the noise (rows) and band of the measurement (columns).
pub(super) type Spread = Arc<Vec<Vec<f64>>>;

/// Mean power that noise of unit rms in each band (rows) has in each band (columns), as dsp-core
/// plays it.
///
/// Frames have `window` samples.
///
/// # Errors
/// [`FitError::Render`] at a rate that the instrument does not play.
pub(super) fn measured(edges_hz: &[f64], rate_hz: f64, window: usize) -> Result<Spread, FitError> {
    // Kept, because it takes a second and is equal for all recordings of one rate.
    static KNOWN: Mutex<BTreeMap<(u64, usize), Spread>> = Mutex::new(BTreeMap::new());
    let key = (rate_hz.to_bits(), edges_hz.len());
    let mut known = KNOWN.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(spread) = known.get(&key) {
        return Ok(spread.clone());
    }
    let spread = Arc::new(measure(edges_hz, rate_hz, window)?);
    known.insert(key, spread.clone());
    Ok(spread)
}

fn measure(edges_hz: &[f64], rate_hz: f64, window: usize) -> Result<Vec<Vec<f64>>, FitError> {
    let spectrogram = Spectrogram::new(window);
    let silent = table::of_fit(
        &crate::strike::Fit::silent(rate_hz),
        &table::Provenance { name: "noise".to_owned(), source: String::new(), licence: String::new() },
    );
    let places: Vec<f64> = edges_hz.iter().map(|edge| edge / rate_hz * window as f64).collect();
    let rows = edges_hz.windows(2).zip(1..).map(|(edges, seed)| {
        const WEIGHT: f64 = 0.05;
        // The other bands are present but quiet: a table's lowest band is played differently from
        // those above it.
        let bands: Vec<Band> = edges_hz
            .windows(2)
            .map(|its| Band {
                edges_hz: [its[0], its[1]],
                weight: if its == edges { WEIGHT } else { 1e-4 * WEIGHT },
                decay_db_per_s: DECAY_DB_PER_S,
            })
            .collect();
        let table = with_residual(silent.clone(), &bands, seed);
        let sound = render::by_instrument(&table, 0.0, rate_hz, (SECONDS * rate_hz) as usize)?;
        let power = spectrogram.power(sound.get((SETTLING_S * rate_hz) as usize..).unwrap_or(&[]));
        let frames = power.chunks_exact(spectrogram.bin_count());
        let step_s = (SECONDS - SETTLING_S) / frames.len().max(1) as f64;
        let left = |frame: usize| 10f64.powf(-0.1 * DECAY_DB_PER_S * (SETTLING_S + frame as f64 * step_s));
        let count = (0..frames.len()).map(left).sum::<f64>().max(1e-9) * WEIGHT * WEIGHT;
        let mut row = vec![0.0; places.len().saturating_sub(1)];
        for frame in frames {
            for (sum, place) in row.iter_mut().zip(places.windows(2)) {
                *sum += band_power(frame, place[0], place[1]) / count;
            }
        }
        Ok(row)
    });
    rows.collect()
}

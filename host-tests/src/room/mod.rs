//! Measurements of the room: impulse responses, with their decay, energy, density and spectrum.

mod analysis;
mod band_errors;
mod ideal;
mod statistics;
mod tables;

pub use analysis::{Band, Look, Spectrum, crest_db, echo_density_per_s, energy, t60_s};
pub use band_errors::{BandError, band_errors, frames_needed};
pub use ideal::ideal_response;
pub use statistics::{Answer, mean_and_rms};
pub use tables::{Table, TableBand, octave_tables, random_tables};

use dsp_core::SampleRate;
use dsp_core::fixed::ONE_Q27;
use dsp_core::room::{Room, RoomError, Sample};

use crate::lent;

/// Number of delay samples in 48 KB of 16-bit samples.
pub const LARGE: usize = 24_576;
/// Number of delay samples in 16 KB of 16-bit samples.
pub const SMALL: usize = 8_192;

/// Answer of a room, left and right, to a unit impulse on both sides, without the impulse; 1.0 =
/// full scale.
///
/// # Errors
/// A [`RoomError`] for a table that cannot be played.
pub fn impulse_response<T: Sample + 'static, const SAMPLES: usize>(
    table: &Table,
    rate: SampleRate,
    frames: usize,
) -> Result<[Vec<f64>; 2], RoomError> {
    let mut dry = vec![0.0; frames];
    dry[0] = 1.0;
    answer::<T, SAMPLES>(table, rate, &dry)
}

/// Answer of a room, left and right, to one sound on both sides, without the sound itself.
///
/// # Errors
/// A [`RoomError`] for a table that cannot be played.
pub fn answer<T: Sample + 'static, const SAMPLES: usize>(
    table: &Table,
    rate: SampleRate,
    dry: &[f64],
) -> Result<[Vec<f64>; 2], RoomError> {
    answer_to_sides::<T, SAMPLES>(table, rate, [dry, dry])
}

/// Room of `dsp-core` for a table, in memory of its own, with at most `samples` samples of delay.
///
/// # Errors
/// A [`RoomError`] for a table that cannot be played.
pub fn room<T: Sample + 'static>(
    table: &Table,
    rate: SampleRate,
    samples: usize,
) -> Result<Room<'static, T>, RoomError> {
    let records = table.records();
    let size = Room::<T>::size(&records, rate, samples)?;
    let mut room = lent!(lender => Room::<T>::take(lender, size));
    room.load(&records, rate, samples).map(|()| room)
}

/// Answer of a room, left and right, to a stereo sound, without the sound itself.
///
/// # Errors
/// A [`RoomError`] for a table that cannot be played.
pub fn answer_to_sides<T: Sample + 'static, const SAMPLES: usize>(
    table: &Table,
    rate: SampleRate,
    dry: [&[f64]; 2],
) -> Result<[Vec<f64>; 2], RoomError> {
    let mut room = room::<T>(table, rate, SAMPLES)?;
    let [left, right] = dry.map(|side| side.iter().map(|&x| dsp_core::fixed::q27_from(x)).collect::<Vec<i32>>());
    let dry: Vec<[i32; 2]> = left.into_iter().zip(right).map(|(left, right)| [left, right]).collect();
    let mut out = dry.clone();
    room.render(&mut out);
    Ok([0, 1].map(|side| {
        let wet = out.iter().zip(&dry).map(|(out, dry)| i64::from(out[side]) - i64::from(dry[side]));
        wet.map(|wet| wet as f64 / f64::from(ONE_Q27)).collect()
    }))
}

//! A fitted recording, played anew from its table and events.

use std::path::Path;

use dsp_core::SampleRate;
use dsp_core::engine::Setup;
use dsp_core::table::{Kit, TableError};
use kit::KitError;

use super::own_force;
use super::parts::{self, PartsError};
use super::performance::Performance;
use crate::events::{self, EventsError};

/// Reason for which a recording cannot be played anew.
#[derive(Debug, thiserror::Error)]
pub enum ReplayError {
    /// The table cannot be read, or is no kit.
    #[error(transparent)]
    Kit(#[from] KitError),
    /// The table is invalid.
    #[error("the table cannot be played: {0}")]
    Table(#[from] TableError),
    /// The events cannot be read.
    #[error(transparent)]
    Events(#[from] EventsError),
    /// The table cannot be rendered.
    #[error("the table cannot be played: {0}")]
    Parts(#[from] PartsError),
    /// The instrument does not run at the recording's rate.
    #[error("the instrument plays at whole rates from 8000 to 192000 Hz, and the recording has {0} Hz: resample it")]
    Rate(f64),
}

/// Number of frames per block, which changes no bit.
const BLOCK: usize = 128;

/// Plays events on a table with the instrument, as `malleus play --rate HZ` does, to 24-bit frames.
///
/// `seconds` is the least length of the sound.
///
/// # Errors
/// [`ReplayError`] if a file cannot be read or the table cannot be played.
pub fn replay(table: &Path, strikes: &Path, rate_hz: f64, seconds: f64) -> Result<Vec<[i32; 2]>, ReplayError> {
    let whole_hz = (rate_hz.fract() == 0.0).then_some(rate_hz as u32);
    let rate = whole_hz.and_then(|hz| SampleRate::new(hz, 1)).ok_or(ReplayError::Rate(rate_hz))?;
    let loaded = kit::open(&table.to_string_lossy())?;
    let binary = Kit::parse(&loaded.binary)?;
    let list = events::read(strikes, &binary, rate)?;
    let direct = own_force::direct(&list.strikes, &loaded.kit, rate);
    let parts = own_force::parts(&list.strikes, &loaded.kit, rate);
    let performance = Performance::new(list.events, direct, &loaded.kit, rate, Some(seconds));
    let scenes = match parts.is_empty() {
        true => vec![(loaded.kit, performance)],
        false => parts::scenes(&loaded.kit, &performance, &parts),
    };
    let mut frames = parts::render(&scenes, Setup::new(rate), BLOCK, |_| {})?;
    dsp_core::output::to_24_bit(&mut frames);
    Ok(frames)
}

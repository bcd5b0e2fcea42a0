//! Sound of a shape's table: a strike at each position.

use std::path::Path;

use dsp_core::engine::Setup;
use dsp_core::event::{Event, Time};
use dsp_core::{SampleRate, table::Kit};
use malleus::render::Performance;
use malleus::render::instrument::{self, Output, Settings};
use malleus::wave;

use super::error::CommandError;
use super::kit_new;

/// Sample rate of the sound.
const RATE: SampleRate = SampleRate::HZ_48000;
/// Frames from one strike to the next.
const FRAMES: usize = 48_000;
/// Velocity of the strikes.
const VELOCITY: f32 = 0.8;

/// Writes the sound of a strike at each of a table's positions, the first one first.
pub(super) fn write(path: &Path, table: &Path, kit: kit::Kit, positions: usize) -> Result<(), CommandError> {
    let kit = kit_new::playable(kit, table)?;
    let name = || table.display().to_string();
    let binary = kit::binary::build(&kit)?;
    let parsed = Kit::parse(&binary).map_err(|error| CommandError::Table { kit: name(), error })?;
    let last = positions.max(2) - 1;
    let strike = |number: usize| Event {
        time: Time::at_frame((number * FRAMES) as u64),
        velocity: VELOCITY,
        position: number as f32 / last as f32,
        ..Event::default()
    };
    let events = (0..positions).map(strike).collect();
    let performance = Performance { events, direct: None, frames: positions * FRAMES };
    let settings = Settings { setup: Setup::new(RATE), block: 128, budget_cycles: None };
    let frames = instrument::render(&parsed, &performance, settings, Output::Samples24, |_| {})
        .map_err(|error| CommandError::Render { kit: name(), error })?;
    Ok(wave::write_stereo(path, RATE, &frames)?)
}

//! Sounds of a shape's table: strikes at each position.

use std::path::Path;

use dsp_core::engine::Setup;
use dsp_core::event::{Event, Time};
use dsp_core::fixed::FULL_SCALE_24_BIT;
use dsp_core::{SampleRate, table::Kit};
use malleus::render::Performance;
use malleus::render::instrument::{self, Output, Settings};
use malleus::wave;

use super::error::CommandError;
use super::kit_new;

/// Sample rate of the sounds.
const RATE: SampleRate = SampleRate::HZ_48000;
/// Sample rate of the sounds in Hz.
pub(super) const RATE_HZ: f64 = 48_000.0;
/// Frames from one strike to the next.
const FRAMES: usize = 48_000;
/// Velocity of the strikes.
const VELOCITY: f32 = 0.8;
/// Longest sound of one strike in seconds, and of all strikes on a page together.
const LONGEST_S: [f64; 2] = [2.0, 40.0];
/// Shortest sound of one strike in seconds.
const SHORTEST_S: f64 = 0.3;
/// Time at the end in which a sound that still rings fades out, in seconds.
const FADE_S: f64 = 0.03;
/// Peak of the loudest sound, full scale 1.
const PEAK: f64 = 0.9;

/// Strike of a table at one of its positions, the first one being 0.
fn strike(number: usize, positions: usize, frame: usize) -> Event {
    Event {
        time: Time::at_frame(frame as u64),
        velocity: VELOCITY,
        position: number as f32 / (positions.max(2) - 1) as f32,
        ..Event::default()
    }
}

/// Renders strikes of a table; `table` is its path for messages.
fn render(table: &Path, binary: &[u8], events: Vec<Event>, frames: usize) -> Result<Vec<[i32; 2]>, CommandError> {
    let name = || table.display().to_string();
    let parsed = Kit::parse(binary).map_err(|error| CommandError::Table { kit: name(), error })?;
    let performance = Performance { events, direct: None, frames };
    let settings = Settings { setup: Setup::new(RATE), block: 128, budget_cycles: None };
    instrument::render(&parsed, &performance, settings, Output::Samples24, |_| {})
        .map_err(|error| CommandError::Render { kit: name(), error })
}

/// Makes the bytes of a WAV file of a strike at each of a table's positions, the first one first.
pub(super) fn file(path: &Path, table: &Path, kit: kit::Kit, positions: usize) -> Result<Vec<u8>, CommandError> {
    let binary = kit::binary::build(&kit_new::playable(kit, table)?)?;
    let events = (0..positions).map(|number| strike(number, positions, number * FRAMES)).collect();
    let frames = render(table, &binary, events, positions * FRAMES)?;
    Ok(wave::stereo_bytes(path, RATE.hz(), &frames)?)
}

/// Renders a strike at each position on its own, all at the level at which the loudest one peaks
/// below full scale. `ring_s` is the time in which the longest mode falls by 60 dB.
pub(super) fn strikes(
    table: &Path,
    kit: kit::Kit,
    positions: usize,
    ring_s: f64,
    tell: impl Fn(),
) -> Result<Vec<Vec<f32>>, CommandError> {
    let binary = kit::binary::build(&kit_new::playable(kit, table)?)?;
    let longest_s = LONGEST_S[0].min(LONGEST_S[1] / positions as f64);
    let seconds = ring_s.min(longest_s).max(SHORTEST_S);
    let frames = (seconds * RATE_HZ) as usize;
    let mut sounds = Vec::with_capacity(positions);
    for number in 0..positions {
        let rendered = render(table, &binary, vec![strike(number, positions, 0)], frames)?;
        // The pad is in the middle: both channels are the sound.
        let samples = rendered.iter().enumerate().map(|(frame, sample)| {
            let fade = ((frames - frame) as f64 / (FADE_S * RATE_HZ)).min(1.0);
            fade * f64::from(sample[0]) / f64::from(FULL_SCALE_24_BIT)
        });
        sounds.push(samples.collect::<Vec<f64>>());
        tell();
    }
    let peak = sounds.iter().flatten().fold(0.0_f64, |peak, sample| peak.max(sample.abs()));
    let factor = if peak > 0.0 { PEAK / peak } else { 0.0 };
    let scaled = |sound: Vec<f64>| sound.into_iter().map(|sample| (factor * sample) as f32).collect();
    Ok(sounds.into_iter().map(scaled).collect())
}

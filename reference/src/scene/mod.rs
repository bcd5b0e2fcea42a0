//! Scene: several pads, played by one list of events, mixed to stereo.

mod output;

use crate::error::Error;
use crate::event::{self, Direct, Event};
use crate::pad::{Pad, Part, striker_counts};
use crate::rate::SampleRate;

pub use output::{level_gain, pan_gains, quantise_24};

/// Pads being played.
///
/// A pad that no event and no direct force reaches costs nothing.
pub struct Scene<'a> {
    channels: Vec<Channel<'a>>,
}

/// Part of a pad in the scene, and its gains to left and right.
struct Channel<'a> {
    part: Part<'a>,
    gains: [f64; 2],
}

impl<'a> Scene<'a> {
    /// Scene at sample 0. `events` are sorted by time.
    ///
    /// # Errors
    /// [`Error`] if an index is out of range, events are out of order, or the gains of a bank that
    /// will sound are uneven.
    pub fn new(pads: &'a [Pad], events: &[Event], direct: Option<Direct<'a>>, rate: SampleRate) -> Result<Self, Error> {
        event::check(events, direct, &striker_counts(pads))?;
        let is_driven = |index: usize| {
            direct.is_some_and(|direct| direct.pad == index) || events.iter().any(|event| event.pad == index)
        };
        let driven = (0..pads.len()).filter(|index| is_driven(*index));
        let channels = driven.map(|index| {
            let level = level_gain(pads[index].level_db);
            Ok(Channel {
                part: Part::new(pads, index, events, direct, rate)?,
                gains: pan_gains(pads[index].pan).map(|gain| level * gain),
            })
        });
        Ok(Self { channels: channels.collect::<Result<_, Error>>()? })
    }

    /// Computes the next `frames.len()` frames, `[left, right]`, 1.0 = 0 dBFS, not clipped.
    ///
    /// Blocks of any size, one after another, give the same bits as a single large one.
    pub fn render(&mut self, frames: &mut [[f64; 2]]) {
        frames.fill([0.0; 2]);
        for Channel { part, gains } in &mut self.channels {
            let mut sound = vec![0.0; frames.len()];
            part.render(&mut sound);
            for (frame, y) in frames.iter_mut().zip(sound) {
                frame[0] += gains[0] * y;
                frame[1] += gains[1] * y;
            }
        }
    }
}

/// Renders the first `frame_count` frames of a scene, `[left, right]`, 1.0 = 0 dBFS, not clipped.
///
/// `events` are sorted by time, and `direct` is a force from outside on one pad. A caller that
/// wants to see progress can use [`Scene`] block by block.
///
/// # Errors
/// [`Error`] if an index is out of range, events are out of order, or the gains of a bank that will
/// sound are uneven.
pub fn render(
    pads: &[Pad],
    events: &[Event],
    direct: Option<Direct<'_>>,
    rate: SampleRate,
    frame_count: usize,
) -> Result<Vec<[f64; 2]>, Error> {
    let mut frames = vec![[0.0; 2]; frame_count];
    Scene::new(pads, events, direct, rate)?.render(&mut frames);
    Ok(frames)
}

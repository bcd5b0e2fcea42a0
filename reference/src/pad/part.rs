//! A pad's part in the scene: its voice, and the events that play it, each at its sample.

use super::hand::BLOCK_SAMPLES;
use super::object::Pad;
use super::voice::Voice;
use crate::error::Error;
use crate::event::{Direct, Event, TICK_SAMPLES, in_effect};
use crate::rate::SampleRate;

/// Largest number of samples for which forces are evaluated at a time.
///
/// It keeps memory small for blocks of any length, and changes no bit of the result.
const SPAN_SAMPLES: usize = 256;

/// One pad playing its events.
pub(crate) struct Part<'a> {
    voice: Voice<'a>,
    /// Events yet to come, with the samples at which they act, the latest first.
    to_come: Vec<(u64, Event)>,
    /// Direct force in newtons from sample 0; 0 after its end.
    direct_force: &'a [f64],
    /// Sample to be computed next.
    next_sample: u64,
}

impl<'a> Part<'a> {
    /// Part of the pad with index `pad`, at sample 0. `events` have been checked.
    pub(crate) fn new(
        pads: &'a [Pad],
        pad: usize,
        events: &[Event],
        direct: Option<Direct<'a>>,
        rate: SampleRate,
    ) -> Result<Self, Error> {
        let played = pads.get(pad).ok_or(Error::NoSuchPad { pad, pad_count: pads.len() })?;
        let voice = Voice::new(played, rate).map_err(|(owner, gains)| Error::Bank { pad, owner, gains })?;
        let own_events = events.iter().filter(|event| event.pad == pad).copied();
        let own_direct = direct.filter(|direct| direct.pad == pad);
        Ok(Self {
            voice,
            to_come: in_effect(own_events).into_iter().rev().collect(),
            direct_force: own_direct.map_or(&[], |direct| direct.force),
            next_sample: 0,
        })
    }

    /// Adds the next `sound.len()` samples to `sound`.
    pub(crate) fn render(&mut self, mut sound: &mut [f64]) {
        while !sound.is_empty() {
            while let Some((_, event)) = self.to_come.pop_if(|(sample, _)| *sample <= self.next_sample) {
                self.voice.play(&event);
            }
            if self.next_sample.is_multiple_of(TICK_SAMPLES) {
                self.voice.reach();
            }
            if self.next_sample.is_multiple_of(BLOCK_SAMPLES) {
                self.voice.begin_block();
            }
            let (span, rest) = sound.split_at_mut(self.span_samples().min(sound.len()));
            let direct = self.direct(span.len());
            self.voice.add_sound(self.next_sample, &direct, span);
            self.next_sample += span.len() as u64;
            sound = rest;
        }
    }

    /// Number of samples up to the next event or block, or up to the next tick if a choke or
    /// release still spreads.
    fn span_samples(&self) -> usize {
        let until_event = self.to_come.last().map(|(sample, _)| sample - self.next_sample);
        let until_event = until_event.and_then(|samples| usize::try_from(samples).ok()).unwrap_or(SPAN_SAMPLES);
        // A choke or release reaches further modes at each tick.
        let until_tick = match self.voice.is_being_reached() {
            true => (TICK_SAMPLES - self.next_sample % TICK_SAMPLES) as usize,
            false => (BLOCK_SAMPLES - self.next_sample % BLOCK_SAMPLES) as usize,
        };
        until_event.min(until_tick).min(SPAN_SAMPLES)
    }

    /// Direct force in newtons over the next `length` samples.
    fn direct(&self, length: usize) -> Vec<f64> {
        let from = usize::try_from(self.next_sample).unwrap_or(usize::MAX);
        let ahead = self.direct_force.get(from..).unwrap_or(&[]);
        let mut force = ahead[..length.min(ahead.len())].to_vec();
        force.resize(length, 0.0);
        force
    }
}

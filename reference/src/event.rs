//! What is played: strikes, chokes and releases, each at its time on its pad, and force from outside.

use crate::error::Error;
use crate::pad::Pad;

/// What an [`Event`] does to its pad.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Action {
    /// A contact begins: its pulse starts at the event's exact time.
    Strike,
    /// A hand is laid on the pad: from the first tick behind the event on every mode dies away at least
    /// as fast as [`Pad::choke_t60_s`] says, new strikes included.
    Choke,
    /// The hand is lifted: from the first tick behind the event on the modes have their own decay rates
    /// again.
    Release,
}

/// One thing that happens to one pad.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Event {
    /// When, in samples from the start of the scene, with a fraction; 0 or later.
    pub time_samples: f64,
    /// Index of the pad.
    pub pad: usize,
    /// Strike velocity, 0 to 1; a strike at 0 does nothing at all. Not read for a choke or release.
    pub velocity: f64,
    /// Where along the object the contact is, 0 to 1. Not read for a choke or release.
    pub position: f64,
    /// Index into the pad's strikers. Not read for a choke or release.
    pub striker: usize,
    /// What happens.
    pub action: Action,
}

impl Event {
    /// The first sample `n` with `n >= time_samples`.
    pub fn first_sample(&self) -> u64 {
        // The cast saturates: what happened before the start is known at sample 0.
        self.time_samples.ceil() as u64
    }

    /// The first sample that can hear of this event: of a strike [`Self::first_sample`], of a hand the
    /// first tick behind it.
    pub fn acts_at(&self) -> u64 {
        match self.action {
            Action::Strike => self.first_sample(),
            Action::Choke | Action::Release => (self.first_sample() / TICK_SAMPLES + 1) * TICK_SAMPLES,
        }
    }
}

/// A tick: at each, hands come and go and reach further modes, and the end of their fade is looked for.
pub(crate) const TICK_SAMPLES: u64 = 32;

/// Events in the order in which they act, each with its sample. Of several hands that act at one tick
/// the last counts, and only if it changes whether one lies there.
pub(crate) fn in_effect(events: impl Iterator<Item = Event>) -> Vec<(u64, Event)> {
    let (hands, mut acting): (Vec<_>, Vec<_>) =
        events.map(|event| (event.acts_at(), event)).partition(|(_, event)| event.action != Action::Strike);
    let mut lies = Action::Release;
    for at_tick in hands.chunk_by(|(a, _), (b, _)| a == b) {
        let last = at_tick[at_tick.len() - 1];
        if last.1.action != lies {
            lies = last.1.action;
            acting.push(last);
        }
    }
    // Stable: at one sample hands before strikes.
    acting.sort_by_key(|(sample, event)| (*sample, event.action == Action::Strike));
    acting
}

/// A force that drives a pad sample by sample, such as the signal of a piezo under it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Direct<'a> {
    /// Index of the pad. For its strikers' sound, striker 0 makes this force.
    pub pad: usize,
    /// The force in newtons, one value a sample from sample 0; none after its end.
    pub force: &'a [f64],
}

/// Checks that `events` come in order of time, and that they and `direct` name pads and strikers
/// that exist.
pub(crate) fn check(events: &[Event], direct: Option<Direct<'_>>, pads: &[Pad]) -> Result<(), Error> {
    if let Some(Direct { pad, .. }) = direct
        && pad >= pads.len()
    {
        return Err(Error::NoSuchPad { pad, pad_count: pads.len() });
    }
    let mut previous_samples = f64::NEG_INFINITY;
    for (index, event) in events.iter().enumerate() {
        let Some(pad) = pads.get(event.pad) else {
            return Err(Error::EventPad { event: index, pad: event.pad, pad_count: pads.len() });
        };
        if event.action == Action::Strike && event.striker >= pad.strikers.len() {
            return Err(Error::EventStriker {
                event: index,
                pad: event.pad,
                striker: event.striker,
                striker_count: pad.strikers.len(),
            });
        }
        // The comparison is false for a time that is not a number, which has no place in an order.
        let in_order = previous_samples <= event.time_samples;
        if !in_order {
            return Err(Error::EventOrder { event: index, time_samples: event.time_samples, previous_samples });
        }
        previous_samples = event.time_samples;
    }
    Ok(())
}

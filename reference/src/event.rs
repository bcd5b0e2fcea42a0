//! Events: strikes, chokes and releases, each at its time on its pad, and direct force from
//! outside.

use crate::error::Error;

/// Effect of an [`Event`] on its pad.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Action {
    /// A contact begins: its pulse starts at the event's exact time.
    Strike,
    /// A hand is laid on the pad: every mode decays at least as fast as [`crate::Pad::choke_t60_s`]
    /// says.
    ///
    /// It acts from the first tick after the event on, and on new strikes too.
    Choke,
    /// The hand is lifted: the modes have their own decay rates again, from the first tick after
    /// the event on.
    Release,
}

/// An event on one pad, at one time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Event {
    /// Time in samples from the start of the scene, with a fraction; 0 or later.
    pub time_samples: f64,
    /// Index of the pad.
    pub pad: usize,
    /// Strike velocity, 0 to 1. A strike at 0 does nothing at all. Ignored for a choke or release.
    pub velocity: f64,
    /// Position of the contact along the object, 0 to 1. Ignored for a choke or release.
    pub position: f64,
    /// Index into the pad's strikers. Ignored for a choke or release.
    pub striker: usize,
    /// Effect on the pad.
    pub action: Action,
}

impl Event {
    /// First sample `n` with `n >= time_samples`.
    pub fn first_sample(&self) -> u64 {
        // The cast saturates: an event before the start acts at sample 0.
        self.time_samples.ceil() as u64
    }

    /// First sample that the event affects.
    ///
    /// For a strike it is [`Self::first_sample`], for a choke or release the first tick after it.
    pub fn acts_at(&self) -> u64 {
        match self.action {
            Action::Strike => self.first_sample(),
            Action::Choke | Action::Release => (self.first_sample() / TICK_SAMPLES + 1) * TICK_SAMPLES,
        }
    }
}

/// Length of a tick in samples.
///
/// At each tick hands come and go, chokes and releases reach further modes, and finished fades end.
pub(crate) const TICK_SAMPLES: u64 = 32;

/// Events in the order in which they act, each with its sample.
///
/// If several chokes and releases act at one tick, the last one counts, and only if it changes the
/// state.
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
    // The sort is stable; at one sample chokes and releases come before strikes.
    acting.sort_by_key(|(sample, event)| (*sample, event.action == Action::Strike));
    acting
}

/// A force that drives a pad sample by sample, such as the signal of a piezo under it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Direct<'a> {
    /// Index of the pad. For the strikers' own sound, its striker 0 counts as the source of the
    /// force.
    pub pad: usize,
    /// Force in newtons, one value a sample from sample 0; 0 after its end.
    pub force: &'a [f64],
}

/// Checks that `events` are sorted by time, and that they and `direct` name pads and strikers that
/// exist.
///
/// `striker_counts` holds the number of strikers of each pad.
pub(crate) fn check(events: &[Event], direct: Option<Direct<'_>>, striker_counts: &[usize]) -> Result<(), Error> {
    if let Some(Direct { pad, .. }) = direct
        && pad >= striker_counts.len()
    {
        return Err(Error::NoSuchPad { pad, pad_count: striker_counts.len() });
    }
    let mut previous_samples = f64::NEG_INFINITY;
    for (index, event) in events.iter().enumerate() {
        let Some(&striker_count) = striker_counts.get(event.pad) else {
            return Err(Error::EventPad { event: index, pad: event.pad, pad_count: striker_counts.len() });
        };
        if event.action == Action::Strike && event.striker >= striker_count {
            return Err(Error::EventStriker { event: index, pad: event.pad, striker: event.striker, striker_count });
        }
        // The comparison is false for a time that is not a number, which cannot be sorted.
        let in_order = previous_samples <= event.time_samples;
        if !in_order {
            return Err(Error::EventOrder { event: index, time_samples: event.time_samples, previous_samples });
        }
        previous_samples = event.time_samples;
    }
    Ok(())
}

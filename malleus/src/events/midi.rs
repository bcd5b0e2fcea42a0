//! Events from a Standard MIDI File: General MIDI percussion notes, mapped by the kit.

use std::collections::BTreeMap;

use dsp_core::SampleRate;
use dsp_core::event::{Action, Event};
use dsp_core::table::Kit;
use midly::{Fps, MetaMessage, MidiMessage, Smf, Timing, TrackEventKind};

use super::error::EventsFault;
use super::list::{EventList, time_from_seconds};

/// Channel of General MIDI percussion, counted from 0: users know it as channel 10.
const PERCUSSION_CHANNEL: u8 = 9;

/// Parses a Standard MIDI File into events for a kit at a sample rate.
///
/// A note-on of velocity v is a strike of velocity v/127 on the pad that has the note in
/// `midi_notes`. Note-offs are ignored. Polyphonic aftertouch of 64 and more chokes the pad, less
/// releases it. Only messages on channel 10 count, unless the file has no notes there. All tempo
/// changes are followed; tracks of a format 2 file are merged.
///
/// # Errors
/// [`EventsFault`] for a damaged file and for one whose notes the kit maps to no pad.
pub fn parse(bytes: &[u8], kit: &Kit<'_>, rate: SampleRate) -> Result<EventList, EventsFault> {
    let smf = Smf::parse(bytes).map_err(EventsFault::Midi)?;
    let mut messages: Vec<(u64, Message)> = Vec::new();
    for track in &smf.tracks {
        let mut ticks = 0u64;
        for event in track {
            ticks += u64::from(event.delta.as_int());
            match event.kind {
                TrackEventKind::Meta(MetaMessage::Tempo(tempo)) => {
                    messages.push((ticks, Message::Tempo(tempo.as_int())))
                }
                TrackEventKind::Midi { channel, message } => {
                    messages.push((ticks, Message::Midi(channel.as_int(), message)))
                }
                _ => {}
            }
        }
    }
    // The sort is stable: messages of one tick keep the file's order, in which the tempo track of a
    // format 1 file comes first.
    messages.sort_by_key(|(ticks, _)| *ticks);
    let on_percussion = messages.iter().any(|(_, message)| message.is_note_on(Some(PERCUSSION_CHANNEL)));
    let channel = on_percussion.then_some(PERCUSSION_CHANNEL);

    let mut list = EventList::default();
    let mut unmapped = BTreeMap::<u8, usize>::new();
    let mut clock = Clock::new(smf.header.timing)?;
    for (ticks, message) in &messages {
        let seconds = clock.seconds_at(*ticks);
        if let Message::Tempo(microseconds) = message {
            clock.set_tempo(*microseconds);
        }
        let Some((note, velocity, action)) = message.action(channel) else { continue };
        let Some(pad) = pad_of_note(kit, note) else {
            if action == Action::Strike {
                *unmapped.entry(note).or_default() += 1;
            }
            continue;
        };
        let Some(time) = time_from_seconds(seconds, rate) else { continue };
        list.events.push(Event { time, pad, velocity, position: 0.0, striker: 0, action });
    }
    let skipped: usize = unmapped.values().sum();
    if skipped > 0 {
        if !list.events.iter().any(|event| event.action == Action::Strike) {
            return Err(EventsFault::NoMappedNote { notes: skipped, mapped: mapped_notes(kit) });
        }
        let notes: Vec<_> = unmapped.iter().map(|(note, count)| format!("{note} ({count} times)")).collect();
        list.remarks.push(format!("no pad plays note {}: these notes are left out", notes.join(", ")));
    }
    Ok(list)
}

/// A message of any track that may matter.
enum Message {
    /// New tempo, in microseconds per quarter note.
    Tempo(u32),
    Midi(u8, MidiMessage),
}

impl Message {
    fn is_note_on(&self, channel: Option<u8>) -> bool {
        matches!(self.action(channel), Some((_, _, Action::Strike)))
    }

    /// Note, velocity and action of a message, or `None` if it means nothing or is on a channel
    /// other than `only_channel`.
    fn action(&self, only_channel: Option<u8>) -> Option<(u8, f32, Action)> {
        let Self::Midi(channel, message) = self else { return None };
        if only_channel.is_some_and(|only| only != *channel) {
            return None;
        }
        match message {
            MidiMessage::NoteOn { key, vel } if vel.as_int() > 0 => {
                Some((key.as_int(), f32::from(vel.as_int()) / 127.0, Action::Strike))
            }
            MidiMessage::Aftertouch { key, vel } => {
                let action = if vel.as_int() >= 64 { Action::Choke } else { Action::Release };
                Some((key.as_int(), 0.0, action))
            }
            _ => None,
        }
    }
}

/// Converter from MIDI ticks to seconds that follows the tempo changes so far.
pub(super) struct Clock {
    ticks: u64,
    seconds: f64,
    seconds_per_tick: f64,
    ticks_per_quarter: Option<f64>,
}

impl Clock {
    pub(super) fn new(timing: Timing) -> Result<Self, EventsFault> {
        let (ticks_per_quarter, seconds_per_tick) = match timing {
            // 120 quarter notes per minute until the file sets a tempo.
            Timing::Metrical(ticks) => (Some(f64::from(ticks.as_int())), 0.5 / f64::from(ticks.as_int())),
            Timing::Timecode(fps, subframes) => (None, 1.0 / (frames_per_second(fps) * f64::from(subframes))),
        };
        match seconds_per_tick.is_finite() {
            true => Ok(Self { ticks: 0, seconds: 0.0, seconds_per_tick, ticks_per_quarter }),
            false => Err(EventsFault::MidiTiming),
        }
    }

    pub(super) fn seconds_at(&mut self, ticks: u64) -> f64 {
        self.seconds += (ticks - self.ticks) as f64 * self.seconds_per_tick;
        self.ticks = ticks;
        self.seconds
    }

    pub(super) fn set_tempo(&mut self, microseconds_per_quarter: u32) {
        if let Some(ticks_per_quarter) = self.ticks_per_quarter {
            self.seconds_per_tick = f64::from(microseconds_per_quarter) * 1e-6 / ticks_per_quarter;
        }
    }
}

fn frames_per_second(fps: Fps) -> f64 {
    match fps {
        Fps::Fps29 => 30_000.0 / 1001.0,
        other => f64::from(other.as_int()),
    }
}

fn pad_of_note(kit: &Kit<'_>, note: u8) -> Option<u8> {
    (0u8..=254).zip(kit.pads()).find(|(_, pad)| pad.midi_notes().any(|own| own == note)).map(|(index, _)| index)
}

fn mapped_notes(kit: &Kit<'_>) -> String {
    let mapped: Vec<_> =
        kit.pads().flat_map(|pad| pad.midi_notes().map(move |note| format!("{note} ({})", pad.name()))).collect();
    if mapped.is_empty() { "no notes".to_owned() } else { mapped.join(", ") }
}

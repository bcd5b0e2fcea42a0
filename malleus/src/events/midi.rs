//! Events from a Standard MIDI File: General MIDI percussion notes, mapped by the kit.

use std::collections::BTreeMap;

use dsp_core::SampleRate;
use dsp_core::event::Action;
use dsp_core::midi::{self, Keyboard, Outcome};
use dsp_core::table::Kit;
use midly::{Fps, MetaMessage, MidiMessage, Smf, Timing, TrackEventKind};

use super::error::EventsFault;
use super::list::{EventList, time_from_seconds};
use kit::counting::counted;

/// Channel of General MIDI percussion, counted from 0: users know it as channel 10.
const PERCUSSION_CHANNEL: u8 = 9;

/// Parses a Standard MIDI File into events for a kit at a sample rate.
///
/// The [`Keyboard`] maps the messages, as on the boards. Only messages on channel 10 count, unless
/// the file has no notes there. SysEx is left out. All tempo changes are followed; tracks of a
/// format 2 file are merged.
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
                    messages.push((ticks, Message::Midi(message_of(channel.as_int(), message))))
                }
                _ => {}
            }
        }
    }
    // The sort is stable: messages of one tick keep the file's order, in which the tempo track of a
    // format 1 file comes first.
    messages.sort_by_key(|(ticks, _)| *ticks);
    let on_percussion = messages.iter().any(|(_, message)| message.is_note_on());
    let channel = on_percussion.then_some(PERCUSSION_CHANNEL);

    let mut list = EventList::default();
    let mut unmapped = BTreeMap::<u8, usize>::new();
    let (mut strikes, mut programs) = (0usize, 0usize);
    let mut clock = Clock::new(smf.header.timing)?;
    let mut keyboard = Keyboard::new(*kit, channel);
    for (ticks, message) in &messages {
        let seconds = clock.seconds_at(*ticks);
        let Some(message) = (match message {
            Message::Tempo(microseconds) => {
                clock.set_tempo(*microseconds);
                None
            }
            Message::Midi(message) => Some(*message),
        }) else {
            continue;
        };
        let Some(time) = time_from_seconds(seconds, rate) else { continue };
        let outcome = keyboard.take(message, time, |event| {
            strikes += usize::from(event.action == Action::Strike);
            list.events.push(event);
        });
        match (outcome, message) {
            (Outcome::NoPad(note), midi::Message::NoteOn { .. }) => *unmapped.entry(note).or_default() += 1,
            (Outcome::Program(_), _) => programs += 1,
            _ => {}
        }
    }
    if programs > 0 {
        list.remarks.push(format!("{} left out: a file plays one kit", counted(programs, "program changes")));
    }
    let skipped: usize = unmapped.values().sum();
    if skipped > 0 {
        if strikes == 0 {
            return Err(EventsFault::NoMappedNote { notes: skipped, mapped: mapped_notes(kit) });
        }
        let notes: Vec<_> =
            unmapped.iter().map(|(note, &count)| format!("{note} ({})", counted(count, "times"))).collect();
        list.remarks.push(format!("no pad plays note {}: these notes are left out", notes.join(", ")));
    }
    Ok(list)
}

/// A message of any track that may matter.
enum Message {
    /// New tempo, in microseconds per quarter note.
    Tempo(u32),
    Midi(midi::Message),
}

impl Message {
    fn is_note_on(&self) -> bool {
        matches!(self, Self::Midi(midi::Message::NoteOn { channel: PERCUSSION_CHANNEL, velocity: 1.., .. }))
    }
}

/// Converts a message of a file.
fn message_of(channel: u8, message: MidiMessage) -> midi::Message {
    match message {
        MidiMessage::NoteOff { key, vel } => {
            midi::Message::NoteOff { channel, note: key.as_int(), velocity: vel.as_int() }
        }
        MidiMessage::NoteOn { key, vel } => {
            midi::Message::NoteOn { channel, note: key.as_int(), velocity: vel.as_int() }
        }
        MidiMessage::Aftertouch { key, vel } => {
            midi::Message::PolyPressure { channel, note: key.as_int(), pressure: vel.as_int() }
        }
        MidiMessage::Controller { controller, value } => {
            midi::Message::ControlChange { channel, controller: controller.as_int(), value: value.as_int() }
        }
        MidiMessage::ProgramChange { program } => midi::Message::ProgramChange { channel, program: program.as_int() },
        MidiMessage::ChannelAftertouch { vel } => midi::Message::ChannelPressure { channel, pressure: vel.as_int() },
        MidiMessage::PitchBend { bend } => {
            let bend = bend.0.as_int();
            midi::Message::PitchBend { channel, bend: [(bend & 0x7F) as u8, (bend >> 7) as u8] }
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

fn mapped_notes(kit: &Kit<'_>) -> String {
    let mapped: Vec<_> =
        kit.pads().flat_map(|pad| pad.midi_notes().map(move |note| format!("{note} ({})", pad.name()))).collect();
    if mapped.is_empty() { "no notes".to_owned() } else { mapped.join(", ") }
}

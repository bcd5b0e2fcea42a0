//! MIDI of the USB host: its messages become events, and strikes of the pads become its messages.
//!
//! ```text
//! transfer ends ──► age at the interrupt ──► frame of the next half - age + HALF_FRAMES ──► event
//! ```

use dsp_core::event::{Event, Time};
use dsp_core::midi::{Cables, Heard, Keyboard, Message, MidiOut, Outcome, Packet};
use dsp_core::table::Kit;

use super::instrument::Instrument;
use super::programs;
use crate::board::CLOCKS;
use crate::counters;
use crate::half::HALF_FRAMES;
use crate::usb::{self, Incoming, Outgoing};

/// Maximum number of packets that a half takes: one full transfer. Others wait for the next half,
/// as do all behind a message to all pads, and all while no more events can wait.
const PACKETS_PER_HALF: usize = 16;
/// Maximum number of events of a message to one pad: a note lifts the hand and strikes.
const EVENTS_OF_A_PAD: usize = 2;
/// Core cycles of a frame of the output.
const CYCLES_PER_FRAME: i32 = CLOCKS.cycles_per_frames(1) as i32;
/// Channel on which strikes go out unless the settings name another, counted from 0: users know it
/// as channel 10.
const CHANNEL_OUT: u8 = 9;

/// Ends of the MIDI queues, with the state of both directions.
pub struct Midi {
    incoming: Incoming,
    outgoing: Outgoing,
    cables: Cables,
    keyboard: Keyboard<'static>,
    out: MidiOut<'static>,
}

impl Midi {
    /// Makes the MIDI of a kit on a channel, counted from 0. `None` listens to all channels, and
    /// sends on channel 10.
    pub fn new((incoming, outgoing): (Incoming, Outgoing), kit: Kit<'static>, channel: Option<u8>) -> Self {
        let (keyboard, out) = (Keyboard::new(kit, channel), MidiOut::new(kit, channel.unwrap_or(CHANNEL_OUT)));
        Self { incoming, outgoing, cables: Cables::new(), keyboard, out }
    }

    /// Changes the kit and the channel.
    // Not inlined: the keyboard that is built here must not add to the stack of its callers.
    #[inline(never)]
    pub(super) fn set(&mut self, kit: Kit<'static>, channel: Option<u8>) {
        self.keyboard = Keyboard::new(kit, channel);
        self.out = MidiOut::new(kit, channel.unwrap_or(CHANNEL_OUT));
    }

    /// Drops the messages that have come and not been taken.
    pub(super) fn forget_waiting(&mut self) {
        while self.incoming.take().is_some() {
            counters::USB_LOST.add(1);
        }
    }

    /// Passes the messages of the host to the instrument, each with the time at which its transfer
    /// ended. `begun` is the time of the interrupt in core cycles.
    #[inline(always)]
    pub(super) fn take(&mut self, begun: u32, instrument: &mut Instrument) {
        if usb::host_is_new() {
            self.keyboard.forget_keys();
        }
        if !self.incoming.is_empty() {
            self.take_packets(begun, instrument);
        }
    }

    // Not inlined, so that its stack and that of the renderer share their place.
    #[inline(never)]
    fn take_packets(&mut self, begun: u32, instrument: &mut Instrument) {
        for _ in 0..PACKETS_PER_HALF {
            if !instrument.has_room() {
                return;
            }
            let Some(received) = self.incoming.take() else { return };
            // A transfer may end after the interrupt began.
            let age = begun.wrapping_sub(received.at).cast_signed() / CYCLES_PER_FRAME;
            let frame = (instrument.now() + HALF_FRAMES as u64).saturating_add_signed(-i64::from(age));
            let (keyboard, time) = (&mut self.keyboard, Time::at_frame(frame.max(instrument.now())));
            let mut events = 0;
            self.cables.take(Packet(received.packet), |heard| match heard {
                Heard::Message(message) => {
                    counters::MIDI_MESSAGES.add(1);
                    let expect = |event| {
                        instrument.expect(event);
                        events += 1;
                    };
                    match keyboard.take(message, time, expect) {
                        Outcome::Program(program) => programs::ask(program),
                        outcome => count(message, outcome),
                    }
                }
                // SysEx goes to its task; only damaged streams have any here.
                _ => counters::MIDI_UNKNOWN.add(1),
            });
            if events > EVENTS_OF_A_PAD {
                return;
            }
        }
    }

    /// Tells the host what a piezo or a button has played.
    pub(super) fn tell(&mut self, event: &Event) {
        let outgoing = &mut self.outgoing;
        self.out.tell(event, &self.keyboard, |packet| outgoing.push(packet.0));
    }
}

/// Counts a message without a meaning here. Real-time messages come all the time and are not
/// counted.
fn count(message: Message, outcome: Outcome) {
    let is_real_time = matches!(message, Message::System { status: 0xF8.., .. });
    if !is_real_time && !matches!(outcome, Outcome::Taken) {
        counters::MIDI_UNKNOWN.add(1);
    }
}

//! MIDI out: packets for what is played on the pads.

use super::keyboard::Keyboard;
use super::message::Message;
use super::packet::Packet;
use crate::event::{Action, Event};
use crate::table::Kit;

/// Controller in which the position of a strike goes out.
const POSITION: u8 = 16;

/// MIDI out of a kit.
#[derive(Clone, Debug)]
pub struct MidiOut<'k> {
    kit: Kit<'k>,
    channel: u8,
    /// Position that the host was told last.
    position: u8,
}

impl<'k> MidiOut<'k> {
    /// Makes the MIDI out of a kit on a channel, counted from 0.
    pub const fn new(kit: Kit<'k>, channel: u8) -> Self {
        Self { kit, channel, position: 0 }
    }

    /// Gives the packets of an event that a piezo or a button has made, up to two.
    ///
    /// A pad without notes sends nothing, nor does one that the host plays: a key of the pad is
    /// down on the `keyboard`.
    pub fn tell(&mut self, event: &Event, keyboard: &Keyboard<'_>, mut send: impl FnMut(Packet)) {
        let (channel, pad) = (self.channel, self.kit.pads().nth(usize::from(event.pad)));
        let Some(note) = pad.and_then(|pad| pad.midi_notes().next()) else { return };
        if keyboard.is_held(event.pad) {
            return;
        }
        let mut send = |message| send(Packet::of(message));
        let pressure = match event.action {
            Action::Strike => {
                let position = seven_bits(event.position);
                if core::mem::replace(&mut self.position, position) != position {
                    send(Message::ControlChange { channel, controller: POSITION, value: position });
                }
                return send(Message::NoteOn { channel, note, velocity: seven_bits(event.velocity).max(1) });
            }
            Action::Choke => 127,
            Action::Release => 0,
            _ => return,
        };
        send(Message::PolyPressure { channel, note, pressure });
    }
}

/// Returns a share of 0 to 1 as the nearest value of 7 bits.
fn seven_bits(share: f32) -> u8 {
    (share * 127.0 + 0.5) as u8
}

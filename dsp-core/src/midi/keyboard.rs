//! Mapping of messages to events.

use super::message::Message;
use crate::event::{Action, Event, Time};
use crate::fixed;
use crate::table::Kit;
use crate::trigger::Settings;

/// Controllers that set the position of the strikes that follow: general purpose 1 and 2, which
/// drum modules send for snare and ride.
const POSITION: core::ops::RangeInclusive<u8> = 16..=17;
/// Controller of the level.
const LEVEL: u8 = 7;
/// Controller that ends all sound.
const ALL_SOUND_OFF: u8 = 120;
/// Controller that lets all others go back to their beginning.
const RESET_CONTROLLERS: u8 = 121;
/// Controller that lets all keys go.
const ALL_NOTES_OFF: u8 = 123;
/// Pressure from which a hand lies on the pad.
const HAND: u8 = 64;
/// Mark of a note that no pad plays.
const NO_PAD: u8 = u8::MAX;

/// Result of a message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// The message was understood. It has made events, or changed what later messages do.
    Taken,
    /// The kit of a program is asked for. The caller changes kits.
    Program(u8),
    /// No pad plays the note of the message.
    NoPad(u8),
    /// The message is of another channel than the keyboard's.
    OtherChannel,
    /// The message has no meaning here.
    Unknown,
}

/// Set of up to 256 pads.
#[derive(Clone, Copy, Debug, Default)]
struct Pads([u32; 8]);

impl Pads {
    /// Puts a pad in, or takes it out. Returns true if that changes the set.
    fn set(&mut self, pad: u8, is_in: bool) -> bool {
        let Some(word) = self.0.get_mut(usize::from(pad / 32)) else { return false };
        let (before, bit) = (*word, 1 << (pad % 32));
        *word = if is_in { before | bit } else { before & !bit };
        *word != before
    }

    /// True if a pad is in the set.
    fn has(&self, pad: u8) -> bool {
        self.0.get(usize::from(pad / 32)).is_some_and(|word| word >> (pad % 32) & 1 != 0)
    }
}

/// Keyboard of a kit: which pads its notes play, and what messages have set.
///
/// State: 320 bytes. A message takes some hundred cycles for each event that it makes.
#[derive(Clone, Debug)]
pub struct Keyboard<'k> {
    kit: Kit<'k>,
    /// Channel that is listened to; `None` for all.
    channel: Option<u8>,
    pad_of_note: [u8; 128],
    /// Value of the position controller of each channel.
    positions: [u8; 16],
    /// Pads on which pressure lays a hand.
    pressed: Pads,
    /// Pads that the end of a note has choked.
    damped: Pads,
    /// Keys that are down, a bit each.
    down: [u32; 4],
}

impl<'k> Keyboard<'k> {
    /// Makes the keyboard of a kit. `channel` is the one that is listened to, counted from 0;
    /// `None` listens to all.
    pub fn new(kit: Kit<'k>, channel: Option<u8>) -> Self {
        let mut pad_of_note = [NO_PAD; 128];
        for (number, pad) in (0..NO_PAD).zip(kit.pads()) {
            for note in pad.midi_notes() {
                if let Some(place) = pad_of_note.get_mut(usize::from(note)) {
                    *place = number;
                }
            }
        }
        let (pressed, damped) = (Pads::default(), Pads::default());
        Self { kit, channel, pad_of_note, positions: [0; 16], pressed, damped, down: [0; 4] }
    }

    /// Pad that plays a note; `None` if no pad does.
    pub fn pad_of_note(&self, note: u8) -> Option<u8> {
        self.pad_of_note.get(usize::from(note)).copied().filter(|&pad| pad != NO_PAD)
    }

    /// True if a key of the pad is down: the host plays the pad.
    pub fn is_held(&self, pad: u8) -> bool {
        let notes = self.kit.pads().nth(usize::from(pad));
        notes.is_some_and(|pad| pad.midi_notes().any(|note| self.down_word(note) >> (note % 32) & 1 != 0))
    }

    /// Forgets the keys that are down: another host plays from now on.
    pub fn forget_keys(&mut self) {
        self.down = [0; 4];
    }

    fn down_word(&self, note: u8) -> u32 {
        self.down.get(usize::from(note / 32)).copied().unwrap_or(0)
    }

    fn set_down(&mut self, note: u8, is_down: bool) {
        if let Some(word) = self.down.get_mut(usize::from(note / 32)) {
            let bit = 1 << (note % 32);
            *word = if is_down { *word | bit } else { *word & !bit };
        }
    }

    /// Takes a message of a time. `play` gets the events that it makes, in order.
    pub fn take(&mut self, message: Message, time: Time, mut play: impl FnMut(Event)) -> Outcome {
        let Some(channel) = message.channel() else { return Outcome::Unknown };
        if self.channel.is_some_and(|own| own != channel) {
            return Outcome::OtherChannel;
        }
        match message {
            Message::NoteOn { note, velocity: 1.., .. } | Message::PolyPressure { note, .. }
                if self.pad_of_note(note).is_none() =>
            {
                return Outcome::NoPad(note);
            }
            Message::NoteOn { note, velocity: 0, .. } | Message::NoteOff { note, .. } => self.let_go(note, time, play),
            Message::NoteOn { note, velocity, .. } => self.strike(note, velocity, channel, time, play),
            Message::PolyPressure { note, pressure, .. } => {
                if let Some(pad) = self.pad_of_note(note) {
                    self.press(pad, pressure, time, &mut play);
                }
            }
            Message::ChannelPressure { pressure, .. } => self.press_all(pressure, time, play),
            Message::ControlChange { controller, value, .. } => match controller {
                _ if POSITION.contains(&controller) => {
                    if let Some(position) = self.positions.get_mut(usize::from(channel)) {
                        *position = value;
                    }
                }
                LEVEL => {
                    let share = share(value);
                    play(Event { time, velocity: share * share, action: Action::Level, ..Event::NOTHING });
                }
                ALL_SOUND_OFF | ALL_NOTES_OFF => {
                    self.down = [0; 4];
                    play(Event { time, action: Action::Silence, ..Event::NOTHING });
                }
                RESET_CONTROLLERS => {
                    if let Some(position) = self.positions.get_mut(usize::from(channel)) {
                        *position = 0;
                    }
                    self.press_all(0, time, play);
                }
                _ => return Outcome::Unknown,
            },
            Message::ProgramChange { program, .. } => return Outcome::Program(program),
            Message::PitchBend { .. } | Message::System { .. } => return Outcome::Unknown,
        }
        Outcome::Taken
    }

    fn strike(&mut self, note: u8, velocity: u8, channel: u8, time: Time, mut play: impl FnMut(Event)) {
        let Some(pad) = self.pad_of_note(note) else { return };
        self.set_down(note, true);
        if self.damped.set(pad, false) && !self.pressed.has(pad) {
            play(Event { time, pad, action: Action::Release, ..Event::NOTHING });
        }
        let exponent = Settings::of_pad(&self.kit, pad).velocity_exponent;
        let velocity = fixed::power(share(velocity), exponent);
        let position = share(self.positions.get(usize::from(channel)).copied().unwrap_or(0));
        play(Event { time, pad, velocity, position, ..Event::NOTHING });
    }

    /// Ends a note: the pad is choked if the kit says so.
    fn let_go(&mut self, note: u8, time: Time, mut play: impl FnMut(Event)) {
        self.set_down(note, false);
        let Some(number) = self.pad_of_note(note) else { return };
        let chokes = self.kit.pads().nth(usize::from(number)).is_some_and(|pad| pad.note_off_chokes());
        if chokes && self.damped.set(number, true) && !self.pressed.has(number) {
            play(Event { time, pad: number, action: Action::Choke, ..Event::NOTHING });
        }
    }

    /// Lays a hand on a pad or takes it away, if it was not so before.
    fn press(&mut self, pad: u8, pressure: u8, time: Time, play: &mut impl FnMut(Event)) {
        let is_hand = pressure >= HAND;
        // The end of a note may have laid a hand there already.
        if self.pressed.set(pad, is_hand) && !self.damped.has(pad) {
            let action = if is_hand { Action::Choke } else { Action::Release };
            play(Event { time, pad, action, ..Event::NOTHING });
        }
    }

    fn press_all(&mut self, pressure: u8, time: Time, mut play: impl FnMut(Event)) {
        for pad in (0..NO_PAD).take(self.kit.pads().len()) {
            self.press(pad, pressure, time, &mut play);
        }
    }
}

/// Returns a value of 7 bits as a share of its range, 0 to 1.
fn share(value: u8) -> f32 {
    f32::from(value.min(127)) / 127.0
}

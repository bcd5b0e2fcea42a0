//! The parser against a second one that is written plainly, cables, and the mapping.

extern crate std;

use std::vec::Vec;

use super::message::Message;
use super::packet::{Cables, Packet};
use super::parser::{Heard, Parser};

/// Source of random numbers with equal sequences in all runs.
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0
    }

    fn below(&mut self, limit: u64) -> u64 {
        self.next() % limit
    }
}

/// Messages of a stream, and its whole SysEx, by the rules of the MIDI 1.0 specification, applied
/// to the stream as a whole: real-time bytes are taken out first, then the rest is cut at its
/// status bytes.
fn plainly(stream: &[u8]) -> (Vec<[u8; 3]>, Vec<Vec<u8>>, usize) {
    let is_real_time = |byte: &u8| *byte >= 0xF8;
    let rest: Vec<u8> = stream.iter().copied().filter(|byte| !is_real_time(byte)).collect();
    let (mut messages, mut sysex) = (Vec::new(), Vec::new());
    let mut at = rest.iter().position(|&byte| byte >= 0x80).unwrap_or(rest.len());
    while at < rest.len() {
        let status = rest[at];
        let end = rest[at + 1..].iter().position(|&byte| byte >= 0x80).map_or(rest.len(), |n| at + 1 + n);
        let data = &rest[at + 1..end];
        match status {
            0xF0 if rest.get(end) == Some(&0xF7) => sysex.push(data.to_vec()),
            0xC0..=0xDF => messages.extend(data.iter().map(|&first| [status, first, 0])),
            0x80..=0xEF => messages.extend(data.chunks_exact(2).map(|pair| [status, pair[0], pair[1]])),
            0xF1 | 0xF3 => messages.extend(data.first().map(|&first| [status, first, 0])),
            0xF2 if data.len() >= 2 => messages.push([status, data[0], data[1]]),
            0xF6 => messages.push([status, 0, 0]),
            _ => {}
        }
        at = end;
    }
    let real_time = stream.iter().filter(|byte| is_real_time(byte) && **byte != 0xF9 && **byte != 0xFD).count();
    (messages, sysex, real_time)
}

/// Result of the parser for a stream, in the form of [`plainly`].
fn parsed(stream: &[u8]) -> (Vec<[u8; 3]>, Vec<Vec<u8>>, usize) {
    let (mut messages, mut sysex, mut real_time) = (Vec::new(), Vec::new(), 0);
    let mut parser = Parser::new();
    let mut present = Vec::new();
    for &byte in stream {
        parser.take(byte, |heard| match heard {
            Heard::Message(Message::System { status: 0xF8.., .. }) => real_time += 1,
            Heard::Message(message) => messages.push(message.bytes()),
            Heard::SysexBegins => present.clear(),
            Heard::SysexByte(byte) => present.push(byte),
            Heard::SysexEnds => sysex.push(core::mem::take(&mut present)),
            Heard::SysexCut | Heard::Stray => {}
        });
    }
    (messages, sysex, real_time)
}

/// A stream of about `length` bytes: messages, whole and cut, SysEx, running status, real-time
/// bytes between any two bytes, and bytes at random.
fn stream(length: usize, random: &mut Random) -> Vec<u8> {
    let mut bytes = Vec::new();
    while bytes.len() < length {
        let begin = bytes.len();
        match random.below(8) {
            0 => bytes.extend((0..random.below(20)).map(|_| random.next() as u8)),
            1 => {
                bytes.push(0xF0);
                bytes.extend((0..random.below(40)).map(|_| random.next() as u8 & 0x7F));
                if random.below(4) > 0 {
                    bytes.push(0xF7);
                }
            }
            2 => bytes.push(0xF1 + random.below(7) as u8),
            kind => {
                if kind != 3 {
                    bytes.push(0x80 | random.below(0x70) as u8);
                }
                bytes.extend((0..random.below(7)).map(|_| random.next() as u8 & 0x7F));
            }
        }
        if random.below(4) == 0 {
            let place = begin + random.below((bytes.len() - begin) as u64 + 1) as usize;
            bytes.insert(place, 0xF8 + random.below(8) as u8);
        }
    }
    bytes
}

#[test]
fn ten_million_bytes_give_the_messages_of_a_second_parser() {
    let mut random = Random(0x9E37_79B9_7F4A_7C15);
    let mut bytes = 0;
    while bytes < 10_000_000 {
        let stream = stream(100_000, &mut random);
        assert!(parsed(&stream) == plainly(&stream));
        bytes += stream.len();
    }
}

#[test]
fn damage_costs_at_most_the_message_that_it_hits() {
    let mut random = Random(77);
    for _ in 0..2_000 {
        let note = |n: u8| [0x90 | (n % 16), n % 128, 1 + n % 100];
        let mut stream: Vec<u8> = (0..20).flat_map(note).collect();
        let place = random.below(stream.len() as u64) as usize;
        if random.below(2) == 0 {
            stream.remove(place);
        } else {
            stream[place] = random.next() as u8 & 0x7F;
        }
        let messages = parsed(&stream).0;
        let intact = (0..20).filter(|&n| messages.contains(&note(n))).count();
        assert!(intact >= 19, "{intact} of 20 notes");
    }
}

#[test]
fn packets_of_sixteen_cables_do_not_mix() {
    let mut random = Random(5);
    let mut cables = Cables::new();
    let mut heard = Vec::new();
    // Each cable sends a SysEx byte by byte and notes between; the cables take turns at random.
    let mut places = [0u8; 16];
    while places.iter().any(|&place| place < 30) {
        let cable = random.below(16) as u8;
        let place = &mut places[usize::from(cable)];
        let packet = match *place {
            0 => [0x0F, 0xF0, 0, 0],
            1..20 => [0x0F, *place, 0, 0],
            20 => [0x0F, 0xF7, 0, 0],
            _ => [0x09, 0x90 | cable, *place, 64],
        };
        *place += 1;
        cables.take(Packet([cable << 4 | packet[0], packet[1], packet[2], packet[3]]), |thing| {
            heard.push((cable, thing))
        });
    }
    for cable in 0..16 {
        let of_cable = |thing: Heard| heard.iter().filter(|&&(from, heard)| from == cable && heard == thing).count();
        assert_eq!((of_cable(Heard::SysexBegins), of_cable(Heard::SysexEnds), of_cable(Heard::Stray)), (1, 1, 0));
        let note = Message::NoteOn { channel: cable, note: 25, velocity: 64 };
        assert_eq!(of_cable(Heard::Message(note)), 1);
    }
}

#[test]
fn each_message_survives_the_way_through_a_packet() {
    for status in (0x80..=0xEF).chain([0xF1, 0xF2, 0xF3, 0xF6, 0xF8, 0xFA, 0xFE, 0xFF]) {
        let data = match super::message::data_bytes(status) {
            0 => [0, 0],
            1 => [5, 0],
            _ => [5, 99],
        };
        let message = Message::new(status, data);
        let mut heard = Vec::new();
        Cables::new().take(Packet::of(message), |thing| heard.push(thing));
        assert_eq!(heard, [Heard::Message(message)]);
    }
}

#[test]
fn reserved_packets_and_packets_of_other_lengths_leave_the_stream_in_step() {
    let mut cables = Cables::new();
    let mut heard = Vec::new();
    // Reserved codes, a packet with status bytes where data belong, and one with data alone.
    for packet in [[0x00, 0x90, 1, 1], [0x01, 1, 2, 3], [0x09, 0x90, 0x90, 0x90], [0x09, 1, 2, 3]] {
        cables.take(Packet(packet), |_| {});
    }
    cables.take(Packet([0x09, 0x91, 60, 64]), |thing| heard.push(thing));
    let note = Heard::Message(Message::NoteOn { channel: 1, note: 60, velocity: 64 });
    assert!(heard.contains(&note), "{heard:?}");
}

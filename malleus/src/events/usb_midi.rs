//! USB-MIDI event packets from Standard MIDI Files and SysEx files, and a file of what a board
//! sends (USB Device Class Definition for MIDI Devices 1.0, section 4).

use midly::live::LiveEvent;
use midly::num::{u15, u24, u28};
use midly::{Format, Header, MetaMessage, Smf, Timing, TrackEvent, TrackEventKind};

use super::error::EventsFault;
use super::midi::Clock;

/// Event packet: cable and code index number, then up to three MIDI bytes.
pub type Packet = [u8; 4];

/// Ticks per quarter note in files of what a board sends: 20 us at 120 quarter notes per minute.
const TICKS_PER_QUARTER: u16 = 25_000;
/// Tempo of these files in microseconds per quarter note.
const QUARTER_US: u32 = 500_000;
/// First byte of a SysEx.
const BEGIN: u8 = 0xf0;
/// Last byte of a SysEx.
const END: u8 = 0xf7;

/// Returns the messages of a Standard MIDI File as packets, with their times in seconds.
///
/// All channels and all SysEx are there. Tracks are merged, and tempo changes followed.
///
/// # Errors
/// [`EventsFault`] for a damaged file.
pub fn packets(bytes: &[u8]) -> Result<Vec<(f64, Vec<Packet>)>, EventsFault> {
    let smf = Smf::parse(bytes).map_err(EventsFault::Midi)?;
    let mut events: Vec<(u64, &TrackEventKind<'_>)> = Vec::new();
    for track in &smf.tracks {
        let mut ticks = 0u64;
        for event in track {
            ticks += u64::from(event.delta.as_int());
            events.push((ticks, &event.kind));
        }
    }
    // The sort is stable: the tempo track of a format 1 file stays before the others.
    events.sort_by_key(|(ticks, _)| *ticks);
    let mut clock = Clock::new(smf.header.timing)?;
    let mut list = Vec::new();
    for (ticks, event) in events {
        let seconds = clock.seconds_at(ticks);
        match event {
            TrackEventKind::Meta(MetaMessage::Tempo(tempo)) => clock.set_tempo(tempo.as_int()),
            TrackEventKind::SysEx(data) => list.push((seconds, sysex(&[&[BEGIN], *data].concat()))),
            TrackEventKind::Midi { channel, message } => {
                let mut packet = [0; 4];
                let mut rest = &mut packet[1..];
                let message = LiveEvent::Midi { channel: *channel, message: *message };
                // A channel message has at most three bytes.
                if message.write(&mut rest).is_ok() {
                    packet[0] = packet[1] >> 4;
                    list.push((seconds, vec![packet]));
                }
            }
            TrackEventKind::Meta(_) | TrackEventKind::Escape(_) => {}
        }
    }
    Ok(list)
}

/// Returns the packets of raw SysEx bytes, as in a .syx file: one SysEx after the other.
pub fn sysex(bytes: &[u8]) -> Vec<Packet> {
    let messages = bytes.split_inclusive(|&byte| byte == END);
    let packet = |piece: &[u8]| {
        let mut packet = [4, 0, 0, 0];
        packet[1..=piece.len()].copy_from_slice(piece);
        if piece.last() == Some(&END) || piece.len() < 3 {
            packet[0] = 4 + piece.len() as u8;
        }
        packet
    };
    messages.flat_map(|message| message.chunks(3)).map(packet).collect()
}

/// Writes packets, with their times in seconds in order, as a Standard MIDI File of one track.
///
/// Messages that a file cannot hold, such as real-time bytes, are left out.
///
/// # Errors
/// The description of a failure to write to memory, which does not happen.
pub fn song(packets: &[(f64, Packet)]) -> std::io::Result<Vec<u8>> {
    let mut messages: Vec<(u32, Vec<u8>)> = Vec::new();
    let mut open = Vec::new();
    let ticks_per_second = f64::from(TICKS_PER_QUARTER) * 1e6 / f64::from(QUARTER_US);
    for (seconds, packet) in packets {
        let ticks = (seconds.max(0.0) * ticks_per_second).round() as u32;
        let length = match packet[0] & 0xf {
            0x5 | 0xf => 1,
            0x2 | 0x6 | 0xc | 0xd => 2,
            0x3 | 0x4 | 0x7..=0xe => 3,
            _ => 0,
        };
        let bytes = &packet[1..1 + length];
        match packet[0] & 0xf {
            4..=7 => {
                open.extend_from_slice(bytes);
                if open.last() == Some(&END) {
                    messages.push((ticks, std::mem::take(&mut open)));
                }
            }
            8..=14 => messages.push((ticks, bytes.to_vec())),
            _ => {}
        }
    }
    let tempo = TrackEventKind::Meta(MetaMessage::Tempo(u24::new(QUARTER_US)));
    let mut track = vec![TrackEvent { delta: u28::new(0), kind: tempo }];
    let mut before = 0;
    for (ticks, message) in &messages {
        let kind = match message.strip_prefix(&[BEGIN]) {
            Some(data) => TrackEventKind::SysEx(data),
            None => match LiveEvent::parse(message) {
                Ok(LiveEvent::Midi { channel, message }) => TrackEventKind::Midi { channel, message },
                _ => continue,
            },
        };
        track.push(TrackEvent { delta: u28::new(ticks.saturating_sub(before)), kind });
        before = *ticks;
    }
    track.push(TrackEvent { delta: u28::new(0), kind: TrackEventKind::Meta(MetaMessage::EndOfTrack) });
    let timing = Timing::Metrical(u15::new(TICKS_PER_QUARTER));
    let smf = Smf { header: Header { format: Format::SingleTrack, timing }, tracks: vec![track] };
    let mut bytes = Vec::new();
    smf.write_std(&mut bytes)?;
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sysex_is_cut_into_packets_of_three_bytes_whose_last_tells_its_length() {
        assert_eq!(sysex(&[0xf0, 0xf7]), [[6, 0xf0, 0xf7, 0]]);
        assert_eq!(sysex(&[0xf0, 1, 0xf7]), [[7, 0xf0, 1, 0xf7]]);
        assert_eq!(sysex(&[0xf0, 1, 2, 0xf7]), [[4, 0xf0, 1, 2], [5, 0xf7, 0, 0]]);
        assert_eq!(sysex(&[0xf0, 0xf7, 0xf0, 1, 0xf7]), [[6, 0xf0, 0xf7, 0], [7, 0xf0, 1, 0xf7]]);
    }

    #[test]
    fn song_of_packets_reads_back_as_the_same_packets_and_times() {
        let played: Vec<(f64, Packet)> = vec![
            (0.0, [0x0b, 0xb9, 16, 100]),
            (0.25, [0x09, 0x99, 36, 127]),
            (0.25, [0x04, 0xf0, 0x7d, 1]),
            (0.251, [0x09, 0x99, 38, 1]),
            (0.3, [0x06, 2, 0xf7, 0]),
            (1.5, [0x0a, 0xa9, 36, 64]),
        ];
        let read = packets(&song(&played).unwrap()).unwrap();
        // A SysEx stands in the file where it ends.
        let expected = [
            (0.0, vec![[0x0b, 0xb9, 16, 100]]),
            (0.25, vec![[0x09, 0x99, 36, 127]]),
            (0.251, vec![[0x09, 0x99, 38, 1]]),
            (0.3, vec![[0x04, 0xf0, 0x7d, 1], [0x06, 2, 0xf7, 0]]),
            (1.5, vec![[0x0a, 0xa9, 36, 64]]),
        ];
        assert_eq!(read.len(), expected.len());
        for (found, wanted) in read.iter().zip(&expected) {
            assert_eq!(found.1, wanted.1);
            assert!((found.0 - wanted.0).abs() < 21e-6, "{found:?}");
        }
    }
}

//! USB: the images under a host that enumerates, sends, fetches, suspends, and is unplugged.

mod conversation;
mod descriptors;
mod host;
pub(crate) mod link;
mod packets;
mod song;
mod storms;
mod times;

use crate::common;
use virtual_board::{Board, Report, Setup, UsbAction, UsbHost, VirtualBoard};

/// Time at which the board is configured if the cable is plugged in at 0.2 s. The BlackPill has
/// loaded its kit at 0.31 s.
const CONFIGURED_S: f64 = 0.5;

/// Returns a host whose cable is plugged in at 0.2 s, and that does `actions` then.
fn host(actions: Vec<(f64, UsbAction)>) -> UsbHost {
    let actions = std::iter::once((0.2, UsbAction::Plug)).chain(actions).collect();
    UsbHost { actions, ..UsbHost::default() }
}

/// Runs a board with a USB host for `seconds` seconds.
fn run(board: Board, usb: UsbHost, seconds: f64) -> (VirtualBoard, Report) {
    let running = common::run(board, &Setup { usb, ..Setup::default() }, seconds);
    let report = running.report().unwrap();
    (running, report)
}

/// Checks that sound was never interrupted and that the board never restarted.
fn assert_sound(board: Board, report: &Report) {
    let missed: Vec<_> = report.log.iter().filter(|line| line.message.contains("halves missed")).collect();
    assert!(missed.is_empty() && report.audio.late_halves == 0, "{}: {missed:?}", board.name());
    assert!(report.resets.is_empty(), "{}: {:?}", board.name(), report.resets);
    assert_eq!(report.audio.streams.len(), 1, "{}", board.name());
    assert!(report.usb.failures.is_empty(), "{}: {:?}", board.name(), report.usb.failures);
}

/// MIDI note of the demo kit's first pad.
const NOTE: u8 = 60;

/// Returns the packet of a note-on of that pad, on channel 10.
fn note(velocity: u8) -> [u8; 4] {
    [0x09, 0x99, NOTE, velocity]
}

/// Returns `count` note-on packets, whose velocities differ from one to the next.
fn notes(count: usize) -> Vec<[u8; 4]> {
    (0..count).map(|n| note(1 + (n % 127) as u8)).collect()
}

/// Returns the packets of the notes that the board has played, by its log.
fn played(report: &Report) -> Vec<[u8; 4]> {
    let pad = &kit::open("demo").unwrap().kit.pads[0].name;
    let note_of = |message: &str| {
        let fields: Vec<&str> = message.strip_prefix("event ")?.strip_suffix(",strike")?.split(',').collect();
        let velocity: f32 = fields.get(2)?.parse().ok()?;
        (fields[1] == pad).then(|| note((127.0 * velocity).round() as u8))
    };
    report.log.iter().filter_map(|line| note_of(&line.message)).collect()
}

/// Returns the packets that came from the board.
fn received(report: &Report) -> Vec<[u8; 4]> {
    let bytes = report.usb.received.iter().flat_map(|transfer| transfer.bytes.iter().copied());
    bytes.collect::<Vec<u8>>().as_chunks().0.to_vec()
}

//! Cable between the host side of the crate `cable` and a board: what a program asks, the board
//! answers, while it runs on.

use std::collections::VecDeque;
use std::fmt;

use cable::{HostError, Link};
use malleus::events::usb_midi;
use virtual_board::{BoardError, UsbAction, VirtualBoard};

/// Time for which the board runs on between two looks at what it has sent, in s: a quarter of a
/// frame of the bus.
const STEP_S: f64 = 0.25e-3;

/// Reason for which a conversation ends early.
pub(crate) enum LinkError {
    Host(HostError),
    Board(BoardError),
}

impl fmt::Debug for LinkError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            LinkError::Host(error) => write!(f, "{error}"),
            LinkError::Board(error) => write!(f, "{error}"),
        }
    }
}

impl From<HostError> for LinkError {
    fn from(error: HostError) -> LinkError {
        LinkError::Host(error)
    }
}

/// Cable to a board that runs as far as the conversation goes.
pub(crate) struct BoardLink<'b> {
    board: &'b mut VirtualBoard,
    /// Number of transfers from the board that have been looked at.
    seen: usize,
    /// Bytes of MIDI that have not been taken.
    bytes: VecDeque<u8>,
}

impl BoardLink<'_> {
    /// Connects to a board that its host has configured. What it sent before is not heard.
    pub(crate) fn new(board: &mut VirtualBoard) -> BoardLink<'_> {
        let seen = board.usb_received(0).len();
        BoardLink { board, seen, bytes: VecDeque::new() }
    }
}

/// Returns the MIDI bytes of a USB-MIDI event packet (USB-MIDI 1.0, table 4-1).
fn midi_bytes(packet: &[u8; 4]) -> &[u8] {
    let count = match packet[0] & 0xf {
        0x5 | 0xf => 1,
        0x2 | 0x6 | 0xc | 0xd => 2,
        _ => 3,
    };
    &packet[1..=count]
}

impl Link for BoardLink<'_> {
    type Error = LinkError;

    fn send(&mut self, message: &[u8]) -> Result<(), LinkError> {
        let packets = usb_midi::sysex(message);
        self.board.usb(UsbAction::Send(packets.as_flattened().to_vec()));
        Ok(())
    }

    fn receive(&mut self, until_ms: u64) -> Result<Option<u8>, LinkError> {
        loop {
            for transfer in self.board.usb_received(self.seen) {
                self.seen += 1;
                self.bytes.extend(transfer.bytes.as_chunks().0.iter().flat_map(midi_bytes));
            }
            if let Some(byte) = self.bytes.pop_front() {
                return Ok(Some(byte));
            }
            if self.now_ms() >= until_ms || self.board.power_lost_s().is_some() {
                return Ok(None);
            }
            self.board.run_until(self.board.now_s() + STEP_S).map_err(LinkError::Board)?;
        }
    }

    fn now_ms(&mut self) -> u64 {
        (self.board.now_s() * 1e3) as u64
    }
}

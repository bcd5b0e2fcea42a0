//! Cable between a board and the computer's end of the protocol.

use std::collections::VecDeque;

use cable::{HostError, Link};
use dsp_core::midi::Packet;
use virtual_board::{UsbAction, VirtualBoard};

/// Time for which the board runs between two looks at what it has sent, in s.
const STEP_S: f64 = 0.5e-3;
/// Bytes of a full transfer.
const TRANSFER_BYTES: usize = 64;

/// Board whose SysEx goes to and comes from a task of the computer.
pub(super) struct VirtualCable {
    pub(super) board: VirtualBoard,
    /// Number of transfers of the board that have been taken.
    taken: usize,
    waiting: VecDeque<u8>,
}

impl VirtualCable {
    pub(super) fn new(board: VirtualBoard) -> Self {
        Self { board, taken: 0, waiting: VecDeque::new() }
    }

    fn take(&mut self) {
        for transfer in self.board.usb_received(self.taken) {
            self.taken += 1;
            for &packet in transfer.bytes.as_chunks().0 {
                let is_sysex = (4..=7).contains(&(packet[0] & 0xf));
                self.waiting.extend(Packet(packet).bytes().iter().filter(|_| is_sysex));
            }
        }
    }
}

/// Returns the packets of a SysEx.
pub(super) fn packets(message: &[u8]) -> Vec<u8> {
    let last = message.len().div_ceil(3).saturating_sub(1);
    let packet = |(n, bytes): (usize, &[u8])| {
        let mut packet = [if n == last { 4 + bytes.len() as u8 } else { 4 }, 0, 0, 0];
        packet[1..=bytes.len()].copy_from_slice(bytes);
        packet
    };
    message.chunks(3).enumerate().flat_map(packet).collect()
}

impl Link for VirtualCable {
    type Error = HostError;

    fn send(&mut self, message: &[u8]) -> Result<(), HostError> {
        for transfer in packets(message).chunks(TRANSFER_BYTES) {
            self.board.usb(UsbAction::Send(transfer.to_vec()));
        }
        Ok(())
    }

    fn receive(&mut self, until_ms: u64) -> Result<Option<u8>, HostError> {
        loop {
            self.take();
            if let Some(byte) = self.waiting.pop_front() {
                return Ok(Some(byte));
            }
            if self.now_ms() >= until_ms || self.board.power_lost_s().is_some() {
                return Ok(None);
            }
            self.board.run_until(self.board.now_s() + STEP_S).unwrap();
        }
    }

    fn now_ms(&mut self) -> u64 {
        (1e3 * self.board.now_s()) as u64
    }
}

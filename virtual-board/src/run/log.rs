//! Log of the program: defmt frames in an RTT channel, fetched as a debug probe does and decoded
//! with the table in the image.

use defmt_decoder::{DecodeError, Table};
use serde::Serialize;
use virtual_core::Machine;

use crate::error::BoardError;

/// Offset of the buffer's address in the RTT control block, for the first up-channel.
const BUFFER: u32 = 28;
/// Offset of the buffer's size in the RTT control block, for the first up-channel.
const SIZE: u32 = 32;
/// Offset of the write index in the RTT control block, for the first up-channel.
const WRITE: u32 = 36;
/// Offset of the read index in the RTT control block, for the first up-channel.
const READ: u32 = 40;

/// Line of the log.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LogLine {
    /// Time at which the line was fetched, in seconds from power-on: at most a few instructions
    /// after it was complete.
    pub at_s: f64,
    /// Number of resets of the chip before.
    pub boot: usize,
    /// Level, such as `info`, `warn` or `error`; empty if the program gave none.
    pub level: String,
    /// Text of the line.
    pub message: String,
}

/// Bytes of the log, with the times at which they came.
#[derive(Debug)]
pub(super) struct Log {
    /// Image, which contains the table of the log.
    elf: Vec<u8>,
    /// Address of the RTT control block, if the image has one.
    control: Option<u32>,
    /// Bytes with their time in seconds and the number of resets before.
    chunks: Vec<(f64, usize, Vec<u8>)>,
    /// Write index that was last seen.
    seen: u32,
}

/// Returns a word of memory, or 0 outside the memory.
fn word(machine: &Machine, address: u32) -> u32 {
    let mut bytes = [0; 4];
    match machine.read(address, &mut bytes) {
        Ok(()) => u32::from_le_bytes(bytes),
        Err(_) => 0,
    }
}

impl Log {
    /// Makes the empty log of an image.
    pub(super) fn new(elf: &[u8], machine: &Machine) -> Log {
        let control = machine.symbol("_SEGGER_RTT").map(|symbol| symbol.address);
        Log { elf: elf.to_vec(), control, chunks: Vec::new(), seen: 0 }
    }

    /// Takes the bytes that the program has written since the last call.
    pub(super) fn fetch(&mut self, at_s: f64, boot: usize, machine: &mut Machine) {
        let Some(control) = self.control else { return };
        let write = word(machine, control + WRITE);
        if write == self.seen {
            return;
        }
        let (buffer, size, read) =
            (word(machine, control + BUFFER), word(machine, control + SIZE), word(machine, control + READ));
        if size == 0 || write >= size || read >= size {
            return;
        }
        let mut bytes = vec![0; ((write + size - read) % size) as usize];
        for (index, byte) in (0..).zip(&mut bytes) {
            let mut one = [0];
            if machine.read(buffer + (read + index) % size, &mut one).is_err() {
                return;
            }
            *byte = one[0];
        }
        if machine.write(control + READ, &write.to_le_bytes()).is_ok() {
            self.seen = write;
            self.chunks.push((at_s, boot, bytes));
        }
    }

    /// Notes that the program restarts, whose write index is then 0.
    pub(super) fn restart(&mut self) {
        self.seen = 0;
    }

    /// Returns all lines so far.
    pub(super) fn lines(&self) -> Result<Vec<LogLine>, BoardError> {
        let table = Table::parse(&self.elf).map_err(|error| BoardError::LogTable { reason: error.to_string() })?;
        let Some(table) = table else { return Ok(Vec::new()) };
        let mut lines = Vec::new();
        let mut decoder = table.new_stream_decoder();
        let mut decoded_boot = 0;
        for (at_s, boot, bytes) in &self.chunks {
            if *boot != decoded_boot {
                decoder = table.new_stream_decoder();
                decoded_boot = *boot;
            }
            decoder.received(bytes);
            loop {
                let (level, message) = match decoder.decode() {
                    Ok(frame) => {
                        let level = frame.level().map(|level| level.as_str().to_owned()).unwrap_or_default();
                        (level, frame.display_message().to_string())
                    }
                    Err(DecodeError::UnexpectedEof) => break,
                    Err(DecodeError::Malformed) => {
                        (String::new(), "(a frame that cannot be decoded: log lines were lost)".to_owned())
                    }
                };
                lines.push(LogLine { at_s: *at_s, boot: *boot, level, message });
            }
        }
        Ok(lines)
    }
}

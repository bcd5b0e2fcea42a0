//! The program's log: defmt frames in an RTT channel, fetched as a debug probe does and decoded with the image's own table.

use defmt_decoder::{DecodeError, Table};
use serde::Serialize;
use virtual_core::Machine;

use crate::error::BoardError;

/// Where the first up-channel's words stand in the RTT control block.
const BUFFER: u32 = 28;
const SIZE: u32 = 32;
const WRITE: u32 = 36;
const READ: u32 = 40;

/// A line of the log.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LogLine {
    /// When it was fetched, in seconds from power-on: at most a few instructions after it was complete.
    pub at_s: f64,
    /// How often the chip had been reset before.
    pub boot: usize,
    /// `info`, `warn`, `error`, ...; empty where the program gave none.
    pub level: String,
    /// The text.
    pub message: String,
}

/// The bytes of the log, with when they came.
#[derive(Debug)]
pub(super) struct Log {
    elf: Vec<u8>,
    control: Option<u32>,
    chunks: Vec<(f64, usize, Vec<u8>)>,
    /// The write index that was last seen.
    seen: u32,
}

fn word(machine: &Machine, address: u32) -> u32 {
    let mut bytes = [0; 4];
    match machine.read(address, &mut bytes) {
        Ok(()) => u32::from_le_bytes(bytes),
        Err(_) => 0,
    }
}

impl Log {
    pub(super) fn new(elf: &[u8], machine: &Machine) -> Log {
        let control = machine.symbol("_SEGGER_RTT").map(|symbol| symbol.address);
        Log { elf: elf.to_vec(), control, chunks: Vec::new(), seen: 0 }
    }

    /// Takes what the program has written since the last time.
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

    /// The program starts anew.
    pub(super) fn restart(&mut self) {
        self.seen = 0;
    }

    /// All lines so far.
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

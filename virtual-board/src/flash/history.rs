//! Record of all operations on flash in a run, from which the contents at any moment can be made.

use super::memory::FlashMemory;

/// Change of flash that an operation makes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FlashChange {
    /// A byte, half-word or word is programmed.
    Program {
        /// Address of the first byte.
        address: u32,
        /// Number of bytes: 1, 2 or 4.
        bytes: u8,
        /// Content before.
        old: u32,
        /// Content after: bits only ever become 0.
        new: u32,
    },
    /// A sector is erased.
    Erase {
        /// Number of the sector.
        sector: u8,
    },
    /// The option bytes are written.
    Options {
        /// Option bytes before, in the form of FLASH_OPTCR.
        old: u32,
        /// Option bytes after.
        new: u32,
    },
}

/// End of an operation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FlashEnding {
    /// The operation was carried out.
    Done,
    /// The operation was refused with an error flag, on request ([`crate::Fault::FlashError`]), and
    /// had no effect.
    Failed,
    /// Power was lost or the chip was reset within the operation.
    Torn {
        /// Seed of what it left.
        seed: u64,
    },
}

/// Operation on flash.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FlashOperation {
    /// Time of its beginning, in seconds from power-on.
    pub at_s: f64,
    /// Change that it makes if it is carried out.
    pub change: FlashChange,
    /// End of the operation.
    pub ending: FlashEnding,
}

/// Flash at power-on, and all operations on it since.
///
/// A run with few or many operations tells what the flash held before, after and within each of
/// them. Tests of power loss at many places need one run, and a start for each place.
#[derive(Debug, Clone, PartialEq)]
pub struct FlashHistory {
    /// Flash at power-on, the image included.
    pub start: FlashMemory,
    /// Operations that have ended, in order.
    pub operations: Vec<FlashOperation>,
}

impl FlashHistory {
    /// Returns the flash as it was before operation `nth`, counted from 0; as it is at the end if
    /// there are no more operations.
    pub fn before(&self, nth: usize) -> FlashMemory {
        let mut memory = self.start.clone();
        self.replay(&mut memory, 0, nth);
        memory
    }

    /// Returns the flash that a loss of power within operation `nth` leaves, or `None` if there is
    /// no such operation. Seeds choose between the possible remains.
    pub fn torn(&self, nth: usize, seed: u64) -> Option<FlashMemory> {
        let mut memory = self.before(nth);
        memory.tear(&self.operations.get(nth)?.change, seed);
        Some(memory)
    }

    /// Applies operations `from` to `to`, the last one excluded, to a flash as it was before the
    /// first of them. This makes the flash at many places in turn cheaper than
    /// [`FlashHistory::before`].
    pub fn replay(&self, memory: &mut FlashMemory, from: usize, to: usize) {
        let operations = self.operations.iter().take(to).skip(from);
        for operation in operations {
            match operation.ending {
                FlashEnding::Done => memory.apply(&operation.change),
                FlashEnding::Failed => {}
                FlashEnding::Torn { seed } => memory.tear(&operation.change, seed),
            }
        }
    }
}

//! DMA1 and DMA2: eight streams each, requests by channel, flags of half, end and errors, circular
//! and double buffers (RM0090 section 10, RM0383 section 9).
//!
//! A transfer moves one item at the moment of its request. Packing of unequal widths, bursts,
//! arbitration and transfers from memory to memory are not modelled, nor is the delay of the FIFO.
//! With equal widths the FIFO changes only the time of a transfer.

use super::{Access, Problem, Unmodelled};

const ENABLE: u32 = 1 << 0;
const CIRCULAR: u32 = 1 << 8;
const DOUBLE: u32 = 1 << 18;
const TARGET: u32 = 1 << 19;
const FLOW_CONTROL: u32 = 1 << 5;

/// Flag of an error of the FIFO, as in LISR for stream 0.
pub(crate) const FIFO_ERROR: u32 = 1 << 0;
/// Flag of a transfer error, as in LISR for stream 0.
pub(crate) const TRANSFER_ERROR: u32 = 1 << 3;
/// Flag of the first half of a buffer, as in LISR for stream 0.
pub(crate) const HALF: u32 = 1 << 4;
/// Flag of the end of a buffer, as in LISR for stream 0.
pub(crate) const COMPLETE: u32 = 1 << 5;
/// All flags of a stream, as in LISR for stream 0.
const ALL: u32 = 0x3d;

/// First bit of the flags of each stream, 0 to 3 in LISR and 4 to 7 in HISR.
const SHIFT: [u32; 4] = [0, 6, 16, 22];

/// Stream of a controller.
#[derive(Debug, Default, Clone)]
pub(crate) struct Stream {
    control: u32,
    count: u32,
    reload: u32,
    peripheral: u32,
    memory: [u32; 2],
    fifo: u32,
    /// Flags, as in LISR for stream 0.
    pub(crate) flags: u32,
    /// Number of items that were moved since the start of the buffer.
    position: u32,
}

/// Item that a transfer moves.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Item {
    pub(crate) peripheral: u32,
    pub(crate) memory: u32,
    /// Length in bytes: 1, 2 or 4.
    pub(crate) bytes: u32,
    /// True if the item moves from memory to the peripheral.
    pub(crate) to_peripheral: bool,
}

impl Stream {
    pub(crate) fn is_enabled(&self) -> bool {
        self.control & ENABLE != 0
    }

    pub(crate) fn channel(&self) -> u32 {
        self.control >> 25 & 7
    }

    pub(crate) fn is_to_peripheral(&self) -> bool {
        self.control >> 6 & 3 == 1
    }

    fn bytes(&self) -> u32 {
        1 << (self.control >> 11 & 3)
    }

    /// Returns the item that the next request moves.
    pub(crate) fn item(&self) -> Item {
        let bytes = self.bytes();
        let buffer = self.memory[usize::from(self.control & TARGET != 0)];
        let memory = if self.control & 1 << 10 != 0 { buffer + self.position * bytes } else { buffer };
        let peripheral =
            if self.control & 1 << 9 != 0 { self.peripheral + self.position * bytes } else { self.peripheral };
        Item { peripheral, memory, bytes, to_peripheral: self.is_to_peripheral() }
    }

    /// Counts an item that was moved; returns the flags that it raised.
    pub(crate) fn moved(&mut self) -> u32 {
        self.position += 1;
        self.count -= 1;
        let mut raised = 0;
        if self.count == self.reload / 2 && self.count != 0 {
            raised |= HALF;
        }
        if self.count == 0 {
            raised |= COMPLETE;
            if self.control & (CIRCULAR | DOUBLE) != 0 {
                self.count = self.reload;
                self.position = 0;
                if self.control & DOUBLE != 0 {
                    self.control ^= TARGET;
                }
            } else {
                self.control &= !ENABLE;
            }
        }
        self.flags |= raised;
        raised
    }

    /// Ends the stream with a transfer error.
    pub(crate) fn fail(&mut self) {
        self.flags |= TRANSFER_ERROR;
        self.control &= !ENABLE;
    }

    /// Returns true if the interrupt is asserted.
    pub(crate) fn is_asserted(&self) -> bool {
        // DMEIE, TEIE, HTIE and TCIE are bits 1 to 4 of the control register, and their flags are
        // bits 2 to 5.
        self.flags & (self.control << 1 & 0x3c) != 0 || self.flags & FIFO_ERROR != 0 && self.fifo & 1 << 7 != 0
    }

    fn write_control(&mut self, value: u32) -> Access<()> {
        let starts = value & ENABLE != 0 && !self.is_enabled();
        self.control = value & 0x0fef_ffff;
        if !starts {
            return Ok(());
        }
        let problem = |reason: &str| Err(Problem::Misuse { reason: reason.to_owned() });
        if value & FLOW_CONTROL != 0 || value >> 6 & 3 > 1 {
            return Err(Unmodelled::new("memory to memory and peripheral flow control").into());
        }
        if value >> 11 & 3 != value >> 13 & 3 || value & 0xf << 21 != 0 {
            return Err(Unmodelled::new("DMA with unequal widths or bursts").into());
        }
        if value >> 11 & 3 == 3 {
            return problem("PSIZE 3 is reserved");
        }
        let widths = [self.peripheral, self.memory[0]];
        if widths.iter().any(|address| address % self.bytes() != 0) {
            return problem("an address is not aligned to the width of the items");
        }
        if self.count == 0 {
            // A stream without items does not start.
            self.control &= !ENABLE;
        }
        if self.flags & ALL != 0 {
            return problem(
                "a stream is enabled while flags of its last transfer are set; clear them first (LIFCR, HIFCR)",
            );
        }
        self.reload = self.count;
        self.position = 0;
        Ok(())
    }

    fn read(&self, offset: u32) -> u32 {
        match offset {
            0x00 => self.control,
            0x04 => self.count,
            0x08 => self.peripheral,
            0x0c => self.memory[0],
            0x10 => self.memory[1],
            // The field FS tells that the FIFO is empty.
            _ => self.fifo & !0x38 | 4 << 3,
        }
    }

    fn write(&mut self, offset: u32, value: u32) -> Access<()> {
        if offset == 0 {
            return self.write_control(value);
        }
        // With double buffers the memory address that is not in use may be written at any time.
        let unused = self.control & DOUBLE != 0 && offset == if self.control & TARGET != 0 { 0x0c } else { 0x10 };
        if self.is_enabled() && !unused && self.read(offset) != value {
            return Err(Problem::Misuse {
                reason: "a register of a stream is written while the stream runs".to_owned(),
            });
        }
        match offset {
            0x04 => self.count = value & 0xffff,
            0x08 => self.peripheral = value,
            0x0c => self.memory[0] = value,
            0x10 => self.memory[1] = value,
            _ => self.fifo = value & 0x87,
        }
        Ok(())
    }
}

/// Controller of eight streams.
#[derive(Debug, Default)]
pub(crate) struct Dma {
    pub(crate) streams: [Stream; 8],
}

impl Dma {
    pub(crate) fn read(&self, offset: u32) -> Access<u32> {
        match offset {
            0x00 | 0x04 => {
                let streams = &self.streams[offset as usize..][..4];
                Ok(streams.iter().zip(SHIFT).map(|(stream, shift)| stream.flags << shift).sum())
            }
            0x08 | 0x0c => Ok(0),
            0x10..0xd0 => Ok(self.streams[((offset - 0x10) / 0x18) as usize].read((offset - 0x10) % 0x18)),
            _ => Err(Problem::register()),
        }
    }

    pub(crate) fn write(&mut self, offset: u32, value: u32) -> Access<()> {
        match offset {
            0x00 | 0x04 => Ok(()),
            0x08 | 0x0c => {
                for (stream, shift) in self.streams[(offset - 8) as usize..][..4].iter_mut().zip(SHIFT) {
                    stream.flags &= !(value >> shift & ALL);
                }
                Ok(())
            }
            0x10..0xd0 => self.streams[((offset - 0x10) / 0x18) as usize].write((offset - 0x10) % 0x18, value),
            _ => Err(Problem::register()),
        }
    }
}

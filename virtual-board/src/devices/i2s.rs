//! SPI2 and SPI3 as I2S master transmitters (RM0090 section 28, RM0383 section 20). The SPI mode is
//! not modelled.
//!
//! Half-words leave a shift register that is refilled from the data register at each boundary. A
//! stream begins with the first half-word after I2SE. If the data register is empty at a boundary,
//! the last half-word is sent again and the slot goes on. The manuals name no flag for the underrun
//! of a master; this reading is the hardest on a driver, whose late half-word arrives in the wrong
//! slot.

use super::{Access, Context, Problem, Unmodelled};
use crate::frequency::{Frequency, Pace};

const I2SE: u32 = 1 << 10;
const I2SMOD: u32 = 1 << 11;
const TXE: u32 = 1 << 1;
const CHSIDE: u32 = 1 << 2;
const BUSY: u32 = 1 << 7;
const TXDMAEN: u32 = 1 << 1;

/// Output of the I2S without interruption, as it stood on the data pin.
#[derive(Debug, Clone)]
pub struct Stream {
    /// Core cycle from power-on at which the first bit of the first frame stood on the pin.
    pub start_cycle: u64,
    /// Time from power-on at which the first bit of the first frame stood on the pin, in seconds.
    pub start_s: f64,
    /// Exact sample rate.
    pub rate: Frequency,
    /// Left and right sample of each frame, left-justified in 32 bits for all widths of the data.
    pub frames: Vec<[i32; 2]>,
    /// Number of half-words that were sent twice because no new one had come.
    pub underruns: u64,
    /// Number of frames that no pin carried, because its alternate function was another. They are
    /// recorded as zeros.
    pub unconnected_frames: u64,
}

/// State of a stream that runs.
#[derive(Debug)]
struct Running {
    /// Pace of the half-words.
    pace: Pace,
    /// Cycle at which the stream began.
    since: u64,
    /// Number of half-words that have begun to leave.
    boundaries: u64,
    /// Half-word in the shift register.
    shift: u16,
    /// Half-words of the frame so far, the last one low.
    frame: u64,
}

#[derive(Debug, Default)]
pub(crate) struct I2s {
    control: [u32; 2],
    configuration: u32,
    prescaler: u32,
    data: Option<u16>,
    running: Option<Running>,
    /// Streams so far, the present one last.
    pub(crate) streams: Vec<Stream>,
}

impl I2s {
    /// Resets the registers. The recorded streams stay.
    pub(crate) fn reset(&mut self) {
        *self = I2s { streams: std::mem::take(&mut self.streams), ..I2s::default() };
    }

    pub(crate) fn read(&mut self, offset: u32) -> Access<u32> {
        Ok(match offset {
            0x00 | 0x04 => self.control[(offset / 4) as usize],
            0x08 => {
                let busy = if self.running.is_some() { BUSY } else { 0 };
                let right = self.running.as_ref().is_some_and(|running| running.boundaries % 4 / 2 == 1);
                busy | if self.data.is_none() { TXE } else { 0 } | if right { CHSIDE } else { 0 }
            }
            0x0c => 0,
            0x10 => 7,
            0x14 | 0x18 => 0,
            0x1c => self.configuration,
            0x20 => self.prescaler,
            _ => return Err(Problem::register()),
        })
    }

    pub(crate) fn write(&mut self, offset: u32, value: u32, context: &Context<'_>) -> Access<()> {
        match offset {
            0x00 if value & 1 << 6 != 0 => return Err(Unmodelled::new("SPI mode (SPI_CR1.SPE)").into()),
            0x00 => self.control[0] = value,
            0x04 => self.control[1] = value,
            0x08 | 0x10 => {}
            0x0c => {
                self.data = Some(value as u16);
                self.begin(context)?;
            }
            0x1c => self.configure(value, context)?,
            0x20 if self.configuration & I2SE != 0 => {
                let reason = "SPI_I2SPR is written while the I2S is on (I2SE)".to_owned();
                return Err(Problem::Misuse { reason });
            }
            0x20 => self.prescaler = value & 0x3ff,
            _ => return Err(Problem::register()),
        }
        Ok(())
    }

    fn configure(&mut self, value: u32, context: &Context<'_>) -> Access<()> {
        let was_on = self.configuration & I2SE != 0;
        if was_on && (self.configuration ^ value) & !I2SE != 0 {
            let reason = "SPI_I2SCFGR is changed while the I2S is on (I2SE)".to_owned();
            return Err(Problem::Misuse { reason });
        }
        self.configuration = value;
        if value & I2SE == 0 {
            // What was not sent stays in the data register, and begins the next stream. Only a
            // reset of the peripheral clears it.
            self.running = None;
            return Ok(());
        }
        if value & I2SMOD == 0 || value >> 8 & 3 != 2 || value >> 4 & 3 != 0 {
            return Err(Unmodelled::new("I2S other than master transmit in Philips format").into());
        }
        if value & 1 == 0 && value >> 1 & 3 != 0 {
            return Err(Problem::Misuse { reason: "SPI_I2SCFGR: 24 or 32 bits do not fit 16-bit channels".to_owned() });
        }
        if self.prescaler & 0xff < 2 {
            return Err(Problem::Misuse { reason: "SPI_I2SPR: I2SDIV must be at least 2".to_owned() });
        }
        self.begin(context)
    }

    /// Returns the number of half-words per frame that the program writes.
    fn half_words(&self) -> u64 {
        if self.configuration >> 1 & 3 == 0 { 2 } else { 4 }
    }

    /// Returns the sample rate at a clock of the I2S.
    pub(crate) fn rate(&self, clock: Frequency) -> Frequency {
        let divider = u64::from(2 * (self.prescaler & 0xff) + (self.prescaler >> 8 & 1));
        let bits = if self.configuration & 1 == 0 { 32 } else { 64 };
        let slowdown = if !self.makes_master_clock() {
            1
        } else if bits == 32 {
            8
        } else {
            4
        };
        clock.scaled(1, bits * divider * slowdown)
    }

    /// Returns true if the I2S makes MCLK (SPI_I2SPR.MCKOE).
    pub(crate) fn makes_master_clock(&self) -> bool {
        self.prescaler & 1 << 9 != 0
    }

    /// Begins a stream if the I2S is on and has data.
    fn begin(&mut self, context: &Context<'_>) -> Access<()> {
        if self.running.is_some() || self.configuration & I2SE == 0 || self.data.is_none() {
            return Ok(());
        }
        let Some(clock) = context.clocks.i2s else {
            let reason = "the I2S is on, PLLI2S is not (RCC_CR.PLLI2SON)".to_owned();
            return Err(Problem::ClockTree { reason });
        };
        let rate = self.rate(clock);
        let pace = rate.scaled(self.half_words(), 1).for_each(context.clocks.core);
        self.running = Some(Running { pace, since: context.now, boundaries: 0, shift: 0, frame: 0 });
        self.streams.push(Stream {
            start_cycle: context.now,
            start_s: context.seconds,
            rate,
            frames: Vec::new(),
            underruns: 0,
            unconnected_frames: 0,
        });
        Ok(())
    }

    /// Returns the cycle at which the next half-word begins to leave.
    pub(crate) fn next_event(&self) -> u64 {
        self.running.as_ref().map_or(u64::MAX, |running| running.since + running.pace.cycle_of(running.boundaries))
    }

    /// Sends the next half-word. `connected` returns true if the pins carry the signal.
    pub(crate) fn fire(&mut self, connected: impl FnOnce() -> bool) {
        let half_words = self.half_words();
        let (Some(running), Some(stream)) = (&mut self.running, self.streams.last_mut()) else { return };
        match self.data.take() {
            Some(half_word) => running.shift = half_word,
            None => stream.underruns += 1,
        }
        running.frame = running.frame << 16 | u64::from(running.shift);
        running.boundaries += 1;
        if running.boundaries % half_words != 0 {
            return;
        }
        let frame = match half_words {
            2 => [(running.frame & 0xffff_0000) as u32, (running.frame as u32) << 16],
            _ => [(running.frame >> 32) as u32, running.frame as u32],
        };
        let connected = connected();
        stream.unconnected_frames += u64::from(!connected);
        stream.frames.push(if connected { frame.map(u32::cast_signed) } else { [0; 2] });
    }

    /// Returns true if the DMA is requested.
    pub(crate) fn requests_dma(&self) -> bool {
        self.control[1] & TXDMAEN != 0 && self.configuration & I2SE != 0 && self.data.is_none()
    }

    /// Returns true if a stream runs.
    pub(crate) fn is_running(&self) -> bool {
        self.running.is_some()
    }

    /// Returns true if the I2S is switched on (I2SE), with or without data.
    pub(crate) fn is_on(&self) -> bool {
        self.configuration & I2SE != 0
    }

    /// Returns true if the interrupt for an empty data register is asserted.
    pub(crate) fn is_asserted(&self) -> bool {
        self.control[1] & 1 << 7 != 0 && self.configuration & I2SE != 0 && self.data.is_none()
    }
}

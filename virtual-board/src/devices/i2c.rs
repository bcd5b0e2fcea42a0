//! I2C1 as master, with the codec as the only device on the bus (RM0090 section 27, RM0383 section
//! 18).

use super::{Access, Context, Problem, Unmodelled};
use crate::codec::{self, Codec};
use crate::frequency::Frequency;

const PE: u32 = 1 << 0;
const START: u32 = 1 << 8;
const STOP: u32 = 1 << 9;
const ACK: u32 = 1 << 10;
const SWRST: u32 = 1 << 15;
const SB: u32 = 1 << 0;
const ADDR: u32 = 1 << 1;
const BTF: u32 = 1 << 2;
const RXNE: u32 = 1 << 6;
const TXE: u32 = 1 << 7;
const AF: u32 = 1 << 10;
const ERRORS: u32 = 0xdf00;
const MASTER: u32 = 1 << 0;
const BUSY: u32 = 1 << 1;
const TRANSMITTER: u32 = 1 << 2;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Phase {
    Idle,
    /// The start condition is being sent.
    Starting,
    /// SB is set, and the program must write the address.
    Started,
    /// The address is on the bus.
    Addressing {
        reading: bool,
        address: u8,
    },
    /// Bytes are being sent.
    Sending {
        /// Byte in the shift register, if there is one.
        shifting: Option<u8>,
    },
    /// Bytes are being received.
    Receiving,
    /// A byte was not acknowledged, or the last byte was received: the program must set STOP or
    /// START.
    Waiting,
}

#[derive(Debug)]
pub(crate) struct I2c {
    control: [u32; 2],
    own: [u32; 2],
    clock_control: u32,
    rise: u32,
    filter: u32,
    status: u32,
    transmitter: bool,
    data: Option<u8>,
    received: u8,
    phase: Phase,
    due: u64,
    /// True if STOP follows the byte that is being received.
    stopping: bool,
    /// True if SR1 was read while ADDR was set, so that reading SR2 clears ADDR.
    address_seen: bool,
}

impl Default for I2c {
    fn default() -> I2c {
        I2c {
            control: [0; 2],
            own: [0; 2],
            clock_control: 0,
            rise: 2,
            filter: 0,
            status: 0,
            transmitter: false,
            data: None,
            received: 0,
            phase: Phase::Idle,
            due: u64::MAX,
            stopping: false,
            address_seen: false,
        }
    }
}

impl I2c {
    pub(crate) fn read(&mut self, offset: u32, context: &Context<'_>) -> Access<u32> {
        Ok(match offset {
            0x00 | 0x04 => self.control[(offset / 4) as usize],
            0x08 | 0x0c => self.own[(offset / 4 - 2) as usize],
            0x10 => {
                self.status &= !RXNE;
                let byte = u32::from(self.received);
                if self.phase == Phase::Receiving {
                    self.due = context.now + self.byte_cycles(context);
                }
                byte
            }
            0x14 => {
                self.address_seen |= self.status & ADDR != 0;
                self.status
            }
            0x18 => {
                if self.address_seen {
                    self.address_seen = false;
                    self.status &= !ADDR;
                    self.after_address(context);
                }
                let master = if self.phase == Phase::Idle { 0 } else { MASTER | BUSY };
                master | if self.transmitter && master != 0 { TRANSMITTER } else { 0 }
            }
            0x1c => self.clock_control,
            0x20 => self.rise,
            0x24 => self.filter,
            _ => return Err(Problem::register()),
        })
    }

    fn after_address(&mut self, context: &Context<'_>) {
        match self.phase {
            Phase::Sending { .. } => self.load(context),
            Phase::Receiving => self.due = context.now + self.byte_cycles(context),
            _ => {}
        }
    }

    pub(crate) fn write(&mut self, offset: u32, value: u32, context: &Context<'_>) -> Access<()> {
        match offset {
            0x00 => self.write_control(value, context)?,
            0x04 if value & 1 << 11 != 0 => return Err(Unmodelled::new("DMA of I2C").into()),
            0x04 => self.control[1] = value,
            0x08 | 0x0c => self.own[(offset / 4 - 2) as usize] = value,
            0x10 => self.write_data(value as u8, context)?,
            0x14 => self.status &= value | !ERRORS,
            0x1c => self.clock_control = value,
            0x20 => self.rise = value,
            0x24 => self.filter = value,
            0x18 => {}
            _ => return Err(Problem::register()),
        }
        Ok(())
    }

    fn write_control(&mut self, value: u32, context: &Context<'_>) -> Access<()> {
        if value & SWRST != 0 || value & PE == 0 {
            *self = I2c {
                own: self.own,
                control: [value, self.control[1]],
                clock_control: self.clock_control,
                rise: self.rise,
                filter: self.filter,
                ..I2c::default()
            };
            return Ok(());
        }
        self.control[0] = value & !(START | STOP);
        if value & STOP != 0 && self.phase == Phase::Receiving && self.due != u64::MAX {
            self.stopping = true;
        } else if value & STOP != 0 {
            self.phase = Phase::Idle;
            self.due = u64::MAX;
            self.status &= !(BTF | TXE);
        }
        if value & START != 0 {
            let frequency = u64::from(self.control[1] & 0x3f) * 1_000_000;
            if Frequency::hz(frequency) != context.clocks.apb1 || self.clock_control & 0xfff == 0 {
                let reason =
                    format!("I2C_CR2.FREQ says {frequency} Hz, PCLK1 is {}; both must agree", context.clocks.apb1);
                return Err(Problem::Misuse { reason });
            }
            self.phase = Phase::Starting;
            self.due = context.now + self.byte_cycles(context) / 9;
        }
        Ok(())
    }

    fn write_data(&mut self, byte: u8, context: &Context<'_>) -> Access<()> {
        match self.phase {
            Phase::Started => {
                self.status &= !SB;
                self.phase = Phase::Addressing { reading: byte & 1 != 0, address: byte >> 1 };
                self.due = context.now + self.byte_cycles(context);
            }
            Phase::Sending { shifting } => {
                self.data = Some(byte);
                self.status &= !(TXE | BTF);
                if shifting.is_none() {
                    self.load(context);
                }
            }
            _ => {}
        }
        Ok(())
    }

    /// Moves the data register to the shift register.
    fn load(&mut self, context: &Context<'_>) {
        let byte = self.data.take();
        self.phase = Phase::Sending { shifting: byte };
        self.status |= TXE;
        self.due = if byte.is_some() { context.now + self.byte_cycles(context) } else { u64::MAX };
    }

    /// Returns the number of core cycles of nine bits on the bus.
    fn byte_cycles(&self, context: &Context<'_>) -> u64 {
        let count = u64::from(self.clock_control & 0xfff).max(1);
        let periods = match self.clock_control >> 14 & 3 {
            0 | 1 => 2 * count,
            2 => 3 * count,
            _ => 25 * count,
        };
        context.clocks.apb1.scaled(1, periods).for_each(context.clocks.core).cycle_of(9)
    }

    pub(crate) fn next_event(&self) -> u64 {
        self.due
    }

    /// Ends the step that is due. `codec` is the codec, if the pins are connected to it.
    pub(crate) fn fire(&mut self, codec: Option<&mut Codec>, master_clock_runs: bool, context: &Context<'_>) {
        self.due = u64::MAX;
        match self.phase {
            Phase::Starting => {
                self.status |= SB;
                self.phase = Phase::Started;
            }
            Phase::Addressing { reading, address } => {
                let listening = codec.filter(|_| address == codec::ADDRESS);
                if listening.is_some_and(|codec| codec.addressed(reading)) {
                    self.status |= ADDR;
                    self.transmitter = !reading;
                    self.phase = if reading { Phase::Receiving } else { Phase::Sending { shifting: None } };
                } else {
                    self.status |= AF;
                    self.phase = Phase::Waiting;
                }
            }
            Phase::Sending { shifting: Some(byte) } => {
                if !codec.is_some_and(|codec| codec.write(byte, master_clock_runs)) {
                    self.status |= AF;
                    self.phase = Phase::Waiting;
                } else if self.data.is_some() {
                    self.load(context);
                } else {
                    self.phase = Phase::Sending { shifting: None };
                    self.status |= BTF | TXE;
                }
            }
            Phase::Receiving => {
                self.received = codec.map_or(0xff, Codec::read);
                self.status |= RXNE;
                if std::mem::take(&mut self.stopping) {
                    self.phase = Phase::Idle;
                } else if self.control[0] & ACK == 0 {
                    self.phase = Phase::Waiting;
                }
            }
            _ => {}
        }
    }

    /// Returns two flags: true if the event interrupt is asserted, and true if the error interrupt
    /// is.
    pub(crate) fn asserted(&self) -> (bool, bool) {
        let buffer = if self.control[1] & 1 << 10 != 0 { TXE | RXNE } else { 0 };
        let events = self.control[1] & 1 << 9 != 0 && self.status & (SB | ADDR | BTF | buffer) != 0;
        (events, self.control[1] & 1 << 8 != 0 && self.status & ERRORS != 0)
    }
}

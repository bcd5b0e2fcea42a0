//! Registers of the USB core.

use super::{ENDPOINTS, FIFO_WORDS, Usb, flag};
use crate::devices::{Access, Context, Problem, Unmodelled};
use crate::frequency::Frequency;

/// GCCFG.PWRDWN: the transceiver is on.
const PWRDWN: u32 = 1 << 16;
/// GCCFG.NOVBUSSENS: the USB supply counts as present.
const NOVBUSSENS: u32 = 1 << 21;
/// DCTL.SDIS: the pull-up of D+ is off.
const SDIS: u32 = 1 << 1;
/// GRSTCTL.RXFFLSH and TXFFLSH.
const FLUSHES: u32 = 3 << 4;
/// GRSTCTL.AHBIDL: the core's master is idle. Read-only.
const AHBIDL: u32 = 1 << 31;
/// Time that flushing a FIFO takes: 8 periods of the 48 MHz clock.
const FLUSH_S: f64 = 8.0 / 48e6;
/// GHWCFG4 as silicon has it.
const GHWCFG4: u32 = 0x0ff0_8030;
/// CID of both chips.
const CID: u32 = 0x1200;

/// Returns an error if bits are set that are not modelled.
fn only(register: &str, value: u32, known: u32) -> Access<()> {
    match value & !known {
        0 => Ok(()),
        others => Err(Unmodelled::new(&format!("bits {others:#x} of {register}")).into()),
    }
}

/// Returns the endpoint and the offset in its registers, if there is such an endpoint.
fn endpoint(offset: u32, first: u32) -> Access<(usize, u32)> {
    let (index, register) = (((offset - first) / 0x20) as usize, (offset - first) % 0x20);
    if index < ENDPOINTS { Ok((index, register)) } else { Err(Problem::register()) }
}

impl Usb {
    /// Reads a register. Reading GRXSTSP may change the interrupt line.
    pub(crate) fn read(&mut self, offset: u32, context: &Context<'_>) -> Access<u32> {
        Ok(match offset {
            0x008 => self.bus_config,
            0x00c => self.config,
            0x010 => {
                if context.seconds >= self.flush.1 {
                    self.flush.0 &= !FLUSHES;
                }
                self.flush.0 | AHBIDL
            }
            0x014 => self.all_flags(),
            0x018 => self.mask,
            0x01c => self.received.peek().map_or(0, |entry| entry.word()),
            0x020 => {
                let entry = self.received.pop()?;
                self.status_read(entry.endpoint, entry.status);
                entry.word()
            }
            0x024 => self.received.depth,
            0x028 => self.transmit[0].depth << 16 | self.transmit[0].start,
            0x104..=0x10c => {
                let transmit = &self.transmit[(offset - 0x100) as usize / 4];
                transmit.depth << 16 | transmit.start
            }
            0x038 => self.general,
            0x03c => CID,
            0x050 => GHWCFG4,
            0x800 => self.device_config,
            0x804 => self.control,
            0x808 => u32::from(self.suspended) | 3 << 1 | u32::from(self.frame) << 8,
            0x810 => self.in_mask,
            0x814 => self.out_mask,
            0x818 => self.pending_endpoints(),
            0x81c => self.endpoint_mask,
            0x834 => self.empty_mask,
            0x900..=0x97f => {
                let (index, register) = endpoint(offset, 0x900)?;
                let input = &self.inputs[index];
                match register {
                    0x00 => input.read_control(),
                    0x08 => input.interrupts | if self.is_transmit_empty(index) { 1 << 7 } else { 0 },
                    0x10 => input.read_size(),
                    0x18 => self.transmit[input.fifo()].free_words(),
                    _ => return Err(Problem::register()),
                }
            }
            0xb00..=0xb7f => {
                let (index, register) = endpoint(offset, 0xb00)?;
                let output = &self.outputs[index];
                match register {
                    0x00 => output.read_control(),
                    0x08 => output.interrupts,
                    0x10 => output.read_size(),
                    _ => return Err(Problem::register()),
                }
            }
            // All FIFO addresses read the receive FIFO.
            0x1000..=0x4fff => self.received.read()?,
            _ => return Err(Problem::register()),
        })
    }

    pub(crate) fn write(&mut self, offset: u32, value: u32, context: &Context<'_>) -> Access<()> {
        let was_attached = self.is_attached();
        match offset {
            0x008 => {
                only("GAHBCFG", value, 0x81)?;
                self.bus_config = value;
            }
            0x00c => {
                only("GUSBCFG", value, 0x4000_3c47)?;
                self.config = value;
            }
            0x010 => self.write_reset(value, context)?,
            0x014 => self.flags &= !(value & flag::CLEARED),
            0x018 => self.mask = value,
            0x024 => {
                if !(16..=256).contains(&value) {
                    let reason = format!("GRXFSIZ is {value}; it must be 16 to 256 words");
                    return Err(Problem::Misuse { reason });
                }
                self.received.depth = value;
            }
            0x028 => self.write_transmit_size(0, value)?,
            0x104..=0x10c => self.write_transmit_size((offset - 0x100) as usize / 4, value)?,
            0x038 => self.write_general(value, context)?,
            0x800 => {
                only("DCFG", value, 0x1ff7)?;
                if value & 3 != 3 {
                    let reason = format!("DCFG.DSPD is {}; the core has full speed alone, 3", value & 3);
                    return Err(Problem::Misuse { reason });
                }
                self.device_config = value;
            }
            0x804 => {
                only("DCTL", value, SDIS)?;
                self.control = value;
            }
            0x810 => self.in_mask = value,
            0x814 => self.out_mask = value,
            0x81c => self.endpoint_mask = value,
            0x834 => self.empty_mask = value,
            0x900..=0x97f => self.write_input(offset, value)?,
            0xb00..=0xb7f => self.write_output(offset, value)?,
            0x1000..=0x4fff => {
                let index = (offset / 0x1000 - 1) as usize;
                if !self.inputs.iter().any(|input| input.is_enabled() && input.fifo() == index) {
                    let reason = format!("transmit FIFO {index} is written, and no endpoint that uses it is enabled");
                    return Err(Problem::Misuse { reason });
                }
                self.transmit[index].write(value)?;
            }
            _ => return Err(Problem::register()),
        }
        if self.is_attached() != was_attached {
            self.suspended = false;
            self.active_s = context.seconds;
        }
        Ok(())
    }

    /// Writes GRSTCTL, which flushes FIFOs.
    fn write_reset(&mut self, value: u32, context: &Context<'_>) -> Access<()> {
        only("GRSTCTL", value, FLUSHES | 0x1f << 6 | AHBIDL)?;
        // The idle bit can be read alone; a driver writes back what it read.
        let value = value & !AHBIDL;
        self.flush = (value, context.seconds + FLUSH_S);
        if value & 1 << 4 != 0 {
            self.received.flush();
        }
        if value & 1 << 5 != 0 {
            let number = (value >> 6 & 0x1f) as usize;
            match self.transmit.get_mut(number) {
                Some(transmit) => transmit.flush(),
                None if number == 0x10 => self.transmit.iter_mut().for_each(super::Transmit::flush),
                None => {
                    let reason = format!("GRSTCTL.TXFNUM is {number}; there are 0 to 3, and 16 for all");
                    return Err(Problem::Misuse { reason });
                }
            }
        }
        Ok(())
    }

    fn write_transmit_size(&mut self, index: usize, value: u32) -> Access<()> {
        let (start, depth) = (value & 0xffff, value >> 16);
        if depth < 16 || start + depth > FIFO_WORDS || start < self.received.depth {
            let reason = format!(
                "transmit FIFO {index} begins at word {start} and has a depth of {depth}; it must have at least 16 words, \
                 behind the receive FIFO of {} and within {FIFO_WORDS}",
                self.received.depth
            );
            return Err(Problem::Misuse { reason });
        }
        (self.transmit[index].start, self.transmit[index].depth) = (start, depth);
        Ok(())
    }

    /// Writes GCCFG. The transceiver needs a clock of 48 MHz, exact to 0.25 %.
    fn write_general(&mut self, value: u32, context: &Context<'_>) -> Access<()> {
        only("GCCFG", value, PWRDWN | NOVBUSSENS)?;
        let (low, high) = (Frequency::hz(47_880_000), Frequency::hz(48_120_000));
        if value & PWRDWN != 0 && !context.clocks.usb.is_some_and(|clock| (low..=high).contains(&clock)) {
            let is = context.clocks.usb.map_or("off".to_owned(), |clock| clock.to_string());
            let reason = format!("GCCFG.PWRDWN is set while the USB clock is {is}; it must be 48 MHz, within 0.25 %");
            return Err(Problem::ClockTree { reason });
        }
        self.general = value;
        Ok(())
    }

    fn write_input(&mut self, offset: u32, value: u32) -> Access<()> {
        let (index, register) = endpoint(offset, 0x900)?;
        let input = &mut self.inputs[index];
        match register {
            0x00 => {
                let was_enabled = input.is_enabled();
                input.write_control(value)?;
                if input.is_enabled() && !was_enabled {
                    self.check_transmit(index)?;
                }
            }
            0x08 => input.interrupts &= !value,
            0x10 => input.write_size(value)?,
            _ => return Err(Problem::register()),
        }
        Ok(())
    }

    /// Checks that the transmit FIFOs in use do not overlap.
    fn check_transmit(&self, index: usize) -> Access<()> {
        let used = |index: usize| {
            let transmit = &self.transmit[self.inputs[index].fifo()];
            transmit.start..transmit.start + transmit.depth
        };
        let own = used(index);
        for other in (0..ENDPOINTS).filter(|&other| other != index && self.inputs[other].is_active()) {
            let range = used(other);
            if own.start < range.end && range.start < own.end {
                let reason = format!("the transmit FIFOs of endpoints {index} and {other} overlap");
                return Err(Problem::Misuse { reason });
            }
        }
        Ok(())
    }

    fn write_output(&mut self, offset: u32, value: u32) -> Access<()> {
        let (index, register) = endpoint(offset, 0xb00)?;
        let output = &mut self.outputs[index];
        match register {
            0x00 => output.write_control(value)?,
            0x08 => output.interrupts &= !value,
            0x10 if output.write_size(value) => {
                let warning = format!("DOEPTSIZ{index} is written while DOEPCTL{index}.EPENA is set");
                if !self.warnings.contains(&warning) {
                    self.warnings.push(warning);
                }
            }
            0x10 => {}
            _ => return Err(Problem::register()),
        }
        Ok(())
    }
}

//! Endpoints of the USB core: their registers, and what they have to transfer.

use super::super::{Access, Problem, Unmodelled};

const USBAEP: u32 = 1 << 15;
const NAKSTS: u32 = 1 << 17;
const STALL: u32 = 1 << 21;
const CNAK: u32 = 1 << 26;
const SNAK: u32 = 1 << 27;
const SD0PID: u32 = 1 << 28;
const SODDFRM: u32 = 1 << 29;
const EPDIS: u32 = 1 << 30;
const EPENA: u32 = 1 << 31;
/// Transfer complete (DIEPINT, DOEPINT).
pub(super) const XFRC: u32 = 1 << 0;
/// Endpoint disabled (DIEPINT, DOEPINT).
const EPDISD: u32 = 1 << 1;
/// SETUP phase done (DOEPINT).
pub(super) const STUP: u32 = 1 << 3;
/// IN token received when the transmit FIFO was empty (DIEPINT).
pub(super) const ITTXFE: u32 = 1 << 4;

/// Registers that an endpoint of either direction has.
#[derive(Debug)]
struct Common {
    index: usize,
    /// Fields of the control register that keep their value: MPSIZ, USBAEP, EPTYP, STALL, TXFNUM.
    control: u32,
    is_nak: bool,
    is_enabled: bool,
    /// True if the next packet is DATA1.
    odd: bool,
    /// Bytes and packets that are left (DIEPTSIZ, DOEPTSIZ).
    bytes: u32,
    packets: u32,
}

impl Common {
    fn new(index: usize) -> Common {
        let control = if index == 0 { USBAEP } else { 0 };
        Common { index, control, is_nak: false, is_enabled: false, odd: false, bytes: 0, packets: 0 }
    }

    fn read(&self) -> u32 {
        let level = |is_set: bool, bit: u32| if is_set { bit } else { 0 };
        self.control | level(self.odd, 1 << 16) | level(self.is_nak, NAKSTS) | level(self.is_enabled, EPENA)
    }

    /// Writes the control register but for EPENA and EPDIS.
    fn write(&mut self, value: u32) -> Access<()> {
        if value & SODDFRM != 0 || self.index != 0 && value & USBAEP != 0 && value >> 18 & 3 == 1 {
            return Err(Unmodelled::new("isochronous endpoints").into());
        }
        let kept = 0x03ec_0000 | USBAEP | 0x7ff;
        self.control = value & kept | if self.index == 0 { USBAEP } else { 0 };
        if value & CNAK != 0 {
            self.is_nak = false;
        }
        if value & SNAK != 0 {
            self.is_nak = true;
        }
        if value & SD0PID != 0 {
            self.odd = false;
        }
        Ok(())
    }

    fn packet_bytes(&self) -> u32 {
        if self.index == 0 { 64 >> (self.control & 3) } else { self.control & 0x7ff }
    }

    fn is_active(&self) -> bool {
        self.control & USBAEP != 0
    }

    /// Writes the transfer size register.
    fn write_size(&mut self, value: u32) {
        let (bytes, packets) = if self.index == 0 { (0x7f, 3) } else { (0x7_ffff, 0x3ff) };
        self.bytes = value & bytes;
        self.packets = value >> 19 & packets;
    }

    /// Sets what a reset of the bus sets: only endpoint 0 is active.
    fn bus_reset(&mut self) {
        if self.index != 0 {
            self.control &= !USBAEP;
        }
        self.odd = false;
    }
}

/// IN endpoint: it sends to the host.
#[derive(Debug)]
pub(super) struct In {
    common: Common,
    /// DIEPINT without TXFE.
    pub(super) interrupts: u32,
}

impl In {
    pub(super) fn new(index: usize) -> In {
        In { common: Common::new(index), interrupts: 0 }
    }

    pub(super) fn read_control(&self) -> u32 {
        self.common.read()
    }

    pub(super) fn write_control(&mut self, value: u32) -> Access<()> {
        let common = &mut self.common;
        common.write(value)?;
        if value & EPDIS != 0 && common.is_enabled {
            common.is_enabled = false;
            self.interrupts |= EPDISD;
        } else if value & EPENA != 0 && !common.is_enabled {
            let name = format!("DIEPCTL{}.EPENA is set", common.index);
            if common.packets == 0 {
                let reason = format!("{name} with DIEPTSIZ{}.PKTCNT = 0; set the size first", common.index);
                return Err(Problem::Misuse { reason });
            }
            if !common.is_active() {
                return Err(Problem::Misuse { reason: format!("{name} on an endpoint that is not active") });
            }
            if common.packets > 1 {
                return Err(Unmodelled::new("IN transfers of several packets").into());
            }
            common.is_enabled = true;
        }
        Ok(())
    }

    pub(super) fn read_size(&self) -> u32 {
        self.common.packets << 19 | self.common.bytes
    }

    pub(super) fn write_size(&mut self, value: u32) -> Access<()> {
        if self.common.is_enabled {
            let reason = format!("DIEPTSIZ{} is written while DIEPCTL{0}.EPENA is set", self.common.index);
            return Err(Problem::Misuse { reason });
        }
        self.common.write_size(value);
        Ok(())
    }

    /// Returns the number of the endpoint's transmit FIFO.
    pub(super) fn fifo(&self) -> usize {
        if self.common.index == 0 { 0 } else { (self.common.control >> 22 & 3) as usize }
    }

    pub(super) fn is_enabled(&self) -> bool {
        self.common.is_enabled
    }

    pub(super) fn is_active(&self) -> bool {
        self.common.is_active()
    }

    pub(super) fn is_stalled(&self) -> bool {
        self.common.control & STALL != 0
    }

    pub(super) fn is_odd(&self) -> bool {
        self.common.odd
    }

    /// Returns the number of bytes of the next packet, or `None` if the endpoint answers with NAK.
    pub(super) fn next_bytes(&self) -> Option<usize> {
        let common = &self.common;
        (common.is_enabled && !common.is_nak).then(|| common.bytes.min(common.packet_bytes()) as usize)
    }

    /// Ends a packet that the host has acknowledged.
    pub(super) fn sent(&mut self, bytes: usize) {
        let common = &mut self.common;
        common.bytes = common.bytes.saturating_sub(bytes as u32);
        common.packets = common.packets.saturating_sub(1);
        common.odd = !common.odd;
        if common.packets == 0 {
            common.is_enabled = false;
            self.interrupts |= XFRC;
        }
    }

    /// Prepares endpoint 0 for the data of a control transfer.
    pub(super) fn setup(&mut self) {
        self.common.is_nak = true;
        self.common.control &= !STALL;
        self.common.odd = true;
    }

    pub(super) fn bus_reset(&mut self) {
        self.common.bus_reset();
    }
}

/// OUT endpoint: the host sends to it.
#[derive(Debug)]
pub(super) struct Out {
    common: Common,
    /// DOEPINT.
    pub(super) interrupts: u32,
    /// DOEPTSIZ0.STUPCNT.
    setups: u32,
}

impl Out {
    pub(super) fn new(index: usize) -> Out {
        Out { common: Common::new(index), interrupts: 0, setups: 0 }
    }

    pub(super) fn read_control(&self) -> u32 {
        self.common.read()
    }

    pub(super) fn write_control(&mut self, value: u32) -> Access<()> {
        let common = &mut self.common;
        common.write(value)?;
        if value & EPDIS != 0 {
            let reason = format!("DOEPCTL{}.EPDIS is set without the global OUT NAK (DCTL.SGONAK)", common.index);
            return Err(Problem::Misuse { reason });
        }
        common.is_enabled |= value & EPENA != 0;
        Ok(())
    }

    pub(super) fn read_size(&self) -> u32 {
        self.setups << 29 | self.common.packets << 19 | self.common.bytes
    }

    /// Writes the transfer size. Returns true if the endpoint is enabled: the manual forbids that.
    pub(super) fn write_size(&mut self, value: u32) -> bool {
        self.common.write_size(value);
        self.setups = value >> 29 & 3;
        self.common.is_enabled
    }

    pub(super) fn is_active(&self) -> bool {
        self.common.is_active()
    }

    pub(super) fn is_stalled(&self) -> bool {
        self.common.control & STALL != 0
    }

    /// Returns true if the endpoint takes a packet, and true if it then is DATA1.
    pub(super) fn takes(&self) -> (bool, bool) {
        let common = &self.common;
        (!common.is_nak && (common.index == 0 || common.packets > 0), common.odd)
    }

    /// Takes a packet. Returns true if it ends the transfer.
    pub(super) fn take(&mut self, bytes: usize) -> bool {
        let common = &mut self.common;
        let is_short = (bytes as u32) < common.packet_bytes();
        common.bytes = common.bytes.saturating_sub(bytes as u32);
        common.packets = common.packets.saturating_sub(1);
        common.odd = !common.odd;
        let ends = is_short || common.packets == 0;
        if ends {
            common.is_nak = true;
            common.is_enabled = false;
        }
        ends
    }

    /// Takes a SETUP packet, after which the endpoint answers with NAK.
    pub(super) fn setup(&mut self) {
        self.common.is_nak = true;
        self.common.control &= !STALL;
        self.common.odd = true;
        self.setups = self.setups.saturating_sub(1);
    }

    pub(super) fn bus_reset(&mut self) {
        self.common.bus_reset();
    }
}

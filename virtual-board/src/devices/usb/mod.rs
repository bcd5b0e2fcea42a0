//! USB core OTG_FS in device mode, full speed (RM0090 section 34, RM0383 section 22).
//!
//! ```text
//! program ──registers──► global registers ─► interrupt line
//!                        endpoints ◄─► FIFOs
//! host ─── packets ────► bus.rs ───────► endpoints, FIFOs
//! ```
//!
//! Host mode, DMA, isochronous endpoints, low power and sensing of the USB supply are not modelled.
//! An OUT endpoint takes a packet if its NAK status is clear, whether or not EPENA is set: drivers
//! that clear NAK alone are known to work on silicon.

mod board;
mod bus;
mod endpoint;
mod fifo;
mod registers;

pub(crate) use bus::Answer;
use endpoint::{In, Out};
use fifo::{Received, Transmit};

/// Number of endpoints in each direction.
const ENDPOINTS: usize = 4;
/// Size of the memory that all FIFOs share, in words.
const FIFO_WORDS: u32 = 320;
/// Time without activity after which a device is suspended, in seconds.
const IDLE_S: f64 = 3e-3;

/// Latched flags of GINTSTS.
mod flag {
    pub(super) const SOF: u32 = 1 << 3;
    pub(super) const RXFLVL: u32 = 1 << 4;
    pub(super) const ESUSP: u32 = 1 << 10;
    pub(super) const USBSUSP: u32 = 1 << 11;
    pub(super) const USBRST: u32 = 1 << 12;
    pub(super) const ENUMDNE: u32 = 1 << 13;
    pub(super) const IEPINT: u32 = 1 << 18;
    pub(super) const OEPINT: u32 = 1 << 19;
    pub(super) const WKUPINT: u32 = 1 << 31;
    /// Flags that writing 1 clears.
    pub(super) const CLEARED: u32 = 0xf030_fc0a;
}

/// USB core.
#[derive(Debug)]
pub(crate) struct Usb {
    /// GAHBCFG.
    bus_config: u32,
    /// GUSBCFG.
    config: u32,
    /// Latched flags of GINTSTS.
    flags: u32,
    /// GINTMSK.
    mask: u32,
    /// GCCFG.
    general: u32,
    /// DCFG.
    device_config: u32,
    /// Address that the core listens to: DCFG.DAD once the request that set it is over.
    address: u8,
    /// DCTL.
    control: u32,
    /// DIEPMSK.
    in_mask: u32,
    /// DOEPMSK.
    out_mask: u32,
    /// DAINTMSK.
    endpoint_mask: u32,
    /// DIEPEMPMSK.
    empty_mask: u32,
    /// Bits of GRSTCTL that flush FIFOs, and the time in seconds at which they clear.
    flush: (u32, f64),
    received: Received,
    transmit: [Transmit; ENDPOINTS],
    inputs: [In; ENDPOINTS],
    outputs: [Out; ENDPOINTS],
    /// True if a SETUP packet has come whose end the receive FIFO does not tell yet.
    setup_is_open: bool,
    /// Number of the last frame.
    frame: u16,
    /// Time in seconds at which the bus was last active.
    active_s: f64,
    suspended: bool,
    /// Faults of the program that a chip would let pass, as sentences.
    pub(crate) warnings: Vec<String>,
}

impl Default for Usb {
    fn default() -> Usb {
        Usb {
            bus_config: 0,
            config: 0x1440,
            flags: 0,
            mask: 0,
            general: 0,
            device_config: 0,
            address: 0,
            control: 0,
            in_mask: 0,
            out_mask: 0,
            endpoint_mask: 0,
            empty_mask: 0,
            flush: (0, 0.0),
            received: Received::default(),
            transmit: std::array::from_fn(Transmit::new),
            inputs: std::array::from_fn(In::new),
            outputs: std::array::from_fn(Out::new),
            setup_is_open: false,
            frame: 0,
            active_s: 0.0,
            suspended: false,
            warnings: Vec::new(),
        }
    }
}

impl Usb {
    /// Returns true if the interrupt is asserted.
    pub(crate) fn is_asserted(&self) -> bool {
        self.bus_config & 1 != 0 && self.all_flags() & self.mask != 0
    }

    /// Returns GINTSTS.
    fn all_flags(&self) -> u32 {
        let pending = self.pending_endpoints() & self.endpoint_mask;
        let level = |is_set: bool, bit: u32| if is_set { bit } else { 0 };
        // The FIFOs of host mode are empty.
        0x0400_0020
            | self.flags
            | level(!self.received.is_empty(), flag::RXFLVL)
            | level(pending & 0xffff != 0, flag::IEPINT)
            | level(pending >> 16 != 0, flag::OEPINT)
    }

    /// Returns DAINT: IN endpoints with an interrupt in the lower half, OUT endpoints in the upper.
    fn pending_endpoints(&self) -> u32 {
        let mut pending = 0;
        for index in 0..ENDPOINTS {
            let empty = self.empty_mask >> index & 1 != 0 && self.is_transmit_empty(index);
            if empty || self.inputs[index].interrupts & self.in_mask != 0 {
                pending |= 1 << index;
            }
            if self.outputs[index].interrupts & self.out_mask != 0 {
                pending |= 1 << (16 + index);
            }
        }
        pending
    }

    /// Returns true if the transmit FIFO of an endpoint is empty, or half empty if GAHBCFG.TXFELVL
    /// asks for that.
    fn is_transmit_empty(&self, index: usize) -> bool {
        let transmit = &self.transmit[self.inputs[index].fifo()];
        transmit.free_words() * if self.bus_config & 1 << 7 != 0 { 1 } else { 2 } >= transmit.depth
    }
}

//! Report of what the host saw.

use serde::Serialize;

/// Transfer over a MIDI endpoint. Times are seconds from power-on.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct UsbTransfer {
    /// Time at which the host wanted to send it, or first asked for it.
    pub asked_s: f64,
    /// Time of the end of its acknowledgement.
    pub ended_s: f64,
    /// Bytes: event packets of 4 bytes.
    pub bytes: Vec<u8>,
}

/// Report of the host at the USB cable.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct UsbReport {
    /// Times at which the board was configured.
    pub configured_s: Vec<f64>,
    /// Device descriptor that the board gave last.
    pub device_descriptor: Vec<u8>,
    /// Configuration descriptor that the board gave last, with all descriptors in it.
    pub configuration_descriptor: Vec<u8>,
    /// Strings that the device descriptor names: manufacturer, product, serial number.
    pub strings: Vec<String>,
    /// Transfers that the board took, in order.
    pub sent: Vec<UsbTransfer>,
    /// Transfers that the board sent, in order.
    pub received: Vec<UsbTransfer>,
    /// Number of transfers that the board did not get: they were lost when it left the bus or its
    /// cable was pulled out, or they still wait at the end.
    pub unsent: u64,
    /// Number of resets of the bus.
    pub resets: u64,
    /// Number of times that the board refused a MIDI transfer for the moment.
    pub refused: u64,
    /// Number of times that the board had nothing to fetch.
    pub empty_polls: u64,
    /// Number of requests that the board stalled.
    pub stalls: u64,
    /// Faults on the bus, as sentences.
    pub failures: Vec<String>,
}

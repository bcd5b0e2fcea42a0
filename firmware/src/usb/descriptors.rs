//! Descriptors: the device, and its MIDI function with one cable in each direction.
//!
//! ```text
//! host ─► endpoint OUT ─► embedded IN jack ─► external OUT jack
//! host ◄─ endpoint IN ◄─ embedded OUT jack ◄─ external IN jack
//! ```
//!
//! The function is that of appendix B of the USB Device Class Definition for MIDI Devices 1.0. The
//! function of `embassy-usb` is not used: its endpoint descriptors have 7 bytes, where section 6.2
//! asks for 9.

use embassy_usb::descriptor::{SynchronizationType, UsageType};
use embassy_usb::driver::{Driver, Endpoint, EndpointType};
use embassy_usb::{Builder, Config, UsbVersion};

/// Length of a transfer of the MIDI endpoints in bytes: the longest of full speed.
pub(super) const TRANSFER_BYTES: usize = 64;
/// Length of all descriptors of the configuration in bytes.
pub(super) const CONFIGURATION_BYTES: usize = 9 + 9 + 9 + 9 + MIDI_BYTES;
/// Length of the descriptors that describe the MIDI interface in bytes: header, four jacks, two
/// endpoints.
const MIDI_BYTES: usize = 7 + 2 * 6 + 2 * 9 + 2 * (9 + 5);

/// Vendor of open-source projects, <https://pid.codes>.
const VENDOR: u16 = 0x1209;
/// Product number for tests: a board for sale needs a number of its own.
const PRODUCT: u16 = 0x0001;

const AUDIO: u8 = 1;
const AUDIO_CONTROL: u8 = 1;
const MIDI_STREAMING: u8 = 3;
const CS_INTERFACE: u8 = 0x24;
const CS_ENDPOINT: u8 = 0x25;
const HEADER: u8 = 1;
const MIDI_IN_JACK: u8 = 2;
const MIDI_OUT_JACK: u8 = 3;
const MS_GENERAL: u8 = 1;
const EMBEDDED: u8 = 1;
const EXTERNAL: u8 = 2;
const EMBEDDED_IN: u8 = 1;
const EXTERNAL_IN: u8 = 2;
const EMBEDDED_OUT: u8 = 3;
const EXTERNAL_OUT: u8 = 4;

/// Returns the description of the device, whose serial number is that of the chip.
pub(super) fn device() -> Config<'static> {
    let mut config = Config::new(VENDOR, PRODUCT);
    config.manufacturer = Some("Malleus");
    config.product = Some("Malleus");
    config.serial_number = Some(embassy_stm32::uid::uid_hex());
    config.bcd_usb = UsbVersion::Two;
    // The interfaces name their classes, and one function needs no association.
    (config.device_class, config.device_sub_class, config.device_protocol) = (0, 0, 0);
    config.composite_with_iads = false;
    config.max_power = 100;
    config
}

/// Adds the MIDI function and returns its endpoints, OUT and IN.
pub(super) fn add_midi<D: Driver<'static>>(builder: &mut Builder<'static, D>) -> (D::EndpointOut, D::EndpointIn) {
    let mut function = builder.function(AUDIO, AUDIO_CONTROL, 0);
    let mut control = function.interface();
    let midi_interface = u8::from(control.interface_number()) + 1;
    let mut settings = control.alt_setting(AUDIO, AUDIO_CONTROL, 0, None);
    settings.descriptor(CS_INTERFACE, &[HEADER, 0x00, 0x01, 9, 0, 1, midi_interface]);

    let mut midi = function.interface();
    let mut settings = midi.alt_setting(AUDIO, MIDI_STREAMING, 0, None);
    settings.descriptor(CS_INTERFACE, &[HEADER, 0x00, 0x01, MIDI_BYTES as u8, 0]);
    settings.descriptor(CS_INTERFACE, &[MIDI_IN_JACK, EMBEDDED, EMBEDDED_IN, 0]);
    settings.descriptor(CS_INTERFACE, &[MIDI_IN_JACK, EXTERNAL, EXTERNAL_IN, 0]);
    settings.descriptor(CS_INTERFACE, &[MIDI_OUT_JACK, EMBEDDED, EMBEDDED_OUT, 1, EXTERNAL_IN, 1, 0]);
    settings.descriptor(CS_INTERFACE, &[MIDI_OUT_JACK, EXTERNAL, EXTERNAL_OUT, 1, EMBEDDED_IN, 1, 0]);
    let (none, data) = (SynchronizationType::NoSynchronization, UsageType::DataEndpoint);
    let receiving = settings.alloc_endpoint_out(EndpointType::Bulk, None, TRANSFER_BYTES as u16, 0);
    settings.endpoint_descriptor(receiving.info(), none, data, &[0, 0]);
    settings.descriptor(CS_ENDPOINT, &[MS_GENERAL, 1, EMBEDDED_IN]);
    let sending = settings.alloc_endpoint_in(EndpointType::Bulk, None, TRANSFER_BYTES as u16, 0);
    settings.endpoint_descriptor(sending.info(), none, data, &[0, 0]);
    settings.descriptor(CS_ENDPOINT, &[MS_GENERAL, 1, EMBEDDED_OUT]);
    (receiving, sending)
}

//! SysEx of the host: the identity request of MIDI, and kits and settings over the cable
//! (docs/midi-sysex.md).

use cable::{Device, Message, Outcome};
use dsp_core::midi::Packet;
use embassy_futures::select::{Either, select};
use embassy_sync::blocking_mutex::raw::ThreadModeRawMutex;
use embassy_sync::signal::Signal;

use crate::board::MIDI_NUMBER;
use crate::storage::Storage;
use crate::usb::{Replies, Sysex};

/// Kit that a program change asks for: its slot, or `None` for the built-in kit.
static KIT: Signal<ThreadModeRawMutex, Option<u8>> = Signal::new();

/// Asks for the kit of a slot, or for the built-in kit.
pub fn change_kit(slot: Option<u8>) {
    KIT.signal(slot);
}

/// Answers the host, and changes kits.
///
/// An answer of a long job is sent before the job is done: erasing flash holds the core up.
#[embassy_executor::task]
pub async fn serve(mut sysex: Sysex, mut replies: Replies, mut storage: Storage) {
    let (mut device, mut message) = (Device::new(), Message::new());
    let mut matched = 0;
    loop {
        let packet = match select(sysex.next(), KIT.wait()).await {
            Either::First(packet) => packet,
            Either::Second(slot) => {
                if let Err(refusal) = storage.play(slot) {
                    defmt::warn!("program change: {}", refusal);
                }
                continue;
            }
        };
        for &byte in Packet(packet).bytes() {
            // The request goes to all devices, or to one by its number.
            let is_next = REQUEST.get(matched).is_some_and(|&next| byte == next || matched == 2 && byte < 0x80);
            matched = if is_next { matched + 1 } else { usize::from(byte == REQUEST[0]) };
            if matched == REQUEST.len() {
                matched = 0;
                send(&IDENTITY, &mut replies).await;
            }
            let mut outcome = receive(&mut device, byte, &mut storage, &mut message);
            while outcome != Outcome::Nothing {
                if let Outcome::Refused(refusal) = outcome {
                    defmt::warn!("cable: {}", refusal);
                }
                send(message.bytes(), &mut replies).await;
                outcome = Outcome::Nothing;
                if let Some(job) = device.job() {
                    defmt::info!("cable: {}", job);
                    outcome = work(&mut device, &mut storage, &mut message);
                }
            }
        }
    }
}

/// Takes a byte.
// Not inlined: its stack must not add to that of a job.
#[inline(never)]
fn receive(device: &mut Device, byte: u8, storage: &mut Storage, message: &mut Message) -> Outcome {
    device.receive(byte, storage, message)
}

/// Does the job that waits.
#[inline(never)]
fn work(device: &mut Device, storage: &mut Storage, message: &mut Message) -> Outcome {
    device.work(storage, message)
}

/// Sends a whole SysEx.
async fn send(bytes: &[u8], replies: &mut Replies) {
    let (whole, rest) = bytes.as_chunks::<3>();
    // The last packet has one to three bytes, and a code of its own.
    let (last, before) = match (rest, whole.split_last()) {
        ([], Some((last, before))) => (&last[..], before),
        _ => (rest, whole),
    };
    for &[a, b, c] in before {
        replies.push([0x04, a, b, c]).await;
    }
    let mut packet = [0x04 + last.len() as u8, 0, 0, 0];
    for (place, &byte) in packet.iter_mut().skip(1).zip(last) {
        *place = byte;
    }
    replies.push(packet).await;
}

/// Identity request of MIDI (universal SysEx 06 01), to all devices.
const REQUEST: [u8; 6] = [0xF0, 0x7E, 0x7F, 0x06, 0x01, 0xF7];

/// Identity reply: manufacturer 7D (not for sale), family 1, number of the board, version of the
/// firmware.
const IDENTITY: [u8; 15] =
    [0xF0, 0x7E, 0x7F, 0x06, 0x02, 0x7D, 1, 0, MIDI_NUMBER, 0, VERSION[0], VERSION[1], VERSION[2], 0, 0xF7];

/// Version of the firmware, a number of 7 bits each.
const VERSION: [u8; 3] = {
    let text = env!("CARGO_PKG_VERSION").as_bytes();
    let (mut version, mut part, mut at) = ([0; 3], 0, 0);
    while at < text.len() && part < 3 {
        match text[at] {
            digit @ b'0'..=b'9' => version[part] = version[part] * 10 + (digit - b'0'),
            _ => part += 1,
        }
        at += 1;
    }
    version
};

//! Transport of the log: defmt frames in a ring in memory, which a debug probe fetches (RTT, by
//! SEGGER).
//!
//! Nothing waits for the probe. A frame is written whole or not at all: one that finds no room is
//! left out and counted, so that what the probe fetches later can be decoded.

use core::cell::UnsafeCell;
use core::sync::atomic::{AtomicU32, Ordering};

use cortex_m::interrupt;
use cortex_m::register::primask;

use crate::counters;

/// Length of the ring in bytes, of which all but one can wait for the probe.
const BYTES: usize = 1024;

/// Block by which the probe finds the ring. SEGGER sets its layout, and the probe moves `read`.
#[repr(C)]
struct ControlBlock {
    id: [u8; 16],
    channels_up: u32,
    channels_down: u32,
    name: &'static [u8; 6],
    ring: &'static Ring,
    size: u32,
    write: AtomicU32,
    read: AtomicU32,
    /// Wish of the probe to make the program wait, which the program does not heed.
    mode: AtomicU32,
}

#[repr(transparent)]
struct Ring(UnsafeCell<[u8; BYTES]>);

// SAFETY: only the one open frame writes the ring, where the probe does not read yet.
unsafe impl Sync for Ring {}

#[unsafe(link_section = ".uninit.rtt")]
static RING: Ring = Ring(UnsafeCell::new([0; BYTES]));

/// Control block. The probe looks for this name, or for the bytes of `id` in memory.
#[unsafe(no_mangle)]
static _SEGGER_RTT: ControlBlock = ControlBlock {
    id: *b"SEGGER RTT\0\0\0\0\0\0",
    channels_up: 1,
    channels_down: 0,
    name: b"defmt\0",
    ring: &RING,
    size: BYTES as u32,
    write: AtomicU32::new(0),
    read: AtomicU32::new(0),
    mode: AtomicU32::new(0),
};

/// Frame that is being written.
struct Frame {
    encoder: defmt::Encoder,
    /// Place in the ring of the next byte.
    place: usize,
    /// True if the frame has found no room.
    is_cut: bool,
    /// True if interrupts were enabled before the frame was begun.
    interrupts: bool,
}

impl Frame {
    /// Encodes a part of the frame by `encode`, which gets the encoder and a sink of bytes.
    fn put(&mut self, encode: impl FnOnce(&mut defmt::Encoder, &mut dyn FnMut(&[u8]))) {
        let Self { encoder, place, is_cut, .. } = self;
        let read = _SEGGER_RTT.read.load(Ordering::Relaxed) as usize;
        encode(encoder, &mut |bytes| {
            for &byte in bytes {
                let next = (*place + 1) % BYTES;
                *is_cut |= next == read;
                if !*is_cut {
                    // SAFETY: the place lies inside the ring and holds no unread byte.
                    unsafe { RING.0.get().cast::<u8>().add(*place).write_volatile(byte) };
                    *place = next;
                }
            }
        });
    }
}

struct OpenFrame(UnsafeCell<Frame>);

// SAFETY: it is used between `acquire` and `release` alone, while interrupts are disabled.
unsafe impl Sync for OpenFrame {}

static FRAME: OpenFrame =
    OpenFrame(UnsafeCell::new(Frame { encoder: defmt::Encoder::new(), place: 0, is_cut: false, interrupts: false }));

#[defmt::global_logger]
struct Logger;

// SAFETY: interrupts are disabled from `acquire` to `release`, so that a frame is alone. A panic in
// a frame begins the next one, and does not come back to its own.
unsafe impl defmt::Logger for Logger {
    fn acquire() {
        let interrupts = primask::read().is_active();
        interrupt::disable();
        // SAFETY: interrupts are disabled.
        let frame = unsafe { &mut *FRAME.0.get() };
        frame.interrupts = interrupts;
        frame.place = _SEGGER_RTT.write.load(Ordering::Relaxed) as usize;
        frame.is_cut = false;
        frame.put(|encoder, sink| encoder.start_frame(sink));
    }

    unsafe fn flush() {}

    unsafe fn write(bytes: &[u8]) {
        // SAFETY: the caller is between `acquire` and `release`.
        let frame = unsafe { &mut *FRAME.0.get() };
        frame.put(|encoder, sink| encoder.write(bytes, sink));
    }

    unsafe fn release() {
        // SAFETY: the caller is between `acquire` and `release`.
        let frame = unsafe { &mut *FRAME.0.get() };
        frame.put(|encoder, sink| encoder.end_frame(sink));
        match frame.is_cut {
            true => counters::UNLOGGED_LINES.add(1),
            false => _SEGGER_RTT.write.store(frame.place as u32, Ordering::Release),
        }
        if frame.interrupts {
            // SAFETY: they were enabled before `acquire`.
            unsafe { interrupt::enable() };
        }
    }
}

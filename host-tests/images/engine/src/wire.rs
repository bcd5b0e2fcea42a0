//! How the host hands things over: plain memory with a fixed layout, little-endian.

use dsp_core::event::{Action, Event, Time};

/// An event: 32 bytes.
#[derive(Clone, Copy)]
#[repr(C)]
pub struct WireEvent {
    frame: u64,
    fraction: u32,
    pad: u8,
    striker: u8,
    action: u8,
    reserved: u8,
    velocity: f32,
    position: f32,
    reserved_end: u64,
}

impl WireEvent {
    pub fn event(&self) -> Event {
        Event {
            time: Time { frame: self.frame, fraction: self.fraction },
            pad: self.pad,
            velocity: self.velocity,
            position: self.position,
            striker: self.striker,
            action: match self.action {
                0 => Action::Strike,
                1 => Action::Choke,
                _ => Action::Release,
            },
        }
    }
}

/// A slice that the host has laid at an address.
///
/// # Safety
/// `count` valid values lie there, aligned, and nothing else uses them during the call: the host writes them before it, to memory that the
/// image leaves alone.
pub unsafe fn slice<'a, T>(address: *const T, count: usize) -> &'a [T] {
    // SAFETY: the caller's.
    unsafe { core::slice::from_raw_parts(address, count) }
}

/// The same to be written.
///
/// # Safety
/// As [`slice`].
pub unsafe fn slice_mut<'a, T>(address: *mut T, count: usize) -> &'a mut [T] {
    // SAFETY: the caller's.
    unsafe { core::slice::from_raw_parts_mut(address, count) }
}

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
    /// Of a shedding: how many register groups.
    groups: u32,
    reserved_end: u32,
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
                2 => Action::Release,
                _ => Action::Shed(self.groups as u16),
            },
        }
    }

    /// A decision of the engine: always a shedding.
    pub fn shedding(event: &Event) -> Self {
        let groups = if let Action::Shed(groups) = event.action { u32::from(groups) } else { 0 };
        Self { frame: event.time.frame, action: 3, groups, ..Self::NOTHING }
    }

    /// No event.
    pub const NOTHING: Self = Self {
        frame: 0,
        fraction: 0,
        pad: 0,
        striker: 0,
        action: 0,
        reserved: 0,
        velocity: 0.0,
        position: 0.0,
        groups: 0,
        reserved_end: 0,
    };
}

/// A slice that the host has laid at an address.
///
/// # Safety
/// `count` valid values lie there, aligned, and nothing else uses them during the call: the host
/// writes them before it, to memory that the image leaves alone.
pub unsafe fn slice<'a, T>(address: *const T, count: usize) -> &'a [T] {
    // SAFETY: the caller's.
    unsafe { core::slice::from_raw_parts(address, count) }
}

/// Mutable slice at an address.
///
/// # Safety
/// As [`slice`].
pub unsafe fn slice_mut<'a, T>(address: *mut T, count: usize) -> &'a mut [T] {
    // SAFETY: the caller's.
    unsafe { core::slice::from_raw_parts_mut(address, count) }
}

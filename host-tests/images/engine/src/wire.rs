//! Format in which the host hands over data: plain memory with a fixed layout, little-endian.

use dsp_core::event::{Action, Event, Shedding, Time};
use dsp_core::scrape::Motion;

/// Number that stands for all register groups but the first.
const ALL_BUT_FIRST: u32 = u32::MAX;

/// Event as the host writes and reads it: 40 bytes.
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
    /// Number of register groups that a shed decision leaves out, or [`ALL_BUT_FIRST`]; 0 for other
    /// events.
    groups: u32,
    /// Least and largest normal force of a touch; velocity and normal force of a motion.
    numbers: [f32; 3],
}

impl WireEvent {
    pub fn event(&self) -> Event {
        let [x, y, z] = self.numbers;
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
                3 if self.groups == ALL_BUT_FIRST => Action::Shed(Shedding::AllButFirst),
                3 => Action::Shed(Shedding::Quietest(self.groups as u16)),
                4 => Action::Level,
                5 => Action::Silence,
                6 => Action::Touch { rolls: false, normal_n: [x, y] },
                7 => Action::Touch { rolls: true, normal_n: [x, y] },
                8 => Action::Move(Motion { velocity_m_per_s: [x, y], normal_n: z }),
                _ => Action::Lift,
            },
        }
    }

    /// Decision of the engine as an event; all its decisions are to shed.
    pub fn shedding(event: &Event) -> Self {
        let groups = match event.action {
            Action::Shed(Shedding::Quietest(groups)) => groups.into(),
            Action::Shed(Shedding::AllButFirst) => ALL_BUT_FIRST,
            _ => 0,
        };
        Self { frame: event.time.frame, action: 3, groups, ..Self::NOTHING }
    }

    /// Event of zeros.
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
        numbers: [0.0; 3],
    };
}

/// Slice that the host has laid at an address.
///
/// # Safety
/// `count` valid and aligned values lie there, and nothing else uses them during the call. The host
/// writes them before the call, to memory that the image leaves alone.
pub unsafe fn slice<'a, T>(address: *const T, count: usize) -> &'a [T] {
    // SAFETY: the caller keeps the rule above.
    unsafe { core::slice::from_raw_parts(address, count) }
}

/// Mutable slice that the host has laid at an address.
///
/// # Safety
/// The rule of [`slice`] holds.
pub unsafe fn slice_mut<'a, T>(address: *mut T, count: usize) -> &'a mut [T] {
    // SAFETY: the caller keeps the rule above.
    unsafe { core::slice::from_raw_parts_mut(address, count) }
}

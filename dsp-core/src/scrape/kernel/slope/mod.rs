//! Readings of the path's slope for fast contacts.

#[cfg(cortex_m4f)]
mod cortex_m4;
#[cfg(not(cortex_m4f))]
mod portable;

use super::super::ramp::Ramp;

#[cfg(cortex_m4f)]
pub(in super::super) use cortex_m4::read_rises;
#[cfg(not(cortex_m4f))]
pub(in super::super) use portable::read_rises;

/// Places in an octave of the table; the way of each frame grows before it is gone.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub(in super::super) struct Strides {
    /// Place before the first one, Q32 points, from 0 to the table's end.
    pub(in super::super) place: i64,
    /// Way of a frame and its growth.
    pub(in super::super) speed: i64,
    pub(in super::super) step: i64,
}

/// Mix of the rises at two limits.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub(in super::super) struct Mix {
    /// Weights of both.
    pub(in super::super) weights: [Ramp; 2],
    /// Largest mix.
    pub(in super::super) largest: i32,
    /// Shifts of the mix to the left, and then to the right, 0 to 31.
    pub(in super::super) left: u32,
    pub(in super::super) right: u32,
}

/// Value of the slope's spline for a coefficient of 1 everywhere.
pub(in super::super) const ONE: i32 = 48 << 8;

impl Strides {
    /// True if no frame of a block goes further than all points of a table.
    const fn stay_within(&self, points: usize, frames: usize) -> bool {
        let length = (points as i64) << 32;
        let (first, last) = (self.speed + self.step, self.speed + self.step * frames as i64);
        first < length && first > -length && last < length && last > -length
    }
}

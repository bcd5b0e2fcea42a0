//! Sum of the vertical and the horizontal force, frame by frame.

use super::kernel::{self, Adding};
use super::motion::MAX_SPEED_M_PER_S;
use super::power::Powers;
use super::ramp::{Ramp, bits_for, fixed_from, power_of_two};
use super::scale::Gain;
use crate::fixed;
use crate::time::TICK_FRAMES;

/// Fraction bits of the path's slope.
const SLOPE_BITS: i32 = 28;

/// Gains of a contact, and its path's slope.
#[derive(Clone, Debug)]
pub(super) struct Sum {
    /// From speed times rise to force: `m fs`, in units of the force bus.
    vertical: f32,
    /// From |speed times slope| to force, if the exponent is 1.
    horizontal: f32,
    /// Powers of the slope with another exponent, and the gain from them to Q27 of the bus.
    powers: Option<(Powers, Gain)>,
    /// Share of the slope that is lost in a frame at a speed of 1 m/s.
    leak: f32,
    /// Slope S' of the path in units, with 32 bits more than [`SLOPE_BITS`]: what rounding loses in
    /// each frame would pile up.
    slope: i64,
}

/// Numbers that stay the same over a tick.
#[derive(Clone, Copy, Debug)]
pub(super) struct Weights {
    /// From rises to the slope.
    rise: i32,
    vertical: Ramp,
    horizontal: Ramp,
    /// Shift of the sum to the left, or to the right.
    left: u32,
    right: u32,
    /// Share of the slope, Q32, that is lost in a frame: at most a half, with its sign.
    pub(super) less: i32,
}

impl Sum {
    /// No force.
    pub(super) const fn none() -> Self {
        Self { vertical: 0.0, horizontal: 0.0, powers: None, leak: 0.0, slope: 0 }
    }

    /// Begins a contact: gains from speed in m/s times rise or slope in units, and the slope's leak
    /// in a frame at 1 m/s. `other` holds the powers of the slope if their exponent is not 1.
    pub(super) fn begin(&mut self, vertical: f32, horizontal: f32, other: Option<(Powers, Gain)>, leak: f32) {
        (self.vertical, self.horizontal, self.powers, self.leak, self.slope) = (vertical, horizontal, other, leak, 0);
    }

    /// Prepares a tick with the speeds at its ends in m/s, and rises whose unit is the slope's,
    /// `halvings` times halved.
    pub(super) fn weights(&self, speeds: [f32; 2], halvings: u32) -> Weights {
        let vertical = speeds.map(|speed| speed * self.vertical * power_of_two(-(halvings as i32)));
        let horizontal = if self.powers.is_some() { [0.0; 2] } else { speeds.map(|speed| speed * self.horizontal) };
        // The high word of a rise of 31 bits and a gain of n bits has n - 1.
        let bits = bits_for(vertical, 90) - 1;
        let bits = bits.min(bits_for(horizontal, 90) + SLOPE_BITS - 32).clamp(0, 58);
        let left = 27 - bits;
        Weights {
            rise: 1 << (SLOPE_BITS as u32 + 1).saturating_sub(halvings),
            vertical: Ramp::new(vertical.map(|gain| fixed_from(gain, bits + 1))),
            horizontal: Ramp::new(horizontal.map(|gain| fixed_from(gain, bits - SLOPE_BITS + 32))),
            left: left.clamp(0, 31) as u32,
            right: (-left).clamp(0, 31) as u32,
            less: -2 * fixed_from(0.5 * (speeds[0] + speeds[1]).abs() * self.leak, 31),
        }
    }

    /// Turns rises of the slope, Q31 of a unit, into force, Q27 of the bus, saturated, and gives
    /// the slope in each frame to whom it concerns. The speeds at the ends of the tick are in m/s.
    pub(super) fn render(
        &mut self,
        weights: Weights,
        speeds: [f32; 2],
        frames: &mut [i32; TICK_FRAMES],
        slopes: Option<&mut [i32; TICK_FRAMES]>,
    ) {
        let Weights { rise: gain, vertical, horizontal, left, right, less } = weights;
        let mut adding = Adding { slope: self.slope, gain, less, vertical, horizontal, right, left };
        match (&self.powers, slopes) {
            (None, None) => kernel::add_up_alone(&mut adding, frames),
            (None, Some(slopes)) => kernel::add_up(&mut adding, frames, slopes),
            (Some((powers, gain)), Some(slopes)) => {
                kernel::add_up(&mut adding, frames, slopes);
                add_powers(powers, *gain, speeds, frames, slopes);
            }
            (Some((powers, gain)), None) => {
                let mut slopes = [0; TICK_FRAMES];
                kernel::add_up(&mut adding, frames, &mut slopes);
                add_powers(powers, *gain, speeds, frames, &slopes);
            }
        }
        self.slope = adding.slope;
    }
}

/// Adds the horizontal force of slopes with another exponent than 1, at speeds in m/s.
#[inline(never)]
fn add_powers(
    powers: &Powers,
    gain: Gain,
    speeds: [f32; 2],
    frames: &mut [i32; TICK_FRAMES],
    slopes: &[i32; TICK_FRAMES],
) {
    // As shares of the highest speed, Q30.
    let mut speed = Ramp::new(speeds.map(|speed| fixed_from(speed / MAX_SPEED_M_PER_S, 30)));
    for (frame, slope) in frames.iter_mut().zip(slopes) {
        // Speed Q30 and slope Q28, of 4 units at most: as Q63 of 8 units.
        let product = i64::from(*slope) * i64::from(speed.next());
        *frame = fixed::qadd(*frame, gain.apply_to(powers.of(product.unsigned_abs() << 2)));
    }
}

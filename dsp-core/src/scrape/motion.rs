//! Motion of a contact, tick by tick.

use core::fmt;

/// Highest speed of a contact, in m/s.
pub const MAX_SPEED_M_PER_S: f32 = 10.0;

/// Motion of a contact at the end of a tick. Within the tick speed and limit change linearly.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Motion {
    /// Velocity along the surface's rows and across them, in m/s.
    pub velocity_m_per_s: [f32; 2],
    /// Normal force N in newtons; 0 or below lifts the scraper off.
    pub normal_n: f32,
}

/// Refusal of a motion.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum MotionError {
    /// A speed is above [`MAX_SPEED_M_PER_S`] or not a number.
    Speed {
        /// Speed in m/s.
        found: f32,
    },
    /// The normal force is not a number.
    NormalForce,
}

impl fmt::Display for MotionError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Speed { found } => {
                write!(f, "a contact moves at {found} m/s: must be at most {MAX_SPEED_M_PER_S} m/s")
            }
            Self::NormalForce => write!(f, "the normal force of a contact is not a number: give newtons"),
        }
    }
}

impl core::error::Error for MotionError {}

impl Motion {
    /// Checks the numbers.
    ///
    /// # Errors
    /// [`MotionError`].
    pub fn check(&self) -> Result<(), MotionError> {
        let [x, y] = self.velocity_m_per_s;
        let square = x * x + y * y;
        // The margin takes up the rounding of a speed of exactly the limit.
        if square.is_nan() || square > MAX_SPEED_M_PER_S * MAX_SPEED_M_PER_S * 1.0001 {
            return Err(MotionError::Speed { found: crate::square_root::rounded_root(square) });
        }
        if self.normal_n.is_nan() { Err(MotionError::NormalForce) } else { Ok(()) }
    }
}

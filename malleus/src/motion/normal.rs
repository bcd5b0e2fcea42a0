//! Normal force: how hard a tool is pressed onto a surface, from its motion.
//!
//! Scraping (scraping-rolling §2.3): a hand holds a tool of mass m at an angle θ to the surface and
//! pushes along the tool with a force F. The tool leans along x, with the hand at negative x. With
//! the acceleration a along +x and the friction μN against +x:
//!
//! ```text
//! along x:   F cos θ - μ N = m a
//! upward:    N = m g + F sin θ        =>   N = m (g + a tan θ) / (1 - μ tan θ)
//! ```
//!
//! At the ends of a back-and-forth of angular frequency ω and amplitude L (half the stroke), a is
//! ω² L at the end near the hand and -ω² L at the far one: eq. 8 and 9. As there, the friction
//! keeps its sign while the tool moves back. Where the equation gives less than 0, the hand lifts
//! the tool off: N = 0, no sound.

use super::path::{Action, Motion, State};

/// Standard gravity in metres per second squared.
pub const GRAVITY_M_PER_S2: f64 = 9.806_65;

/// Grip of a hand that holds a tool, or the mass of a ball.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grip {
    /// Mass m of the tool, or of a ball, in kilograms, above 0.
    pub mass_kg: f64,
    /// Angle θ between tool and surface in radians, from 0 to below π/2.
    pub tilt_rad: f64,
    /// Coefficient of friction μ between tool and surface, 0 or more.
    pub friction: f64,
}

/// Reason for which a grip is refused.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum GripError {
    /// The mass is 0, negative or not finite.
    #[error("mass_kg = {0}: must be a number of kilograms above 0")]
    Mass(f64),
    /// The angle is negative, a right angle or more, or not a number.
    #[error("tilt_rad = {0}: must be at least 0 and below 1.5708 radians, a right angle")]
    Tilt(f64),
    /// The coefficient of friction is negative or not finite.
    #[error("friction = {0}: must be a number of 0 or more")]
    Friction(f64),
    /// The product of friction and tan(tilt) is 1 or more.
    #[error(
        "friction {friction} at tilt_rad {tilt_rad}: friction · tan(tilt) = {product:.4}, so that pushing jams the tool; it must be below 1: take less friction, or a flatter tool"
    )]
    Jam {
        /// Coefficient of friction.
        friction: f64,
        /// Angle in radians.
        tilt_rad: f64,
        /// Friction times the tangent of the angle.
        product: f64,
    },
}

/// Normal force of a tool that is held by a certain grip.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NormalForce {
    mass_kg: f64,
    tangent: f64,
    /// 1 / (1 - μ tan θ).
    gain: f64,
}

/// Least and largest normal force over a contact or a motion: N_min and N_max of eq. 7.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NormalRange {
    /// Least force in newtons, 0 or more.
    pub least_n: f64,
    /// Largest force in newtons, at least the least.
    pub most_n: f64,
}

impl NormalRange {
    /// Range of both ranges together.
    pub fn with(self, other: Self) -> Self {
        Self { least_n: self.least_n.min(other.least_n), most_n: self.most_n.max(other.most_n) }
    }
}

impl NormalForce {
    /// Normal force for a grip.
    ///
    /// # Errors
    /// [`GripError`] for a parameter out of its range, and for `μ tan θ >= 1`.
    pub fn new(grip: &Grip) -> Result<Self, GripError> {
        let Grip { mass_kg, tilt_rad, friction } = *grip;
        if !(mass_kg > 0.0 && mass_kg.is_finite()) {
            return Err(GripError::Mass(mass_kg));
        }
        if !(0.0..std::f64::consts::FRAC_PI_2).contains(&tilt_rad) {
            return Err(GripError::Tilt(tilt_rad));
        }
        if !(friction >= 0.0 && friction.is_finite()) {
            return Err(GripError::Friction(friction));
        }
        let tangent = tilt_rad.tan();
        let product = friction * tangent;
        // Written so that a product that is not a number is refused.
        if !matches!(product.partial_cmp(&1.0), Some(std::cmp::Ordering::Less)) {
            return Err(GripError::Jam { friction, tilt_rad, product });
        }
        Ok(Self { mass_kg, tangent, gain: 1.0 / (1.0 - product) })
    }

    /// Force in newtons on a scraper whose acceleration along +x is `along_x`, in metres per second
    /// squared: eq. 8 and 9 for any acceleration. Never below 0.
    pub fn scraping_n(&self, along_x: f64) -> f64 {
        (self.mass_kg * (GRAVITY_M_PER_S2 + along_x * self.tangent) * self.gain).max(0.0)
    }

    /// Weight m g in newtons: the mean force on a rolling ball, which is not held. An incline
    /// enters by the path alone, and the modulation by the ball's off-centre mass (§4.1) comes on
    /// top.
    pub fn rolling_n(&self) -> f64 {
        self.mass_kg * GRAVITY_M_PER_S2
    }

    /// Force in newtons at a state of a motion: that of the file where it gives one, else
    /// [`scraping_n`](Self::scraping_n) or [`rolling_n`](Self::rolling_n).
    pub fn at(&self, state: &State) -> f64 {
        state.normal_n.unwrap_or_else(|| match state.action {
            Action::Scrape => self.scraping_n(state.acceleration_m_per_s2[0]),
            Action::Roll => self.rolling_n(),
        })
    }

    /// Range of [`at`](Self::at) over one contact of a motion, exact: between two lines the force
    /// is straight, or straight above 0.
    ///
    /// `None` if the motion has no contact of this number.
    pub fn range(&self, motion: &Motion, contact: usize) -> Option<NormalRange> {
        motion.contacts().get(contact)?;
        let ends = motion.pieces(contact).flat_map(|piece| [0.0, 1.0].map(|u| self.at(&motion.state(piece, u))));
        ends.map(|force_n| NormalRange { least_n: force_n, most_n: force_n }).reduce(NormalRange::with)
    }

    /// Range of [`at`](Self::at) over all contacts of a motion with one grip.
    pub fn range_of_motion(&self, motion: &Motion) -> NormalRange {
        let ranges = (0..motion.contacts().len()).filter_map(|contact| self.range(motion, contact));
        ranges.reduce(NormalRange::with).unwrap_or(NormalRange { least_n: 0.0, most_n: 0.0 })
    }
}

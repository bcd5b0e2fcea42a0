//! Acceleration sound of a struck object.

/// Acceleration sound of an object (eq. 1, §3.2).
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Acceleration {
    /// Fixed α, in full scale per newton.
    Factor(f64),
    /// α that cancels the static response of the modes, so that a constant force makes no sound.
    ///
    /// It is minus the sum of the impulse response, mode by mode and at the position of the force
    /// ([`crate::resonator::Bank::balanced`]). It takes the way of the modes: through a dynamic
    /// filter if they feed one. Strikers' own modes are balanced as well.
    Balance,
}

impl Acceleration {
    /// No acceleration sound.
    pub const NONE: Self = Self::Factor(0.0);
}

/// Adds the acceleration sound `α F` to `sound` (full scale; eq. 1, §3.2).
///
/// The striker's sudden stop sends out a click of pressure. Its mass is fixed, so its deceleration
/// follows the contact `force` (newtons), and so does the click. `acceleration` is α, in full scale
/// per newton. The shorter of the two slices sets the length.
pub fn add_acceleration_sound(acceleration: f64, force: &[f64], sound: &mut [f64]) {
    for (force, y) in force.iter().zip(sound) {
        *y += acceleration * force;
    }
}

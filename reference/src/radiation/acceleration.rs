//! The acceleration sound.

/// Adds the acceleration sound `α F` to `sound` (full scale; eq. 1, §3.2).
///
/// The striker's sudden stop sends out a click of pressure. Its mass is fixed, so its deceleration,
/// and with it the click, follows the contact `force` (newtons). `acceleration` is α, in full scale
/// per newton. The shorter of the two slices says for how long.
pub fn add_acceleration_sound(acceleration: f64, force: &[f64], sound: &mut [f64]) {
    for (force, y) in force.iter().zip(sound) {
        *y += acceleration * force;
    }
}

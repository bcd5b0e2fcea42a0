//! Levels.

use kit::{Acceleration, Kit, Striker};

use crate::Failure;

/// Multiplies everything that an object radiates.
pub(crate) fn scale(table: &mut Kit, factor: f64) {
    for object in &mut table.objects {
        if let Acceleration::Factor(alpha) = &mut object.acceleration {
            *alpha = (f64::from(*alpha) * factor) as f32;
        }
        for gain in object.modes.iter_mut().flat_map(|mode| &mut mode.gains) {
            gain.sine = (f64::from(gain.sine) * factor) as f32;
            gain.cosine = (f64::from(gain.cosine) * factor) as f32;
        }
    }
}

/// Peak of a strike at a velocity, full scale 1, by the instrument at 48 kHz.
///
/// # Errors
/// As [`fit::render::by_instrument`].
pub(crate) fn peak(table: &Kit, velocity: f32) -> Result<f64, Failure> {
    let mut struck = table.clone();
    for striker in &mut struck.strikers {
        *striker = at_velocity(striker, velocity);
    }
    let sound = fit::render::by_instrument(&struck, 0.0, 48_000.0, 48_000)?;
    Ok(sound.iter().fold(0.0, |peak, x| peak.max(x.abs())))
}

/// The striker whose strike at velocity 1 is this one's at `velocity`.
fn at_velocity(striker: &Striker, velocity: f32) -> Striker {
    Striker {
        peak_force: striker.peak_force * velocity.powf(striker.peak_exponent),
        contact_time_s: striker.contact_time_s * velocity.powf(striker.contact_exponent),
        ..striker.clone()
    }
}

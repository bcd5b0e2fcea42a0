//! Levels of a fitted table: the thump of its acceleration sound, and its peaks.

use kit::{Acceleration, Kit, Striker};

use crate::failure::Failure;

/// Largest share of a strike's energy that may lie below 0.7 times the frequency of the lowest
/// mode.
const MOST_BELOW: f64 = 0.029;

/// Velocity of the strike whose share is measured: soft contacts last long, and thump most.
const SOFT: f32 = 0.2;

/// Moves a table's fitted α toward the one that is derived from its modes, as far as a soft strike
/// needs so that it does not thump.
///
/// The fitted α cancels the static response of the gains as they were fitted, but may leave softer
/// strikes a thump that no recording has. Returns the part of the way that α has moved, in percent.
///
/// # Errors
/// The errors of [`fit::render::by_instrument`], and a table that thumps even with the derived α.
pub(crate) fn balance(table: &mut Kit) -> Result<u8, Failure> {
    let modes = table.objects.iter().flat_map(|object| &object.modes);
    let lowest_hz = modes.map(|mode| f64::from(mode.frequency_hz)).fold(f64::INFINITY, f64::min);
    let fitted =
        table.objects.first().and_then(|object| object.acceleration.factor()).ok_or("no fitted acceleration")?;
    let derived = derived(table)?;
    for percent in 0..=100u8 {
        let alpha = fitted + f32::from(percent) / 100.0 * (derived - fitted);
        table.objects.iter_mut().for_each(|object| object.acceleration = Acceleration::Factor(alpha));
        // Noise is no thump: it is left out, whatever bands it has below the lowest mode.
        let mut modes = table.clone();
        modes.objects.iter_mut().for_each(|object| object.residual = None);
        if share_below(&strike(&modes, SOFT, 96_000)?, 0.7 * lowest_hz)? <= MOST_BELOW {
            return Ok(percent);
        }
    }
    Err("a balanced table thumps".into())
}

/// Acceleration factor α that balances the table's first object at 48 kHz.
fn derived(table: &Kit) -> Result<f32, Failure> {
    let mut balanced = table.clone();
    balanced.objects.iter_mut().for_each(|object| object.acceleration = Acceleration::Balance);
    let bytes = kit::binary::build(&balanced)?;
    let view = dsp_core::table::Kit::parse(&bytes).map_err(|error| error.to_string())?;
    Ok(view.objects().next().ok_or("no object")?.acceleration())
}

/// Share of a sound's energy that lies below a frequency, 0 to 1.
fn share_below(sound: &[f64], hz: f64) -> Result<f64, Failure> {
    let transform = fourier::forward(sound.len());
    let (mut samples, mut bins) = (sound.to_vec(), transform.make_output_vec());
    transform.process(&mut samples, &mut bins)?;
    let bin = (hz / RATE_HZ * sound.len() as f64) as usize;
    let energy = |bins: &[fourier::Complex<f64>]| bins.iter().map(|value| value.norm_sqr()).sum::<f64>();
    Ok(energy(bins.get(..bin).unwrap_or(&bins)) / energy(&bins))
}

/// Sample rate at which strikes are rendered, in Hz.
const RATE_HZ: f64 = 48_000.0;

/// Multiplies the sound of the table's strikes by a factor: modes, acceleration sound and noise.
///
/// The force at velocity 1 changes and the gains stay, so that the largest remains 50. The
/// reference force changes with it, and the residual's weights with the reference force.
pub(crate) fn scale(table: &mut Kit, factor: f64) {
    for object in &mut table.objects {
        *object = object.with_reference_force((f64::from(object.reference_force) * factor) as f32);
    }
    for striker in &mut table.strikers {
        striker.peak_force = (f64::from(striker.peak_force) * factor) as f32;
    }
}

/// Peak of a strike by the instrument at 48 kHz, 1.0 = full scale.
///
/// # Errors
/// The errors of [`fit::render::by_instrument`].
pub(crate) fn peak(table: &Kit, velocity: f32) -> Result<f64, Failure> {
    Ok(strike(table, velocity, 48_000)?.iter().fold(0.0, |peak, x| peak.max(x.abs())))
}

/// The first `frames` frames of a strike at a velocity.
fn strike(table: &Kit, velocity: f32, frames: usize) -> Result<Vec<f64>, Failure> {
    let mut struck = table.clone();
    for striker in &mut struck.strikers {
        *striker = at_velocity(striker, velocity);
    }
    Ok(fit::render::by_instrument(&struck, 0.0, RATE_HZ, frames)?)
}

/// Striker whose strike at velocity 1 equals the given striker's strike at `velocity`.
fn at_velocity(striker: &Striker, velocity: f32) -> Striker {
    Striker {
        peak_force: striker.peak_force * velocity.powf(striker.peak_exponent),
        contact_time_s: striker.contact_time_s * velocity.powf(striker.contact_exponent),
        ..striker.clone()
    }
}

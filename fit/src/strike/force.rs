//! Fit of strikes with a measured force: the object's own response, with the force divided out.

use super::fit::{Fit, Settings, Strike};
use super::measured::{force_width_s, measured_hits};
use super::shared::share_poles;
use crate::contact::PULSE_FWHM;
use crate::distance::RecordedLevels;
use crate::error::FitError;
use crate::segment::Hit;

/// Fits the strikes of a recording with its force.
///
/// The object gets gains at as many positions as there are strikes, in an order in which neighbours
/// are alike. Each strike's contact time is that of the pulse with the measured force's width at
/// half maximum. A strike's figures compare the sound with the model under the measured force, both
/// high-passed at 300 Hz.
///
/// # Errors
/// [`FitError::NoForce`] if the force channel has no pulses, [`FitError::NoModes`] if no mode is
/// found.
pub fn fit_force(
    sound: &[f64],
    force: &[f64],
    channel: usize,
    rate_hz: f64,
    hits: &[Hit],
    settings: Settings,
) -> Result<Fit, FitError> {
    let measured = measured_hits(sound, force, channel, rate_hz, hits)?;
    let shared = share_poles(&measured, rate_hz, settings)?;
    let every: Vec<usize> = (0..measured.len()).collect();
    let row = shared.in_a_row(&every);
    let (modes, acceleration) = shared.as_modes(&row, rate_hz);
    let strikes = measured.iter().zip(&shared.places).zip(&shared.residual_db).map(|((hit, place), &residual_db)| {
        let model = shared.sound(place, hit);
        let onset = (hit.at_s * rate_hz).round() as usize;
        Strike {
            hit: Hit { onset, end: onset + hit.sound.len() },
            contact_time_s: force_width_s(force, onset, rate_hz) / PULSE_FWHM,
            peak_force: force.get(onset).copied().unwrap_or(1.0),
            position: shared.prediction_along_db(&row, hit).1,
            acceleration,
            lsd_db: RecordedLevels::new(&[], &hit.sound, rate_hz).lsd_db(&model),
            residual_db,
        }
    });
    let strikes: Vec<Strike> = strikes.collect();
    let loudest = (0..measured.len()).max_by(|&a, &b| measured[a].energy().total_cmp(&measured[b].energy()));
    Ok(Fit {
        rate_hz,
        modes,
        strikes,
        measured: true,
        noise: Vec::new(),
        is_exact: false,
        loudest: loudest.unwrap_or(0),
    })
}

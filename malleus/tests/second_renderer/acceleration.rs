//! Section "Acceleration sound" of docs/kit-format.md.

use crate::modes::Bank;

/// Factor α that cancels the static response of a bank at a position: -H(1).
pub(crate) fn balance(bank: &Bank, position: f64, fs: f64) -> f64 {
    let static_response = bank.modes.iter().map(|mode| {
        let (gs, gc) = mode.gains(position);
        let (r, (sin, cos)) = (mode.own_radius, mode.theta.sin_cos());
        (gs * r * sin + gc * (1.0 - r * cos)) / (1.0 - 2.0 * r * cos + r * r) - gc / 2.0
    });
    -static_response.sum::<f64>() / fs
}

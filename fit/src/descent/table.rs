//! Table and events of a descent, whose forces are Gaussians.

use std::f64::consts::PI;

use kit::{Kit, Pulse, Striker};

use crate::multi_strike::{self, Estimate};
use crate::table::Provenance;

/// The table of a descent: as [`multi_strike::table`], with strikers whose pulses are Gaussians.
pub fn table(estimate: &Estimate, provenance: &Provenance) -> Kit {
    let mut unattenuated = estimate.clone();
    for mode in &mut unattenuated.modes {
        // A Gaussian is played as it is, and not as a mean over each sample, which
        // `multi_strike::table` makes up for.
        let turn = PI * mode.frequency_hz / estimate.rate_hz;
        mode.gain = mode.gain.map(|gain| gain * turn.sin() / turn);
    }
    let mut table = multi_strike::table(&unattenuated, provenance);
    for striker in &mut table.strikers {
        (striker.pulse, striker.restitution) = (Pulse::Gaussian, Striker::DEFAULT_RESTITUTION);
    }
    table
}

/// Events that replay a descent on its table, in the columns of [`multi_strike::events`].
///
/// A Gaussian is played from where it stands 100 dB below its peak (docs/kit-format.md).
pub fn events(estimate: &Estimate, table: &Kit) -> String {
    let mut audible = estimate.clone();
    for strike in &mut audible.strikes {
        let before_middle_s = strike.contact_time_s * (1e5f64.ln() / 6.0).sqrt();
        // `multi_strike::events` puts forces that are means over a sample half a sample early.
        strike.at_s = strike.middle_s - before_middle_s + 0.5 / estimate.rate_hz;
    }
    multi_strike::events(&audible, table)
}

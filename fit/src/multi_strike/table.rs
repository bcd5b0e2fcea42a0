//! Table and events of a joint fit, from which `malleus play` makes the recording anew.

use std::f64::consts::PI;

use kit::Kit;

use super::estimate::Estimate;
use crate::render::playable;
use crate::segment::Hit;
use crate::strike::{Fit, Mode, Strike};
use crate::table::{self, Provenance};

/// Exponent of the peak in `m = m1 v^a` that velocities are read off by (Hertz).
const PEAK_EXPONENT: f64 = 1.2;

/// The table of a joint fit, bound to a pad in the middle at the recording's level.
///
/// The instrument's force is a mean over each sample, which attenuates a mode at f by `sinc(f/fs)`:
/// the gains make up for it at the recording's rate. The striker's law `τ = τ1 v^b` is the line
/// through the logarithms of all contact times over those of the peaks, `m = m1 v^1.2`.
pub fn table(estimate: &Estimate, provenance: &Provenance) -> Kit {
    let strongest = estimate.strikes.iter().map(|strike| strike.peak_force).fold(0.0, f64::max);
    let modes = estimate.modes.iter().map(|mode| {
        let turn = PI * mode.frequency_hz / estimate.rate_hz;
        let gain = turn / turn.sin();
        Mode {
            frequency_hz: mode.frequency_hz,
            decay_per_s: mode.decay_per_s,
            gains: vec![mode.gain.map(|part| part * gain)],
        }
    });
    let (contact_time_s, exponent) = law(estimate);
    let strike = Strike {
        hit: Hit { onset: 0, end: 0 },
        contact_time_s,
        peak_force: strongest,
        position: 0.0,
        acceleration: estimate.acceleration,
        lsd_db: 0.0,
        residual_db: 0.0,
    };
    let fit = Fit { modes: modes.collect(), strikes: vec![strike], ..Fit::silent(estimate.rate_hz) };
    let mut table = table::of_fit(&fit, provenance);
    for striker in &mut table.strikers {
        // A half-sine.
        striker.restitution = 1.0;
        striker.peak_exponent = PEAK_EXPONENT as f32;
        striker.contact_exponent = exponent.clamp(-1.0, 1.0) as f32;
        striker.contact_time_s = striker.contact_time_s.clamp(LEAST_CONTACT_S, MOST_CONTACT_S);
    }
    playable(&table)
}

/// Shortest and longest contact time in seconds that the format holds.
const LEAST_CONTACT_S: f32 = 2e-5;
const MOST_CONTACT_S: f32 = 0.1;

/// Contact time at velocity 1, and exponent b of the contact time.
fn law(estimate: &Estimate) -> (f64, f64) {
    let points: Vec<[f64; 2]> =
        estimate.strikes.iter().map(|strike| [strike.peak_force.ln(), strike.contact_time_s.ln()]).collect();
    let count = points.len().max(1) as f64;
    let mean = |axis: usize| points.iter().map(|point| point[axis]).sum::<f64>() / count;
    let (peak, time) = (mean(0), mean(1));
    let spread: f64 = points.iter().map(|point| (point[0] - peak).powi(2)).sum();
    let common: f64 = points.iter().map(|point| (point[0] - peak) * (point[1] - time)).sum();
    // Strikes of one loudness tell no exponent.
    let slope = if spread > 0.01 * count { common / spread } else { 0.0 };
    ((time - slope * peak).exp(), slope * PEAK_EXPONENT)
}

/// Events in CSV that replay the recording on its table: `time_s`, `pad`, `velocity`, `peak_force`
/// and `contact_time_s` of each strike.
///
/// The mean over a sample comes half a sample late, so that the events are half a sample early.
pub fn events(estimate: &Estimate, table: &Kit) -> String {
    let pad = table.pads.first().map_or("", |pad| pad.name.as_str());
    let unit = table.strikers.first().map_or(1.0, |striker| f64::from(striker.peak_force));
    let strongest = estimate.strikes.iter().map(|strike| strike.peak_force).fold(f64::MIN_POSITIVE, f64::max);
    let mut text = String::from("time_s,pad,velocity,peak_force,contact_time_s\n");
    for strike in &estimate.strikes {
        let time_s = (strike.at_s - 0.5 / estimate.rate_hz).max(0.0);
        let velocity = (strike.peak_force / strongest).powf(1.0 / PEAK_EXPONENT).min(1.0) as f32;
        let peak = strike.peak_force / strongest * unit;
        text += &format!("{time_s},{pad},{velocity},{peak},{}\n", strike.contact_time_s);
    }
    text
}

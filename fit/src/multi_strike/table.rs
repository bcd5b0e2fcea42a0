//! Table and events of a joint fit, from which `malleus play` makes the recording anew.

use std::f64::consts::PI;

use kit::{Gain, Kit, Striker, item_name};

use super::estimate::{Estimate, ModeEstimate};
use crate::render::playable;
use crate::segment::Hit;
use crate::strike::{Fit, Mode, Strike};
use crate::table::{self, Provenance};

/// Exponent of the peak in `m = m1 v^a` that velocities are read off by (Hertz).
const PEAK_EXPONENT: f64 = 1.2;

/// The table of a joint fit, bound to a pad in the middle at the recording's level.
///
/// The instrument's force is a mean over each sample, which attenuates a mode at f by `sinc(f/fs)`:
/// the gains make up for it at the recording's rate. The object has the gains of all positions.
/// Each striker has its own modes, and the law `τ = τ1 v^b`: the line through the logarithms of its
/// contact times over those of its peaks, `m = m1 v^1.2`, m1 the peak of its strongest strike.
/// A room that was heard is the table's.
pub fn table(estimate: &Estimate, provenance: &Provenance) -> Kit {
    let mode_of = |mode: &ModeEstimate, gains: &[[f64; 2]]| {
        let turn = PI * mode.frequency_hz / estimate.rate_hz;
        let gain = turn / turn.sin();
        Mode {
            frequency_hz: mode.frequency_hz,
            decay_per_s: mode.decay_per_s,
            gains: gains.iter().map(|both| both.map(|part| part * gain)).collect(),
        }
    };
    let of_object = estimate.modes.iter().filter(|mode| mode.striker.is_none());
    let strike = Strike {
        hit: Hit { onset: 0, end: 0 },
        contact_time_s: 1e-3,
        peak_force: strongest(estimate, None),
        position: 0.0,
        acceleration: estimate.acceleration,
        lsd_db: 0.0,
        residual_db: 0.0,
    };
    let modes = of_object.clone().map(|mode| mode_of(mode, &[mode.gain])).collect();
    let fit = Fit { modes, strikes: vec![strike], ..Fit::silent(estimate.rate_hz) };
    let mut table = table::of_fit(&fit, provenance);
    // Newtons that a peak of 1 stands for.
    let unit = table.strikers.first().map_or(1.0, |striker| f64::from(striker.peak_force) / strongest(estimate, None));
    let in_newtons = |mode: &Mode| {
        let gain = |part: f64| (part / unit) as f32;
        mode.gains.iter().map(|both| Gain { sine: gain(both[0]), cosine: gain(both[1]) }).collect::<Vec<Gain>>()
    };
    for (mode, estimated) in table.objects[0].modes.iter_mut().zip(of_object) {
        if !estimated.gains.is_empty() {
            mode.gains = in_newtons(&mode_of(estimated, &estimated.gains));
        }
    }
    let first = table.strikers.swap_remove(0);
    let count = 1 + estimate.strikes.iter().map(|strike| strike.striker).max().unwrap_or(0);
    for striker in 0..count {
        let (contact_time_s, exponent) = law(estimate, striker);
        let own = estimate.modes.iter().filter(|mode| mode.striker == Some(striker));
        let ending = if count > 1 { format!(" strike {}", striker + 1) } else { " strike".to_owned() };
        table.strikers.push(Striker {
            name: item_name(&provenance.name, &ending),
            peak_force: (strongest(estimate, Some(striker)) * unit) as f32,
            // A half-sine.
            restitution: 1.0,
            scrape: None,
            roll: None,
            peak_exponent: PEAK_EXPONENT as f32,
            contact_exponent: exponent.clamp(-1.0, 1.0) as f32,
            contact_time_s: (contact_time_s as f32).clamp(LEAST_CONTACT_S, MOST_CONTACT_S),
            modes: own
                .map(|mode| kit::Mode {
                    frequency_hz: mode.frequency_hz as f32,
                    decay_per_s: mode.decay_per_s as f32,
                    gains: in_newtons(&mode_of(mode, &[mode.gain])),
                })
                .collect(),
            ..first.clone()
        });
    }
    let table = playable(&table);
    match &estimate.room {
        Some(room) => table::with_room(table, room, 0.0),
        None => table,
    }
}

/// Largest peak of a striker's strikes, or of all.
fn strongest(estimate: &Estimate, striker: Option<usize>) -> f64 {
    let own = estimate.strikes.iter().filter(|strike| striker.is_none_or(|striker| strike.striker == striker));
    own.map(|strike| strike.peak_force).fold(f64::MIN_POSITIVE, f64::max)
}

/// Shortest and longest contact time in seconds that the format holds.
const LEAST_CONTACT_S: f32 = 2e-5;
const MOST_CONTACT_S: f32 = 0.1;

/// Contact time of a striker at velocity 1, and exponent b of the contact time.
fn law(estimate: &Estimate, striker: usize) -> (f64, f64) {
    let most = strongest(estimate, Some(striker));
    let own = estimate.strikes.iter().filter(|strike| strike.striker == striker);
    let points: Vec<[f64; 2]> =
        own.map(|strike| [(strike.peak_force / most).ln(), strike.contact_time_s.ln()]).collect();
    let count = points.len().max(1) as f64;
    let mean = |axis: usize| points.iter().map(|point| point[axis]).sum::<f64>() / count;
    let (peak, time) = (mean(0), mean(1));
    let spread: f64 = points.iter().map(|point| (point[0] - peak).powi(2)).sum();
    let common: f64 = points.iter().map(|point| (point[0] - peak) * (point[1] - time)).sum();
    // Strikes of one loudness tell no exponent.
    let slope = if spread > 0.01 * count { common / spread } else { 0.0 };
    ((time - slope * peak).exp(), slope * PEAK_EXPONENT)
}

/// Events in CSV that replay the recording on its table: `time_s`, `pad`, `velocity`, `position`,
/// `striker`, `peak_force` and `contact_time_s` of each strike.
///
/// The mean over a sample comes half a sample late, so that the events are half a sample early.
pub fn events(estimate: &Estimate, table: &Kit) -> String {
    let pad = table.pads.first().map_or("", |pad| pad.name.as_str());
    let mut text = String::from("time_s,pad,velocity,position,striker,peak_force,contact_time_s\n");
    for strike in &estimate.strikes {
        let time_s = (strike.at_s - 0.5 / estimate.rate_hz).max(0.0);
        let share = strike.peak_force / strongest(estimate, Some(strike.striker));
        let velocity = share.powf(1.0 / PEAK_EXPONENT).min(1.0) as f32;
        let Some(striker) = table.strikers.get(strike.striker) else { continue };
        let (position, peak) = (strike.position as f32, share * f64::from(striker.peak_force));
        let name = &striker.name;
        text += &format!("{time_s},{pad},{velocity},{position},{name},{peak},{}\n", strike.contact_time_s);
    }
    text
}

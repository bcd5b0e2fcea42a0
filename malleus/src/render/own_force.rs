//! Force of strikes whose peak and contact time stand in the events, instead of a striker's law.

use dsp_core::SampleRate;
use dsp_core::fixed::ONE_Q27;
use reference::contact::Impact;

use super::force::bound;
use crate::events::OwnForce;

/// Renders the force of strikes as a direct force on their pad, in Q4.27 of the force bus.
///
/// The contacts have the striker's pulse; a peak or contact time that the events leave out follows
/// from the striker's law. Returns `None` without such strikes, or without their pad in the kit.
/// All strikes are on one pad ([`crate::events::csv::parse`] refuses others).
pub fn direct(strikes: &[OwnForce], kit: &kit::Kit, rate: SampleRate) -> Option<(u8, Vec<i32>)> {
    let pad_index = strikes.first()?.pad;
    let pad = kit.pads.get(usize::from(pad_index))?;
    let (numerator, denominator) = rate.ratio();
    let exact = reference::SampleRate { numerator, denominator };
    let mut force: Vec<f64> = Vec::new();
    let mut unit = 1.0;
    for strike in strikes {
        let Some((striker, object)) = bound(kit, pad, usize::from(strike.striker)) else { continue };
        unit = f64::from(object.reference_force);
        let velocity = f64::from(strike.velocity);
        let law = |at_1: f32, exponent: f32| f64::from(at_1) * velocity.powf(f64::from(exponent));
        let impact = Impact {
            onset_samples: strike.time.frame as f64 + f64::from(strike.time.fraction) / 4_294_967_296.0,
            pulse: match striker.pulse {
                kit::Pulse::Hertz => reference::Pulse::Hertz { restitution: f64::from(striker.restitution) },
                kit::Pulse::Gaussian => reference::Pulse::Gaussian,
            },
            peak_force: strike.peak_force.unwrap_or_else(|| law(striker.peak_force, striker.peak_exponent)),
            contact_time_s: strike
                .contact_time_s
                .unwrap_or_else(|| law(striker.contact_time_s, striker.contact_exponent)),
        };
        let first = strike.time.frame as usize;
        let lasts_s = impact.pulse.sampled_duration_s(impact.contact_time_s, exact);
        let end = first + (lasts_s * rate.hz()).ceil() as usize + 2;
        if force.len() < end {
            force.resize(end, 0.0);
        }
        impact.add_force(first as u64, exact, &mut force[first..end]);
    }
    // `as` saturates, as the force bus does.
    let samples = force.into_iter().map(|newtons| (newtons / unit * f64::from(ONE_Q27)).round() as i32);
    Some((pad_index, samples.collect()))
}

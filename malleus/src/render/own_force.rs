//! Force of strikes whose peak and contact time stand in the events, instead of a striker's law.

use dsp_core::SampleRate;
use dsp_core::fixed::ONE_Q27;
use reference::contact::Impact;

use super::force::bound;
use super::part::{self, Part};
use crate::events::OwnForce;

/// Renders the force of strikes as a direct force on their pad, in Q4.27 of the force bus.
///
/// The contacts have the striker's pulse; a peak or contact time that the events leave out follows
/// from the striker's law. Returns `None` without such strikes, or without their pad in the kit.
/// All strikes are on one pad ([`crate::events::csv::parse`] refuses others).
pub fn direct(strikes: &[OwnForce], kit: &kit::Kit, rate: SampleRate) -> Option<(u8, Vec<i32>)> {
    let pad = strikes.first()?.pad;
    kit.pads.get(usize::from(pad))?;
    Some((pad, force(strikes, kit, rate, |_| 1.0)))
}

/// Splits strikes at several positions or with several strikers into parts ([`super::part`]), whose
/// sounds add up. Empty if one direct force is enough: all strikes are with the first striker, at
/// position 0.
pub fn parts(strikes: &[OwnForce], kit: &kit::Kit, rate: SampleRate) -> Vec<Part> {
    let is_plain = |strike: &OwnForce| strike.position == 0.0 && strike.striker == 0;
    let Some(pad_index) = strikes.first().map(|strike| strike.pad).filter(|_| !strikes.iter().all(is_plain)) else {
        return Vec::new();
    };
    let Some(pad) = kit.pads.get(usize::from(pad_index)) else { return Vec::new() };
    let positions = part::positions(kit, pad);
    let mut parts = Vec::new();
    for position in 0..positions {
        let shares = |strike: &OwnForce| part::share(strike.position.into(), position, positions);
        let direct = (pad_index, force(strikes, kit, rate, shares));
        parts.push(Part { kit: part::at_position(kit, pad, position), direct });
    }
    for striker in 0..pad.strikers.len() {
        let own = |strike: &OwnForce| f64::from(u8::from(usize::from(strike.striker) == striker));
        if !strikes.iter().any(|strike| own(strike) > 0.0) {
            continue;
        }
        let kit_of_striker = part::of_striker(kit, pad, striker);
        parts
            .extend(kit_of_striker.map(|part| Part { kit: part, direct: (pad_index, force(strikes, kit, rate, own)) }));
    }
    // What sounds without a strike sounds once.
    parts.iter_mut().skip(1).for_each(|part| part.kit.background = None);
    parts
}

/// Force of strikes in Q4.27 of their pad's force bus, each with a weight.
fn force(strikes: &[OwnForce], kit: &kit::Kit, rate: SampleRate, weight: impl Fn(&OwnForce) -> f64) -> Vec<i32> {
    let (numerator, denominator) = rate.ratio();
    let exact = reference::SampleRate { numerator, denominator };
    let mut force: Vec<f64> = Vec::new();
    let mut unit = 1.0;
    for strike in strikes {
        let Some(pad) = kit.pads.get(usize::from(strike.pad)) else { continue };
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
            peak_force: strike.peak_force.unwrap_or_else(|| law(striker.peak_force, striker.peak_exponent))
                * weight(strike),
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
    force.into_iter().map(|newtons| (newtons / unit * f64::from(ONE_Q27)).round() as i32).collect()
}

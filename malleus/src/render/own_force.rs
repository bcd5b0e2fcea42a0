//! Force of strikes whose peak and contact time stand in the events, instead of a striker's law.

use dsp_core::SampleRate;
use dsp_core::fixed::ONE_Q27;
use reference::contact::Impact;

use super::force::bound;
use crate::events::OwnForce;

/// A kit with a pad that a force drives; the sounds of all parts of a performance add up.
#[derive(Clone, Debug)]
pub struct Part {
    /// Kit whose pad has one position, and no modes of strikers beside the object's.
    pub kit: kit::Kit,
    /// Number of the pad, and its force in Q4.27 of the force bus.
    pub direct: (u8, Vec<i32>),
}

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

/// Splits strikes at several positions or with several strikers into parts, whose sounds add up.
///
/// A pad plays a direct force at one position and with its first striker. All stages of a force are
/// linear, so that a part for each position of the object, with the share of each force that falls
/// to it, and one for each striker with modes of its own make the whole. Empty if one direct force
/// is enough: all strikes are with the first striker, at position 0.
pub fn parts(strikes: &[OwnForce], kit: &kit::Kit, rate: SampleRate) -> Vec<Part> {
    let is_plain = |strike: &OwnForce| strike.position == 0.0 && strike.striker == 0;
    let Some(pad_index) = strikes.first().map(|strike| strike.pad).filter(|_| !strikes.iter().all(is_plain)) else {
        return Vec::new();
    };
    let Some(pad) = kit.pads.get(usize::from(pad_index)) else { return Vec::new() };
    let Some(object) = kit.objects.iter().position(|object| object.name == pad.object) else { return Vec::new() };
    let positions = kit.objects[object].modes.iter().map(|mode| mode.gains.len()).max().unwrap_or(1);
    let mut parts = Vec::new();
    for position in 0..positions {
        let direct = (pad_index, force(strikes, kit, rate, |strike| share(strike.position, position, positions)));
        let mut part = without_own_modes(kit);
        for mode in &mut part.objects[object].modes {
            mode.gains = mode.gains.get(position).or(mode.gains.first()).copied().into_iter().collect();
        }
        parts.push(Part { kit: part, direct });
    }
    for (index, name) in (0u8..).zip(&pad.strikers) {
        let own = kit.strikers.iter().find(|striker| striker.name == *name && !striker.modes.is_empty());
        let Some(own) = own.filter(|_| strikes.iter().any(|strike| strike.striker == index)) else { continue };
        let mut part = without_own_modes(kit);
        part.objects[object].acceleration = kit::Acceleration::Factor(0.0);
        part.objects[object].modes = own.modes.clone();
        for gain in part.objects[object].modes.iter_mut().flat_map(|mode| &mut mode.gains) {
            (gain.sine, gain.cosine) = (gain.sine * pad.striker_weight, gain.cosine * pad.striker_weight);
        }
        let own = |strike: &OwnForce| f64::from(u8::from(strike.striker == index));
        parts.push(Part { direct: (pad_index, force(strikes, kit, rate, own)), kit: part });
    }
    // What sounds without a strike sounds once.
    parts.iter_mut().skip(1).for_each(|part| part.kit.background = None);
    parts
}

/// Share of a force at a position that falls to one of the object's evenly spaced positions.
fn share(at: f32, position: usize, positions: usize) -> f64 {
    let along = f64::from(at) * positions.saturating_sub(1) as f64;
    (1.0 - (along - position as f64).abs()).max(0.0)
}

fn without_own_modes(kit: &kit::Kit) -> kit::Kit {
    let mut part = kit.clone();
    part.strikers.iter_mut().for_each(|striker| striker.modes.clear());
    part
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

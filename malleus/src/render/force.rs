//! The force bus: how near its end the strikes of a performance come.
//!
//! A pad's force is Q4.27 in units of its object's `reference_force`, and clips at 16 times that
//! force. Clipping is predicted from the events and the strikers' force laws alone, so that the
//! audio path need not look for it.

use dsp_core::SampleRate;
use dsp_core::contact::Pulse;
use dsp_core::contact::law::{MAX_CONTACT_TIME_S, MIN_CONTACT_TIME_S};
use dsp_core::event::{Action, Event};

/// Force at which the force bus clips, in reference forces.
pub const FORCE_BUS_END: f64 = 16.0;

/// Measure of how near strikes come to the end of the force bus.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ForceLoad {
    /// Largest bound of the force on a pad, in reference forces.
    ///
    /// The bound at a strike is the sum of the peaks of all contacts that are then under way.
    pub largest: f64,
    /// Number of strikes at which the bound lies beyond the end of the bus.
    pub overloads: u64,
}

/// Peak force of a striker at velocity 1, in reference forces of an object.
pub fn peak(striker: &kit::Striker, object: &kit::Object) -> f64 {
    f64::from(striker.peak_force) / f64::from(object.reference_force)
}

/// Measures how near the strikes of a performance come to the end of the force bus.
///
/// The result is a bound: each contact counts with its peak for as long as it lasts.
pub fn load(kit: &kit::Kit, events: &[Event], rate: SampleRate) -> ForceLoad {
    let mut load = ForceLoad::default();
    // For each pad, the contacts under way: when each is over, in seconds, and its peak.
    let mut under_way: Vec<Vec<(f64, f64)>> = vec![Vec::new(); kit.pads.len()];
    for event in events.iter().filter(|event| event.action == Action::Strike && event.velocity > 0.0) {
        let Some((pad, contacts)) = kit.pads.iter().zip(&mut under_way).nth(usize::from(event.pad)) else { continue };
        let Some((striker, object)) = bound(kit, pad, usize::from(event.striker)) else { continue };
        let now_s = event.time.first_frame() as f64 / rate.hz();
        let velocity = f64::from(event.velocity);
        let contact_time_s = f64::from(striker.contact_time_s) * velocity.powf(f64::from(striker.contact_exponent));
        let lasts_s = contact_time_s.clamp(MIN_CONTACT_TIME_S, MAX_CONTACT_TIME_S) * length(striker);
        contacts.retain(|&(over_s, _)| over_s > now_s);
        contacts.push((now_s + lasts_s, peak(striker, object) * velocity.powf(f64::from(striker.peak_exponent))));
        let force: f64 = contacts.iter().map(|&(_, peak)| peak).sum();
        load.largest = load.largest.max(force);
        load.overloads += u64::from(force > FORCE_BUS_END);
    }
    load
}

/// A pad's striker of the given index, and the pad's object.
pub fn bound<'k>(kit: &'k kit::Kit, pad: &kit::Pad, striker: usize) -> Option<(&'k kit::Striker, &'k kit::Object)> {
    let name = pad.strikers.get(striker)?;
    let striker = kit.strikers.iter().find(|striker| striker.name == *name)?;
    Some((striker, kit.objects.iter().find(|object| object.name == pad.object)?))
}

/// Length of a striker's pulse, in contact times.
fn length(striker: &kit::Striker) -> f64 {
    match striker.pulse {
        kit::Pulse::Hertz => 1.0,
        kit::Pulse::Gaussian => Pulse::Gaussian.length(),
    }
}

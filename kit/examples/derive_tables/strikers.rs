//! Strikers of the demo kit.

use kit::{Pulse, Striker};

use crate::bar;
use crate::level::{Contact, mode, rounded};

/// All strikers of the demo kit.
///
/// Contact times lie in the range that impact hammers show: 0.25 to 0.9 ms for hard tips,
/// milliseconds for wound mallets.
pub(crate) fn all() -> Vec<Striker> {
    vec![
        striker("yarn-mallet", 1.0, 0.0024, "wound mallet: contact time chosen, 2.4 ms at velocity 1"),
        striker("hard-mallet", 1.0, 0.0007, "plastic mallet: contact time chosen, 0.7 ms at velocity 1"),
        striker("brass-mallet", 1.0, 0.0002, "brass mallet: contact time chosen, 0.2 ms at velocity 1"),
        striker(
            "hammer-tip",
            0.6,
            0.00066,
            "impact hammer on a mug: peak in units of the recording's full scale, contact time from its width at half maximum, 0.33 ms, half of it",
        ),
        Striker {
            pulse: Pulse::Gaussian,
            ..striker("fingertip", 0.6, 0.004, "finger pad: Gaussian pulse, contact time chosen, 4 ms at velocity 1")
        },
        drumstick(),
    ]
}

fn striker(name: &str, peak_force: f64, contact_time_s: f64, source: &str) -> Striker {
    Striker {
        name: name.to_owned(),
        source: format!("{source}; exponents of Hertz's law"),
        licence: "CC0-1.0".to_owned(),
        pulse: Pulse::Hertz,
        peak_force: rounded(peak_force),
        peak_exponent: 1.2,
        contact_time_s: rounded(contact_time_s),
        contact_exponent: -0.2,
        restitution: Striker::DEFAULT_RESTITUTION,
        scrape: None,
        roll: None,
        modes: Vec::new(),
    }
}

/// Drumstick with a sound of its own: the first transverse modes of a free wooden bar.
fn drumstick() -> Striker {
    let contact = Contact { time_s: 0.001, peak: 1.0 };
    let modes = (1..=4).map(|n| {
        let frequency_hz = 610.0 * bar::ratio(n);
        mode(frequency_hz, 0.09 / f64::from(n).sqrt(), 0.03 / f64::from(n), &[1.0], contact)
    });
    Striker {
        modes: modes.collect(),
        ..striker(
            "drumstick",
            contact.peak,
            contact.time_s,
            "wooden stick: contact time chosen, 1 ms at velocity 1; own modes of a free-free bar (Euler-Bernoulli) from 610 Hz, T60 90 ms falling with the mode's number",
        )
    }
}

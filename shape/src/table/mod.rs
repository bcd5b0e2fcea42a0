//! Table of a body: the kit text that people keep and boards play.

use kit::{Acceleration, Kit, Mode, Object, Pulse, Striker, item_name};

use crate::file::{Readout, ShapeFile};
use crate::solve::Solved;

/// Peak force of the table's striker at velocity 1, N, if the file has none.
const PEAK_FORCE_N: f64 = 20.0;
/// Contact time of the table's striker at velocity 1, s, if the file has none: a hard mallet.
const CONTACT_TIME_S: f64 = 5e-4;
/// Decays that the format holds and the engine plays at 48 kHz, 1/s.
const DECAYS_PER_S: [f64; 2] = [0.01, 16_000.0];

/// Decay that a table has for a mode, 1/s: at least 0.01 and at most 16 000.
pub fn kept_decay_per_s(decay_per_s: f64) -> f64 {
    decay_per_s.clamp(DECAYS_PER_S[0], DECAYS_PER_S[1])
}

/// The object and a mallet as a kit without pads. The object has the solved gains, in
/// output/(N s), and the mallet's peak force as reference force. Decays are those of
/// [`kept_decay_per_s`]. A table of pressures is balanced.
pub fn of(solved: &Solved, file: &ShapeFile, source: &str, licence: &str) -> Kit {
    let gain = |gain: &crate::gain::Gain| kit::Gain { sine: gain.sine as f32, cosine: gain.cosine as f32 };
    let modes = solved.modes.iter().map(|mode| Mode {
        frequency_hz: mode.frequency_hz as f32,
        decay_per_s: kept_decay_per_s(mode.decay_per_s) as f32,
        gains: mode.gains.iter().map(gain).collect(),
    });
    let name = item_name(&file.name, "");
    let peak_force = file.strike.peak_force_n.unwrap_or(PEAK_FORCE_N) as f32;
    Kit {
        name: name.clone(),
        objects: vec![Object {
            name: name.clone(),
            source: source.to_owned(),
            licence: licence.to_owned(),
            reference_force: peak_force,
            acceleration: match file.sound.readout {
                // The pressure follows the acceleration, whose share at the force itself takes the
                // static response away. A velocity has none.
                Readout::Pressure => Acceleration::Balance,
                Readout::Velocity | Readout::Even => Acceleration::Factor(0.0),
            },
            modes: modes.collect(),
            residual: None,
            dynamic_filter: None,
            biquads: None,
            surface: None,
        }],
        strikers: vec![Striker {
            name: item_name(&name, " mallet"),
            source: "mallet, chosen".to_owned(),
            licence: licence.to_owned(),
            pulse: Pulse::Hertz,
            peak_force,
            peak_exponent: 1.2,
            contact_time_s: file.strike.contact_time_s.unwrap_or(CONTACT_TIME_S) as f32,
            contact_exponent: -0.2,
            restitution: Striker::DEFAULT_RESTITUTION,
            scrape: None,
            roll: None,
            modes: Vec::new(),
        }],
        pads: Vec::new(),
        background: None,
        room: vec![],
        headphone_db: None,
        surfaces: Vec::new(),
    }
}

//! Tables of fits: the kit text that people keep and boards play.

use dsp_core::table::range::REFERENCE_FORCE;
use kit::{Acceleration, Gain, Kit, Mode, Object, Pulse, Striker, item_name};

use crate::room::Room;
use crate::strike::Fit;

/// Cortex-M4 cycles a mode and sample while a contact drives it with gain and phase (README, "How
/// fast").
///
/// It converts a budget of cycles into a number of modes.
pub const CYCLES_A_MODE: f64 = 9.42;

/// Maximum number of modes for a budget of cycles a sample; 0 if it is less than a mode takes.
pub fn modes_within(cycles_a_sample: f64) -> usize {
    (cycles_a_sample / CYCLES_A_MODE).floor() as usize
}

/// Gain of the strongest mode of a table from sound alone.
const STRONGEST_GAIN: f64 = 50.0;

/// Name and origin of a table.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Provenance {
    /// Name of the object; it is made printable and cut to 24 characters.
    pub name: String,
    /// Origin of the numbers.
    pub source: String,
    /// Licence of the numbers.
    pub licence: String,
}

/// The object and its striker as a kit without pads.
///
/// From sound alone the gains are those of the loudest strike, and the force at velocity 1, which
/// is the reference force, is such that the strongest gain is 50. With a measured force the table
/// has gains at all positions, and a strike at velocity 1 has the peak force of the loudest
/// recorded one.
///
/// The reference force is the force at velocity 1, but at least 1 if the force was measured. The
/// full scale of the force bus is 16 times the reference force, so that no strike at velocity 1
/// clips it. A recorded force with a peak of at most 1, played as a direct force, keeps its own
/// level.
pub fn of_fit(fit: &Fit, provenance: &Provenance) -> Kit {
    let name = item_name(&provenance.name, "");
    let strike = fit.strikes.get(fit.loudest);
    let place = if fit.measured { 0 } else { fit.loudest };
    // From sound alone the force is free: with this one the strongest gain is of the order of 10.
    let strongest = fit.modes.iter().filter_map(|mode| mode.gains.get(place)).map(|gain| gain[0].hypot(gain[1]));
    let strongest = strongest.fold(0.0, f64::max);
    let unit = if fit.measured || strongest <= 0.0 { 1.0 } else { (strongest / STRONGEST_GAIN).clamp(1e-3, 1e5) };
    let peak_force = (strike.map_or(1.0, |strike| strike.peak_force) * unit) as f32;
    let least_reference = if fit.measured { 1.0 } else { REFERENCE_FORCE.min };
    let (source, licence) = (provenance.source.clone(), provenance.licence.clone());
    let modes = fit.modes.iter().map(|mode| Mode {
        frequency_hz: mode.frequency_hz as f32,
        decay_per_s: (mode.decay_per_s as f32).clamp(LEAST_DECAY_PER_S, MOST_DECAY_PER_S),
        gains: mode
            .gains
            .iter()
            .skip(place)
            .take(if fit.measured { MOST_POSITIONS } else { 1 })
            .map(|[sine, cosine]| Gain { sine: (*sine / unit) as f32, cosine: (*cosine / unit) as f32 })
            .collect(),
    });
    Kit {
        name: name.clone(),
        objects: vec![Object {
            name,
            source: source.clone(),
            licence: licence.clone(),
            reference_force: peak_force.clamp(least_reference, REFERENCE_FORCE.max),
            acceleration: Acceleration::Factor(strike.map_or(0.0, |strike| (strike.acceleration / unit) as f32)),
            modes: modes.collect(),
            residual: None,
            dynamic_filter: None,
            biquads: None,
            surface: None,
        }],
        strikers: vec![Striker {
            name: item_name(&provenance.name, " strike"),
            source,
            licence,
            pulse: Pulse::Hertz,
            peak_force,
            peak_exponent: 1.2,
            contact_time_s: strike.map_or(5e-4, |strike| strike.contact_time_s as f32),
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

/// The table with the room of its recording, `level_db` louder than it was measured.
///
/// Each octave is a band; the lowest reaches down to 0 Hz, the highest up to half the rate.
pub fn with_room(mut table: Kit, room: &Room, level_db: f64) -> Kit {
    let bands = room.bands.iter().enumerate();
    let from_hz = |band: usize, edge_hz: f64| if band == 0 { 0.0 } else { edge_hz };
    let bands = bands.map(|(index, band)| {
        kit::RoomBand::new(from_hz(index, band.edges_hz[0]), band.t60_s, (band.gain_db + level_db).min(MOST_ROOM_DB))
    });
    table.room = bands.collect();
    table
}

/// Largest gain of a room's band in dB; at the shortest T60 it stays far below the format's limit.
const MOST_ROOM_DB: f64 = 12.0;
/// Slowest decay of a mode that the format holds, in 1/s.
const LEAST_DECAY_PER_S: f32 = 0.01;
/// Fastest decay of a mode that the format holds, in 1/s.
const MOST_DECAY_PER_S: f32 = 20_000.0;

/// Maximum number of positions that the format holds.
const MOST_POSITIONS: usize = 64;

#[cfg(test)]
mod tests {
    use super::*;

    fn table(peak_force: f32) -> Kit {
        let fit = Fit::silent(44_100.0);
        let provenance = Provenance { name: "mug".to_owned(), source: String::new(), licence: String::new() };
        let mut table = of_fit(&fit, &provenance);
        table.strikers[0].peak_force = peak_force;
        table
    }

    #[test]
    fn a_room_reaches_from_0_hz_and_keeps_t60_and_energy() {
        let band =
            |low_hz: f64, t60_s: f64| crate::room::RoomBand { edges_hz: [low_hz, 2.0 * low_hz], gain_db: -11.0, t60_s };
        let room =
            Room { bands: vec![band(350.0, 0.9), band(700.0, 0.8), band(1_400.0, 0.6)], gain_db: -11.0, t60_s: 0.76 };
        let table = with_room(table(1.0), &room, -3.0);
        let from_hz: Vec<f32> = table.room.iter().map(|band| band.from_hz).collect();
        assert_eq!(from_hz, [0.0, 700.0, 1_400.0]);
        for (band, t60_s) in table.room.iter().zip([0.9, 0.8, 0.6]) {
            assert!((band.t60_s() - t60_s).abs() < 1e-6 && (band.energy_db() + 14.0).abs() < 1e-5, "{band:?}");
        }
        assert!(kit::binary::build(&crate::render::playable(&table)).is_ok());
    }
}

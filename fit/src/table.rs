//! A fit as a table: the text that people keep and boards play.

use dsp_core::table::range::REFERENCE_FORCE;
use kit::{Acceleration, Gain, Kit, Mode, Object, Pulse, Residual, Striker};

use crate::residual::Band;
use crate::room::Room;
use crate::strike::Fit;

/// Cortex-M4 cycles a mode and sample while a contact drives it with gain and phase (README, "How fast"): what a budget is divided by.
pub const CYCLES_A_MODE: f64 = 9.42;

/// Most modes that a budget of cycles a sample allows.
pub fn modes_within(cycles_a_sample: f64) -> usize {
    (cycles_a_sample / CYCLES_A_MODE).floor().max(1.0) as usize
}

/// What a table says of itself.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Provenance {
    /// Name of the object: made printable and cut to 24 characters.
    pub name: String,
    /// Where the numbers come from.
    pub source: String,
    /// Their licence.
    pub licence: String,
}

/// The object and its striker as a kit without pads. From sound alone the gains are those of the
/// loudest strike, whose force has a peak of 1 at velocity 1; with a measured force they stand at
/// all positions, and velocity 1 is the loudest strike. The reference force is the peak force where
/// that is above 1, so that the force bus, which ends at 16 times of it, never clips at velocity 1.
/// Below it is 1: the recorded force, played as a direct one, then has its own level.
pub fn of_fit(fit: &Fit, provenance: &Provenance) -> Kit {
    let name = item_name(&provenance.name, "");
    let strike = fit.strikes.get(fit.loudest);
    let peak_force = strike.map_or(1.0, |strike| strike.peak_force as f32);
    let (source, licence) = (provenance.source.clone(), provenance.licence.clone());
    let modes = fit.modes.iter().map(|mode| Mode {
        frequency_hz: mode.frequency_hz as f32,
        decay_per_s: (mode.decay_per_s as f32).clamp(LEAST_DECAY_PER_S, MOST_DECAY_PER_S),
        gains: mode
            .gains
            .iter()
            .skip(if fit.measured { 0 } else { fit.loudest })
            .take(if fit.measured { MOST_POSITIONS } else { 1 })
            .map(|[sine, cosine]| Gain { sine: *sine as f32, cosine: *cosine as f32 })
            .collect(),
    });
    Kit {
        name: name.clone(),
        objects: vec![Object {
            name,
            source: source.clone(),
            licence: licence.clone(),
            reference_force: peak_force.clamp(1.0, REFERENCE_FORCE.max),
            acceleration: Acceleration::Factor(strike.map_or(0.0, |strike| strike.acceleration as f32)),
            modes: modes.collect(),
            residual: None,
            dynamic_filter: None,
            biquads: None,
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
            modes: Vec::new(),
        }],
        pads: Vec::new(),
        background: None,
        room: vec![],
    }
}

/// The table with a residual: bands as [`crate::residual::fit_bands`] gives them for a strike of the table's peak force, neighbours without gaps. Bands
/// that end above 20 kHz, and those without weight at either end, are left out; without any weight the table stays as it is.
pub fn with_residual(mut table: Kit, bands: &[Band], seed: u32) -> Kit {
    let audible: Vec<&Band> = bands.iter().filter(|band| band.edges_hz[1] <= HIGHEST_EDGE_HZ).collect();
    let sounds = |band: &&&Band| band.weight > 0.0;
    let first = audible.iter().position(|band| sounds(&band)).unwrap_or(audible.len());
    let last = audible.iter().rposition(|band| sounds(&band)).map_or(first, |last| last + 1);
    let kept = audible.get(first..last).unwrap_or(&[]);
    let peak_force = table.strikers.first().map_or(1.0, |striker| f64::from(striker.peak_force));
    if let (Some(lowest), Some(object)) = (kept.first(), table.objects.first_mut()) {
        let edges = std::iter::once(lowest.edges_hz[0]).chain(kept.iter().map(|band| band.edges_hz[1]));
        // Bands are heard at the strike's peak force, and weights are those of the reference force.
        let ratio = f64::from(object.reference_force) / peak_force;
        let weight = |band: &&Band| ((band.weight * ratio) as f32).min(MOST_WEIGHT);
        let decay = |band: &&Band| (band.decay_db_per_s as f32).clamp(LEAST_DECAY_DB_PER_S, MOST_DECAY_DB_PER_S);
        object.residual = Some(Residual {
            seed,
            edges_hz: edges.map(|edge| edge as f32).collect(),
            weight: kept.iter().map(weight).collect(),
            decay_db_per_s: kept.iter().map(decay).collect(),
        });
    }
    table
}

/// The table with the room of its recording, by so many dB weaker than it was heard: an octave a band, the outermost to either end.
pub fn with_room(mut table: Kit, room: &Room, level_db: f64) -> Kit {
    let bands = room.bands.iter().enumerate();
    let from_hz = |band: usize, edge_hz: f64| if band == 0 { 0.0 } else { edge_hz };
    let bands = bands.map(|(index, band)| {
        kit::RoomBand::new(from_hz(index, band.edges_hz[0]), band.t60_s, (band.gain_db + level_db).min(MOST_ROOM_DB))
    });
    table.room = bands.collect();
    table
}

/// Strongest band of a room; at the shortest T60 its gain is far from what the format ends at.
const MOST_ROOM_DB: f64 = 12.0;
/// Highest edge of a residual band in a table: any rate of 44.1 kHz and more plays it.
const HIGHEST_EDGE_HZ: f64 = 20_000.0;
/// Strongest band, slowest and fastest decay of one that the format knows.
const MOST_WEIGHT: f32 = 16.0;
const LEAST_DECAY_DB_PER_S: f32 = 1.0;
const MOST_DECAY_DB_PER_S: f32 = 20_000.0;
/// Slowest and fastest decay that the format knows, 1/s.
const LEAST_DECAY_PER_S: f32 = 0.01;
const MOST_DECAY_PER_S: f32 = 20_000.0;

/// Positions that the format holds at most.
const MOST_POSITIONS: usize = 64;
/// Longest name of an item.
const NAME_LENGTH: usize = 24;

/// A name that the format accepts: printable ASCII without comma and quote, at most 24 characters, `ending` included.
pub fn item_name(wanted: &str, ending: &str) -> String {
    let plain = |c: char| if (' '..='~').contains(&c) && c != ',' && c != '"' { c } else { '-' };
    let name: String = wanted.trim().chars().map(plain).take(NAME_LENGTH - ending.len()).collect();
    let name = name.trim();
    format!("{}{ending}", if name.is_empty() { "object" } else { name })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table(peak_force: f32) -> Kit {
        let fit = Fit { rate_hz: 44_100.0, modes: vec![], strikes: vec![], measured: false, loudest: 0 };
        let provenance = Provenance { name: "mug".to_owned(), source: String::new(), licence: String::new() };
        let mut table = of_fit(&fit, &provenance);
        table.strikers[0].peak_force = peak_force;
        table
    }

    #[test]
    fn a_residual_keeps_silent_bands_between_others_and_none_beyond_them() {
        let edges = [50.0, 100.0, 200.0, 400.0, 800.0, 19_000.0, 21_000.0];
        let weights = [0.0, 0.02, 0.0, 0.01, 0.0, 0.3];
        let bands: Vec<Band> = edges
            .windows(2)
            .zip(weights)
            .map(|(edge, weight)| Band { edges_hz: [edge[0], edge[1]], weight, decay_db_per_s: 0.0 })
            .collect();
        let table = with_residual(table(0.5), &bands, 7);
        let residual = table.objects[0].residual.as_ref().expect("some bands sound");
        assert_eq!(residual.edges_hz, [100.0, 200.0, 400.0, 800.0]);
        // Half the reference force: a strike of it sounds half as loud as the table says.
        assert_eq!(residual.weight, [0.04, 0.0, 0.02]);
        assert_eq!(residual.decay_db_per_s, [1.0; 3]);
    }

    #[test]
    fn a_fitted_strike_of_many_newtons_is_the_reference_force() {
        let strike = |peak_force: f64| crate::strike::Strike {
            hit: crate::segment::Hit { onset: 0, end: 1 },
            contact_time_s: 1e-3,
            peak_force,
            position: 0.0,
            acceleration: 0.0,
            lsd_db: 0.0,
            residual_db: 0.0,
        };
        let provenance = Provenance { name: "mug".to_owned(), source: String::new(), licence: String::new() };
        for (peak_force, expected) in [(250.0, 250.0), (0.5, 1.0), (1.0, 1.0)] {
            let strikes = vec![strike(peak_force)];
            let fit = Fit { rate_hz: 44_100.0, modes: vec![], strikes, measured: true, loudest: 0 };
            let band = Band { edges_hz: [100.0, 200.0], weight: 0.02, decay_db_per_s: 10.0 };
            let table = with_residual(of_fit(&fit, &provenance), &[band], 7);
            let object = &table.objects[0];
            assert_eq!(object.reference_force, expected);
            // A strike of the table's peak force has the weight that was heard.
            let weight = object.residual.as_ref().map_or(0.0, |residual| f64::from(residual.weight[0]));
            assert!((weight * peak_force / f64::from(object.reference_force) - 0.02).abs() < 1e-8, "{weight}");
        }
    }

    #[test]
    fn silent_bands_are_no_residual() {
        let band = Band { edges_hz: [100.0, 200.0], weight: 0.0, decay_db_per_s: 10.0 };
        assert!(with_residual(table(1.0), &[band], 7).objects[0].residual.is_none());
        assert!(with_residual(table(1.0), &[], 7).objects[0].residual.is_none());
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

//! What stands beside the modes: residual and room, each where it brings the sound nearer.
//!
//! Nearer by the ERB distance, what an ear hears, over the whole strike and over its first quarter of a second, averaged over draws of the noise; and not further
//! by the log-spectral distance than [`MOST_RISE_DB`] above that of the modes alone.

use crate::distance::{ErbLevels, log_spectral_distance_db, lsd_window};
use crate::{FitError, render, residual, room, table};

/// By how much noise may raise the log-spectral distance over that of the modes alone, dB.
pub const MOST_RISE_DB: f64 = 0.2;
/// The residual's noise in the table; the draws that are averaged over follow it.
const SEED: u32 = 1;
/// Draws over which distances are averaged.
const DRAWS: u32 = 3;
/// Levels of all bands together that are tried.
const LEVELS: [f64; 4] = [1.0, 0.7, 0.5, 0.3];
/// Levels at which the room is tried, dB.
const ROOM_LEVELS_DB: [f64; 5] = [0.0, -3.0, -6.0, -10.0, -15.0];
/// A stage brings the sound nearer by at least this share of the ERB distance, or it stays out.
const LEAST_GAIN: f64 = 0.01;

/// How far a sound is from a recording.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Distances {
    /// Log-spectral distance, dB.
    pub lsd_db: f64,
    /// ERB distance over the whole strike, dB.
    pub erb_db: f64,
    /// ERB distance over the stretch of the log-spectral distance, dB.
    pub early_erb_db: f64,
}

/// A recorded strike that tables are compared with.
pub struct Heard<'a> {
    samples: &'a [f64],
    rate_hz: f64,
    position: f64,
    window: std::ops::Range<usize>,
    levels: ErbLevels,
    early_levels: ErbLevels,
}

/// A table, dsp-core's rendering of it with the table's own noise, and its distances, averaged over draws where there is noise.
#[derive(Clone, Debug)]
pub struct Sounding {
    /// The table.
    pub table: kit::Kit,
    /// What dsp-core makes of it.
    pub sound: Vec<f64>,
    /// How far that is from what was heard.
    pub distances: Distances,
}

impl<'a> Heard<'a> {
    /// Of a strike from its onset on, played at a position from 0 to 1.
    pub fn new(samples: &'a [f64], rate_hz: f64, position: f64) -> Self {
        let window = lsd_window(samples, rate_hz);
        Self {
            samples,
            rate_hz,
            position,
            levels: ErbLevels::new(samples, rate_hz),
            early_levels: ErbLevels::new(samples.get(window.clone()).unwrap_or(&[]), rate_hz),
            window,
        }
    }

    /// How far a sound is from the recording.
    pub fn distances(&self, sound: &[f64]) -> Distances {
        let early = sound.get(self.window.clone()).unwrap_or(&[]);
        Distances {
            lsd_db: log_spectral_distance_db(self.samples.get(self.window.clone()).unwrap_or(&[]), early),
            erb_db: self.levels.distance_db(&ErbLevels::new(sound, self.rate_hz)),
            early_erb_db: self.early_levels.distance_db(&ErbLevels::new(early, self.rate_hz)),
        }
    }

    /// A table as dsp-core plays it; distances are averages over `draws` of its noise, where it has any.
    ///
    /// # Errors
    /// [`FitError`] for what a board would refuse.
    pub fn play(&self, table: kit::Kit, draws: u32) -> Result<Sounding, FitError> {
        let render = |table: &kit::Kit| render::by_instrument(table, self.position, self.rate_hz, self.samples.len());
        let sound = render(&table)?;
        let first = self.distances(&sound);
        let Some(residual) = table.objects.first().and_then(|object| object.residual.clone()) else {
            return Ok(Sounding { distances: first, table, sound });
        };
        // Modes do not change with the seed: the noise alone is drawn anew and put in the place of the table's. In a room both are heard as one, and all is rendered.
        let mut drawn = table.clone();
        let modes = if table.room.is_empty() && draws > 1 {
            drawn.objects.iter_mut().for_each(|object| object.modes.clear());
            let noise = render(&drawn)?;
            sound.iter().zip(noise).map(|(sound, noise)| sound - noise).collect()
        } else {
            vec![0.0; sound.len()]
        };
        let mut sum = first;
        for draw in 1..draws.max(1) {
            if let Some(object) = drawn.objects.first_mut() {
                object.residual = Some(kit::Residual { seed: residual.seed.wrapping_add(draw), ..residual.clone() });
            }
            let noise = render(&drawn)?;
            let together: Vec<f64> = modes.iter().zip(noise).map(|(modes, noise)| modes + noise).collect();
            let distances = self.distances(&together);
            sum.lsd_db += distances.lsd_db;
            sum.erb_db += distances.erb_db;
            sum.early_erb_db += distances.early_erb_db;
        }
        let count = f64::from(draws.max(1));
        let distances = Distances {
            lsd_db: sum.lsd_db / count,
            erb_db: sum.erb_db / count,
            early_erb_db: sum.early_erb_db / count,
        };
        Ok(Sounding { table, sound, distances })
    }

    /// With what the sound leaves as residual; as it was where that brings it no nearer. `most_lsd_db` bounds the log-spectral distance.
    ///
    /// # Errors
    /// As [`play`](Self::play).
    pub fn with_residual(
        &self,
        plain: Sounding,
        most_lsd_db: f64,
    ) -> Result<(Sounding, Vec<residual::Band>), FitError> {
        let rise_db = (most_lsd_db - plain.distances.lsd_db).max(0.0);
        let all = residual::fit_bands(self.samples, &plain.sound, self.rate_hz)?;
        let admitted = residual::admit(all.clone(), self.samples, &plain.sound, self.rate_hz, rise_db);
        let mut best = (plain, Vec::new());
        for (bands, level) in [&admitted, &all].into_iter().flat_map(|bands| LEVELS.map(|level| (bands, level))) {
            let bands: Vec<_> =
                bands.iter().map(|band| residual::Band { weight: band.weight * level, ..*band }).collect();
            let mut dry = best.0.table.clone();
            dry.objects.iter_mut().for_each(|object| object.residual = None);
            let table = table::with_residual(dry, &bands, SEED);
            if table.objects.iter().all(|object| object.residual.is_none()) {
                break;
            }
            let noisy = self.play(table, DRAWS)?;
            if is_worth(&noisy, &best.0, most_lsd_db) {
                best = (noisy, bands.into_iter().filter(|band| band.weight > 0.0).collect());
            }
        }
        Ok(best)
    }

    /// The modes of a table in the room, at the level (dB over what was heard) that brings them nearest to what was heard.
    ///
    /// # Errors
    /// As [`play`](Self::play).
    pub fn in_room(&self, table: &kit::Kit, room: &room::Room) -> Result<Option<(f64, Sounding)>, FitError> {
        let mut modes = table.clone();
        modes.objects.iter_mut().for_each(|object| object.residual = None);
        let mut best: Option<(f64, Sounding)> = None;
        for level_db in ROOM_LEVELS_DB {
            let sounding = self.play(table::with_room(modes.clone(), room, level_db), 1)?;
            if best.as_ref().is_none_or(|(_, best)| is_worth(&sounding, best, f64::INFINITY)) {
                best = Some((level_db, sounding));
            }
        }
        Ok(best)
    }
}

/// Whether a sounding is so much nearer than another, over the whole strike and its beginning on the mean, that what it has more is worth it, and its
/// log-spectral distance within the bound.
pub fn is_worth(more: &Sounding, less: &Sounding, most_lsd_db: f64) -> bool {
    let (more, less) = (more.distances, less.distances);
    let ratio = |more: f64, less: f64| more / less.max(1e-9);
    let worse = more.erb_db > less.erb_db || more.early_erb_db > less.early_erb_db;
    let nearer = 0.5 * (ratio(more.erb_db, less.erb_db) + ratio(more.early_erb_db, less.early_erb_db));
    !worse && nearer < 1.0 - LEAST_GAIN && more.lsd_db <= most_lsd_db
}

/// Whether a room is worth what it does to a sound: its log-spectral distance is nearer than the dry one's by a twentieth, and its ERB distance, which may be further
/// than the dry one's with a residual, nearer than that of the modes alone by a tenth.
pub fn is_worth_its_room(wet: &Sounding, dry: &Sounding, alone: Distances) -> bool {
    wet.distances.lsd_db < 0.95 * dry.distances.lsd_db && wet.distances.erb_db < 0.9 * alone.erb_db
}

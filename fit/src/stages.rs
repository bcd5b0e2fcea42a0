//! Choice of the stages beside the modes: residual and room, each if it brings the sound nearer to
//! the recording.
//!
//! The ERB distance decides, which follows hearing: over the whole strike and over its first
//! quarter of a second, averaged over several noises. The log-spectral distance may not exceed that
//! of the modes alone by more than [`MOST_RISE_DB`]. A physical prior has its residual in any case.

pub use crate::distance::Distances;
use crate::distance::RecordedLevels;
use crate::error::FitError;
use crate::{render, residual, room, table};

/// Maximum rise of the log-spectral distance by noise, over that of the modes alone, in dB.
pub const MOST_RISE_DB: f64 = 0.2;
/// Seed of the residual's noise in the table; the other noises of an average have the seeds after
/// it.
const SEED: u32 = 1;
/// Number of noises over which distances are averaged.
const DRAWS: u32 = 3;
/// Factors on the weights of all residual bands that are tried.
const LEVELS: [f64; 4] = [1.0, 0.7, 0.5, 0.3];
/// Levels at which the room is tried, in dB.
const ROOM_LEVELS_DB: [f64; 5] = [0.0, -3.0, -6.0, -10.0, -15.0];
/// Least relative gain of the ERB distance for which a stage is kept.
const LEAST_GAIN: f64 = 0.01;

/// A recorded strike with which played tables are compared.
pub struct RecordedStrike<'a> {
    before: &'a [f64],
    samples: &'a [f64],
    rate_hz: f64,
    position: f64,
    levels: RecordedLevels,
}

/// A table, its rendering by dsp-core with the table's own noise, and its distances from the
/// recording.
#[derive(Clone, Debug)]
pub struct PlayedTable {
    /// The table.
    pub table: kit::Kit,
    /// Rendering of the table by dsp-core.
    pub sound: Vec<f64>,
    /// Distances of the rendering from the recording, averaged over several noises if the table has
    /// noise.
    pub distances: Distances,
}

impl<'a> RecordedStrike<'a> {
    /// A strike from its onset on, to be played at a position from 0 to 1.
    ///
    /// `before` are the samples that precede it.
    pub fn new(before: &'a [f64], samples: &'a [f64], rate_hz: f64, position: f64) -> Self {
        Self { before, samples, rate_hz, position, levels: RecordedLevels::new(before, samples, rate_hz) }
    }

    /// Samples of the strike from its onset on.
    pub(crate) fn samples(&self) -> &'a [f64] {
        self.samples
    }

    /// Sample rate in Hz.
    pub(crate) fn rate_hz(&self) -> f64 {
        self.rate_hz
    }

    /// Distances of a sound from the recording.
    pub fn distances(&self, sound: &[f64]) -> Distances {
        self.levels.distances(sound)
    }

    /// Renders the first `length` samples of a table's strike by dsp-core.
    ///
    /// # Errors
    /// [`FitError`] if a board would refuse the table.
    pub(crate) fn render(&self, table: &kit::Kit, length: usize) -> Result<Vec<f64>, FitError> {
        render::by_instrument(table, self.position, self.rate_hz, length)
    }

    /// Plays a table by dsp-core; the distances are averages over `draws` noises if the table has
    /// noise.
    ///
    /// # Errors
    /// [`FitError`] if a board would refuse the table.
    pub fn play(&self, table: kit::Kit, draws: u32) -> Result<PlayedTable, FitError> {
        let sound = self.render(&table, self.samples.len())?;
        let first = self.distances(&sound);
        let Some(residual) = table.objects.first().and_then(|object| object.residual.clone()) else {
            return Ok(PlayedTable { distances: first, table, sound });
        };
        // Modes do not depend on the seed, so only the noise is rendered again and replaces the
        // table's. In a room both are heard as one, so all is rendered.
        let mut drawn = table.clone();
        let modes = if table.room.is_empty() && draws > 1 {
            drawn.objects.iter_mut().for_each(|object| object.modes.clear());
            let noise = self.render(&drawn, self.samples.len())?;
            sound.iter().zip(noise).map(|(sound, noise)| sound - noise).collect()
        } else {
            vec![0.0; sound.len()]
        };
        let mut sum = first;
        for draw in 1..draws.max(1) {
            if let Some(object) = drawn.objects.first_mut() {
                object.residual = Some(kit::Residual { seed: residual.seed.wrapping_add(draw), ..residual.clone() });
            }
            let noise = self.render(&drawn, self.samples.len())?;
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
        Ok(PlayedTable { table, sound, distances })
    }

    /// Adds the residual that brings the sound nearest to the recording; `plain` is returned if
    /// none does.
    ///
    /// `most_lsd_db` bounds the log-spectral distance.
    ///
    /// # Errors
    /// [`FitError`] if a board would refuse a table.
    pub fn with_residual(
        &self,
        plain: PlayedTable,
        most_lsd_db: f64,
    ) -> Result<(PlayedTable, Vec<residual::Band>), FitError> {
        let tried = self.bands(&plain, most_lsd_db, &residual::usual_edges_hz(self.rate_hz))?;
        let mut best = (plain, Vec::new());
        for bands in tried {
            let mut dry = best.0.table.clone();
            dry.objects.iter_mut().for_each(|object| object.residual = None);
            let table = residual::with_residual(dry, &bands, SEED);
            if table.objects.iter().all(|object| object.residual.is_none()) {
                break;
            }
            // In a room each draw is a rendering of everything.
            let draws = if table.room.is_empty() { DRAWS } else { 1 };
            let noisy = self.play(table, draws)?;
            if is_worth(&noisy, &best.0, most_lsd_db) {
                best = (noisy, bands.into_iter().filter(|band| band.weight > 0.0).collect());
            }
        }
        Ok(best)
    }

    /// Adds the noise that was fitted together with the modes.
    ///
    /// # Errors
    /// [`FitError`] if a board would refuse the table.
    pub fn with_noise(
        &self,
        plain: PlayedTable,
        bands: &[residual::Band],
    ) -> Result<(PlayedTable, Vec<residual::Band>), FitError> {
        let noisy = self.play(noisy(plain.table.clone(), bands), DRAWS)?;
        let sounding = bands.iter().filter(|band| band.weight > 0.0).copied().collect();
        Ok(if nearness(&noisy, &plain) < 1.0 { (noisy, sounding) } else { (plain, Vec::new()) })
    }

    /// Adds the residual of a physical prior: 100 bands, fitted to what the modes leave.
    ///
    /// Of all weights that are tried, those are taken whose ERB distance is least. The modes alone
    /// may be nearer, since a prior always has its bands. `plain` is returned if the modes leave
    /// nothing. Among the residuals that are tried are those that `most_lsd_db` admits.
    ///
    /// # Errors
    /// [`FitError`] if a board would refuse a table.
    pub fn with_prior(
        &self,
        plain: PlayedTable,
        most_lsd_db: f64,
    ) -> Result<(PlayedTable, Vec<residual::Band>), FitError> {
        let tried = self.bands(&plain, most_lsd_db, &residual::prior_edges_hz(self.rate_hz))?;
        let (mut nearest, mut best) = (f64::INFINITY, None);
        for bands in tried.into_iter().filter(|bands| bands.iter().any(|band| band.weight > 0.0)) {
            let noisy = self.play(residual::with_bands(plain.table.clone(), &bands, SEED), DRAWS)?;
            let ratio = nearness(&noisy, &plain);
            if ratio < nearest {
                (nearest, best) = (ratio, Some((noisy, bands)));
            }
        }
        Ok(best.unwrap_or((plain, Vec::new())))
    }

    /// Residuals to try: the bands that the log-spectral distance admits and then all, each at
    /// several levels.
    fn bands(
        &self,
        plain: &PlayedTable,
        most_lsd_db: f64,
        edges_hz: &[f64],
    ) -> Result<Vec<Vec<residual::Band>>, FitError> {
        let rise_db = (most_lsd_db - plain.distances.lsd_db).max(0.0);
        let all = residual::fit_bands(self.before, self.samples, &plain.sound, self.rate_hz, edges_hz)?;
        let admitted = residual::admit(all.clone(), &self.levels, &plain.sound, self.rate_hz, rise_db);
        let at_levels = |bands: Vec<residual::Band>| {
            LEVELS
                .map(|level| bands.iter().map(|band| residual::Band { weight: band.weight * level, ..*band }).collect())
        };
        Ok([admitted, all].into_iter().flat_map(at_levels).collect())
    }

    /// The table's modes in the room, with the level in dB of the room that brings them nearest to
    /// the recording.
    ///
    /// The level is relative to the room of the recording.
    ///
    /// # Errors
    /// [`FitError`] if a board would refuse a table.
    pub fn in_room(&self, table: &kit::Kit, room: &room::Room) -> Result<Option<(f64, PlayedTable)>, FitError> {
        let mut modes = table.clone();
        modes.objects.iter_mut().for_each(|object| object.residual = None);
        let mut best: Option<(f64, PlayedTable)> = None;
        for level_db in ROOM_LEVELS_DB {
            let sounding = self.play(table::with_room(modes.clone(), room, level_db), 1)?;
            if best.as_ref().is_none_or(|(_, best)| is_worth(&sounding, best, f64::INFINITY)) {
                best = Some((level_db, sounding));
            }
        }
        Ok(best)
    }
}

/// The table with noise in these bands, drawn as tables of fits draw it.
pub(crate) fn noisy(table: kit::Kit, bands: &[residual::Band]) -> kit::Kit {
    residual::with_residual(table, bands, SEED)
}

/// True if `more` is nearer to the recording than `less` by enough to justify its additional stage.
///
/// The ERB distance counts, as the mean over the whole strike and its beginning. The log-spectral
/// distance must be at most `most_lsd_db`.
pub fn is_worth(more: &PlayedTable, less: &PlayedTable, most_lsd_db: f64) -> bool {
    let worse =
        more.distances.erb_db > less.distances.erb_db || more.distances.early_erb_db > less.distances.early_erb_db;
    !worse && nearness(more, less) < 1.0 - LEAST_GAIN && more.distances.lsd_db <= most_lsd_db
}

/// Ratio of the ERB distances of `more` to those of `less`, as the mean over the whole strike and
/// its beginning.
fn nearness(more: &PlayedTable, less: &PlayedTable) -> f64 {
    let (more, less) = (more.distances, less.distances);
    let ratio = |more: f64, less: f64| more / less.max(1e-9);
    0.5 * (ratio(more.erb_db, less.erb_db) + ratio(more.early_erb_db, less.early_erb_db))
}

/// True if a room justifies its effect on the sound.
///
/// The log-spectral distance must be 5 % below that of the dry sound. The ERB distance must be 10 %
/// below that of the modes alone; it may exceed that of the dry sound with a residual.
pub fn is_worth_its_room(wet: &PlayedTable, dry: &PlayedTable, alone: Distances) -> bool {
    wet.distances.lsd_db < 0.95 * dry.distances.lsd_db && wet.distances.erb_db < 0.9 * alone.erb_db
}

//! Shortest wavelength that was measured.

use super::options::Note;
use super::profile::Profiles;
use super::spectrum::{Level, levels};

/// Wavelengths in metres at which the level that a cliff is measured from lies.
const REFERENCE_M: [f64; 2] = [0.7e-3, 1.4e-3];
/// Number of the longest waves' levels that take its place on a short surface.
const LONGEST: usize = 6;
/// Fall from that level in dB by which nothing is left.
const FALLEN_DB: f64 = 60.0;
/// Fall in dB within half an octave that no surface has: the edge of an interpolation.
const CLIFF_DB: f64 = 40.0;
/// Number of levels of an octave, and of half an octave.
const OCTAVE: usize = 12;
const HALF_OCTAVE: usize = 6;
/// Shortest wavelength in steps of a profile without such an edge.
const STEPS: f64 = 2.5;

/// Shortest wavelength in metres that was measured, and a note if it lies far above two steps.
///
/// An interpolation to finer steps leaves an edge in the spectrum, and images of the spectrum below
/// it. The edge lies where the density of heights is 60 dB below that at 1 mm, or at the longest
/// waves of a surface of a few millimetres. An edge at waves of 0.7 mm and longer lies where it is
/// 60 dB below the octave of waves before the edge. Without an edge it is 2.5 steps.
///
/// On the ten interpolated profiles of ThreeDWorld it is within 5 % of those in the data's manifest
/// (`cargo test -p fit --test sounds surfaces -- --nocapture`).
pub(super) fn shortest_m(profiles: &Profiles) -> (f64, Option<Note>) {
    let levels = levels(profiles);
    let finest_m = STEPS * profiles.step_m;
    match edge_m(&levels).filter(|edge_m| *edge_m > finest_m) {
        Some(shortest_m) => (shortest_m, Some(Note::Upsampled { shortest_m, step_m: profiles.step_m })),
        None => (finest_m, None),
    }
}

/// Wavelength in metres of an interpolation's edge; `None` if the spectrum has none.
fn edge_m(levels: &[Level]) -> Option<f64> {
    // Behind an edge that lies near 1 mm or at longer waves nothing is left to measure it from.
    let long = (LONGEST..levels.len()).take_while(|&first| length_m(&levels[first]) >= REFERENCE_M[0]);
    let of_long = |first: usize| edge_at(levels, first, typical_db(&levels[first.saturating_sub(OCTAVE)..first]));
    if let Some(edge_m) = long.filter_map(of_long).next() {
        return Some(edge_m);
    }
    let near: Vec<f64> = levels
        .iter()
        .filter(|level| (REFERENCE_M[0]..REFERENCE_M[1]).contains(&length_m(level)))
        .map(|level| level.db)
        .collect();
    // A short surface has no such waves: its longest ones stand for them.
    let near = if near.is_empty() { levels.iter().take(LONGEST).map(|level| level.db).collect() } else { near };
    let near_db = near.iter().sum::<f64>() / near.len() as f64;
    let is_below = |level: &Level| length_m(level) < REFERENCE_M[0] && level.db < near_db - FALLEN_DB;
    edge_at(levels, levels.iter().position(is_below)?, near_db)
}

/// Wavelength in metres of the edge before the level `first`, the first one that lies 60 dB below
/// `from_db`; `None` if it does not lie there, or the spectrum falls slowly.
fn edge_at(levels: &[Level], first: usize, from_db: f64) -> Option<f64> {
    let least_db = from_db - FALLEN_DB;
    let before = levels.get(first.checked_sub(1)?)?;
    if levels[first].db >= least_db || before.db < least_db {
        return None;
    }
    let window = &levels[first.saturating_sub(HALF_OCTAVE)..(first + HALF_OCTAVE + 1).min(levels.len())];
    let falls = window.windows(HALF_OCTAVE + 1).map(|part| part[0].db - part[HALF_OCTAVE].db);
    if falls.fold(0.0, f64::max) < CLIFF_DB {
        return None;
    }
    // Between two levels it goes in a straight line.
    let share = (before.db - least_db) / (before.db - levels[first].db);
    let octaves = (levels[first].frequency_per_m / before.frequency_per_m).log2();
    Some(length_m(before) * 2f64.powf(-share * octaves))
}

fn length_m(level: &Level) -> f64 {
    1.0 / level.frequency_per_m
}

/// Median of levels in dB, which the lines of a surface with grooves do not move.
fn typical_db(levels: &[Level]) -> f64 {
    let mut sorted: Vec<f64> = levels.iter().map(|level| level.db).collect();
    sorted.sort_by(f64::total_cmp);
    sorted[sorted.len() / 2]
}

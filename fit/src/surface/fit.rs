//! Steps that make the table of a surface.

use super::error::SurfaceError;
use super::extension::{FITTED, extended};
use super::filled::{fill, fill_short, whole_rows};
use super::heights::Heights;
use super::map::map;
use super::options::{Note, Options, Source};
use super::profile::{LEAST_POINTS, profiles};
use super::report::{Report, below_shortest_percent, report};
use super::section::{resampled, section};
use super::shortest::shortest_m;
use super::statistics::{Curvature, statistics};
use super::synthesis::synthesised;
use super::table::Table;
use super::tip;
use super::waves::frequency_per_m;

/// Number of points of a synthesis at least and at most, a power of two. Twice as many would not
/// fit into the 64 KB that a surface may take.
const POINTS: [usize; 2] = [256, 4096];
/// Least number of columns that are read as profiles where rows are too short.
const LEAST_COLUMNS: usize = 25;
/// Points of a table in its shortest wave.
const POINTS_PER_WAVE: f64 = 3.0;
/// Largest share of a profile's curvature, in percent of its power, that may lie below the shortest
/// wave before long waves are taken off.
const MOST_BELOW_PERCENT: f64 = 0.1;
/// Longest wave in metres that is then kept, and in shortest waves if that is longer.
const LONGEST_M: f64 = 1.1e-3;
const LONGEST_WAVES: f64 = 20.0;
/// Least length of a profile in shortest waves.
const LEAST_WAVES: f64 = 40.0;

/// Makes a surface's table: the steps of the module, in their order.
///
/// `told` gets the share of the work that is done, from 0 to 1.
///
/// On the ten profiles of ThreeDWorld the table's third octaves are within 0.5 dB rms of the
/// surface's, and the kurtosis of its curvature within 1 % (`cargo test -p fit --test sounds
/// surfaces -- --nocapture`).
///
/// # Errors
/// [`SurfaceError`] if the surface is too small, flat or mostly missing, or an option does not fit
/// it.
pub fn fit(
    heights: Heights,
    options: &Options,
    told: impl Fn(f64),
) -> Result<(Table, Report, Vec<Note>), SurfaceError> {
    let mut notes = Vec::new();
    match fitted(heights, options, told, &mut notes) {
        Ok((table, report)) => Ok((table, report, notes)),
        // Heights in another unit are the likeliest reason for which no kit takes a table.
        Err(SurfaceError::NotOfKit { cause }) => Err(match notes.into_iter().find(Note::is_scale) {
            Some(note) => SurfaceError::Unit { note },
            None => SurfaceError::NotOfKit { cause },
        }),
        Err(error) => Err(error),
    }
}

/// Makes a surface's table, with notes on what was decided.
fn fitted(
    mut heights: Heights,
    options: &Options,
    told: impl Fn(f64),
    notes: &mut Vec<Note>,
) -> Result<(Table, Report), SurfaceError> {
    check(&heights, options)?;
    let is_map = options.source == Source::Map;
    let is_tall = heights.columns < LEAST_POINTS;
    if is_tall && !is_map {
        heights = heights.turned();
    }
    heights.values.iter_mut().for_each(|height| *height *= options.height_scale);
    notes.extend(fill_short(&mut heights)?);
    let whole = whole_rows(&heights, LEAST_POINTS);
    let whole_across = if is_map { whole_rows(&heights.turned(), LEAST_POINTS) } else { None };
    let is_missing: Vec<bool> = heights.values.iter().map(|height| !height.is_finite()).collect();
    fill(&mut heights);
    told(0.1);
    let of_rows = profiles(whole.as_ref().unwrap_or(&heights));
    let of_columns = if is_map { profiles(&whole_across.unwrap_or_else(|| heights.turned())).ok() } else { None };
    let (mut profiles, others, is_turned) = match (of_rows, of_columns) {
        // A map of grooves has waves across its rows alone, and a strip may have short rows.
        (Err(SurfaceError::Flat | SurfaceError::TooFew { .. }), Some(columns)) => (columns, None, true),
        (rows, columns) => (rows?, columns, false),
    };
    notes.extend(profiles.doubt(options.height_scale));
    if profiles.rows.len() > 1 && !is_map {
        notes.push(Note::Rows { rows: profiles.rows.len(), is_turned: is_tall });
    }
    let (mut measured_m, mut note) = shortest_m(&profiles);
    if let Some((across_m, across)) = others.as_ref().map(shortest_m).filter(|(across_m, _)| *across_m < measured_m) {
        (measured_m, note) = (across_m, across);
    }
    notes.extend(note);
    if !is_map && profiles.length_m() < LEAST_WAVES * measured_m {
        return Err(SurfaceError::TooShort { length_m: profiles.length_m(), shortest_m: measured_m });
    }
    if let Some(radius_m) = options.tip_radius_m {
        let step_m = profiles.step_m;
        profiles.rows.iter_mut().for_each(|row| *row = tip::path(row, step_m, radius_m));
    }
    told(0.3);
    let surface = Curvature::new(&profiles, measured_m);
    let step_m = |shortest_m: f64| shortest_m / POINTS_PER_WAVE;
    let table = match options.source {
        Source::Map => {
            let (map, rows, step_m) = map(&heights, &is_missing, measured_m, POINTS_PER_WAVE)?;
            Table::of_map(&map, rows, step_m, measured_m)?
        }
        Source::Section(range_m) => {
            let (heights, step_m) = section(&profiles, range_m, measured_m, step_m(measured_m))?;
            table_of(&heights, step_m, measured_m, notes)?
        }
        Source::Statistics => {
            let shortest_m = options.extend_to_m.unwrap_or(measured_m);
            let mut wanted = statistics(&surface, measured_m, options.points as f64 * step_m(shortest_m));
            if let Some(to_m) = options.extend_to_m {
                if !(measured_m / 64.0..measured_m).contains(&to_m) {
                    let range = "give a wavelength from 1/64 of the shortest measured one to below it";
                    return Err(SurfaceError::Range { option: "--extend-to", value: to_m, range });
                }
                let (more, note) = extended(wanted, to_m);
                notes.push(note);
                wanted = more;
            }
            told(0.5);
            let step_m = step_m(wanted.shortest_m);
            let heights = synthesised(&wanted, options.points, step_m, options.seed);
            table_of(&heights, step_m, wanted.shortest_m, notes)?
        }
    };
    told(0.9);
    let kept_m = if options.extend_to_m.is_some() { FITTED[0] * measured_m } else { measured_m };
    let report = report(&table, (&surface, kept_m), is_turned)?;
    told(1.0);
    Ok((table, report))
}

/// Table of a profile. If rounding its heights to 16 bits leaves more than [`MOST_BELOW_PERCENT`]
/// below the shortest wave, waves that are long beside the shortest one are taken off, and a note
/// says so: they take up the range of the numbers, and hardly bend the surface.
fn table_of(heights: &[f64], step_m: f64, shortest_m: f64, notes: &mut Vec<Note>) -> Result<Table, SurfaceError> {
    let table = Table::of_profile(heights, step_m, shortest_m)?;
    if below_shortest_percent(&table) <= MOST_BELOW_PERCENT {
        return Ok(table);
    }
    let longest_m = LONGEST_M.max(LONGEST_WAVES * shortest_m);
    notes.push(Note::LongWaves { longest_m });
    let is_kept = |bin| frequency_per_m(bin, heights.len(), step_m) >= 1.0 / longest_m;
    Table::of_profile(&resampled(heights, heights.len(), is_kept), step_m, shortest_m)
}

fn check(heights: &Heights, options: &Options) -> Result<(), SurfaceError> {
    let range = |option, value, range| Err(SurfaceError::Range { option, value, range });
    if !(1e-12..=1e12).contains(&options.height_scale) {
        return range("--height-scale", options.height_scale, "give 1e-12 to 1e12, such as 1e-6 for heights in µm");
    }
    // A map may be saved either way round. Columns of a list of points are no profiles, though.
    let is_long = heights.columns >= LEAST_POINTS || heights.columns >= LEAST_COLUMNS && heights.rows() >= LEAST_POINTS;
    if !is_long || heights.rows() == 0 {
        return Err(SurfaceError::TooFew { points: heights.columns, least: LEAST_POINTS });
    }
    let [least, most] = POINTS;
    if !options.points.is_power_of_two() || !(least..=most).contains(&options.points) {
        return range("--points", options.points as f64, "give a power of two from 256 to 4096");
    }
    if let Some(radius_m) = options.tip_radius_m.filter(|radius_m| !(1e-7..=1.0).contains(radius_m)) {
        return range("--tip-radius", radius_m, "give 1e-7 to 1 m");
    }
    if options.source == Source::Map && heights.rows() < 2 {
        return Err(SurfaceError::NoMap);
    }
    if let (Source::Map, Some(radius_m)) = (options.source, options.tip_radius_m) {
        return range("--tip-radius", radius_m, "leave it out: a ball's path is taken over profiles, not with --map");
    }
    Ok(())
}

//! `malleus fit` of a recording of many strikes: all of them together.

use std::path::{Path, PathBuf};

use ::fit::audio;
use ::fit::descent;
use ::fit::material::{self, Guess, Interval, RingingMode};
use ::fit::multi_strike::{self, Estimate, Layout};
use ::fit::table::Provenance;
use ::kit::Kit;
use ::kit::counting::counted;
use dsp_core::fixed::FULL_SCALE_24_BIT;
use malleus::render::replay::replay;
use malleus::report::{StrikesPage, write_strikes_page};
use serde::Serialize;

use super::fit::modulus_line;
use super::fit_job::{Job, with_file};
use crate::arguments::{EstimatorName, FitArguments};

/// Figures of a recording whose strikes were fitted together.
#[derive(Debug, Serialize)]
pub(crate) struct StrikesReport {
    /// Decisions that were made without asking, and doubts about Young's modulus.
    notes: Vec<String>,
    /// Events that replay the recording.
    events: PathBuf,
    #[serde(flatten)]
    pub(crate) estimate: Estimate,
    /// Guess at the object's material.
    material: Option<Guess>,
    /// Young's modulus in pascals: of the solid whose size is known, else of the likely materials.
    young_modulus_pa: Option<Interval>,
    /// Duration of the fit in seconds.
    pub(crate) seconds: f64,
}

/// Fits all strikes together, and writes the table and, at `events`, the events that replay it.
///
/// Writes a page, too, if the job has one. `told` gets the share of the work that is done.
pub(super) fn fit_and_write(
    arguments: &FitArguments,
    job: &Job,
    events: &Path,
    told: &(dyn Fn(f64) + Sync),
) -> Result<StrikesReport, String> {
    let start = std::time::Instant::now();
    let recording = match arguments.estimator {
        EstimatorName::Modal => audio::read_up_to(&job.input, None, multi_strike::LONGEST_S),
        EstimatorName::Bins | EstimatorName::Descent => audio::read(&job.input, None),
    };
    let mut recording = recording.map_err(|error| with_file(&job.input, error))?;
    let of_file = |error: &dyn std::fmt::Display| format!("{}: {error}", job.input.display());
    let mut notes: Vec<String> = recording.notes.iter().map(ToString::to_string).collect();
    let (estimate, way) = match arguments.estimator {
        EstimatorName::Bins => {
            return Err("`--events` needs the estimator `modal` or `descent`: leave `--estimator bins` out".to_owned());
        }
        EstimatorName::Modal => {
            let mut settings = ::fit::modes::Settings::default();
            settings.most_modes = arguments.modes.unwrap_or(settings.most_modes);
            let layout =
                Layout { positions: usize::from(arguments.positions), strikers: usize::from(arguments.strikers) };
            let rate_hz = recording.rate_hz;
            let estimate = multi_strike::estimate_in_place(&mut recording.samples, rate_hz, settings, layout, told)
                .map_err(|error| of_file(&error))?;
            (estimate, JOINT)
        }
        EstimatorName::Descent => {
            if arguments.positions > 1 || arguments.strikers > 1 {
                return Err("the descent knows one place and one striker: leave --positions and --strikers out, or --estimator descent".to_owned());
            }
            let mut settings = descent::Settings::default();
            settings.modes = arguments.modes.unwrap_or(settings.modes);
            settings.steps = arguments.steps.map_or(settings.steps, |steps| steps as usize);
            let estimate = descent::estimate(&recording.samples, recording.rate_hz, &settings, told)
                .map_err(|error| of_file(&error))?;
            notes.push("fitted by descent on spectrograms: the numbers have no standard deviations".to_owned());
            (estimate, DESCENT)
        }
    };
    let provenance = provenance(&job.input, &estimate, arguments);
    let table = (way.table)(&estimate, &provenance);
    let text = ::kit::text::write(&table);
    ::kit::file::write_whole(&job.table, text.as_bytes()).map_err(|error| error.to_string())?;
    let text = (way.events)(&estimate, &table);
    ::kit::file::write_whole(events, text.as_bytes()).map_err(|error| error.to_string())?;
    notes.extend(flagged(&estimate));
    notes.extend(unexplained(&estimate, recording.samples.iter().fold(0.0, |peak, x| x.abs().max(peak))));
    let materials = material::named(&arguments.materials).map_err(|error| error.to_string())?;
    let solid = arguments.bar.or(arguments.disc);
    let told = material::guess(&ringing(&estimate), &materials, solid);
    notes.extend(told.doubts.iter().map(ToString::to_string));
    let report = StrikesReport {
        notes,
        events: events.to_owned(),
        estimate,
        material: told.material,
        young_modulus_pa: told.young_modulus_pa,
        seconds: start.elapsed().as_secs_f64(),
    };
    if let Some(page) = &job.page {
        write_page(job, page, &table, &recording.samples, &report)?;
    }
    Ok(report)
}

/// Functions that write down a fit.
struct Way {
    table: fn(&Estimate, &Provenance) -> Kit,
    events: fn(&Estimate, &Kit) -> String,
}

/// The joint fit, whose forces are half-sines.
const JOINT: Way = Way { table: multi_strike::table, events: multi_strike::events };
/// The descent, whose forces are Gaussians.
const DESCENT: Way = Way { table: descent::table, events: descent::events };

/// Writes the page of a recording whose table and events are written.
fn write_page(job: &Job, page: &Path, kit: &Kit, recording: &[f64], report: &StrikesReport) -> Result<(), String> {
    let rate_hz = report.estimate.rate_hz;
    let frames = replay(&job.table, &report.events, rate_hz, recording.len() as f64 / rate_hz)
        .map_err(|error| format!("{}: no page: {error}", job.input.display()))?;
    // The pad is in the middle: both channels are the sound.
    let full_scale = f64::from(FULL_SCALE_24_BIT);
    let played: Vec<f64> = frames.iter().take(recording.len()).map(|frame| f64::from(frame[0]) / full_scale).collect();
    let content = StrikesPage {
        name: &job.name,
        input: &job.input,
        table: &job.table,
        events: &report.events,
        estimate: &report.estimate,
        kit,
        recording,
        replay: &played,
        material: report.material.as_ref().map(|guess| (guess.name, guess.confidence)),
        notes: &report.notes,
        seconds: report.seconds,
    };
    write_strikes_page(page, &content, report).map_err(|error| error.to_string())
}

/// Modes as far as they tell of a material, with their levels under an impulse.
fn ringing(estimate: &Estimate) -> Vec<RingingMode> {
    let squared = |gain: [f64; 2]| gain[0] * gain[0] + gain[1] * gain[1];
    let modes = estimate.modes.iter();
    RingingMode::relative(modes.map(|mode| (mode.frequency_hz, mode.decay_per_s, squared(mode.gain))))
}

fn provenance(input: &Path, estimate: &Estimate, arguments: &FitArguments) -> Provenance {
    let file = input.file_name().unwrap_or(input.as_os_str()).to_string_lossy().into_owned();
    Provenance {
        name: input.file_stem().unwrap_or(input.as_os_str()).to_string_lossy().into_owned(),
        source: format!(
            "{file}, {} together (malleus fit), {}",
            counted(estimate.strikes.len(), "strikes"),
            counted(estimate.modes.len(), "modes")
        ),
        licence: arguments.licence.clone(),
    }
}

/// Least level in dB over what other strikes leave from which a strike is named.
const UNEXPLAINED_DB: f64 = 9.0;

/// Note on contact times that are those of each strike's own sound.
const CONTACT_TIMES_ARE_HEARD: &str = "the strikes are not alike but for their forces: contact times are those of each \
     strike's own sound, about 20 % uncertain; where the thing was struck along its length, try --positions 8";

/// Notes on strikes that the fit does not explain.
fn flagged(estimate: &Estimate) -> Vec<String> {
    let times = |is_flagged: fn(&multi_strike::StrikeEstimate) -> bool| {
        let flagged = estimate.strikes.iter().filter(|strike| is_flagged(strike));
        flagged.map(|strike| format!("{:.3}", strike.at_s)).collect::<Vec<String>>()
    };
    let mut notes = Vec::new();
    let clipped = times(|strike| strike.is_clipped);
    if !clipped.is_empty() {
        notes.push(format!(
            "clipped strikes, whose samples at the limit are replaced by what the fit says of them: {} s",
            clipped.join(", ")
        ));
    }
    if estimate.contact_times_are_heard {
        notes.push(CONTACT_TIMES_ARE_HEARD.to_owned());
    }
    if let Some(room) = &estimate.room {
        notes.push(format!(
            "heard in a room of T60 {:.2} s, {:.1} dB below the direct sound: the table has it, and its modes are without it",
            room.t60_s, -room.gain_db
        ));
    }
    let unexplained = times(|strike| strike.left_db > UNEXPLAINED_DB && !strike.is_clipped);
    if !unexplained.is_empty() {
        notes.push(format!("strikes of which far more is left than of the others: {} s", unexplained.join(", ")));
    }
    notes
}

/// Level in dB of what a fit leaves, over the quietest tenth of it, above which there is a note.
const UNEXPLAINED_OVER_QUIET_DB: f64 = 4.0;
/// Least noise in dB of the recording's peak: below it what a fit leaves does not matter.
const LEAST_QUIET_DB: f64 = -88.0;
/// Duration of a part whose power is taken, in seconds.
const PART_S: f64 = 0.03;

/// Note on a fit that leaves more than noise. The quietest tenth of what it leaves stands for the
/// noise.
fn unexplained(estimate: &Estimate, peak: f64) -> Option<String> {
    let mean = |part: &[f64]| part.iter().map(|x| x * x).sum::<f64>() / part.len() as f64;
    let parts = estimate.residual.chunks_exact(((PART_S * estimate.rate_hz) as usize).max(1));
    let mut powers: Vec<f64> = parts.map(mean).collect();
    powers.sort_by(f64::total_cmp);
    let least = (peak * 10f64.powf(LEAST_QUIET_DB / 20.0)).powi(2);
    let quiet = powers.get(powers.len() / 10)?.max(least);
    let over_db = estimate.left_dbfs - 10.0 * quiet.log10();
    (over_db > UNEXPLAINED_OVER_QUIET_DB).then(|| {
        format!(
            "what the fit leaves lies {over_db:.1} dB above its quietest tenth: more than noise is left, and strikes and \
             modes may be farther off than their standard deviations"
        )
    })
}

/// Lines printed for a recording: its row of figures, its notes, and Young's modulus if the size of
/// the thing is given.
pub(super) fn row(name: &str, report: &StrikesReport, has_solid: bool) -> String {
    let estimate = &report.estimate;
    let t60_s = |choose: fn(f64, f64) -> f64, start: f64| {
        estimate.modes.iter().map(multi_strike::ModeEstimate::t60_s).fold(start, choose)
    };
    let notes: String = report.notes.iter().map(|note| format!("  {note}\n")).collect();
    format!(
        "{name:32} {:>5} {:>7} {:>17} {:>7} {:>7.1}\n{notes}{}",
        estimate.modes.len(),
        "-",
        format!("{:.3} to {:.2}", t60_s(f64::min, f64::INFINITY), t60_s(f64::max, 0.0)),
        estimate.strikes.len(),
        report.seconds,
        modulus_line(report.young_modulus_pa.as_ref(), has_solid)
    )
}

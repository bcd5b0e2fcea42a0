//! The complete fit: from a file to a table and a report.

use std::path::{Path, PathBuf};

use kit::counting::counted;
use serde::Serialize;

use crate::audio::{self, Recording};
use crate::contact;
use crate::distance::Background;
use crate::distance::lsd_window;
use crate::error::FitError;
use crate::hearing::{Heard, Scores};
use crate::modes::{self, Bounds, DampedSine};
use crate::stages::{MOST_RISE_DB, PlayedTable, RecordedStrike, is_worth_its_room};
use crate::strike::{self, Fit, fit_force, fit_sound};
use crate::table::{self, Provenance};
use crate::trim::trimmed;
use crate::{bark, material, render, residual, room, segment};

/// Options of a fit.
#[derive(Clone, Debug, Default)]
pub struct Options {
    /// Settings of the strikes' fit.
    pub strike: strike::Settings,
    /// Channel of the measured force, from 0; `None` for a fit from sound alone.
    pub force_channel: Option<usize>,
    /// Hits to use, counted from 1; all if empty.
    pub hits: Vec<usize>,
    /// Licence of the recording, for the table.
    pub licence: String,
    /// Materials that the object may be made of; all that are known if empty.
    pub materials: Vec<material::Material>,
    /// Size and density of the object, if it is a bar or a disc.
    pub solid: Option<material::solid::Solid>,
}

/// A fitted recording.
#[derive(Clone, Debug)]
pub struct Fitted {
    /// The recording as it was read, without steady tones.
    pub recording: Recording,
    /// Fitted object and strikes.
    pub fit: Fit,
    /// The table.
    pub table: kit::Kit,
    /// Rendering by dsp-core of the modes in the loudest strike, from its onset.
    pub rendering: Vec<f64>,
    /// Rendering by dsp-core of the whole table, residual and room included.
    pub whole: Vec<f64>,
    /// Modes of the table in the loudest strike, with amplitudes and phases extrapolated to its
    /// onset.
    ///
    /// They are in the table's order.
    pub sounding: Vec<DampedSine>,
    /// The loudest strike as it is heard.
    pub heard: Heard,
    /// Figures of the fit.
    pub report: Report,
}

/// Figures of a fit, as `--json` prints them.
#[derive(Clone, Debug, Serialize)]
pub struct Report {
    /// Path of the recording.
    pub input: PathBuf,
    /// Sample rate in Hz at which the recording was fitted.
    pub rate_hz: f64,
    /// Decisions that were made without asking, and doubts about Young's modulus.
    pub notes: Vec<String>,
    /// Strikes in order of time.
    pub strikes: Vec<StrikeReport>,
    /// Number of modes in the table.
    pub modes: usize,
    /// Lowest and highest frequency of the modes in Hz; 0 without modes.
    pub frequency_hz: [f64; 2],
    /// Shortest and longest T60 of the modes in seconds; 0 without modes.
    pub t60_s: [f64; 2],
    /// Guess at the object's material.
    pub material: Option<material::Guess>,
    /// Young's modulus in pascals: of the solid whose size is known, else of the likely materials.
    pub young_modulus_pa: Option<material::Interval>,
    /// Log-spectral distance in dB of dsp-core's rendering of the modes from the loudest strike.
    pub lsd_db: f64,
    /// Log-spectral distance in dB of the `f64` reference's rendering of the modes from the loudest
    /// strike.
    pub lsd_reference_db: f64,
    /// Log-spectral distance in dB of dsp-core's rendering of modes and residual, averaged over
    /// three noises.
    ///
    /// Equal to `lsd_db` if a residual brings the sound no nearer.
    pub lsd_with_residual_db: f64,
    /// Log-spectral distance in dB of modes in the estimated room, with the residual that they
    /// leave there.
    ///
    /// `None` if no room is found.
    pub lsd_with_room_db: Option<f64>,
    /// ERB distance in dB of dsp-core's rendering of the modes from the whole loudest strike.
    pub erb_db: f64,
    /// ERB distance in dB of dsp-core's rendering of modes and residual, averaged over three
    /// noises.
    ///
    /// Equal to `erb_db` if a residual brings the sound no nearer.
    pub erb_with_residual_db: f64,
    /// ERB distance in dB of modes in the estimated room, with the residual that they leave there.
    ///
    /// `None` if no room is found.
    pub erb_with_room_db: Option<f64>,
    /// Level of the table's room in dB relative to the estimated room: the modes hold part of the
    /// tail.
    ///
    /// `None` if the table has no room.
    pub room_level_db: Option<f64>,
    /// Measures of hearing of dsp-core's rendering of the whole table, with the table's own noise.
    pub hearing: Scores,
    /// Measures of hearing of dsp-core's rendering of the modes alone.
    pub hearing_of_modes: Scores,
    /// Audible partials of the loudest strike.
    pub partials: Vec<PartialReport>,
    /// True if the modes explain the strike down to its noise floor.
    pub is_exact: bool,
    /// Standard deviations of each mode's numbers in the noise that the modes leave.
    ///
    /// The modes are in order of frequency. Empty if two modes cannot be told apart, and for the
    /// bins estimator, whose modes are bins of a spectrum.
    pub deviations: Vec<Bounds>,
    /// Residual bands of the table: what the modes lack of the loudest strike.
    ///
    /// Empty if they bring the sound no nearer; the bins estimator has them anyhow.
    pub residual_bands: Vec<residual::Band>,
    /// Estimator of the modes.
    pub estimator: strike::Estimator,
    /// Damping law and spectral centroids of the loudest strike on the Bark scale; `None` if no
    /// band decays.
    pub damping_law: Option<bark::DampingLaw>,
    /// Level in dB by which each mode of the table stands out of the smooth part of the spectrum.
    ///
    /// The modes are in order of frequency. A mode without amplitude is `null` in JSON.
    pub emergence_db: Vec<f64>,
    /// Estimated room; `None` if no tail is found.
    pub room: Option<room::Room>,
    /// Duration of the fit in seconds.
    pub seconds: f64,
}

/// An audible partial, and what the table has in its place.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct PartialReport {
    /// Beginning of the spectrum of 8192 samples in which it is heard, in seconds from the onset.
    pub at_s: f64,
    /// Frequency in Hz, a whole number of bins.
    pub frequency_hz: f64,
    /// Level in dB SPL, if the strike's loudest partial has 85 dB.
    pub level_db: f64,
    /// Level of the rendering over that of the recording in dB.
    pub error_db: f64,
    /// Frequency of the nearest mode in Hz if it is within 0.5 % or one bin.
    pub mode_hz: Option<f64>,
}

/// Figures of one strike.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct StrikeReport {
    /// Onset in seconds of the recording.
    pub at_s: f64,
    /// Contact time in seconds.
    pub contact_time_s: f64,
    /// Shortest and longest contact time in seconds that the sound allows.
    ///
    /// `None` with a measured force, and for a sound too short to tell.
    pub contact_interval_s: Option<[f64; 2]>,
    /// Log-spectral distance of the model in dB.
    pub lsd_db: f64,
    /// Energy that the model leaves, in dB.
    pub residual_db: f64,
}

/// Fits a file.
///
/// # Errors
/// [`FitError`] if the file cannot be read or decoded, or holds no strike that can be fitted.
pub fn fit_file(path: &Path, options: &Options) -> Result<Fitted, FitError> {
    let start = std::time::Instant::now();
    let mut recording = audio::read(path, options.force_channel)?;
    let (found, mut notes) = segment::hits(&recording)?;
    recording.notes.append(&mut notes);
    let hits = segment::select(&recording, &found, &options.hits)?;
    if recording.force.is_some() && options.strike.estimator == strike::Estimator::Bins {
        return Err(FitError::BinsWithForce);
    }
    if recording.force.is_none() {
        take_tones_off(&mut recording, &hits);
    }
    let fit = match recording.force.as_ref().zip(options.force_channel) {
        Some((force, channel)) => {
            fit_force(&recording.samples, force, channel, recording.rate_hz, &hits, options.strike)?
        }
        None => fit_sound(&recording.samples, recording.rate_hz, &hits, options.strike)?,
    };
    let file = path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned();
    let stem = path.file_stem().unwrap_or(path.as_os_str()).to_string_lossy().into_owned();
    let strike = &fit.strikes[fit.loudest];
    let provenance = Provenance {
        name: stem,
        source: format!(
            "{file}, strike at {:.3} s: {} fit {} (malleus fit), {}",
            strike.hit.onset as f64 / recording.rate_hz,
            match options.strike.estimator {
                strike::Estimator::Modal => "modal",
                strike::Estimator::Bins => "bins",
            },
            if recording.force.is_some() { "with the measured force divided out" } else { "from sound alone" },
            counted(fit.modes.len(), "modes")
        ),
        licence: options.licence.clone(),
    };
    let (before, ringing) = recording.samples[..strike.hit.end].split_at(strike.hit.onset);
    let is_left_out = recording.force.is_none() && options.strike.estimator == strike::Estimator::Modal;
    if let Some(background) = Background::under(before, ringing, recording.rate_hz).filter(|_| is_left_out) {
        recording.notes.push(audio::Note::Background { level_dbfs: 20.0 * background.rms().log10() });
    }
    let heard = &recording.samples[strike.hit.onset..strike.hit.end];
    let stage = RecordedStrike::new(&recording.samples[..strike.hit.onset], heard, recording.rate_hz, strike.position);
    let judge = Heard::new(&recording.samples, recording.rate_hz, strike.hit.onset, strike.hit.end);
    let fit = trimmed(fit.clone(), &stage, &judge, &provenance)?;
    let strike = &fit.strikes[fit.loudest];
    let table = table::of_fit(&fit, &provenance);
    let rendering = stage.render(&table, heard.len())?;
    let end = lsd_window(heard, recording.rate_hz).end;
    let by_reference = render::by_reference(&table, strike.position, recording.rate_hz, end)?;
    let modes_alone = stage.distances(&rendering);
    let most_lsd_db = modes_alone.lsd_db + MOST_RISE_DB;
    let modes = PlayedTable { table, sound: rendering.clone(), distances: modes_alone };
    let with_noise = |played: PlayedTable| match options.strike.estimator {
        strike::Estimator::Modal => stage.with_residual(played, most_lsd_db),
        strike::Estimator::Bins => stage.with_prior(played, most_lsd_db),
    };
    let dry = if fit.noise.is_empty() { with_noise(modes)? } else { stage.with_noise(modes, &fit.noise)? };
    let with_residual = dry.0.distances;
    let room = room::estimate(heard, recording.rate_hz);
    let wet = match &room {
        Some(room) => stage.in_room(&dry.0.table, room)?,
        None => None,
    };
    let (mut with_room, mut room_level_db, mut best) = (None, None, dry);
    if let Some((level_db, in_room)) = wet {
        let wet = with_noise(in_room)?;
        with_room = Some(wet.0.distances);
        if is_worth_its_room(&wet.0, &best.0, modes_alone) {
            (room_level_db, best) = (Some(level_db), wet);
        }
    }
    let (PlayedTable { table, sound: whole, .. }, residual_bands) = best;
    let hearing_of_modes = judge.scores(&rendering);
    let hearing =
        if residual_bands.is_empty() && table.room.is_empty() { hearing_of_modes } else { judge.scores(&whole) };
    let range = |of: fn(&strike::Mode) -> f64| {
        let values = || fit.modes.iter().map(of);
        [values().reduce(f64::min).unwrap_or(0.0), values().fold(0.0, f64::max)]
    };
    let sounding = sounding(&fit);
    let told = material::guess(&material::ringing(&fit), &options.materials, options.solid);
    let left: Vec<f64> = heard.iter().zip(&rendering).map(|(heard, given)| heard - given).collect();
    let report = Report {
        input: path.to_owned(),
        rate_hz: recording.rate_hz,
        notes: (recording.notes.iter().map(ToString::to_string))
            .chain(told.doubts.iter().map(ToString::to_string))
            .collect(),
        strikes: fit
            .strikes
            .iter()
            .map(|strike| StrikeReport {
                at_s: strike.hit.onset as f64 / recording.rate_hz,
                contact_time_s: strike.contact_time_s,
                contact_interval_s: contact_interval_s(&recording, strike),
                lsd_db: strike.lsd_db,
                residual_db: strike.residual_db,
            })
            .collect(),
        modes: fit.modes.len(),
        frequency_hz: range(|mode| mode.frequency_hz),
        t60_s: range(strike::Mode::t60_s),
        material: told.material,
        young_modulus_pa: told.young_modulus_pa,
        lsd_db: modes_alone.lsd_db,
        lsd_reference_db: stage.distances(&by_reference).lsd_db,
        lsd_with_residual_db: with_residual.lsd_db,
        lsd_with_room_db: with_room.map(|distances| distances.lsd_db),
        erb_db: modes_alone.erb_db,
        erb_with_residual_db: with_residual.erb_db,
        erb_with_room_db: with_room.map(|distances| distances.erb_db),
        room_level_db,
        hearing,
        hearing_of_modes,
        partials: partials(&judge, &whole, &sounding),
        is_exact: fit.is_exact,
        deviations: match options.strike.estimator {
            strike::Estimator::Modal => modes::standard_deviations_in(&sounding, &left, recording.rate_hz),
            // A thousand modes would take a minute.
            strike::Estimator::Bins => None,
        }
        .unwrap_or_default(),
        residual_bands,
        estimator: options.strike.estimator,
        damping_law: bark::damping_law(heard, recording.rate_hz),
        emergence_db: bark::emergence_db(&sounding, heard, recording.rate_hz),
        room,
        seconds: start.elapsed().as_secs_f64(),
    };
    Ok(Fitted { recording, fit, table, rendering, whole, sounding, heard: judge, report })
}

/// Takes the steady tones under the loudest strike off the recording, with a note.
fn take_tones_off(recording: &mut Recording, hits: &[segment::Hit]) {
    let (samples, rate_hz) = (&mut recording.samples, recording.rate_hz);
    let peak = |hit: &segment::Hit| samples[hit.onset..hit.end].iter().fold(0.0, |peak: f64, x| peak.max(x.abs()));
    let Some(hit) = hits.iter().max_by(|a, b| peak(a).total_cmp(&peak(b))) else { return };
    let (before, strike) = samples[..hit.end].split_at(hit.onset);
    let Some(background) = Background::under(before, strike, rate_hz) else { return };
    let found = background.tones(before, strike);
    if found.is_empty() {
        return;
    }
    for (n, x) in samples.iter_mut().enumerate() {
        *x -= found.iter().map(|tone| tone.at(n as f64 - hit.onset as f64)).sum::<f64>();
    }
    let tones = found.iter().map(|tone| [tone.frequency_hz(rate_hz), 10.0 * tone.power().log10()]).collect();
    recording.notes.push(audio::Note::Tones { tones });
}

/// Contact times that a strike's sound allows; `None` if the force was measured.
fn contact_interval_s(recording: &Recording, strike: &strike::Strike) -> Option<[f64; 2]> {
    if recording.force.is_some() {
        return None;
    }
    let sound = recording.samples.get(strike.hit.onset..strike.hit.end)?;
    contact::contact_interval_s(sound, recording.rate_hz)
}

/// Audible partials beside a rendering and its modes.
fn partials(heard: &Heard, rendering: &[f64], modes: &[DampedSine]) -> Vec<PartialReport> {
    let errors_db = heard.partials().errors_db(rendering);
    let reports = heard.partials().all().zip(errors_db).map(|(partial, error_db)| {
        let distance = |mode: &&DampedSine| (mode.frequency_hz - partial.frequency_hz).abs();
        let nearest = modes.iter().min_by(|a, b| distance(a).total_cmp(&distance(b)));
        let reach_hz = (0.005 * partial.frequency_hz).max(heard.partials().bin_hz());
        PartialReport {
            at_s: partial.at_s,
            frequency_hz: partial.frequency_hz,
            level_db: partial.level_db,
            error_db,
            mode_hz: nearest.filter(|mode| distance(mode) <= reach_hz).map(|mode| mode.frequency_hz),
        }
    });
    reports.collect()
}

/// Modes of the loudest strike as they sound after its contact, extrapolated to its onset.
fn sounding(fit: &Fit) -> Vec<DampedSine> {
    let strike = fit.strikes.get(fit.loudest);
    let force = strike.map_or(Vec::new(), |strike| {
        contact::force(strike.contact_time_s, fit.rate_hz).iter().map(|x| x * strike.peak_force / fit.rate_hz).collect()
    });
    let position = strike.map_or(0.0, |strike| strike.position)
        * fit.modes.first().map_or(0, |mode| mode.gains.len().saturating_sub(1)) as f64;
    let place = if fit.measured { position.round() as usize } else { fit.loudest };
    let modes = fit.modes.iter().map(|mode| {
        let [sine, cosine] = mode.gains.get(place).copied().unwrap_or([0.0; 2]);
        // Response of the mode to the contact: Σ F[m] e^{(d - jω) t_m}.
        let (mut re, mut im) = (0.0, 0.0);
        for (m, force) in force.iter().enumerate() {
            let time_s = m as f64 / fit.rate_hz;
            let (turn_sine, turn_cosine) = (std::f64::consts::TAU * mode.frequency_hz * time_s).sin_cos();
            let grown = force * (mode.decay_per_s * time_s).exp();
            re += grown * turn_cosine;
            im -= grown * turn_sine;
        }
        DampedSine {
            frequency_hz: mode.frequency_hz,
            decay_per_s: mode.decay_per_s,
            amplitude: sine.hypot(cosine) * re.hypot(im),
            phase: (-sine).atan2(cosine) + im.atan2(re),
        }
    });
    modes.collect()
}

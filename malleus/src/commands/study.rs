//! `malleus study`: renders the trials of the paper's experiments for listeners, or lets a program
//! stand in for them.

use std::path::{Path, PathBuf};

use kit::counting::counted;
use malleus::loudness::loudest_lkfs;
use malleus::study::recognition::{self, Confusion, MOTIONS, NAMES};
use malleus::study::{Experiment, RATE, Rated, Scene, StudyTrial, methods, page_path, trials, write_page};
use malleus::wave;
use rayon::prelude::*;
use serde::Serialize;

use super::error::CommandError;
use super::output::{print, print_json, progress};
use crate::arguments::StudyCommand;

/// Shipped kit whose things are scraped.
const KIT: &str = "scrapes";
/// Loudness of all sounds of a page.
const LOUDNESS_LKFS: f64 = -26.0;
/// Window of the loudness, in seconds.
const WINDOW_S: f64 = 0.4;
/// Length in seconds of the fade at the end of a sound.
const FADE_S: f64 = 0.1;
/// Highest peak of a sound of a page, 1.0 = full scale.
const HIGHEST_PEAK: f64 = 0.9;
/// Pad and striker of the motions that are recognized. The pad's object has one position: where an
/// object sounds otherwise at another place, that tells there and back from straight on as well.
const RECOGNIZED: (&str, &str) = ("pan", "stick");

/// Report of a page that `--json` prints (docs/json.md).
#[derive(Debug, Serialize)]
struct PageReport {
    page: PathBuf,
    kit: &'static str,
    trials: usize,
    methods: Vec<&'static str>,
    sounds: Vec<SoundReport>,
}

#[derive(Debug, Serialize)]
struct SoundReport {
    file: PathBuf,
    trial: usize,
    text: String,
    method: &'static str,
    duration_s: f64,
    gain_db: f64,
}

/// Report of the stand-in that `--json` prints (docs/json.md).
#[derive(Debug, Serialize)]
struct StandInReport {
    kit: &'static str,
    pad: &'static str,
    striker: &'static str,
    renderings: u32,
    seed: u32,
    motions: [&'static str; MOTIONS],
    methods: Vec<MethodReport>,
}

#[derive(Debug, Serialize)]
struct MethodReport {
    method: &'static str,
    /// Rows: motion that was played; columns: motion that was heard.
    confusion: [[f64; MOTIONS]; MOTIONS],
    groups_right: f64,
    pairs_right: f64,
    /// Scraping-rolling eq. 14, against a listener who tells all motions apart.
    similarity: f64,
}

pub(crate) fn run(command: &StudyCommand) -> Result<(), CommandError> {
    match command {
        StudyCommand::Scraping(arguments) => {
            if let Some(folder) = &arguments.output {
                let report = page(Experiment::Scraping, folder)?;
                // The stand-in's JSON stands alone on stdout.
                if !(arguments.stand_in && arguments.json) {
                    report.print(arguments.json)?;
                }
            }
            match arguments.stand_in {
                true => stand_in(arguments.renderings, arguments.seed, arguments.json),
                false => Ok(()),
            }
        }
        StudyCommand::Rolling(arguments) => page(Experiment::Rolling, &arguments.output)?.print(arguments.json),
    }
}

/// Renders all trials by all methods, and writes sounds and page.
fn page(experiment: Experiment, folder: &Path) -> Result<PageReport, CommandError> {
    let loaded = kit::open(KIT)?;
    let trials = trials(experiment);
    let methods: Vec<_> = methods(experiment).collect();
    let path = page_path(folder, experiment)?;
    let sounds_folder = folder.join("sounds");
    std::fs::create_dir_all(&sounds_folder).map_err(|cause| kit::file::FileError {
        action: "made",
        path: sounds_folder.clone(),
        cause,
    })?;
    let bar = progress((trials.len() * methods.len()) as u64, "rendering the trials");
    let rendered = trials.par_iter().map(|trial| {
        let sounds = methods.iter().map(|method| {
            let sound = played(&loaded.kit, trial, method.ablations)?;
            bar.inc(1);
            Ok((method.name, sound))
        });
        sounds.collect::<Result<Vec<_>, CommandError>>()
    });
    let rendered = rendered.collect::<Result<Vec<_>, CommandError>>()?;
    bar.finish_and_clear();
    let (mut rated, mut reports) = (Vec::new(), Vec::new());
    for (index, (trial, sounds)) in trials.iter().zip(rendered).enumerate() {
        let mut own = Vec::new();
        for (method, sound) in sounds {
            let gain = gain(&sound);
            let loud: Vec<f64> = faded(&sound).map(|x| gain * x).collect();
            let file = sounds_folder.join(format!("{:02}-{method}.wav", index + 1));
            wave::write_mono(&file, RATE.hz(), &loud)?;
            own.push((method, loud.iter().map(|&x| x as f32).collect()));
            let (text, duration_s) = (trial.text.clone(), loud.len() as f64 / RATE.hz());
            reports.push(SoundReport { file, trial: index, text, method, duration_s, gain_db: 20.0 * gain.log10() });
        }
        rated.push(Rated { text: trial.text.clone(), sounds: own });
    }
    write_page(&path, experiment, &rated)?;
    let methods: Vec<_> = methods.iter().map(|method| method.name).collect();
    Ok(PageReport { page: path, kit: KIT, trials: trials.len(), methods, sounds: reports })
}

/// Sound whose end fades to silence, so that none stops with a click that tells its method.
fn faded(sound: &[f64]) -> impl Iterator<Item = f64> {
    let fade = (FADE_S * RATE.hz()) as usize;
    let weight = move |from_end: usize| {
        let share = (from_end as f64 / fade as f64).min(1.0);
        0.5 - 0.5 * (std::f64::consts::PI * share).cos()
    };
    sound.iter().enumerate().map(move |(index, x)| weight(sound.len() - 1 - index) * x)
}

impl PageReport {
    fn print(&self, json: bool) -> Result<(), CommandError> {
        if json {
            return print_json(self);
        }
        print(&format!(
            "{}: {}, each by {}; open it in a browser, rate the sounds, and save the ratings at the end\n",
            self.page.display(),
            counted(self.trials, "trials"),
            self.methods.join(", ")
        ))
    }
}

/// Sound of a trial without parts of the model.
fn played(
    kit: &kit::Kit,
    trial: &StudyTrial,
    ablations: &[malleus::render::scraped::Ablation],
) -> Result<Vec<f64>, CommandError> {
    let scene = Scene::of(kit, trial.pad, trial.striker)?;
    let motion = trial.trial.draw()?.motion().map_err(malleus::motion::trials::TrialError::from)?;
    Ok(scene.play(&motion, ablations)?)
}

/// Gain that makes a sound as loud as the others of the page, and lets it not clip.
fn gain(sound: &[f64]) -> f64 {
    // A mono sound is heard on both sides.
    let both: Vec<[f64; 2]> = sound.iter().map(|&x| [x, x]).collect();
    let louder = 10f64.powf((LOUDNESS_LKFS - loudest_lkfs(&both, RATE.hz(), WINDOW_S)) / 20.0);
    let peak = sound.iter().fold(0.0f64, |peak, x| peak.max(x.abs()));
    louder.min(HIGHEST_PEAK / peak.max(1e-12))
}

/// Lets a program tell the motions apart, and prints what it confuses.
fn stand_in(renderings: u32, seed: u32, json: bool) -> Result<(), CommandError> {
    let loaded = kit::open(KIT)?;
    let (pad, striker) = RECOGNIZED;
    let scene = Scene::of(&loaded.kit, pad, striker)?;
    let methods: Vec<_> = methods(Experiment::Scraping).collect();
    let bar = progress(2 * u64::from(renderings) * (MOTIONS * methods.len()) as u64, "listening");
    let mut reports = Vec::new();
    for method in methods {
        let confusion = recognition::confusion(&scene, method.ablations, (renderings, seed), || bar.inc(1))?;
        reports.push(MethodReport {
            method: method.name,
            confusion: confusion.shares(),
            groups_right: confusion.groups_right(),
            pairs_right: confusion.pairs_right(),
            similarity: confusion.similarity_to(&Confusion::perfect()),
        });
    }
    bar.finish_and_clear();
    let report = StandInReport { kit: KIT, pad, striker, renderings, seed, motions: NAMES, methods: reports };
    if json { print_json(&report) } else { print(&as_text(&report)) }
}

fn as_text(report: &StandInReport) -> String {
    let mut text = format!(
        "{} of each motion to learn from, {} to be tested by; pad {}, striker {}\n",
        counted(report.renderings, "renderings"),
        report.renderings,
        report.pad,
        report.striker
    );
    for method in &report.methods {
        text += &format!(
            "\n{}: groups {:.1} % right, within pairs {:.1} %, similarity {:.3} (eq. 14)\n",
            method.method,
            100.0 * method.groups_right,
            100.0 * method.pairs_right,
            method.similarity
        );
        text += &format!("{:>16}", "played \\ heard");
        report.motions.iter().for_each(|name| text += &format!("{name:>15}"));
        text.push('\n');
        for (name, row) in report.motions.iter().zip(&method.confusion) {
            text += &format!("{name:>16}");
            row.iter().for_each(|share| text += &format!("{:>13.0} %", 100.0 * share));
            text.push('\n');
        }
    }
    text
}

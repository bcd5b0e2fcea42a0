//! Output of the measurements: page, JSON and picture.

use std::path::{Path, PathBuf};

use kit::file::{FileError, write_whole};
use malleus::plot::{self, KernelMark, PlotError, RunTimePicture};
use serde::Serialize;

use super::bits::Compared;
use super::cycles_over_modes::OverModes;
use super::measure::ALL_FORMS;
use super::over_modes_page;
use super::rows::{Driven, FRAMES, FURTHER_MODE, KernelRow, OURS_FIXED, OURS_FRAMES, SceneRow};
use super::verdict::Verdict;

/// Command that makes page, JSON and picture.
pub const COMMAND: &str = "cargo bench -p host-tests --bench run_time_vs_error";

/// Reason for which a report cannot be written.
#[derive(Debug, thiserror::Error)]
pub enum ReportError {
    /// A file could not be written.
    #[error(transparent)]
    File(#[from] FileError),
    /// The picture could not be drawn.
    #[error(transparent)]
    Plot(#[from] PlotError),
    /// The rows could not be written as JSON.
    #[error("the rows cannot be written as JSON: {0}")]
    Json(#[from] serde_json::Error),
}

/// All measurements.
#[derive(Clone, Debug, Serialize)]
pub struct Report {
    /// Kernels alone.
    pub kernels: Vec<KernelRow>,
    /// Whole scenes.
    pub scenes: Vec<SceneRow>,
    /// Pads with growing numbers of modes, in the bank and in frames.
    pub cycles_over_modes: OverModes,
    /// Comparison of the bank on the virtual core with the bank on the PC.
    #[serde(skip)]
    pub bank_bits: Compared,
    /// Comparison of the rivals on the virtual core with the rivals on the PC.
    #[serde(skip)]
    pub rival_bits: Compared,
}

impl Report {
    /// Markdown of the page: verdict, table, scenes.
    pub fn markdown(&self) -> String {
        let mut page = format!(
            "# Run time against error\n\n{OPENING}\n\n```\n{COMMAND}\n```\n\n![Signal-to-noise ratio over cycles](images/run_time_vs_error.png)\n\n"
        );
        if let Some(verdict) = Verdict::of(&self.kernels) {
            page += &format!("{verdict}\n");
        }
        page += &self.frames_sentence().unwrap_or_default();
        page += &self.bits_sentence();
        page += NOTES;
        page += "## Kernels\n\n";
        page += "| kernel | form | input | block | modes | cycles: nominal | best to worst | with flash | instructions | loop, bytes | SNR: worst, dB | median, dB | PC, ns |\n";
        page += "| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |\n";
        self.kernels.iter().for_each(|row| page += &kernel_line(row));
        if !self.scenes.is_empty() {
            page += "\n## Scenes\n\n";
            page += "| scene | modes | cycles a frame | with flash | share of 168 MHz | share of 96 MHz |\n";
            page += "| --- | --- | --- | --- | --- | --- |\n";
            self.scenes.iter().for_each(|row| page += &scene_line(row));
        }
        if !self.cycles_over_modes.pads.is_empty() {
            page += &over_modes_page::section(&self.cycles_over_modes);
        }
        page
    }

    /// Sentence about the dearest and the cheapest of the rows in frames; `None` without them.
    fn frames_sentence(&self) -> Option<String> {
        let free =
            |form| move |row: &&KernelRow| row.kernel == OURS_FRAMES && row.form == form && row.driven == Driven::Free;
        let all = self.kernels.iter().filter(free(FRAMES)).max_by_key(|row| row.modes)?;
        let further = self.kernels.iter().find(free(FURTHER_MODE))?;
        Some(format!(
            "In frames, {} modes ring freely at {:.2} cycles a mode and sample, and a further mode takes {:.2}; worst SNR {:.1} dB.\n\n",
            all.modes?, all.cycles_nominal, further.cycles_nominal, all.snr_worst_db?
        ))
    }

    fn bits_sentence(&self) -> String {
        let sentence = |what: &str, Compared { samples, different }: Compared| match different {
            0 => format!("{what}: all {samples} samples compared have the same bits"),
            _ => format!("{what}: {different} of {samples} samples compared DIFFER"),
        };
        let bank = sentence("Virtual core against PC, bank", self.bank_bits);
        let rivals = sentence("rivals", self.rival_bits);
        format!("{bank}; {rivals}.\n\n")
    }

    /// JSON of all rows, for programs.
    ///
    /// # Errors
    /// [`ReportError::Json`].
    pub fn json(&self) -> Result<String, ReportError> {
        Ok(serde_json::to_string_pretty(self)? + "\n")
    }

    /// Writes `docs/run_time_vs_error.md`, its two pictures in `docs/images` and
    /// `target/run_time_vs_error.json` of a workspace; gives their paths.
    ///
    /// # Errors
    /// [`ReportError`].
    pub fn write(&self, workspace: &Path) -> Result<[PathBuf; 4], ReportError> {
        let page = workspace.join("docs/run_time_vs_error.md");
        let picture = workspace.join("docs/images/run_time_vs_error.png");
        let json = workspace.join("target/run_time_vs_error.json");
        let over_modes = workspace.join("docs/images/cycles_over_modes.png");
        for path in [&page, &picture, &over_modes, &json] {
            create_folder_of(path)?;
        }
        write_whole(&page, self.markdown().as_bytes())?;
        write_whole(&json, self.json()?.as_bytes())?;
        plot::run_time(&picture, &self.picture())?;
        plot::crossings(&over_modes, &over_modes_page::picture(&self.cycles_over_modes))?;
        Ok([page, picture, over_modes, json])
    }

    fn picture(&self) -> RunTimePicture {
        RunTimePicture {
            title: "Run time against error".to_owned(),
            remark: "one mode against the f64 reference, 20 Hz to 20 kHz, T60 0.05 to 20 s; blocks of 32 frames"
                .to_owned(),
            kernels: self.kernels.iter().filter_map(|row| self.mark(row)).collect(),
        }
    }

    /// Mark of a kernel in the picture, made from its row without input and its row with input.
    fn mark(&self, row: &KernelRow) -> Option<KernelMark> {
        let part_of_bank = row.kernel == OURS_FIXED && row.form != ALL_FORMS;
        if part_of_bank || row.driven != Driven::Free || row.block != 32 {
            return None;
        }
        let is_in_frames = row.kernel == OURS_FRAMES;
        let frames = || self.kernels.iter().filter(|other| other.kernel == OURS_FRAMES);
        // The other picture shows how the cycles of frames depend on the number of modes.
        if is_in_frames && row.modes != frames().filter_map(|other| other.modes).max() {
            return None;
        }
        let key = |row: &KernelRow| (row.kernel.clone(), row.form.clone(), row.block, row.modes);
        let same = |other: &&KernelRow| key(other) == key(row);
        let driven = self.kernels.iter().filter(same).find(|other| other.driven == Driven::Gain)?;
        let label = match row.modes {
            _ if row.form == ALL_FORMS => row.kernel.clone(),
            Some(modes) if is_in_frames => format!("{}, {modes} modes", row.form),
            _ => format!("{}: {}", row.kernel, row.form),
        };
        Some(KernelMark {
            label,
            ours: row.is_ours(),
            cycles: (row.cycles_nominal, driven.cycles_nominal),
            snr_db: (row.snr_worst_db?, row.snr_median_db?),
        })
    }
}

const OPENING: &str = "\
This page tells what a mode and what a whole scene take of a Cortex-M4F, and how exact a mode is, beside other crates. To measure
all of it anew and write this page:";

const NOTES: &str = "\
Cycles, instructions and nanoseconds are for a mode and sample. Cycles are those of a published model of the Cortex-M4F (crate
`virtual-core`), memory without wait states; *with flash* adds the waits of an STM32F407's flash at 168 MHz behind its accelerator. They have
not been compared with silicon. The SNR is taken on the PC over the grid of one mode (20 Hz to 20 kHz in 40 steps, T60 0.05, 0.2, 1, 5
and 20 s, 44.1 and 48 kHz, over min(T60, 2 s), struck by an impulse at full scale, sine gain); a form of the
bank has that of the cases that it plays.
Nanoseconds are from the PC that ran this, which does other things too: only their ratios mean anything; the bank's contain its
bookkeeping and are those of its portable kernel.

Input: *free* is none (a constant 0 for the crates, so that the compiler drops what it multiplies); *gain* is a force in a buffer, with one
gain a mode; *gain and phase* two. The crates are used as their documentation shows, `run(x)` or `process(state, x)` in a loop over the
block, with their memory in registers and their output added to the mix in the same loop. Fixed-point rivals peak at 2^29, with two bits of
headroom. `biquad` brings no fixed-point type.

*frame bank* is a bank [in frames](frames.md) as a stage, at 44.1 kHz, with all its work: transform, force, panning, bookkeeping. Much of it
does not depend on the number of modes, so that a mode's share falls with them. *A further mode* is the difference between 256 and 1025 modes.
Cosine gains cost it nothing. For its SNR each mode is struck at a random frame of a block.

";

fn kernel_line(row: &KernelRow) -> String {
    let decimal = |value: Option<f64>| value.map_or("-".to_owned(), |value| format!("{value:.1}"));
    let modes = row.modes.map_or("-".to_owned(), |modes| modes.to_string());
    let loop_bytes = if row.loop_bytes == 0 { "-".to_owned() } else { row.loop_bytes.to_string() };
    format!(
        "| {} | {} | {} | {} | {modes} | {:.2} | {:.2} to {:.2} | {:.2} | {:.2} | {loop_bytes} | {} | {} | {} |\n",
        row.kernel,
        typed(&row.form),
        row.driven.name(),
        row.block,
        row.cycles_nominal,
        row.cycles_best,
        row.cycles_worst,
        row.cycles_with_flash,
        row.instructions,
        decimal(row.snr_worst_db),
        decimal(row.snr_median_db),
        decimal(row.pc_ns),
    )
}

/// Text of a form in Markdown, where a plain `<` would begin HTML.
pub(super) fn typed(form: &str) -> String {
    if form.contains('<') { format!("`{form}`") } else { form.to_owned() }
}

fn scene_line(row: &SceneRow) -> String {
    format!(
        "| {} | {} | {:.0} | {:.0} | {:.1} % | {:.1} % |\n",
        row.scene,
        row.modes,
        row.cycles_per_frame_nominal,
        row.cycles_per_frame_with_flash,
        100.0 * row.share_of_168_mhz,
        100.0 * row.share_of_96_mhz,
    )
}

fn create_folder_of(path: &Path) -> Result<(), ReportError> {
    let Some(folder) = path.parent() else { return Ok(()) };
    std::fs::create_dir_all(folder)
        .map_err(|cause| FileError { action: "written", path: path.to_owned(), cause }.into())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(kernel: &str, form: &str, driven: Driven, cycles: f64, snr_db: Option<f64>) -> KernelRow {
        KernelRow {
            kernel: kernel.to_owned(),
            form: form.to_owned(),
            driven,
            block: 32,
            modes: Some(64),
            cycles_best: cycles,
            cycles_nominal: cycles,
            cycles_worst: cycles,
            cycles_with_flash: cycles,
            instructions: cycles,
            loop_bytes: 100,
            snr_worst_db: snr_db,
            snr_median_db: snr_db,
            pc_ns: None,
        }
    }

    fn report() -> Report {
        let kernels = vec![
            row(OURS_FIXED, ALL_FORMS, Driven::Free, 5.0, Some(100.0)),
            row(OURS_FIXED, ALL_FORMS, Driven::Gain, 8.0, Some(100.0)),
            row("idsp", "Biquad<f32>", Driven::Free, 15.0, Some(20.0)),
            row("idsp", "Biquad<f32>", Driven::Gain, 20.0, Some(20.0)),
            row("idsp", "Normal<f32>", Driven::Free, 25.0, Some(60.0)),
            row("plain loop", "direct form", Driven::Free, 9.0, Some(10.0)),
        ];
        Report {
            kernels,
            scenes: Vec::new(),
            cycles_over_modes: OverModes::default(),
            bank_bits: Compared::default(),
            rival_bits: Compared::default(),
        }
    }

    #[test]
    fn the_verdict_names_the_quickest_and_the_most_accurate_crate() {
        let verdict = Verdict::of(&report().kernels).expect("bank and crates are there");
        assert_eq!(verdict.quickest_filter.cycle_ratio, 4.0);
        assert_eq!((verdict.quickest_without_input.cycle_ratio, verdict.quickest_without_input.gap_db), (3.0, 80.0));
        assert_eq!((verdict.most_accurate.cycle_ratio, verdict.most_accurate.gap_db), (5.0, 40.0));
        assert_eq!(Verdict::of(&report().kernels[..2]), None);
    }

    #[test]
    fn bookkeeping_has_no_snr_in_json_and_table() {
        let bookkeeping = row(OURS_FIXED, "guard", Driven::GainAndPhase, 0.5, None);
        let report = Report { kernels: vec![bookkeeping], ..report() };
        let json: serde_json::Value = serde_json::from_str(&report.json().expect("JSON")).expect("JSON");
        assert_eq!(json["kernels"][0]["driven"], "gain and phase");
        assert!(json["kernels"][0]["snr_worst_db"].is_null() && json["scenes"].is_array());
        assert!(report.markdown().contains("| - | - | - |\n"));
    }

    #[test]
    fn a_kernel_without_a_driven_row_is_not_in_the_picture() {
        let labels: Vec<String> = report().picture().kernels.into_iter().map(|kernel| kernel.label).collect();
        assert_eq!(labels, [OURS_FIXED, "idsp: Biquad<f32>"]);
    }
}

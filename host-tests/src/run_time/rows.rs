//! Rows of the table and of `target/run_time_vs_error.json`.

use serde::Serialize;

/// Input of a kernel while it runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub enum Driven {
    /// No input: modes ring on.
    #[serde(rename = "free")]
    Free,
    /// Force with one gain a mode.
    #[serde(rename = "gain")]
    Gain,
    /// Force with a sine and a cosine gain a mode.
    #[serde(rename = "gain and phase")]
    GainAndPhase,
}

impl Driven {
    /// Name of the input in the table.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Free => "free",
            Self::Gain => "gain",
            Self::GainAndPhase => "gain and phase",
        }
    }
}

/// Kernel in one use. Cycles and instructions are for a mode and sample on the virtual Cortex-M4F.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct KernelRow {
    /// Name of the kernel: `Q31 bank`, `frame bank`, `f32 modes`, `plain loop`, or a crate.
    pub kernel: String,
    /// Form of the recurrence, or type of the crate.
    pub form: String,
    /// Input of the kernel.
    pub driven: Driven,
    /// Frames of a call.
    pub block: u32,
    /// Number of modes that were played together, between which cycles, instructions and time are
    /// shared.
    ///
    /// `None` for the cost of a further mode.
    pub modes: Option<u32>,
    /// Fewest cycles that Arm's timing tables permit, with memory without wait states.
    pub cycles_best: f64,
    /// Cycles between best and worst: the figure to quote.
    pub cycles_nominal: f64,
    /// Most cycles that Arm's timing tables permit.
    pub cycles_worst: f64,
    /// Nominal cycles, with the waits of flash at 168 MHz behind its accelerator.
    pub cycles_with_flash: f64,
    /// Number of instructions.
    pub instructions: f64,
    /// Length of the hottest loop in bytes. Above 1024 it does not fit the instruction cache of an
    /// STM32F4.
    pub loop_bytes: u32,
    /// Worst SNR in dB against the `f64` reference, over the cases of the grid that the form plays.
    ///
    /// `None` for bookkeeping.
    pub snr_worst_db: Option<f64>,
    /// Median SNR in dB over these cases.
    pub snr_median_db: Option<f64>,
    /// Time of equal work on the PC that ran the bench, in ns a mode and sample. Only ratios of
    /// such times mean anything.
    pub pc_ns: Option<f64>,
}

impl KernelRow {
    /// True if the kernel belongs to this project, false if it is a rival.
    pub fn is_ours(&self) -> bool {
        [OURS_FIXED, OURS_FLOAT, OURS_FRAMES].contains(&self.kernel.as_str())
    }
}

/// [`KernelRow::kernel`] of the fixed-point bank.
pub const OURS_FIXED: &str = "Q31 bank";
/// [`KernelRow::kernel`] of the single-precision modes.
pub const OURS_FLOAT: &str = "f32 modes";
/// [`KernelRow::kernel`] of the bank in frames.
pub const OURS_FRAMES: &str = "frame bank";
/// [`KernelRow::form`] of the bank in frames with all its work, shared between its modes.
pub const FRAMES: &str = "frames";
/// [`KernelRow::form`] of one mode more in frames, without what the bank takes for any number of
/// modes.
pub const FURTHER_MODE: &str = "frames, a further mode";

/// A whole scene on the virtual core.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SceneRow {
    /// Name of the scene.
    pub scene: String,
    /// Number of modes of the scene's kit, or of those that sound in the scene.
    pub modes: u32,
    /// Nominal cycles a frame.
    pub cycles_per_frame_nominal: f64,
    /// Cycles a frame with the waits of flash at 168 MHz.
    pub cycles_per_frame_with_flash: f64,
    /// Share of a core at 168 MHz that the scene takes in real time, 0 to 1.
    pub share_of_168_mhz: f64,
    /// Share of a core at 96 MHz that the scene takes in real time, 0 to 1.
    pub share_of_96_mhz: f64,
}

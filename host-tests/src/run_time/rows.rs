//! The rows of the table and of `target/run_time_vs_error.json`.

use serde::Serialize;

/// Input of a kernel while it runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub enum Driven {
    /// Modes ring on without input.
    #[serde(rename = "free")]
    Free,
    /// A force with one gain a mode.
    #[serde(rename = "gain")]
    Gain,
    /// A force with a sine and a cosine gain a mode.
    #[serde(rename = "gain and phase")]
    GainAndPhase,
}

impl Driven {
    /// As in the table.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Free => "free",
            Self::Gain => "gain",
            Self::GainAndPhase => "gain and phase",
        }
    }
}

/// One kernel in one use. Cycles and instructions are for a mode and sample, on the virtual
/// Cortex-M4F.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct KernelRow {
    /// Whose: `Q31 bank`, `f32 bank`, `plain loop`, or a crate.
    pub kernel: String,
    /// Which form of recurrence, or type of the crate.
    pub form: String,
    /// The input.
    pub driven: Driven,
    /// Frames a call.
    pub block: u32,
    /// The least that Arm's timing tables permit, memory without wait states.
    pub cycles_best: f64,
    /// Between best and worst: the figure to quote.
    pub cycles_nominal: f64,
    /// The most that the tables permit.
    pub cycles_worst: f64,
    /// Nominal, with the waits of flash at 168 MHz behind its accelerator.
    pub cycles_with_flash: f64,
    /// Instructions.
    pub instructions: f64,
    /// Length of the hottest loop, bytes. Above 1024 it does not fit the instruction cache of an
    /// STM32F4.
    pub loop_bytes: u32,
    /// Signal-to-noise ratio against the `f64` reference over the cases of the grid that the form plays:
    /// the worst, dB. None for bookkeeping.
    pub snr_worst_db: Option<f64>,
    /// The median, dB.
    pub snr_median_db: Option<f64>,
    /// Time of equal work on the PC that ran the bench, ns a mode and sample: only its ratios mean
    /// anything.
    pub pc_ns: Option<f64>,
}

impl KernelRow {
    /// True if it is one of this project's kernels rather than somebody else's.
    pub fn is_ours(&self) -> bool {
        self.kernel == OURS_FIXED || self.kernel == OURS_FLOAT
    }
}

/// [`KernelRow::kernel`] of the fixed-point bank.
pub const OURS_FIXED: &str = "Q31 bank";
/// [`KernelRow::kernel`] of the single-precision modes.
pub const OURS_FLOAT: &str = "f32 modes";

/// A whole scene on the virtual core.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SceneRow {
    /// Its name.
    pub scene: String,
    /// Modes of its kit, or of those that sound in it.
    pub modes: u32,
    /// Cycles a frame, nominal.
    pub cycles_per_frame_nominal: f64,
    /// Cycles a frame with the waits of flash at 168 MHz.
    pub cycles_per_frame_with_flash: f64,
    /// Share of a core of 168 MHz at its rate, 0 to 1.
    pub share_of_168_mhz: f64,
    /// Share of a core of 96 MHz at its rate, 0 to 1.
    pub share_of_96_mhz: f64,
}

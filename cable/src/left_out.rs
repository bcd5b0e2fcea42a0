//! Stages of a kit that a board leaves out.

use core::fmt;

use dsp_core::engine::{LoadError, Stage};

/// Reason for which a board leaves a stage out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Lack {
    /// The board has no memory for the stage.
    Memory,
    /// The board has no time for the stage.
    Time,
    /// The stage cannot be built at the board's sample rate.
    Rate,
    /// The board's firmware has no code for the stage.
    Code,
}

/// Stage of a kit that a board leaves out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LeftOut {
    /// Stage that is left out; `None` if the reason names no stage.
    pub stage: Option<Stage>,
    /// Reason for it.
    pub lack: Lack,
}

impl LeftOut {
    /// Bytes of a stage on the wire.
    pub const BYTES: usize = 3;

    /// Bytes of the stage on the wire: number of the stage, pad, reason.
    pub const fn bytes(self) -> [u8; Self::BYTES] {
        let (stage, pad) = match self.stage {
            None => (0, 0),
            Some(Stage::Engine) => (1, 0),
            Some(Stage::Modes(pad)) => (2, pad),
            Some(Stage::Residual(pad)) => (3, pad),
            Some(Stage::Background) => (4, 0),
            Some(Stage::DynamicFilter(pad)) => (5, pad),
            Some(Stage::Biquads(pad)) => (6, pad),
            Some(Stage::Room) => (7, 0),
            Some(Stage::Positions(pad)) => (8, pad),
            Some(Stage::Scrapes) => (9, 0),
        };
        let lack = match self.lack {
            Lack::Memory => 1,
            Lack::Time => 2,
            Lack::Rate => 3,
            Lack::Code => 4,
        };
        [stage, pad, lack]
    }

    /// Stage of bytes from the wire; `None` if a number has no meaning here.
    pub const fn from_bytes([stage, pad, lack]: [u8; Self::BYTES]) -> Option<Self> {
        let stage = match stage {
            0 => None,
            1 => Some(Stage::Engine),
            2 => Some(Stage::Modes(pad)),
            3 => Some(Stage::Residual(pad)),
            4 => Some(Stage::Background),
            5 => Some(Stage::DynamicFilter(pad)),
            6 => Some(Stage::Biquads(pad)),
            7 => Some(Stage::Room),
            8 => Some(Stage::Positions(pad)),
            9 => Some(Stage::Scrapes),
            _ => return None,
        };
        let lack = match lack {
            1 => Lack::Memory,
            2 => Lack::Time,
            3 => Lack::Rate,
            4 => Lack::Code,
            _ => return None,
        };
        Some(Self { stage, lack })
    }
}

impl From<LoadError> for LeftOut {
    fn from(error: LoadError) -> Self {
        let (stage, lack) = match error {
            LoadError::Memory { stage, .. } => (Some(stage), Lack::Memory),
            LoadError::TooDear { stage, .. } => (Some(stage), Lack::Time),
            LoadError::NotBuilt { stage } => (Some(stage), Lack::Code),
            LoadError::BeyondNyquist { stage, .. } => (Some(stage), Lack::Rate),
            LoadError::SurfaceTable(_) => (Some(Stage::Scrapes), Lack::Rate),
            LoadError::Room(_) => (Some(Stage::Room), Lack::Rate),
            LoadError::DynamicFilter { pad, .. } => (Some(Stage::DynamicFilter(pad)), Lack::Rate),
            LoadError::Biquads { pad, .. } => (Some(Stage::Biquads(pad)), Lack::Rate),
            LoadError::Pad { pad, .. } => (u8::try_from(pad).ok().map(Stage::Modes), Lack::Rate),
            LoadError::NoPads | LoadError::TooManyPads { .. } | LoadError::FilterTable(_) => (None, Lack::Rate),
        };
        Self { stage, lack }
    }
}

impl fmt::Display for LeftOut {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.stage {
            Some(stage) => write!(f, "{stage}: ")?,
            None => write!(f, "a stage: ")?,
        }
        f.write_str(match self.lack {
            Lack::Memory => "no memory",
            Lack::Time => "no time",
            Lack::Rate => "cannot be built at the board's sample rate",
            Lack::Code => "this board's firmware has no code for it",
        })
    }
}

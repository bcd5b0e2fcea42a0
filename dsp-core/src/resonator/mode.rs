//! A mode: its state, its coefficients and its input gains.

use super::coefficient::Coefficients;

/// Memory of a mode, in units of 2^-exponent of a bus step; the exponent is its group's.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(C)]
pub struct State {
    /// Quadrature component.
    pub u: i32,
    /// Component that sounds.
    pub v: i32,
}

/// Additions to the state for one unit of force, as mantissas of the group's gain exponent.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(C)]
pub struct InputGain {
    /// Gain into u.
    pub u: i32,
    /// Gain into v; 0 for a mode with sine gain only.
    pub v: i32,
}

/// A mode as a kernel meets it: 24 bytes, the first four words in the order in which they are
/// loaded.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(C)]
pub struct Mode {
    /// State; it changes with every sample.
    pub state: State,
    /// Coefficients; they change on load, choke and release.
    pub coefficients: Coefficients,
    /// Input gains; they change on load, and with the position of a strike.
    pub gain: InputGain,
}

impl Mode {
    /// A silent mode without gains, which fills memory before a kit is loaded.
    pub const SILENT: Self = Self {
        state: State { u: 0, v: 0 },
        coefficients: Coefficients { delta: 0, epsilon: 0 },
        gain: InputGain { u: 0, v: 0 },
    };
}

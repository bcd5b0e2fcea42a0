//! One mode: what it is and where it stands.

use super::coefficient::Coefficients;

/// A mode's memory, in units of 2^-exponent of a bus step (the exponent is its group's).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(C)]
pub struct State {
    /// The quadrature component.
    pub u: i32,
    /// The component that sounds.
    pub v: i32,
}

/// What one unit of force adds to the state, as mantissas of the group's gain exponent.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(C)]
pub struct InputGain {
    /// Into u.
    pub u: i32,
    /// Into v; 0 for a mode with sine gain only.
    pub v: i32,
}

/// A mode as a kernel meets it: 24 bytes, the first four words in the order in which they are loaded.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(C)]
pub struct Mode {
    /// Changes with every sample.
    pub state: State,
    /// Changes on load, choke and release.
    pub coefficients: Coefficients,
    /// Changes on load, and with the position of a strike.
    pub gain: InputGain,
}

impl Mode {
    /// A mode that does nothing, to fill memory before a kit is loaded.
    pub const SILENT: Self = Self {
        state: State { u: 0, v: 0 },
        coefficients: Coefficients { delta: 0, epsilon: 0 },
        gain: InputGain { u: 0, v: 0 },
    };
}

//! A pole as the arithmetic of a section realises it.

use super::design::Root;
use super::fractions::Realised;

/// Arithmetic of a section's step; k is the shift of u.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[repr(u8)]
pub enum Form {
    /// `u -= e v; v += e u; u -= δ u`: e < 1/2, δ < 1/2.
    Coupled = 0,
    /// `u -= (e²/2) v; v += 2 u; u -= δ u`: e² < 1, δ < 1/2.
    Shifted1 = 1,
    /// `u -= (e²/4) v; v += 4 u; u -= δ u`: e² < 2, δ < 1/2.
    Shifted2 = 2,
    /// `u -= (e²/4) v; v += 4 u; u = (1 - δ) u`: e² < 2, any δ.
    Damped = 3,
}

impl Form {
    /// Number of bits by which u is smaller than v.
    pub const fn shift(self) -> u32 {
        match self {
            Self::Coupled => 0,
            Self::Shifted1 => 1,
            Self::Shifted2 | Self::Damped => 2,
        }
    }
}

/// The two multipliers of a pair of conjugate poles: `|p|² = 1 - δ`, `|1 - p|² = e²`.
///
/// The partial fractions of a chain are derived from the rounded multipliers. So rounding moves a
/// pole, and never the balance between parts that cancel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Pole {
    /// Arithmetic of the section.
    pub form: Form,
    /// True if the pole stands for -p, on input and output of alternating sign.
    pub mirrored: bool,
    /// Multiplier e or e²/2^k, Q32.
    pub turn: i32,
    /// Multiplier δ as Q32; for [`Form::Damped`] 1 - δ as Q31.
    pub damp: i32,
}

impl Pole {
    /// Multiplier e or e²/2^k after rounding.
    pub fn turn(self) -> f64 {
        f64::from(self.turn) / TWO_POW_32
    }

    /// Multiplier of another section's v into u, Q32, that realises a result of
    /// [`Realised::handed`].
    pub(super) fn couple(self, handed: f64) -> i32 {
        libm::rint(handed / self.entry() * TWO_POW_32) as i32
    }
}

impl Realised for Pole {
    type Form = Form;

    /// A pole at 1, without decay, at which no state changes.
    const EMPTY: Self = Self { form: Form::Coupled, mirrored: false, turn: 0, damp: 0 };

    /// Bound 0, so that e² <= 2.
    const MIRROR_BELOW: f64 = 0.0;

    fn form_of(root: Root, mirrored: bool) -> Form {
        let (delta, step_squared) = steps(root, mirrored);
        match step_squared {
            _ if delta >= 0.49 => Form::Damped,
            e2 if e2 < 0.249 => Form::Coupled,
            e2 if e2 < 0.99 => Form::Shifted1,
            _ => Form::Shifted2,
        }
    }

    fn new(root: Root, mirrored: bool, &form: &Form) -> Self {
        let (delta, step_squared) = steps(root, mirrored);
        let turn = match form {
            Form::Coupled => libm::sqrt(step_squared),
            _ => step_squared / f64::from(1u32 << form.shift()),
        };
        let damp = match form {
            Form::Damped => libm::rint((1.0 - delta) * 2_147_483_648.0) as i32,
            _ => q32(delta),
        };
        Self { form, mirrored, turn: q32(turn), damp }
    }

    fn is_mirrored(self) -> bool {
        self.mirrored
    }

    fn delta(self) -> f64 {
        match self.form {
            Form::Damped => 1.0 - f64::from(self.damp) / 2_147_483_648.0,
            _ => f64::from(self.damp) / TWO_POW_32,
        }
    }

    fn step_squared(self) -> f64 {
        match self.form {
            Form::Coupled => self.turn() * self.turn(),
            _ => self.turn() * self.entry(),
        }
    }

    fn entry(self) -> f64 {
        match self.form {
            Form::Coupled => self.turn(),
            form => f64::from(1u32 << form.shift()),
        }
    }

    fn handed(self, wanted: f64) -> f64 {
        let couple = libm::rint((wanted / self.entry()).min(0.45) * TWO_POW_32).max(1.0);
        self.entry() * couple / TWO_POW_32
    }
}

const TWO_POW_32: f64 = 4_294_967_296.0;

/// Values δ = `1 - |p|²` and e² = `|1 - p|²` of a pole p, or of -p if mirrored.
///
/// Neither loses digits to cancellation, and δ is exact for a radius near 1.
pub fn steps(root: Root, mirrored: bool) -> (f64, f64) {
    let real = if mirrored { -root.real } else { root.real };
    let radius = libm::sqrt(root.square());
    ((1.0 - radius) * (1.0 + radius), (1.0 - real) * (1.0 - real) + root.imaginary * root.imaginary)
}

/// Rounds to the nearest Q32; values of a half or more give the largest Q32.
fn q32(value: f64) -> i32 {
    libm::rint(value * TWO_POW_32) as i32
}

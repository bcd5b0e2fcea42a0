//! The forms of the fixed-point bank, and the part of the grid that each plays.

use dsp_core::SampleRate;
use dsp_core::resonator::coefficient::{Form, Pole};

use crate::single_mode::Case;

/// Form in which the bank plays a mode.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FixedForm {
    /// Modified coupled form, up to fs/12.4.
    Coupled,
    /// Form shifted by 1 bit, up to about fs/6.
    Shifted1,
    /// Form shifted by 2 bits, up to fs/4.
    Shifted2,
    /// One of the other forms at fs/2 - f with alternating sign, for modes above fs/4.
    Mirrored,
}

impl FixedForm {
    /// All forms.
    pub const ALL: [Self; 4] = [Self::Coupled, Self::Shifted1, Self::Shifted2, Self::Mirrored];

    /// Name of the form in tables.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Coupled => "coupled",
            Self::Shifted1 => "shifted, k = 1",
            Self::Shifted2 => "shifted, k = 2",
            Self::Mirrored => "mirrored",
        }
    }

    /// Form in which the bank plays a case; `None` at or above Nyquist.
    pub fn of(case: &Case) -> Option<Self> {
        let pole = Pole::new(case.frequency_hz, case.decay_per_s(), case.rate)?;
        Some(match (pole.mirrored, pole.form) {
            (true, _) => Self::Mirrored,
            (false, Form::Coupled) => Self::Coupled,
            (false, Form::Shifted1) => Self::Shifted1,
            (false, Form::Shifted2) => Self::Shifted2,
        })
    }

    /// Modes that are all played in this form, spread evenly over its frequencies, at 48 kHz and
    /// -40 dB each.
    pub fn modes(self, count: u32, t60_s: f64) -> Vec<Case> {
        let (low, high) = match self {
            Self::Coupled => (60.0, 3_700.0),
            Self::Shifted1 => (3_900.0, 7_900.0),
            Self::Shifted2 => (8_200.0, 11_900.0),
            Self::Mirrored => (12_100.0, 20_000.0),
        };
        let frequency_hz = |index: u32| low + (high - low) * f64::from(index) / f64::from(count.max(2) - 1);
        let case = |index| Case { frequency_hz: frequency_hz(index), t60_s, rate: SampleRate::HZ_48000, level: 0.01 };
        (0..count).map(|index| case(index).exact()).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bank_of_one_form_has_no_mode_of_another() {
        for form in FixedForm::ALL {
            assert!(form.modes(480, 5.0).iter().all(|case| FixedForm::of(case) == Some(form)), "{form:?}");
        }
    }
}

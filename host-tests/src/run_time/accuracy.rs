//! Error of each form over the grid of one mode, measured on the PC.

use super::fixed_forms::FixedForm;
use super::rivals::{self, Rival};
use crate::single_mode::{Case, float_forms::FloatForm, framed, q31, snr_db, worst_and_median};

/// Kernel that is measured.
#[derive(Clone, Copy, Debug)]
pub enum Subject {
    /// The fixed-point bank, over the cases that it plays in one form, or over all.
    Fixed(Option<FixedForm>),
    /// The bank in frames.
    Frames,
    /// The single-precision modes.
    Float,
    /// A resonator of another crate, or the plain loop.
    Rival(Rival),
}

/// Signal-to-noise ratios of a subject over a grid.
#[derive(Clone, Debug)]
pub struct Accuracy {
    /// Kernel that was measured.
    pub subject: Subject,
    /// SNR in dB of each case that the subject plays.
    pub snr_db: Vec<f64>,
}

impl Accuracy {
    /// Worst and median SNR in dB.
    pub fn worst_and_median(&self) -> (f64, f64) {
        worst_and_median(self.snr_db.clone())
    }
}

/// Measures all subjects over a grid; `advance` is called after each case.
pub fn measure(grid: &[Case], mut advance: impl FnMut()) -> Vec<Accuracy> {
    let mut fixed: Vec<(Option<FixedForm>, f64)> = Vec::new();
    let mut others: Vec<Accuracy> = [Subject::Frames, Subject::Float]
        .into_iter()
        .chain(rivals::all().map(Subject::Rival))
        .map(|subject| Accuracy { subject, snr_db: Vec::new() })
        .collect();
    for case in grid.iter().map(Case::exact) {
        let reference: Vec<f64> = case.reference().take(case.frames()).collect();
        let snr = |sound: Vec<f64>| snr_db(reference.iter().copied(), sound);
        fixed.push((FixedForm::of(&case), snr(q31::render(&case))));
        for other in &mut others {
            let sound = match &other.subject {
                Subject::Rival(rival) => rival.render(&case),
                Subject::Frames => framed::render(&case),
                _ => FloatForm::Coupled.render(&case),
            };
            other.snr_db.push(snr(sound));
        }
        advance();
    }
    let of_form = |form: Option<FixedForm>| Accuracy {
        subject: Subject::Fixed(form),
        snr_db: fixed.iter().filter(|(of, _)| form.is_none() || *of == form).map(|(_, snr)| *snr).collect(),
    };
    std::iter::once(None).chain(FixedForm::ALL.map(Some)).map(of_form).chain(others).collect()
}

//! Common single-precision forms of a mode, for comparison.

use float_forms::modal::FloatMode;

use super::Case;

/// A single-precision form.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FloatForm {
    /// Recurrence `y = a1 y1 + a2 y2`: two multiplies, one addition.
    Direct,
    /// Rotation of a complex state: four multiplies, two additions.
    Rotation,
    /// Modified coupled form of [`float_forms::modal`]: three multiplies, three additions.
    Coupled,
}

impl FloatForm {
    /// All forms.
    pub const ALL: [Self; 3] = [Self::Direct, Self::Rotation, Self::Coupled];

    /// Name of the form in tables.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Direct => "f32 direct form",
            Self::Rotation => "f32 rotation",
            Self::Coupled => "f32 modified coupled",
        }
    }

    /// Sound of a case over its frames; the starting state is exact.
    pub fn render(self, case: &Case) -> Vec<f64> {
        let fs = case.rate.hz();
        let radius = (-case.decay_per_s() / fs).exp();
        let angle = std::f64::consts::TAU * case.frequency_hz / fs;
        let first = (case.level * radius * angle.sin()) as f32;
        let frames = case.frames();
        match self {
            Self::Direct => {
                let (a1, a2) = ((2.0 * radius * angle.cos()) as f32, (-radius * radius) as f32);
                let mut state = (0.0f32, first);
                (0..frames)
                    .map(|_| {
                        let now = state.0;
                        state = (state.1, a1 * state.1 + a2 * state.0);
                        f64::from(now)
                    })
                    .collect()
            }
            Self::Rotation => {
                let (c, s) = ((radius * angle.cos()) as f32, (radius * angle.sin()) as f32);
                let (mut x, mut y) = (case.level as f32, 0.0f32);
                (0..frames)
                    .map(|_| {
                        let now = y;
                        (x, y) = (c * x - s * y, s * x + c * y);
                        f64::from(now)
                    })
                    .collect()
            }
            Self::Coupled => {
                let mut mode = FloatMode::new(case.frequency_hz, case.decay_per_s(), fs);
                // The first step makes v = e r² u. This u makes the first sample that of the
                // reference.
                let step_squared = (1.0 - radius).powi(2) + 4.0 * radius * (angle / 2.0).sin().powi(2);
                mode.u = (f64::from(first) / (step_squared.sqrt() * radius * radius)) as f32;
                std::iter::once(0.0).chain(std::iter::repeat_with(|| f64::from(mode.step()))).take(frames).collect()
            }
        }
    }
}

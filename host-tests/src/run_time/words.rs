//! Coefficients of the rivals, computed in `f64` from a case and rounded once.
//!
//! The impulse response of each rival is `r^n sin nθ` at the case's level.

use crate::single_mode::Case;

/// Peak of a fixed-point rival's mode at full scale. It leaves two bits of headroom, as the largest
/// state of this project's bank does.
pub const FIXED_PEAK: f64 = (1u32 << 29) as f64;

/// Kind of coefficients, and their number format.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Words {
    /// `b0 b1 b2 a1 a2` of `y = b0 x + b1 x1 + b2 x2 + a1 y1 + a2 y2`, as `f32`.
    DirectFloat,
    /// `b0 b1 b2 a1 a2` in fixed point with 30 bits behind the point, because a1 reaches 2.
    Direct30,
    /// Three output weights and the pole's real and imaginary part, as `f32`.
    NormalFloat,
    /// Three output weights and the pole's two parts, in fixed point with 31 bits behind the point.
    Normal31,
    /// Input gain, frequency in cycles a sample and quality of a state-variable filter, as `f32`.
    /// Its poles are those of the case.
    StateVariable,
}

impl Words {
    /// Five words for a case.
    pub fn of(self, case: &Case) -> [u32; 5] {
        let fs = case.rate.hz();
        let radius = (-case.decay_per_s() / fs).exp();
        let angle = std::f64::consts::TAU * case.frequency_hz / fs;
        let (real, imaginary) = (radius * angle.cos(), radius * angle.sin());
        let first = case.level * imaginary;
        let direct = [0.0, first, 0.0, 2.0 * real, -radius * radius];
        let normal = [0.0, first, -case.level * real, real, imaginary];
        match self {
            Self::DirectFloat => direct.map(float),
            Self::NormalFloat => normal.map(float),
            Self::Direct30 => direct.map(fixed::<30>),
            Self::Normal31 => normal.map(fixed::<31>),
            Self::StateVariable => {
                // The loop's poles: f² = 1 - 2 r cos θ + r², f/Q = 1 - r²; its low-pass output
                // answers with f² r^n sin nθ / (r sin θ).
                let loop_gain = ((1.0 - radius).powi(2) + 4.0 * radius * (angle / 2.0).sin().powi(2)).sqrt();
                let damping = -(-2.0 * case.decay_per_s() / fs).exp_m1();
                let frequency = (loop_gain / 2.0).asin() / std::f64::consts::PI;
                [first / (loop_gain * loop_gain), frequency, loop_gain / damping, 0.0, 0.0].map(float)
            }
        }
    }
}

fn float(value: f64) -> u32 {
    (value as f32).to_bits()
}

/// Nearest fixed-point word, saturated.
fn fixed<const BITS: i32>(value: f64) -> u32 {
    ((value * 2f64.powi(BITS)).round() as i32).cast_unsigned()
}

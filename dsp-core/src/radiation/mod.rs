//! Radiation: the sound beside the modes in proportion to the force.
//!
//! [`Acceleration`] is the click of the striker's deceleration, α times the force (diffimpact eq. 1
//! and §3.2). The table gives α.
//!
//! A table may instead have its α derived (`acceleration = "balance"`). A finite number of modes
//! leaves a unipolar pulse: the modes follow a slow force as a spring would, `y = H(1) F`. But a
//! body radiates by its acceleration, and a constant force causes none. α = -H(1) cancels that
//! static response, with
//!
//! ```text
//! H(1) = (1/fs) Σ_k [ Σ_{n>=0} r^n (gs sin nθ + gc cos nθ) - gc/2 ]
//! ```
//!
//! over the modes that are rendered at the rate, at the position that is struck. It is linear in
//! the gains, so that α is interpolated as they are. [`balance`] gives α. It needs no stage: a bank
//! adds `-gc/2` times the force anyway, and adds the whole sum instead
//! ([`BankTable::is_balanced`](crate::resonator::BankTable::is_balanced)). A striker's own bank on
//! a balanced object is balanced too.

use crate::SampleRate;
use crate::fixed::{self, Scale};
use crate::resonator::coefficient::Pole;
use crate::table::layout::{GainRecord, ModeRecord};

/// Acceleration sound: `y += α F`.
///
/// It is exact to one bus step for gains below 1/2 ([`Scale`]), and costs nothing without α or
/// force.
#[derive(Clone, Copy, Debug)]
pub struct Acceleration {
    gain: Scale,
}

impl Acceleration {
    /// A stage that adds no sound.
    pub const NONE: Self = Self { gain: Scale::ZERO };

    /// Makes the stage from α, output (1.0 = full scale) per newton.
    ///
    /// `reference_force` is the force in newtons of 1.0 on the force bus.
    pub fn new(alpha: f32, reference_force: f32) -> Self {
        Self { gain: Scale::new(f64::from(alpha) * f64::from(reference_force)) }
    }

    /// True if the table has an acceleration sound.
    pub fn is_built(&self) -> bool {
        !self.gain.is_zero()
    }

    /// Adds the sound of a run of force to `out`.
    pub fn render(&self, force: &[i32], out: &mut [i32]) {
        for (out, &force) in out.iter_mut().zip(force) {
            *out = fixed::qadd(*out, fixed::saturate(self.gain.apply(force)));
        }
    }
}

/// Derives the α, output per newton, that cancels the static response of modes at their first
/// position.
///
/// `gains` are those of all positions of the first mode, then of the second, and so on. It is meant
/// for tools, not for the audio path: a Cortex-M4F computes `f64` in software.
pub fn balance(modes: &[ModeRecord], gains: &[GainRecord], positions: usize, rate: SampleRate) -> f64 {
    let rendered = modes.iter().zip(gains.chunks(positions.max(1))).filter_map(|(mode, gains)| {
        let pole = Pole::new(f64::from(mode.frequency_hz.get()), f64::from(mode.decay_per_s.get()), rate)?;
        let gain = gains.first()?;
        let (sine, cosine) = (f64::from(gain.sine.get()), f64::from(gain.cosine.get()));
        let (of_sine, of_cosine) = pole.sums();
        Some(sine * f64::from(of_sine) + cosine * (f64::from(of_cosine) - 0.5))
    });
    -rendered.sum::<f64>() / rate.hz()
}

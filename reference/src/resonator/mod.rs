//! Resonator: the vibrating object as a bank of modes driven by the force.
//!
//! An object is a sum of spring-damper systems (§3.3). Its answer to an impulse of one
//! newton-second is
//! ```text
//! h(t) = Σ_k e^(-d_k t) (gs_k sin 2πf_k t + gc_k cos 2πf_k t),   t >= 0
//! ```
//!
//! The paper has sines only, which is right for a displacement that starts from rest. The cosine
//! lets a mode start in any phase, as a radiated pressure does. The sound of a force is their
//! convolution, `y(t) = ∫ F(s) h(t-s) ds`, and at sample rate fs (impulse invariance)
//!
//! ```text
//! y[n] = (1/fs) Σ_{m<=n} F[m] h[n-m],   with h[0] at half weight
//! ```
//!
//! `h[0]` has half weight because the integral begins at the jump of h from 0 to h(0). A
//! band-limited signal has the mean of both sides there. With the full weight a cosine mode would
//! add a constant to the whole spectrum. The factor 1/fs makes the sum an integral, so that one set
//! of modes sounds alike at every rate.
//!
//! [`Mode`] and [`Gain`] are the physical parameters; [`Bank`] computes the sum.

mod bank;
mod complex;
mod mode;
mod one_pole;

pub(crate) use complex::Complex;

pub use bank::{Bank, GainsError, MODES_PER_TICK};
pub use mode::{Gain, Mode};

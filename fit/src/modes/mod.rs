//! Modes from sound: frequency, decay, amplitude and phase of the damped sines that make it up.
//!
//! ```text
//! sound ─► search ─► candidates ─► refine ─► prune ─► model ─► residual
//!            ▲     (likelihood    (all modes  (BIC)               │
//!            │      ratio)         jointly)                       │
//!            └────────────────────────────────────────────────────┘
//! ```
//!
//! Under white noise the refinement is the maximum-likelihood estimate of all modes together. It
//! attains the Cramer-Rao bounds for the modes that are found
//! (`cargo bench -p fit --bench synthetic` prints both).

mod basis;
mod bounds;
mod damped_sine;
mod esprit;
mod estimate;
mod noise;
mod pole;
mod polish;
mod power_sums;
mod refine;
mod search;
mod subbands;

pub(crate) use basis::{Basis, Stretch};
pub use bounds::{Bounds, cramer_rao_bounds, standard_deviations_in};
pub use damped_sine::DampedSine;
pub use estimate::{Settings, estimate};
pub(crate) use estimate::{estimate_poles, explains, filled};
pub(crate) use noise::NoiseFloor;
pub(crate) use pole::{Pole, add_ringing, project};
pub(crate) use polish::polish;
pub(crate) use refine::{Ending, Gains, Group, Model, refine, refine_shared};
pub(crate) use search::{Candidate, Range as SearchRange, standing_out, stands_out};
pub(crate) use subbands::candidates;

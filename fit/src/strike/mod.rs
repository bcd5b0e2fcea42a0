//! Fit of one struck object: from the strikes of a recording to modes, gains and contact times.

mod audible;
mod fit;
mod force;
mod high_pass;
mod loudest;
mod measured;
mod near;
mod noise;
mod shared;
mod sound;

pub use fit::{Estimator, Fit, Mode, Settings, Strike};
pub use force::fit_force;
pub use high_pass::high_pass;
pub use measured::{MeasuredHit, force_width_s, measured_hits};
pub use shared::{Place, Shared, share_poles};
pub use sound::fit_sound;

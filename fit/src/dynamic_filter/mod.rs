//! Fit of the dynamic filter to a strike: noise through a low-order filter whose coefficients move,
//! and at most ten modes (*Analysis-Synthesis of Impact Sounds by Real-Time Dynamic Filtering*,
//! §IV).
//!
//! ```text
//! strike ─► damping law α(f), Λ(f) ─┬► three bands, first order (eq. 19 to 21) ─┐
//!           (crate::bark)           └► all bands, first or second order ────────┴► breakpoints
//!        ─► modes ─► at most ten ─┬► beside the filter, damped (additive) ─► levels left to noise
//!                                 └► loops round it: d_s, γ_s (eq. 22 to 24) ─► banded waveguides
//! ```

pub mod study;
pub mod table;

mod additive;
mod average_filter;
mod closed_loop;
mod damping;
mod delay;
mod evaluation;
mod guide;
mod lattice;
mod levels;
mod misfit;
mod model;
mod objective;
mod path;
mod response;
mod ringing;
mod sound;
mod stability;
mod thin;
mod three_bands;
mod times;
mod waveguide;

pub use additive::additive;
pub use average_filter::{USUAL_BANDWIDTH_HZ, average, by_average_filter};
pub use damping::{Comparison, compare, counted, mean_law};
pub use delay::SHORTEST_DELAY;
pub use model::{Breakpoint, Coefficients, Form, Loop, MOST_MODES, Model, Path, RATE_HZ};
pub use path::{Criterion, noise_alone};
pub use response::response;
pub use sound::render;
pub use stability::{MOST_LOOP_GAIN, loop_gain};
pub use thin::{MOST_BREAKPOINTS, THINNED_WITHIN_DB};
pub use waveguide::waveguide;

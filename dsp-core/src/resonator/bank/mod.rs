//! Modal bank: `y[n] = (1/fs) Σ F[m] h[n-m]`, `h[n] = r^n (gs sin nθ + gc cos nθ)`, the first
//! sample of h at half weight.

mod choke;
mod exchange;
mod guard;
mod load;
mod mix;
mod origin;
mod position;
mod reach;
mod render;
mod run_cost;
mod shed;
mod shed_plan;
mod slot;
mod state;
mod work;

pub use load::BankSize;
pub use mix::MixShift;
pub use origin::Origin;
pub use reach::MODES_PER_TICK as HAND_MODES_PER_TICK;
pub use run_cost::{UpcomingRun, Use};
pub use shed::Shed;
pub use shed_plan::{Audience, ShedChoice, ShedPlan};
pub use slot::Place;
pub use state::Bank;
pub use work::BankWork;

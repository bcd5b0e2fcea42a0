//! Code that the tests and benches of this crate share: signals measured against the `f64`
//! reference.

pub mod biquads;
pub mod dynamic_filter;
pub mod frames;
pub mod lent;
pub mod on_chip;
pub mod performance;
pub mod residual;
pub mod rolls;
pub mod room;
pub mod run_time;
pub mod scene;
pub mod scrape;
pub mod single_mode;
pub mod snr;
pub mod sweeps;
pub mod trigger;

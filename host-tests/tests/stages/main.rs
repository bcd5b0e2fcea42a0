//! Single stages of `dsp-core` against their reference in `f64`: accuracy, refusals, bounds,
//! silence. `cargo test -p host-tests --test stages room::` runs one part.

mod biquad_forms;
mod biquad_rates;
mod biquads;
mod biquads_float;
mod contact;
mod dynamic_filter;
mod dynamic_filter_noise;
mod frames;
mod limiter;
mod long_tails;
mod residual;
mod room;
mod waveguides;

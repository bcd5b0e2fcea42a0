//! `dsp-core` on the virtual Cortex-M4F: bits, cycles, budget. It is one program, so that its long
//! tests run side by side. `cargo test -p host-tests --test on_chip costs` runs one part.

mod biquads;
mod budget;
mod costs;
mod filters;
mod frames;
mod hands;
mod kernels;
mod limiter;
mod page;
mod residual;
mod rolls;
mod room;
mod scrape;
mod trigger;

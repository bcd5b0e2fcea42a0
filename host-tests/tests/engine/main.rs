//! The whole engine against the `f64` reference: accuracy, skipped work, hands, any block size,
//! shipped kits. `cargo test -p host-tests --test engine hands::` runs one part.

mod block_size;
mod choke_residual;
mod choke_stages;
mod demo_kit;
mod fader;
mod filters;
mod filters_any;
mod frames;
mod hands;
mod hands_on_frames;
mod measured_force;
mod midi;
mod positions;
mod residual;
mod rolls;
mod room;
mod scrapes;
mod skipping;
mod static_response;
mod velocity;

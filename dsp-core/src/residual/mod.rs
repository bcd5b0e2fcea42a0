//! Residual: bands of decaying noise that an object sounds beside its modes (physics-diffusion eq.
//! 5, 6), and the stationary background.
//!
//! ```text
//! y(t) = Σ_m w_m 10^(-γ_m t/20) BPF_m(noise)      w rms at t = 0, γ in dB/s, up to 100 bands
//!
//! strike --> energy a band --> spectrum of a frame --> random lines --+
//!              ^      |         (1024 samples)           (SFC32)      |
//!              +------+                                               |
//!         10^(-γ/10 a second)       Σ <-- window <-- inverse transform+
//!                                     (quarter sines) (f32, in pieces)
//! ```
//!
//! A filter for each band would cost a hundred times as much as one filter. Here each pad has one
//! noise, which is shaped in frequency frame by frame: a line of a frame's spectrum is a random
//! number with the power of the bands at its place. Frames overlap by a quarter with
//! power-complementary windows, so that the expected power stays constant from frame to frame. The
//! work for a frame is shared among the 24 ticks before it.
//!
//! A strike begins a frame of its own at its very sample, with nothing before it. Of that frame
//! only the level depends on the strike: its noise is ready before the strike comes, and new noise
//! for the next strike is made little by little afterwards. The next frame begins 24 ticks later.
//! It carries what is left of the strike and of everything that rang before: energies add, band by
//! band.
//!
//! Within a frame the amplitude falls sample by sample by the mean decay of its energy. Each band
//! has the energy that its own decay leaves under the window, and a tilt in time where its decay
//! differs from the mean (`lines`).
//!
//! Resolution: lines are fs/1024 apart (47 Hz at 48 kHz). Narrower bands share lines with their
//! neighbours (`edges`).
//!
//! A strike within 24 ticks of another raises that one's first frame as a whole; from the second
//! frame on it counts band by band.
//!
//! Amplitude is proportional to a strike's peak force, as that of the modes is.

mod bands;
mod edges;
mod fill;
mod job;
mod lines;
mod making;
mod onset;
mod schedule;
mod shaper;
mod slope;
mod stream;

pub use crate::table::ResidualBand;
pub use bands::MAX_BANDS;
pub use shaper::Shaper;

//! The sound of struck objects: the model in `f64`, written from the papers.
//!
//! This crate is to be read beside *DiffImpact: Differentiable Rendering and Identification of
//! Impact Sounds* (Clarke et al., 2021), whose equation numbers stand in the comments ("eq. 2"). It
//! knows physical parameters only (hertz, newtons, seconds) and computes in double precision. It
//! makes no concession to a microcontroller, because the real-time instrument is measured against
//! it.
//!
//! # Signal flow, one module for each stage
//!
//! ```text
//!  event          contact             resonator                   pad               scene
//!
//!  strike ──► m = m1·v^a          ┌─► object bank ───────────┐
//!  (v, where,  τ = τ1·v^b    F    │   radiation              │     y     level, pan
//!   with what) pulse m·C(t) ──►(+)┼─► α·F ────────────────►(+)────────► (+) ──► left, right
//!                              ▲  │                          │              ▲
//!  direct force ───────────────┘  └─► η · striker banks ─────┘              └─ the other pads
//! ```
//!
//! | stage | what it computes | source |
//! | --- | --- | --- |
//! | [`trigger`] | piezos to strikes | this project |
//! | [`event`] | strikes, chokes, releases and direct force, each at its time | this project |
//! | [`contact`] | from velocity to a contact force over time; strikes sum | eq. 2, 3 |
//! | [`resonator`] | the force drives a bank of decaying modes | §3.3 |
//! | [`radiation`] | `α·F`: the striker's click, or the static response's opposite | eq. 1, §3.2 |
//! | [`dynamic_filter`] | noise through a filter that changes | dynamic filtering eq. 5, 6, 17 |
//! | [`waveguide`] | loops round the dynamic filter | dynamic filtering eq. 8 to 13 |
//! | [`biquad`] | chains of biquads beside the modes | diffmodal eq. 2, 3 |
//! | [`scrape`] | force of a scrape or a roll | scraping-rolling eq. 1 to 7, 15 to 19 |
//! | [`residual`] | noise in decaying bands beside the modes | physics-diffusion eq. 5, 6 |
//! | [`pad`] | one object with its filters and strikers, and all they radiate | eq. 1 |
//! | [`scene`] | several pads: level, pan, stereo, and 24-bit quantisation | this project |
//!
//! The background noise `N` of eq. 1 is not part of this model. The room `IR_e` (eq. 19) is in
//! [`mod@room`], and the noise of the residual in [`residual`]; both are to be added to the sound
//! of a scene. The residual is compared with the instrument's by its expected values only, because
//! the two use different random numbers. Beyond eq. 1 the model has the striker's own bank with
//! weight η (as §4.3 does for tools), a cosine gain for every mode, gains that depend on the
//! position of the contact, and the choke.
//!
//! # Conventions
//!
//! Sample `n` stands for time `n/fs`. Events carry times in samples with a fraction. A strike's
//! fraction is never rounded: its pulse is evaluated at `n/fs`. Pulses are not band-limited. A
//! signal of 1.0 is 0 dBFS. Gains turn newton-seconds into that scale, so that one set of
//! parameters sounds alike at every sample rate.
//!
//! # Example
//!
//! ```
//! use reference::{Acceleration, Action, Event, Gain, Mode, Object, Pad, Pulse};
//! use reference::{SampleRate, Striker};
//!
//! let bell = Pad {
//!     object: Object {
//!         modes: vec![Mode {
//!             frequency_hz: 880.0,
//!             decay_per_s: 3.0,
//!             gains: vec![Gain { sine: 2.0, cosine: 0.0 }],
//!         }],
//!         acceleration: Acceleration::Factor(0.001),
//!         biquads: vec![],
//!         dynamic_filter: None,
//!     },
//!     strikers: vec![Striker {
//!         pulse: Pulse::Hertz { restitution: 0.45 },
//!         peak_force: 50.0,
//!         peak_exponent: Striker::HERTZ_PEAK_EXPONENT,
//!         contact_time_s: 0.0005,
//!         contact_exponent: Striker::HERTZ_CONTACT_EXPONENT,
//!         modes: vec![],
//!     }],
//!     striker_weight: 0.0,
//!     level_db: -6.0,
//!     pan: 0.0,
//!     choke_t60_s: 0.1,
//!     is_in_frames: false,
//! };
//! let strike = Event {
//!     time_samples: 10.25,
//!     pad: 0,
//!     velocity: 0.8,
//!     position: 0.0,
//!     striker: 0,
//!     action: Action::Strike,
//! };
//! let rate = SampleRate { numerator: 48_000, denominator: 1 };
//! let sound = reference::render(&[bell], &[strike], None, rate, 4_800)?;
//! assert_eq!(sound[10], [0.0, 0.0]);
//! assert_ne!(sound[11], [0.0, 0.0]);
//! # Ok::<(), reference::Error>(())
//! ```

pub mod biquad;
pub mod contact;
pub mod dynamic_filter;
pub mod event;
pub mod pad;
pub mod radiation;
pub mod residual;
pub mod resonator;
pub mod room;
pub mod scene;
pub mod scrape;
pub mod trigger;
pub mod waveguide;

mod error;
mod rate;

pub use contact::{Pulse, Striker};
pub use error::{BankOwner, Error};
pub use event::{Action, Direct, Event};
pub use pad::{Object, Pad};
pub use radiation::Acceleration;
pub use rate::SampleRate;
pub use resonator::{Bank, Gain, Mode};
pub use room::{RoomBand, network_twin, room};
pub use scene::{Scene, render};

//! Joint descent on modes and noise bands: from modes that are likely to a sound that is near.
//!
//! ```text
//! modes ─► closed-form spectra ─┐
//!                               ├─► expected error in dB of every cell ─► distance ─► slopes
//! bands ─► expected powers ─────┘        (noise is drawn at random)                     │
//!   ▲                                                                                   │
//!   └─────────────────────────────────── Adam ◄──────────────────────────────────────────┘
//! ```
//!
//! Least squares weigh energy, and the ear does not: a mode 40 dB down counts a ten-thousandth of
//! the strongest. With fewer modes than the sound has, the two ask for different modes. The
//! distances of the fit are errors of levels in dB, in single bins and in the ear's bands, and of
//! loudness. Noise is a part of the model from the beginning, so that modes need not fill what
//! noise fills better. Its scatter counts as distance.
//!
//! Frames begin before the onset, so that the attack is heard.

mod cancelling;
mod cell;
mod descent;
mod grid;
mod noise;
mod objective;
mod response;
mod spectra;
mod split;

/// Number of the loudest partials each of which has a mode, at the right level.
pub(crate) const LOUDEST: usize = 6;

pub(crate) use cancelling::{cancel, part_cancelling};
pub(crate) use descent::{Descent, HELD, Sounding};

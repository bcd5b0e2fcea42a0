//! Frequencies and shapes of bodies by means other than finite elements.

// Each test program takes a part of it.
#![allow(dead_code)]

pub(crate) mod bessel;
pub(crate) mod ellipse;
pub(crate) mod kirchhoff;
pub(crate) mod line;
pub(crate) mod ritz;
pub(crate) mod round;

//! Failure of the program, from any of its parts.

/// Failure of the program, from any of its parts.
pub(crate) type Failure = Box<dyn std::error::Error>;

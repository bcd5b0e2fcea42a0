//! Objective of a fit with filter, modes and loops together: the band levels that follow the law.

mod candidate;
mod descent;
mod numbers;
mod rows;
mod targets;

pub(crate) use candidate::Candidate;
pub(crate) use rows::Row;
pub(crate) use targets::Objective;

//! Arrays of exactly two numbers.

use serde::de::{Deserialize, Deserializer, Error};

/// Pair of numbers. A plain `[f32; 2]` is read from longer arrays, too, without their rest.
pub(super) struct Pair(pub(super) [f32; 2]);

impl<'de> Deserialize<'de> for Pair {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let numbers = Vec::<f32>::deserialize(deserializer)?;
        let count = numbers.len();
        numbers.try_into().map(Self).map_err(|_| D::Error::invalid_length(count, &"an array of two numbers"))
    }
}

//! Points of two numbers.

use serde::de::Error;
use serde::{Deserialize, Deserializer};

/// Point of exactly two numbers: a third one is a mistake, and would be dropped.
struct Point([f64; 2]);

impl<'de> Deserialize<'de> for Point {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let numbers = Vec::<f64>::deserialize(deserializer)?;
        let count = numbers.len();
        let point = <[f64; 2]>::try_from(numbers).map(Self);
        point.map_err(|_| D::Error::custom(format!("a point has two numbers here, and this one has {count}")))
    }
}

fn plain(points: Vec<Point>) -> Vec<[f64; 2]> {
    points.into_iter().map(|point| point.0).collect()
}

/// Reads a ring of points.
pub(super) fn ring<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<Vec<[f64; 2]>>, D::Error> {
    Vec::deserialize(deserializer).map(plain).map(Some)
}

/// Reads rings of points.
pub(super) fn rings<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Vec<Vec<[f64; 2]>>, D::Error> {
    let rings = Vec::<Vec<Point>>::deserialize(deserializer)?;
    Ok(rings.into_iter().map(plain).collect())
}

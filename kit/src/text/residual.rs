//! Tables `[object.residual]` and `[background]`: they are read and written.

use std::fmt::{self, Display, Formatter};

use toml::Spanned;

use super::number::shortest_decimal;
use crate::content::{Background, Residual};

/// Numbers of an array, each with its place in the file.
pub(super) type Numbers = Vec<Spanned<f32>>;

/// Table `[object.residual]`, key by key.
#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ResidualTable {
    #[serde(default)]
    seed: u32,
    edges_hz: Numbers,
    weight: Numbers,
    decay_db_per_s: Numbers,
}

/// Table `[background]`, key by key.
#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct BackgroundTable {
    #[serde(default)]
    seed: u32,
    edges_hz: Numbers,
    weight: Numbers,
}

/// Byte offsets of a residual or background, of its edges and of its bands in their file.
///
/// The offset of a band is that of its weight.
#[derive(Default)]
pub(super) struct NoiseOrigin {
    pub(super) offset: usize,
    pub(super) edges: Vec<usize>,
    pub(super) bands: Vec<usize>,
}

impl NoiseOrigin {
    fn new(offset: usize, edges: &Numbers, bands: &Numbers) -> Self {
        let offsets = |numbers: &Numbers| numbers.iter().map(|number| number.span().start).collect();
        Self { offset, edges: offsets(edges), bands: offsets(bands) }
    }
}

impl ResidualTable {
    pub(super) fn read(table: Spanned<Self>) -> (Residual, NoiseOrigin) {
        let offset = table.span().start;
        let Self { seed, edges_hz, weight, decay_db_per_s } = table.into_inner();
        let origin = NoiseOrigin::new(offset, &edges_hz, &weight);
        let residual =
            Residual { seed, edges_hz: plain(edges_hz), weight: plain(weight), decay_db_per_s: plain(decay_db_per_s) };
        (residual, origin)
    }
}

impl BackgroundTable {
    pub(super) fn read(table: Spanned<Self>) -> (Background, NoiseOrigin) {
        let offset = table.span().start;
        let Self { seed, edges_hz, weight } = table.into_inner();
        let origin = NoiseOrigin::new(offset, &edges_hz, &weight);
        (Background { seed, edges_hz: plain(edges_hz), weight: plain(weight) }, origin)
    }
}

fn plain(numbers: Numbers) -> Vec<f32> {
    numbers.into_iter().map(Spanned::into_inner).collect()
}

/// Wrapper of a value that is written as TOML.
pub(super) struct Text<T>(pub(super) T);

impl Display for Text<&Residual> {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let Residual { seed, edges_hz, weight, decay_db_per_s } = self.0;
        writeln!(f, "\n[object.residual]\nseed = {seed}")?;
        numbers(f, "edges_hz", edges_hz)?;
        numbers(f, "weight", weight)?;
        numbers(f, "decay_db_per_s", decay_db_per_s)
    }
}

impl Display for Text<&Background> {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let Background { seed, edges_hz, weight } = self.0;
        writeln!(f, "\n[background]\nseed = {seed}")?;
        numbers(f, "edges_hz", edges_hz)?;
        numbers(f, "weight", weight)
    }
}

/// Writes an array with ten numbers per line.
fn numbers(f: &mut Formatter<'_>, key: &str, numbers: &[f32]) -> fmt::Result {
    writeln!(f, "{key} = [")?;
    for line in numbers.chunks(10) {
        let line: Vec<String> = line.iter().map(|&number| shortest_decimal(number)).collect();
        writeln!(f, "    {},", line.join(", "))?;
    }
    writeln!(f, "]")
}

//! `malleus shape --benchmarks`: published frequencies beside the computed ones.

use ::shape::benchmarks;
use serde::Serialize;

use super::error::CommandError;
use super::output::{print, print_json, progress};
use super::shape::ShapeError;

/// Row that `--json` prints.
#[derive(Debug, Serialize)]
struct Row {
    benchmark: &'static str,
    mode: usize,
    published_hz: f64,
    computed_hz: f64,
    difference: f64,
}

pub(super) fn run(error: f64, is_json: bool) -> Result<(), CommandError> {
    let all = benchmarks::all();
    let bar = progress(all.len() as u64, "solving the benchmarks");
    let mut rows = Vec::new();
    for benchmark in &all {
        let computed = benchmark.solve(error).map_err(ShapeError::Benchmark)?;
        for (mode, (&published_hz, computed_hz)) in benchmark.published_hz.iter().zip(computed).enumerate() {
            let difference = computed_hz / published_hz - 1.0;
            rows.push(Row { benchmark: benchmark.name, mode: mode + 1, published_hz, computed_hz, difference });
        }
        bar.inc(1);
    }
    bar.finish_and_clear();
    if is_json {
        return print_json(&rows);
    }
    let mut text = String::from("benchmark                mode  published Hz  computed Hz  difference %\n");
    for row in &rows {
        text += &format!(
            "{:24} {:4}  {:12.4} {:12.4}  {:12.3}\n",
            row.benchmark,
            row.mode,
            row.published_hz,
            row.computed_hz,
            100.0 * row.difference
        );
    }
    print(&text)
}

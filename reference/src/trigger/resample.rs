//! Resampling from one clock to another.

/// Returns `count` samples of `signal` at positions `k · step - delay`, in samples.
///
/// Each sample comes from the polynomial through the six samples round it (Lagrange). Samples
/// before the beginning and behind the end count as 0.
pub fn resample(signal: &[f64], step: f64, delay: usize, count: usize) -> Vec<f64> {
    (0..count).map(|k| at(signal, k as f64 * step - delay as f64)).collect()
}

fn at(signal: &[f64], position: f64) -> f64 {
    let whole = position.floor();
    let fraction = position - whole;
    let sample = |node: i64| {
        let index = whole as i64 + node;
        usize::try_from(index).ok().and_then(|index| signal.get(index)).copied().unwrap_or(0.0)
    };
    let weight = |node: i64| {
        let others = (-2..=3).filter(|&other| other != node);
        others.map(|other| (fraction - other as f64) / (node - other) as f64).product::<f64>()
    };
    (-2..=3).map(|node| weight(node) * sample(node)).sum()
}

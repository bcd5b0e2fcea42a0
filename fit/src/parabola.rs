//! Place of a peak between the bins of a spectrum.

/// Place of the top of the parabola through three neighbours, in bins from the middle one; 0 if the
/// three do not bend downwards.
pub(crate) fn top([left, middle, right]: [f64; 3]) -> f64 {
    let bend = left - 2.0 * middle + right;
    if bend < 0.0 { 0.5 * (left - right) / bend } else { 0.0 }
}

/// Peaks of a spectrum: the place of each in bins, and the value of its highest bin.
pub(crate) fn peaks(spectrum: &[f64]) -> impl Iterator<Item = (f64, f64)> {
    spectrum.windows(3).enumerate().filter_map(|(before, three)| {
        let three @ [left, middle, right] = [three[0], three[1], three[2]];
        (middle >= left && middle > right).then(|| (before as f64 + 1.0 + top(three), middle))
    })
}

#[cfg(test)]
mod tests {
    #[test]
    fn peaks_of_parabolas_are_found_between_their_bins() {
        let spectrum: Vec<f64> = (0..9u8).map(|bin| 4.0 - (f64::from(bin) - 3.3).powi(2)).collect();
        let found: Vec<(f64, f64)> = super::peaks(&spectrum).collect();
        assert!(found.len() == 1 && (found[0].0 - 3.3).abs() < 1e-12 && found[0].1 == spectrum[3], "{found:?}");
    }
}

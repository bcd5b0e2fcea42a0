//! Path of a ball over a profile.

/// Heights of a ball's lowest point that rolls over a row without sinking in: at each place the
/// ball rests on the highest point under it, `max_u z(x+u) + sqrt(R² - u²) - R`.
///
/// Points farther off than the height of the row allows never touch, and are not looked at.
pub(super) fn path(row: &[f64], step_m: f64, radius_m: f64) -> Vec<f64> {
    let highest = row.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let lowest = row.iter().copied().fold(f64::INFINITY, f64::min);
    let sink = (highest - lowest).min(radius_m);
    let reach = ((2.0 * radius_m * sink - sink * sink).sqrt() / step_m) as usize + 1;
    let ball: Vec<f64> = (0..=reach)
        .map(|away| (radius_m * radius_m - (away as f64 * step_m).powi(2)).max(0.0).sqrt() - radius_m)
        .take_while(|depth| *depth > -radius_m)
        .collect();
    let at = |middle: usize| {
        let from = middle.saturating_sub(ball.len() - 1);
        let to = (middle + ball.len()).min(row.len());
        (from..to).map(|place| row[place] + ball[place.abs_diff(middle)]).fold(f64::NEG_INFINITY, f64::max)
    };
    (0..row.len()).map(at).collect()
}

//! Path of a scraper's tip over a surface's heights.

use std::f64::consts::TAU;

use fourier::Complex;

/// Points of the path for each height.
const FINE: usize = 8;

/// Path whose curvature is `tanh(α z'')/α`, at [`FINE`] points a height. Without a limit α its
/// curvature is the surface's own. Slope and height decay over `leak_m`, as in the instrument.
pub(crate) fn path(heights_m: &[f64], length_m: f64, leak_m: f64, alpha_m: Option<f64>) -> Vec<f64> {
    let points = heights_m.len() * FINE;
    let wave = |bin: usize| TAU * bin as f64 / length_m;
    let curvature: Vec<_> =
        forward(heights_m.to_vec()).iter().enumerate().map(|(bin, value)| value * -wave(bin).powi(2)).collect();
    let limited = match alpha_m {
        None => inverse(&curvature, points),
        Some(alpha_m) => inverse(&curvature, points).into_iter().map(|z| (alpha_m * z).tanh() / alpha_m).collect(),
    };
    let risen: Vec<_> = forward(limited)
        .into_iter()
        .enumerate()
        .map(|(bin, value)| {
            let leaking = Complex::new(1.0 / leak_m, wave(bin));
            // The mean belongs to no wave.
            if bin == 0 { Complex::new(0.0, 0.0) } else { value / (leaking * leaking) }
        })
        .collect();
    inverse(&risen, points)
}

/// Amplitudes of a periodic signal from the mean up.
fn forward(mut samples: Vec<f64>) -> Vec<Complex<f64>> {
    let transform = fourier::forward(samples.len());
    let scale = 1.0 / samples.len() as f64;
    let mut bins = transform.make_output_vec();
    transform.process(&mut samples, &mut bins).expect("slices of the plan's lengths");
    bins.iter().map(|bin| bin * scale).collect()
}

/// Samples of amplitudes at a number of points.
fn inverse(amplitudes: &[Complex<f64>], points: usize) -> Vec<f64> {
    let transform = fourier::inverse(points);
    let mut bins = transform.make_input_vec();
    let last = bins.len() - 1;
    bins.iter_mut().zip(amplitudes).take(last).for_each(|(bin, value)| *bin = *value);
    bins[0].im = 0.0;
    let mut samples = transform.make_output_vec();
    transform.process(&mut bins, &mut samples).expect("slices of the plan's lengths");
    samples
}

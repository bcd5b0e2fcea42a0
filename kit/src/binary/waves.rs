//! Periodic signals as sums of waves, and the 16-bit splines that a kit holds of them.

use dsp_core::table::layout::GUARD;
use fourier::Complex;

/// Complex amplitudes of a periodic signal, from the mean up.
pub(super) fn bins(mut samples: Vec<f64>) -> Vec<Complex<f64>> {
    let transform = fourier::forward(samples.len());
    let mut bins = transform.make_output_vec();
    let scale = 1.0 / samples.len() as f64;
    transform.process(&mut samples, &mut bins).expect("slices of the plan's lengths");
    bins.iter_mut().for_each(|bin| *bin *= scale);
    bins
}

/// Waves of a derivative of a periodic line; the highest one of an even number of points, whose
/// phase is not known, is left out.
pub(super) fn derivative(line: Vec<f64>, length_m: f64, order: i32) -> Vec<Complex<f64>> {
    let even = line.len().is_multiple_of(2);
    let mut bins = bins(line);
    let last = bins.len() - 1;
    for (bin, value) in bins.iter_mut().enumerate() {
        let wave = Complex::new(0.0, std::f64::consts::TAU * bin as f64 / length_m);
        *value *= if even && bin == last { Complex::new(0.0, 0.0) } else { wave.powi(order) };
    }
    bins
}

/// Samples of a periodic signal at a number of points; waves that they cannot hold are left out.
pub(super) fn values(amplitudes: &[Complex<f64>], points: usize) -> Vec<f64> {
    let transform = fourier::inverse(points);
    let mut input = transform.make_input_vec();
    let last = points / 2;
    for (place, value) in input.iter_mut().zip(amplitudes).take(last) {
        *place = *value;
    }
    if let Some(mean) = input.first_mut() {
        mean.im = 0.0;
    }
    let mut output = transform.make_output_vec();
    transform.process(&mut input, &mut output).expect("slices of the plan's lengths");
    output
}

/// Coefficients of the cubic spline that has the signal's amplitudes: the spline's own response,
/// sinc^4, is taken out.
pub(super) fn spline(amplitudes: &[Complex<f64>], points: usize) -> Vec<f64> {
    let response = |bin: usize| {
        let x = std::f64::consts::PI * bin as f64 / points as f64;
        if bin == 0 { 1.0 } else { (x.sin() / x).powi(4) }
    };
    let without: Vec<_> =
        amplitudes.iter().take(points / 2).enumerate().map(|(bin, value)| value / response(bin)).collect();
    values(&without, points)
}

/// Periodic coefficients with their guard: the last one before the first, and the first two behind
/// the last.
pub(super) fn guarded(coefficients: Vec<f64>) -> Vec<f64> {
    let last = coefficients.last().copied();
    let first = coefficients.clone();
    last.into_iter().chain(coefficients).chain(first.into_iter().take(GUARD - 1)).collect()
}

/// Numbers as 16-bit integers, and the value of one unit.
pub(super) fn quantized(values: &[f64]) -> (Vec<i16>, f64) {
    let largest = values.iter().fold(0.0_f64, |largest, value| largest.max(value.abs()));
    let unit = f64::from((largest / f64::from(i16::MAX)) as f32);
    (values.iter().map(|value| (value / unit).round() as i16).collect(), unit)
}

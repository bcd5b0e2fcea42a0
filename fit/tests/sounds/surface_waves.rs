//! Waves of a surface that its table keeps: where they end, and where points are missing.

use std::f64::consts::TAU;

use fit::surface::{Heights, Note, Options, Report, fit};
use fourier::Complex;

/// Numbers from 0 to 1 (xorshift, Marsaglia 2003).
fn random(mut state: u64) -> impl FnMut() -> f64 {
    move || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 11) as f64 / (1u64 << 53) as f64
    }
}

/// A profile of 5 µm rms whose density of heights falls by `f^slope` from waves of 20 mm on down to
/// `shortest_m`, with nothing below.
fn band_limited(points: usize, step_m: f64, shortest_m: f64, slope: f64, seed: u64) -> Heights {
    let mut uniform = random(seed);
    let inverse = fourier::inverse(points);
    let (mut bins, mut values) = (inverse.make_input_vec(), inverse.make_output_vec());
    for (bin, value) in bins.iter_mut().enumerate() {
        let frequency_per_m = bin as f64 / (points as f64 * step_m);
        if (50.0..=1.0 / shortest_m).contains(&frequency_per_m) {
            *value = Complex::from_polar(frequency_per_m.powf(0.5 * slope), TAU * uniform());
        }
    }
    inverse.process(&mut bins, &mut values).expect("plan and buffers have one length");
    let rms = (values.iter().map(|height| height * height).sum::<f64>() / points as f64).sqrt();
    values.iter_mut().for_each(|height| *height *= 5e-6 / rms);
    Heights { step_m, columns: points, values }
}

fn report(heights: &Heights, options: Options) -> (Report, Vec<Note>) {
    let (_, report, notes) = fit(heights.clone(), &options, |_| {}).expect("it is a surface");
    (report, notes)
}

#[test]
fn shortest_wave_is_found_where_it_is_longer_than_0_7_mm() {
    for points in [2_048, 65_536] {
        for slope in [0.0, -4.0] {
            for shortest_m in [0.5e-3, 0.7e-3, 0.8e-3, 0.9e-3, 1.2e-3, 1.4e-3, 2e-3] {
                let heights = band_limited(points, 1e-4, shortest_m, slope, 1);
                let (report, notes) = report(&heights, Options::default());
                let ratio = report.shortest_m / shortest_m;
                println!("{points} points, slope {slope}, {shortest_m} m: {ratio:.3}");
                assert!((ratio - 1.0).abs() < 0.15, "{points} points, slope {slope}, {shortest_m} m: {ratio}");
                assert!(notes.iter().any(|note| matches!(note, Note::Upsampled { .. })), "{notes:?}");
            }
        }
    }
}

#[test]
fn grooves_of_2_mm_are_not_the_shortest_wave_of_a_rough_surface() {
    let mut heights = band_limited(65_536, 1e-5, 2.5e-5, -2.0, 1);
    let groove = |n: usize| 5e-5 * (TAU * n as f64 * 1e-5 / 2e-3).sin();
    heights.values.iter_mut().enumerate().for_each(|(n, height)| *height += groove(n));
    assert!(report(&heights, Options::default()).0.shortest_m < 2.6e-5);
}

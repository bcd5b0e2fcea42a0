//! Waves of a surface that its table keeps: where they end, and where points are missing.

use std::f64::consts::TAU;

use fit::surface::{Heights, Note, Options, Report, Source, SurfaceError, fit};
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

/// Heights without a share of their points.
fn with_holes(heights: &Heights, share: f64) -> Heights {
    let mut uniform = random(3);
    let mut holed = heights.clone();
    holed.values.iter_mut().for_each(|height| *height = if uniform() < share { f64::NAN } else { *height });
    holed
}

/// Asserts that a surface with holes has the waves and the curvature of the whole one.
fn assert_alike(name: &str, whole: &Report, holed: &Report) {
    let in_um = [whole, holed].map(|report| 1e6 * report.shortest_m);
    let curvatures = [whole, holed].map(|report| report.curvature_rms_per_m);
    let kurtosis = [whole, holed].map(|report| report.kurtosis[0]);
    println!("{name}: shortest wave {in_um:.2?} µm, curvature {curvatures:.1?} 1/m, kurtosis {kurtosis:.3?}");
    assert!((in_um[1] / in_um[0] - 1.0).abs() < 0.02, "{name}: shortest wave {in_um:?} µm");
    assert!((curvatures[1] / curvatures[0] - 1.0).abs() < 0.01, "{name}: curvature {curvatures:?} 1/m");
    assert!((kurtosis[1] - kurtosis[0]).abs() < 0.05, "{name}: kurtosis {kurtosis:?}");
}

#[test]
fn single_missing_points_leave_the_waves_of_a_smooth_profile_as_they_are() {
    for points_per_wave in [4.0, 6.0, 10.0, 16.0] {
        let heights = band_limited(32_768, 4e-6, points_per_wave * 4e-6, -2.0, 1);
        let (whole, _) = report(&heights, Options::default());
        for share in [0.01, 0.05] {
            let (holed, notes) = report(&with_holes(&heights, share), Options::default());
            let name = format!("{points_per_wave} points a wave, {share} missing");
            assert_alike(&name, &whole, &holed);
            assert!(notes.iter().any(|note| matches!(note, Note::Filled { .. })), "{notes:?}");
        }
    }
}

#[test]
fn missing_points_of_a_noisy_profile_are_filled_without_more_noise() {
    let mut heights = band_limited(32_768, 4e-6, 40e-6, -2.0, 1);
    let mut uniform = random(5);
    heights.values.iter_mut().for_each(|height| *height += 2e-6 * (uniform() - 0.5));
    let curvature = |heights: &Heights| report(heights, Options::default()).0.curvature_rms_per_m;
    let (whole, holed) = (curvature(&heights), curvature(&with_holes(&heights, 0.05)));
    println!("noisy: curvature {whole:.0} and {holed:.0} 1/m");
    assert!((holed / whole - 1.0).abs() < 0.05, "{holed} and {whole} 1/m");
}

/// A map of waves in all directions, none shorter than 80 µm, in steps of 10 µm.
fn wavy_map(columns: usize, rows: usize) -> Heights {
    let mut uniform = random(9);
    let waves: Vec<[f64; 4]> = (0..200)
        .map(|_| {
            let (direction, length_m) = (TAU * uniform(), 80e-6 / uniform().max(0.05));
            [TAU / length_m * direction.cos(), TAU / length_m * direction.sin(), TAU * uniform(), length_m / 80e-6]
        })
        .collect();
    let height = |index: usize| {
        let (x, y) = ((index % columns) as f64 * 1e-5, (index / columns) as f64 * 1e-5);
        waves.iter().map(|[along, across, phase, size]| 1e-7 * size * (along * x + across * y + phase).sin()).sum()
    };
    Heights { step_m: 1e-5, columns, values: (0..columns * rows).map(height).collect() }
}

#[test]
fn single_missing_points_leave_the_waves_of_a_smooth_map_as_they_are() {
    let heights = wavy_map(400, 400);
    for source in [Source::Map, Source::Statistics] {
        let options = Options { source, ..Options::default() };
        let (whole, _) = report(&heights, options);
        for share in [0.01, 0.05] {
            let (holed, _) = report(&with_holes(&heights, share), options);
            assert_alike(&format!("{source:?}, {share} missing"), &whole, &holed);
        }
    }
}

#[test]
fn strip_of_a_map_has_one_table_whichever_way_round_it_is_saved() {
    let wide = wavy_map(300, 128);
    let tall = Heights { columns: 128, values: by_columns(&wide), ..wide };
    for source in [Source::Map, Source::Statistics] {
        let options = Options { source, ..Options::default() };
        let (of_wide, _) = report(&wide, options);
        let (of_tall, notes) = report(&tall, options);
        println!("{source:?}: {:.1} and {:.1} 1/m", of_wide.curvature_rms_per_m, of_tall.curvature_rms_per_m);
        // A map's sides are rounded to whole steps, the second one to those of the first.
        let close = |a: f64, b: f64| (a / b - 1.0).abs() < if source == Source::Map { 0.03 } else { 1e-9 };
        assert!(close(of_tall.curvature_rms_per_m, of_wide.curvature_rms_per_m), "{of_tall:?}");
        assert!(close(of_tall.flash_bytes as f64, of_wide.flash_bytes as f64), "{of_tall:?}");
        assert_eq!(of_tall.shortest_m, of_wide.shortest_m);
        let is_told = notes.iter().any(|note| matches!(note, Note::Rows { rows: 128, is_turned: true }));
        assert_eq!(is_told, source == Source::Statistics, "{notes:?}");
    }
    // A list of points has many lines, too, and is no map.
    let list = Heights { step_m: 1e-5, columns: 3, values: vec![1e-6; 3_000] };
    let refused = fit(list, &Options::default(), |_| {});
    assert!(matches!(refused, Err(SurfaceError::TooFew { points: 3, .. })), "{refused:?}");
}

/// Heights of a map column by column.
fn by_columns(map: &Heights) -> Vec<f64> {
    let (columns, rows) = (map.columns, map.values.len() / map.columns);
    (0..columns * rows).map(|index| map.values[index % rows * columns + index / rows]).collect()
}
